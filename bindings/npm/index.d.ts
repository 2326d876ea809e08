// lockstep2d: deterministic 2D physics for the web.

// For `using`: these declarations are those of TypeScript's library `esnext.disposable`, which a project may lack.
declare global {
    interface SymbolConstructor {
        readonly dispose: unique symbol;
    }
    interface Disposable {
        [Symbol.dispose](): void;
    }
}

/** A fixed-point number as an argument: an integer, decimal text such as `"0.1"`, or an `Fx`. A float is an error. */
export type Num = number | string | Fx;
/** A vector as an argument. */
export type Vec = readonly [Num, Num] | { readonly x: Num; readonly y: Num };
/** A vector as a result. */
export interface Vec2 {
    /** Component to the right. */
    x: Fx;
    /** Component upwards. */
    y: Fx;
}
declare const handleBrand: unique symbol;
/** Handle of a body: a number that its world never uses again. The first bodies of a world have the handles 0, 1, 2 and
 * so on, in order. `poses()` and files have plain numbers: convert them by `as BodyId`. */
export type BodyId = number & { readonly [handleBrand]: "body" };
/** Handle of a shape. Handles of bodies, shapes and joints are counted separately. */
export type ShapeId = number & { readonly [handleBrand]: "shape" };
/** Handle of a joint. */
export type JointId = number & { readonly [handleBrand]: "joint" };
/** A rotation as an argument, counter-clockwise: `degrees(45)`, `radians("0.5")`, `turns("0.25")`, or 0. */
export type Rotation = Angle | 0;

/** Options of `init`. */
export interface InitOptions {
    /** Chooses the module with or without SIMD; by default, with SIMD if the machine has it. */
    simd?: boolean | undefined;
    /** A module to use instead of the inlined one: a `WebAssembly.Module`, a `Response`, an `ArrayBuffer` or a view. */
    wasm?: object | undefined;
}
/** Loads the wasm module. Call it once before all other functions except `fx`, `degrees`, `radians`, `turns` and
 * `loaded`. */
export function init(options?: InitOptions): Promise<void>;
/** The module that was loaded: with SIMD, without SIMD, or `InitOptions.wasm`. Undefined before `init`. */
export function loaded(): "simd" | "plain" | "given" | undefined;
/** Version of the engine's arithmetic: programs with different versions compute different states. */
export function semantics(): number;
/** Number of objects that neither `dispose` nor the garbage collector has freed. */
export function objectCount(): number;

/** An error with a code, such as `FLOAT`, `STALE_BODY`, `GEOMETRY`, `DISPOSED`. */
export class Lockstep2dError extends Error {
    /** Kind of the error: the name of an error of the C API without `LS2D_`, or `FLOAT`, `INIT`, `DISPOSED`, `MEMORY`,
     * `RELAY`. */
    readonly code: string;
    /** The verdict on a replay that cannot be played. */
    readonly verdict?: Verdict;
}

/** A fixed-point number of 64 bits with 32 fraction bits: -2^31 to just below 2^31, in steps of 2.3e-10. Immutable.
 * Arithmetic is rounded to nearest and saturates: a result out of range becomes the nearest number in range. */
export class Fx {
    #private;
    private constructor(raw: bigint);
    /** The number of `raw` units of 2^-32. */
    static fromRaw(raw: bigint | number): Fx;
    /** The number in units of 2^-32. */
    readonly raw: bigint;
    /** The sum; saturates. */
    add(other: Num): Fx;
    /** The difference; saturates. */
    sub(other: Num): Fx;
    /** The product, rounded to nearest; saturates. */
    mul(other: Num): Fx;
    /** The quotient, rounded to nearest; saturates. Division by zero throws `NUMBER`. */
    div(other: Num): Fx;
    /** The negative number; saturates. */
    neg(): Fx;
    /** The absolute value; saturates. */
    abs(): Fx;
    /** The smaller number. */
    min(other: Num): Fx;
    /** The larger number. */
    max(other: Num): Fx;
    /** -1 if this number is less than the other one, 0 if they are equal, otherwise 1. */
    compare(other: Num): -1 | 0 | 1;
    /** Whether this number is less than the other one. */
    lt(other: Num): boolean;
    /** Whether this number is greater than the other one. */
    gt(other: Num): boolean;
    /** Whether the numbers are equal. */
    eq(other: Num): boolean;
    /** The number rounded down to an integer, which may enter the simulation. */
    floor(): number;
    /** A float for drawing. It must not enter the simulation. */
    toNumber(): number;
    /** Decimal text with up to 10 decimals, which `fx` reads as the same number. */
    toString(): string;
    /** The decimal text. */
    toJSON(): string;
}
/** Makes a fixed-point number: `fx("1.25")`. Numbers out of range are errors. */
export function fx(value: Num): Fx;

/** A rotation in units of 2^-32 turn, counter-clockwise. Immutable. Sums and differences drop whole turns. */
export class Angle {
    #private;
    /** `bits` is an integer in units of 2^-32 turn. */
    constructor(bits: number);
    /** The rotation in units of 2^-32 turn, 0 to 2^32 - 1. */
    readonly bits: number;
    /** The sum. */
    add(other: Rotation): Angle;
    /** The difference. */
    sub(other: Rotation): Angle;
    /** The opposite rotation. */
    neg(): Angle;
    /** Degrees above -180 and up to 180: exact. */
    toDegrees(): Fx;
    /** Radians above -pi and up to pi, rounded to nearest. */
    toRadians(): Fx;
    /** Radians for drawing, as a float. */
    toNumber(): number;
    /** Degrees as decimal text, such as "45". */
    toString(): string;
    /** Returns `bits`, for `JSON.stringify`. */
    toJSON(): number;
}
/** An angle of a number of degrees, rounded to nearest. */
export function degrees(value: Num): Angle;
/** An angle of a number of radians, rounded to nearest. */
export function radians(value: Num): Angle;
/** An angle of a number of full turns: `turns("0.25")` is a right angle. */
export function turns(value: Num): Angle;

/** The square root, rounded to nearest. A negative number throws `NUMBER`. */
export function sqrt(value: Num): Fx;
/** The length of a vector, rounded to nearest. */
export function hypot(x: Num, y: Num): Fx;
/** The sine of an angle. */
export function sin(angle: Rotation): Fx;
/** The cosine of an angle. */
export function cos(angle: Rotation): Fx;
/** The direction of a vector, measured from the x axis; 0 for the zero vector. */
export function angleOf(vector: Vec): Angle;
/** `a.x b.x + a.y b.y`, rounded once. */
export function dot(a: Vec, b: Vec): Fx;
/** `a.x b.y - a.y b.x`, rounded once. */
export function cross(a: Vec, b: Vec): Fx;
/** The unit vector in the direction of a vector. The zero vector throws `NUMBER`. */
export function normalize(vector: Vec): Vec2;
/** The vector turned by an angle. */
export function rotate(vector: Vec, angle: Rotation): Vec2;
/** Hash of bytes: 32 hexadecimal digits. */
export function hashBytes(bytes: Uint8Array): string;
/** A random number generator. Keep `state` in the state of the game. */
export class Random {
    /** `seed` is an integer, of which the lower 64 bits count. */
    constructor(seed: number | bigint);
    /** State of the generator. Assign it to continue from a saved state. */
    state: { state: bigint; increment: bigint };
    /** A uniform integer from 0 to below `bound`. */
    below(bound: number): number;
    /** A uniform number from `low` to below `high`. */
    range(low: Num, high: Num): Fx;
}

/** Rule that combines the values of two shapes: `(a + b) / 2`, `sqrt(a b)`, the smaller value, `a b`, the larger value.
 * If the shapes have different rules, the one that comes later in this list applies. */
export type Mixing = "average" | "geometricMean" | "minimum" | "product" | "maximum";
/** Effect of a sensor on the dynamic bodies in it, in proportion to the part of each shape that is inside. Directions
 * are in the frame of the area's body. Every effect is 0 by default. */
export interface AreaOptions {
    /** Acceleration in m/s² of bodies in the area, within ±10 000 on each axis. It is added to gravity. */
    acceleration?: Vec;
    /** Force in N per m² of the part of a body that is inside the area, within ±2^20 on each axis. */
    force?: Vec;
    /** Velocity of the medium in m/s relative to the area's body, within ±400 on each axis. It acts by `linearDrag`. */
    flow?: Vec;
    /** Rate per second at which the velocity of bodies approaches that of the medium, 0 to 1000. */
    linearDrag?: Num;
    /** Rate per second at which the angular velocity of bodies approaches that of the medium, 0 to 1000. */
    angularDrag?: Num;
    /** Density of the medium in kg/m², for buoyancy, 0 to 2^20. */
    density?: Num;
    /** Acceleration in m/s² towards the centre of the area (±10 000, a negative one repels), at the distance `radius`
     * in metres (0.01 to 2^20). `falloff` applies beyond `radius`: `constant` by default. Nearer to the centre the
     * acceleration decreases linearly to 0. */
    attraction?: { acceleration: Num; radius: Num; falloff?: "constant" | "inverse" | "inverseSquare" };
}
/** Properties of a shape. */
export interface ShapeOptions {
    /** Centre in the body's frame, in metres: within ±128 on each axis if the body can move. The origin by default. */
    offset?: Vec;
    /** Mass per area in kg/m², 0 to 2^20: 1 by default. Segments and chains have no area, and so no mass. */
    density?: Num;
    /** Friction coefficient, 0 to 16: 0.6 by default. */
    friction?: Num;
    /** Rule that combines the friction of two shapes: `geometricMean` by default. */
    frictionMixing?: Mixing;
    /** Fraction of the approach speed that a bounce returns, 0 to 1.5: 0 by default. */
    restitution?: Num;
    /** Rule that combines the restitution of two shapes: `maximum` by default. */
    restitutionMixing?: Mixing;
    /** Approach speed in m/s below which the shape does not bounce, 0 to 400: that of the world by default. Of two
     * shapes the smaller value applies. */
    restitutionThreshold?: Num;
    /** Rolling resistance of a round shape as a fraction of its radius, 0 to 1: 0 by default. */
    rollingResistance?: Num;
    /** Speed of the surface around the shape, clockwise, in m/s, within ±400: 0 by default. */
    surfaceSpeed?: Num;
    /** 64 bits of the categories that the shape belongs to: 1 by default. Two shapes collide if the mask of each has a
     * category of the other. */
    category?: bigint | number;
    /** Bits of the categories that the shape collides with: all by default. */
    mask?: bigint | number;
    /** Shapes with the same group other than 0 always collide if the number is positive, and never if it is
     * negative. An integer of 32 bits: 0 by default. */
    group?: number;
    /** Makes the shape a one-way platform: the direction, in the body's frame, in which other shapes pass through it;
     * `degrees(90)` is up. */
    oneWay?: Rotation;
    /** Makes the shape a sensor, which detects overlaps and does not collide. False by default. */
    sensor?: boolean;
    /** Makes the shape a sensor that acts on the bodies in it. Segments and chains cannot be areas. */
    area?: AreaOptions;
    /** Whether the contacts of the shape are in `contactBegin` and `contactEnd`: true by default. It is enough if one
     * of the two shapes has the option. */
    contactEvents?: boolean;
    /** Whether the hits of the shape are in `hits`: false by default. It is enough if one of the two shapes has the
     * option. */
    hitEvents?: boolean;
    /** Whether sensors detect the shape: true by default. */
    sensorEvents?: boolean;
    /** Whether the shape, if it is a sensor, detects other sensors, too: false by default. */
    detectSensors?: boolean;
    /** Radius in metres by which a polygon, hull or box is rounded outwards, 0 or more: 0 by default. */
    rounding?: Num;
    /** A number of 64 bits for the game, part of the state: 0 by default. */
    userData?: bigint | number;
}
declare const shapeBrand: unique symbol;
/** A shape to be added to a body, made by `circle`, `box` and so on. */
export interface ShapeDef {
    readonly [shapeBrand]: true;
}
/** A chain of lines, to be added to a body. */
export interface ChainDef {
    readonly [shapeBrand]: false;
}
/** A disc with a radius in metres, 0.002 to 110. */
export function circle(radius: Num, options?: ShapeOptions): ShapeDef;
/** A rectangle with half its width and half its height in metres, each up to 110. */
export function box(halfWidth: Num, halfHeight: Num, options?: ShapeOptions): ShapeDef;
/** A convex polygon of 3 to 8 points in counter-clockwise order, in metres from the shape's centre, within ±110. */
export function polygon(points: readonly Vec[], options?: ShapeOptions): ShapeDef;
/** The convex hull of 3 to 8 points in any order, in metres from the shape's centre, within ±110. */
export function hull(points: readonly Vec[], options?: ShapeOptions): ShapeDef;
/** All points within `radius` metres, at least 0.002, of the line from `a` to `b`, which are at least 0.002 m apart. */
export function capsule(a: Vec, b: Vec, radius: Num, options?: ShapeOptions): ShapeDef;
/** A line without area, at least 0.002 m long. It has no mass, and does not collide with segments and chains. */
export function segment(a: Vec, b: Vec, options?: ShapeOptions): ShapeDef;
/** A smooth outline of 2 points or more, 3 if it is closed, with up to 4096 lines, for ground and walls. It has no
 * mass. `closed` connects the last point with the first. `oneSided` makes it solid only from the right side, along the
 * points in their order. Both are false by default. */
export function chain(points: readonly Vec[], options?: ShapeOptions & { closed?: boolean; oneSided?: boolean }): ChainDef;

/** Mass in kg, centre of mass and radius of gyration in metres of a dynamic body with some shapes, for the option
 * `mass`: `{ ...massOf(shapes), mass: 80 }` is a mass of 80 kg with the distribution of the shapes. */
export function massOf(shapes: readonly ShapeDef[]): { mass: Fx; centre: Vec2; gyration: Fx };

/** `fixed`: does not move. `kinematic`: moves at its velocity, which forces and contacts do not change. `dynamic`:
 * moved by forces, contacts and joints. */
export type BodyType = "fixed" | "kinematic" | "dynamic";
/** Mass of a body that does not follow from its shapes. */
export interface MassOptions {
    /** Mass in kg, 1e-5 to 2^30. */
    mass: Num;
    /** Centre of mass in the body's frame in metres, within ±128 on each axis. The origin by default. */
    centre?: Vec;
    /** Radius of gyration about the centre of mass in metres, 0.002 to 512: `sqrt(inertia / mass)`. */
    gyration: Num;
}
/** Settings of a body that `setBody` changes. */
export interface BodySettings {
    /** Decay rate of the velocity, per second, 0 to 1000: 0 by default. */
    linearDamping?: Num;
    /** Decay rate of the angular velocity, per second, 0 to 1000: 0 by default. */
    angularDamping?: Num;
    /** Factor on the world's gravity, within ±1000: 1 by default. */
    gravityScale?: Num;
    /** Speed in m/s below which the body becomes ready to sleep, 0 to 400: 0.05 by default. */
    sleepSpeed?: Num;
    /** Bodies through which the body cannot tunnel: `fixed` by default. `bullet`: all except bullets. `kinematic`:
     * fixed and kinematic bodies. */
    continuous?: "off" | "fixed" | "bullet" | "kinematic";
    /** Whether the body may fall asleep: true by default. */
    maySleep?: boolean;
    /** Whether the body cannot move along the x axis of the world: false by default. */
    lockX?: boolean;
    /** Whether the body cannot move along the y axis of the world: false by default. */
    lockY?: boolean;
    /** Whether the body cannot turn: false by default. */
    lockRotation?: boolean;
}
/** Definition of a body. */
export interface BodyOptions extends BodySettings {
    /** `dynamic` by default. */
    type?: BodyType;
    /** Origin of the body in the world, in metres, within ±2^30 on each axis. [0, 0] by default. */
    position?: Vec;
    /** Rotation of the body: 0 by default. */
    angle?: Rotation;
    /** Velocity of the centre of mass in m/s, up to the world's `speedMax`. Zero by default. */
    velocity?: Vec;
    /** Angular velocity in rad/s, counter-clockwise: 0 by default. */
    angularVelocity?: Num;
    /** Mass, centre of mass and radius of gyration, instead of the values that follow from the shapes. A dynamic body
     * without this option, and without a shape that has both an area and a density, has mass 0: gravity, forces,
     * impulses, contacts and joints do not move it, without an error. */
    mass?: MassOptions;
    /** Whether the body takes part in the simulation: true by default. */
    enabled?: boolean;
    /** Whether a dynamic body is asleep at first: false by default. */
    asleep?: boolean;
    /** A number of 64 bits for the game, part of the state: 0 by default. */
    userData?: bigint | number;
    /** Name of the body in reports: at most 16 letters, digits, `-` and `_`. */
    name?: string;
    /** Shapes of the body, at most 4096 with the links of chains: none by default. */
    shapes?: readonly (ShapeDef | ChainDef)[];
}

/** A damped spring of a joint. */
export interface Spring {
    /** Frequency in Hz, above 0 and up to 1000. */
    hertz: Num;
    /** Damping ratio, 0 to 100: 0 by default; 1 is critical damping. */
    dampingRatio?: Num;
    /** Rest position of the spring, in rad or m: 0 by default. */
    target?: Num;
}
/** A joint. It has a frame on each body: an anchor and an angle. An option that its type does not have throws `VALUE`;
 * a value out of range throws `JOINT`. */
export interface JointOptions {
    /** - `revolute`: a hinge.
     * - `prismatic`: B slides along the x axis of A's frame and does not turn.
     * - `distance`: a rod (`rod`), a rope (`limit`) or a spring between the anchors.
     * - `weld`: B keeps its pose relative to A, rigidly or by springs.
     * - `wheel`: B slides along the x axis of A's frame and turns.
     * - `motor`: B is driven relative to A with limited force.
     * - `filter`: the bodies do not collide with each other.
     * - `gear`: the wheels about the anchors turn in a fixed ratio.
     * - `rack`: the wheel about A's anchor rolls along the x axis of B's frame.
     * - `pulley`: a rope over two wheels that are fixed in the world. */
    type: "revolute" | "prismatic" | "distance" | "weld" | "wheel" | "motor" | "filter" | "gear" | "rack" | "pulley";
    /** Body A. */
    a: BodyId;
    /** Body B, another one than A. A joint has no effect while neither body is dynamic. */
    b: BodyId;
    /** Place of both anchors in the world, in metres, at the current poses: sets `anchorA`, `anchorB`, `angleA` and
     * `angleB`, which must not be given as well, so that the angle of the joint is 0 now. Only `World.addJoint` accepts
     * it. */
    anchor?: Vec;
    /** With `anchor`: direction in the world of the axis of a prismatic joint, wheel or rack. The x axis by default;
     * [0, 1] for the wheel of a car. */
    axis?: Vec;
    /** Anchor in A's frame in metres, within ±128 on each axis, or ±2^30 on a fixed body. The origin by default. */
    anchorA?: Vec;
    /** Anchor in B's frame, like `anchorA`. */
    anchorB?: Vec;
    /** Angle of the joint's frame in A's frame: 0 by default. */
    angleA?: Rotation;
    /** Angle of the joint's frame in B's frame: 0 by default. */
    angleB?: Rotation;
    /** Lower and upper end of the range: the angle in rad (revolute), the translation in m (prismatic, wheel), or the
     * length in m, 0 or more (distance). Without a limit by default. */
    limit?: readonly [Num, Num];
    /** Target speed, and largest torque or force, 0 or more: rad/s and N m (revolute, wheel, motor), or m/s and N
     * (prismatic, distance). */
    motor?: { speed: Num; max: Num };
    /** Spring on the angle in rad (revolute), the translation in m (prismatic, wheel) or the length in m (distance). */
    spring?: Spring;
    /** Smallest force of the spring in N, 0 or less, and largest force, 0 or more (distance). A positive force pushes
     * the anchors apart. Unlimited by default. */
    springForce?: readonly [Num, Num];
    /** Length in metres that is held rigidly, at least 0.001 (distance). */
    rod?: Num;
    /** Frequency in Hz, above 0 and up to 1000, and damping ratio, 0 to 100, of the rigid constraints of the joint (all
     * types): `jointHertz` and `jointDampingRatio` of the world by default. */
    softness?: { hertz: Num; dampingRatio: Num };
    /** Whether the two bodies collide with each other (all types): false by default. */
    collide?: boolean;
    /** Whether the joint acts (all types): true by default. */
    enabled?: boolean;
    /** Force in N and torque in N m, 0 or more, beyond which the joint is reported in `Events.joints` or, with
     * `breaks`, also removed (all types). The load in the last sub-step of a tick counts, so that a shock within a tick
     * may go unnoticed. Without a threshold by default. */
    threshold?: { force?: Num; torque?: Num; breaks?: boolean };
    /** Target velocity of B's anchor relative to A in m/s, along the axes of the world, and largest force in N (motor).
     * */
    linearMotor?: { velocity: Vec; max: Num };
    /** Spring between the anchors: frequency in Hz, damping ratio (weld, motor), and largest force in N (motor, for
     * which it is needed: the default is 0). Without it the anchors of a weld are rigid. */
    linearSpring?: { hertz: Num; dampingRatio: Num; max?: Num };
    /** Spring on the angle: frequency in Hz, damping ratio (weld, motor), and largest torque in N m (motor, for which
     * it is needed: the default is 0). Without it the angle of a weld is rigid. */
    angularSpring?: { hertz: Num; dampingRatio: Num; max?: Num };
    /** Teeth of A's wheel and of B's wheel, 1 to 1000, or -1 to -1000 for a ring around the other wheel (gear). [1, 1]
     * by default. */
    teeth?: readonly [number, number];
    /** Radius of the wheel in metres, 0.001 to 128; negative for a rack on the other side of the wheel (rack, which
     * needs it). */
    radius?: Num;
    /** Positions of the wheels on A's side and on B's side, in the world, in metres (pulley). */
    wheels?: readonly [Vec, Vec];
    /** Length of the rope in metres, 0 to 2^20, without the part between the wheels (pulley). With `anchor` it follows
     * from the current poses. */
    length?: Num;
    /** The length on A's side plus `ratio` times the length on B's side is at most `length`: 0.25 to 4, 1 by default
     * (pulley). */
    ratio?: Num;
    /** A number of 64 bits for the game, part of the state: 0 by default. */
    userData?: bigint | number;
}
/** A joint as `World.joint` returns it: `setJoint` takes it with changes. The fields are those of `JointOptions`. Parts
 * that the joint does not have are missing. */
export interface JointInfo {
    /** Type of the joint. */
    type: JointOptions["type"];
    /** Body A. */
    a: BodyId;
    /** Body B. */
    b: BodyId;
    /** Anchor in A's frame, in metres. `World.jointAnchors` has the anchors in the world. */
    anchorA: Vec2;
    /** Anchor in B's frame, in metres. */
    anchorB: Vec2;
    /** Angle of the joint's frame in A's frame. */
    angleA: Angle;
    /** Angle of the joint's frame in B's frame. */
    angleB: Angle;
    /** Whether the two bodies collide with each other. */
    collide: boolean;
    /** Whether the joint acts. */
    enabled: boolean;
    /** Number that the game stores with the joint. */
    userData: bigint;
    /** Lower and upper end of the range, in rad or m. */
    limit?: [Fx, Fx];
    /** Target speed in rad/s or m/s, and largest torque in N m or force in N. */
    motor?: { speed: Fx; max: Fx };
    /** Frequency in Hz, damping ratio, and rest position in rad or m. */
    spring?: { hertz: Fx; dampingRatio: Fx; target: Fx };
    /** Smallest and largest force of the spring in N. */
    springForce?: [Fx, Fx];
    /** Length of a rod in metres. */
    rod?: Fx;
    /** Frequency in Hz and damping ratio of the rigid constraints. */
    softness?: { hertz: Fx; dampingRatio: Fx };
    /** Force in N and torque in N m beyond which the joint is reported or breaks. */
    threshold?: { force?: Fx; torque?: Fx; breaks?: boolean };
    /** Target velocity in m/s and largest force in N of a motor joint. */
    linearMotor?: { velocity: Vec2; max: Fx };
    /** Frequency in Hz, damping ratio and largest force in N of the spring between the anchors. */
    linearSpring?: { hertz: Fx; dampingRatio: Fx; max?: Fx };
    /** Frequency in Hz, damping ratio and largest torque in N m of the spring on the angle. */
    angularSpring?: { hertz: Fx; dampingRatio: Fx; max?: Fx };
    /** Teeth of both wheels of a gear. */
    teeth?: [number, number];
    /** Radius of the wheel of a rack in metres. */
    radius?: Fx;
    /** Positions of the wheels of a pulley in the world, in metres. */
    wheels?: [Vec2, Vec2];
    /** Length of the rope of a pulley in metres. */
    length?: Fx;
    /** Ratio of a pulley. */
    ratio?: Fx;
}

/** Settings of a world. A value out of range throws `SETTING`. */
export interface ConfigOptions {
    /** Ticks per second, 10 to 1000: 60 by default. It has to stay the same in a match and in a recording. */
    tickRate?: number;
    /** Gravity in m/s², within ±100 000 on each axis: [0, -10] by default. */
    gravity?: Vec;
    /** Sub-steps of a tick, 1 to 64: 4 by default. `tickRate` times `subSteps` is 60 to 4000. */
    subSteps?: number;
    /** Iterations of a sub-step, 1 to 16: 1 by default. More sub-steps improve the result more than more iterations. */
    iterations?: number;
    /** Kind of contact constraints: 0 for soft contacts, 1 for Baumgarte contacts; 0 by default. */
    contact?: number;
    /** Stiffness of soft contacts in Hz, 1 to 1000, effectively at most an eighth of the sub-steps per second: 30 by
     * default. For Baumgarte contacts: share of the overlap that they correct in each sub-step, 0 to 1. */
    contactStiffness?: Num;
    /** Damping ratio of soft contacts, 0 to 100: 10 by default. For Baumgarte contacts: overlap in metres that
     * they leave uncorrected, 0 to 1. */
    contactDamping?: Num;
    /** Largest speed in m/s with which contacts push shapes apart, 0 to 400: 3 by default. */
    contactPushSpeed?: Num;
    /** Stiffness of joints in Hz, 1 to 1000, effectively at most a quarter of the sub-steps per second: 60 by default.
     * */
    jointHertz?: Num;
    /** Damping ratio of joints, 0 to 100: 2 by default. */
    jointDampingRatio?: Num;
    /** Approach speed in m/s below which shapes do not bounce, 0 to 400: 1 by default. */
    restitutionThreshold?: Num;
    /** Largest speed of a body in m/s, 1 to 400: 400 by default. Below 27 ticks per second, also at most 15 m per tick.
     * */
    speedMax?: Num;
    /** Distance in metres at which shapes get contact points before they touch, 0.001 to 1: 0.02 by default. Pairs that
     * approach each other have a larger distance. */
    speculativeDistance?: Num;
    /** Largest margin in metres of the bounding boxes in the broad phase, 0.001 to 10: 0.1 by default. */
    fatMargin?: Num;
    /** Lowest approach speed of a hit event in m/s, 0 to 400: 1 by default. */
    hitSpeed?: Num;
    /** Largest number of bodies, at most 2^20, which is the default. `setConfig` cannot change the limits. */
    bodyLimit?: number;
    /** Largest number of shapes, at most 2^20, which is the default. */
    shapeLimit?: number;
    /** Largest number of joints, at most 2^20, which is the default. */
    jointLimit?: number;
    /** Largest number of pairs of near shapes in a tick, at most 2^20: 2^18 by default. A tick with more pairs leaves
     * some out, and counts as a fault. */
    pairLimit?: number;
    /** Whether bodies at rest fall asleep: true by default. */
    sleeping?: boolean;
    /** Whether fast bodies are swept against shapes that they might pass through: true by default. */
    continuous?: boolean;
}
/** All settings of a world. */
export type ConfigInfo = {
    [Name in keyof ConfigOptions]-?: [Num] extends [ConfigOptions[Name]] ? Fx
        : [Vec] extends [ConfigOptions[Name]] ? Vec2 : Exclude<ConfigOptions[Name], undefined>;
};

/** An object that the library stores. `dispose` frees it at once; otherwise the garbage collector frees it later. */
declare class Handle {
    #private;
    protected constructor();
    /** Frees the object. Every later use except `dispose` throws `DISPOSED`. */
    dispose(): void;
    /** Calls `dispose` at the end of a block: `using world = new World();`. */
    [Symbol.dispose](): void;
}

/** Pose of a body that `spawnEach` adds. */
export interface BodyPose {
    /** Origin of the body in the world, in metres. */
    position: Vec;
    /** No rotation by default. */
    angle?: Rotation;
}

/** Edits, which a world executes at once and a list of commands collects. A world throws `STALE_BODY`, `STALE_SHAPE` or
 * `STALE_JOINT` for a handle that it does not have (any more), and does not change; a list of commands accepts every
 * handle. */
declare class Edits extends Handle {
    #private;
    /** Removes a body with its shapes and joints. */
    despawn(body: BodyId): void;
    /** Removes a shape. The mass of its body follows, unless it was given. */
    removeShape(shape: ShapeId): void;
    /** Replaces the definition of a shape: options that are not given have their defaults. */
    setShape(shape: ShapeId, definition: ShapeDef): void;
    /** Removes a joint. */
    removeJoint(joint: JointId): void;
    /** Replaces the definition of a joint: `setJoint(joint, { ...world.joint(joint), motor })`. The bodies have to stay
     * the same. Options that are not given have their defaults. */
    setJoint(joint: JointId, options: Omit<JointOptions, "anchor" | "axis">): void;
    /** Enables a joint. */
    enableJoint(joint: JointId): void;
    /** Disables a joint: it keeps its handle and has no effect. */
    disableJoint(joint: JointId): void;
    /** A force in N during the next tick, at a point of the world in metres. Forces add up. The body has to be dynamic
     * and enabled; otherwise this throws `WRONG_KIND`, like `applyTorque`, `applyImpulse`, `applyAngularImpulse`. */
    applyForce(body: BodyId, force: Vec, point: Vec): void;
    /** A torque in N m during the next tick, counter-clockwise. */
    applyTorque(body: BodyId, torque: Num): void;
    /** An impulse in N s at a point of the world in metres: changes the velocity at once. */
    applyImpulse(body: BodyId, impulse: Vec, point: Vec): void;
    /** An angular impulse in N m s: changes the angular velocity at once. */
    applyAngularImpulse(body: BodyId, impulse: Num): void;
    /** Sets the velocity of the centre of mass in m/s, and the angular velocity in rad/s (0 by default). Throws
     * `WRONG_KIND` for a fixed body, and `SPEED` above `speedMax` of the world. */
    setVelocity(body: BodyId, velocity: Vec, angular?: Num): void;
    /** Moves the origin of a body at once to a position in metres, with an angle (0 by default), regardless of shapes
     * in between. */
    setTransform(body: BodyId, position: Vec, angle?: Rotation): void;
    /** Gives a kinematic body the velocity with which it reaches this pose in the next tick. Throws `WRONG_KIND` for
     * other bodies. */
    moveTo(body: BodyId, position: Vec, angle?: Rotation): void;
    /** Replaces the settings of a body, and wakes it. Settings that are not given have their defaults. `World.body` has
     * the current ones beside other properties, which are not accepted here. */
    setBody(body: BodyId, settings: BodySettings): void;
    /** Makes a body fixed, kinematic or dynamic. A body that becomes fixed stops. */
    setType(body: BodyId, type: BodyType): void;
    /** Sets the mass of a body, as the option `mass` does. Without `mass`, the mass follows from the shapes again. */
    setMass(body: BodyId, mass?: MassOptions): void;
    /** Sets the number of 64 bits that the game stores with a body. */
    setUserData(body: BodyId, data: bigint | number): void;
    /** Sets the name of a body: at most 16 letters, digits, `-` and `_`, otherwise this throws `NAME`. `""` removes the
     * name. */
    setName(body: BodyId, name: string): void;
    /** Lets a body take part in the simulation again. */
    enable(body: BodyId): void;
    /** Takes a body out of the simulation: it keeps its pose and velocity, collides with nothing, and no query finds
     * it. */
    disable(body: BodyId): void;
    /** Wakes a body, with all dynamic bodies that contacts and joints connect it to. */
    wake(body: BodyId): void;
    /** Puts a dynamic body to sleep, with all dynamic bodies that contacts and joints connect it to. */
    sleep(body: BodyId): void;
    /** Sets the gravity in m/s², and wakes all bodies. */
    setGravity(gravity: Vec): void;
    /** Applies impulses away from `centre`, in N s per metre of the width of a shape as seen from there. The impulse is
     * full within `radius` metres, and falls to 0 over the next `falloff` metres; both are 0 to 1000, and 1 by default.
     * `mask` has the categories of the shapes that it acts on: all by default. */
    explode(options: { centre: Vec; impulse: Num; radius?: Num; falloff?: Num; mask?: bigint | number }): void;
}

/** A list of edits, for replays and networks. The list does not know the handles of what it adds. In a new world, the
 * bodies that it spawns have the handles 0, 1, 2 and so on in the order of the list, and so have shapes and joints: `0
 * as BodyId` is the first body. */
export class Commands extends Edits {
    #private;
    /** Makes an empty list. */
    constructor();
    /** Adds a body with its shapes. */
    spawn(options: BodyOptions): undefined;
    /** Adds a body with the same definition at each pose. */
    spawnEach(options: Omit<BodyOptions, "position" | "angle">, poses: readonly BodyPose[]): undefined;
    /** Adds a shape to a body. */
    addShape(body: BodyId, shape: ShapeDef): undefined;
    /** Adds a joint, with `anchorA` and `anchorB`. */
    addJoint(options: Omit<JointOptions, "anchor" | "axis">): undefined;
    /** Adds a joint with the same definition between each pair of bodies. */
    addJointEach(options: Omit<JointOptions, "a" | "b" | "anchor" | "axis">, pairs: readonly (readonly [BodyId, BodyId])[]): undefined;
    /** Number of commands in the list. */
    readonly length: number;
    /** Empties the list. */
    clear(): void;
    /** The list as bytes. */
    toBytes(): Uint8Array;
    /** Replaces the list by a list that is decoded from bytes, which may come from any source. */
    fromBytes(bytes: Uint8Array): this;
}

/** A saved state in memory. */
export class Snapshot extends Handle {
    #private;
    private constructor();
    /** Hash of the state, as `World.hash`. */
    hash(): string;
}

/** Properties of a body. */
export interface BodyInfo {
    /** Kind of motion. */
    type: BodyType;
    /** Origin in the world, in metres. */
    position: Vec2;
    /** Rotation, counter-clockwise. */
    angle: Angle;
    /** Velocity of the centre of mass in m/s. */
    velocity: Vec2;
    /** Angular velocity in rad/s, counter-clockwise. */
    angularVelocity: Fx;
    /** Centre of mass in the world, in metres. */
    centre: Vec2;
    /** Mass in kg; 0 for a fixed or kinematic body, and for a dynamic body that has no mass (`BodyOptions.mass`). */
    mass: Fx;
    /** Moment of inertia about the centre of mass in kg m². */
    inertia: Fx;
    /** Number of shapes. */
    shapes: number;
    /** Number that the game stores with the body. */
    userData: bigint;
    /** Whether the body takes part in the simulation. */
    enabled: boolean;
    /** Whether the body sleeps. */
    asleep: boolean;
    /** Decay rate of the velocity, per second. */
    linearDamping: Fx;
    /** Decay rate of the angular velocity, per second. */
    angularDamping: Fx;
    /** Factor on the world's gravity. */
    gravityScale: Fx;
    /** Speed in m/s below which the body becomes ready to sleep. */
    sleepSpeed: Fx;
    /** Bodies through which the body cannot tunnel. */
    continuous: "off" | "fixed" | "bullet" | "kinematic";
    /** Whether the body may fall asleep. */
    maySleep: boolean;
    /** Whether the body cannot move along the x axis of the world. */
    lockX: boolean;
    /** Whether the body cannot move along the y axis of the world. */
    lockY: boolean;
    /** Whether the body cannot turn. */
    lockRotation: boolean;
}
/** A shape of a world. A link is a line of a chain. */
export interface ShapeInfo {
    /** Kind of geometry. Boxes and hulls are polygons. */
    type: "circle" | "segment" | "polygon" | "capsule" | "link";
    /** The body that has the shape. */
    body: BodyId;
    /** Points in metres from the shape's centre: none of a circle, the ends of a segment or capsule, the corners of a
     * polygon, or the ends of a link and the far ends of its neighbours. */
    points: Vec2[];
    /** Radius of a circle or capsule, rounding of a polygon, in metres. */
    radius: Fx;
    /** Centre of the shape in the body's frame, in metres. */
    offset: Vec2;
    /** Mass per area in kg/m². */
    density: Fx;
    /** Friction coefficient. */
    friction: Fx;
    /** Fraction of the approach speed that a bounce returns. */
    restitution: Fx;
    /** Rolling resistance. */
    rollingResistance: Fx;
    /** Speed of the surface, clockwise, in m/s. */
    surfaceSpeed: Fx;
    /** Bits of the categories that the shape belongs to. */
    category: bigint;
    /** Bits of the categories that the shape collides with. */
    mask: bigint;
    /** Group, or 0. */
    group: number;
    /** Number that the game stores with the shape. */
    userData: bigint;
}
/** Shapes that a query sees: all shapes of enabled bodies except sensors by default. */
export interface Filter {
    /** Bits of the categories that the query belongs to: all by default. */
    category?: bigint | number;
    /** Bits of the categories that the query sees: all by default. */
    mask?: bigint | number;
    /** Whether the query sees sensors: false by default. */
    sensors?: boolean;
    /** Bodies that the query does not see, at most 8: none by default. */
    except?: readonly BodyId[];
    /** Treatment of shapes that a ray or a cast starts in: `resist` by default. `report`: they are hits. `ignore`: they
     * are not seen. `resist`: they are hits of rays, and of casts only if the shape would move deeper into them. */
    initialOverlap?: "resist" | "report" | "ignore";
}
/** Hit of a ray. */
export interface RayHit {
    /** The shape that is met. */
    shape: ShapeId;
    /** The body of the shape. */
    body: BodyId;
    /** Fraction of the translation, 0 to 1. */
    fraction: Fx;
    /** Point in the world, in metres. */
    point: Vec2;
    /** Outward normal of the surface; zero for a ray that starts inside. */
    normal: Vec2;
    /** Whether the ray or the cast starts in the shape. */
    startsInside: boolean;
}
/** Hit of a moving shape. */
export interface CastHit extends RayHit {
    /** Displacement up to the hit, in metres. */
    travelled: Vec2;
}
/** Two shapes. A handle may be stale if its shape was removed. */
export interface ContactEvent {
    /** The shape in the smaller slot. */
    shapeA: ShapeId;
    /** The shape in the larger slot. */
    shapeB: ShapeId;
}
/** A sensor and a shape. A handle may be stale if its shape was removed. */
export interface SensorEvent {
    /** The sensor. */
    sensor: ShapeId;
    /** The shape that overlaps the sensor. */
    visitor: ShapeId;
    /** Time within the tick at which the overlap began or ceased, 0 to 1. */
    fraction: Fx;
}
/** The events of the last tick only. */
export interface Events {
    /** Bodies that moved or fell asleep, in slot order, with their poses. */
    moved: { body: BodyId; position: Vec2; angle: Angle; fellAsleep: boolean }[];
    /** Shapes that began to touch, sorted. One of the two has to have `contactEvents`. */
    contactBegin: ContactEvent[];
    /** Shapes that ceased to touch, sorted. */
    contactEnd: ContactEvent[];
    /** Shapes that hit each other at `hitSpeed` of the world or faster, sorted. One of the two has to have `hitEvents`.
     * `point` is in the world, in metres; `normal` is the unit vector from A to B; `impulse` is along the normal and
     * summed over the tick, in N s; `approachSpeed` is in m/s. */
    hits: (ContactEvent & { point: Vec2; normal: Vec2; approachSpeed: Fx; impulse: Fx })[];
    /** Shapes that began to overlap a sensor, sorted by `fraction`. */
    sensorBegin: SensorEvent[];
    /** Shapes that ceased to overlap a sensor, sorted by `fraction`. */
    sensorEnd: SensorEvent[];
    /** Joints whose force in N on body B or torque in N m exceeded the `threshold`, in slot order. The handle of a
     * joint that broke is stale. */
    joints: { joint: JointId; force: Vec2; torque: Fx; broke: boolean }[];
}

/** A physics world. Units are metres, kilograms, seconds and radians. */
export class World extends Edits {
    #private;
    /** `smallest` is the size in metres of the smallest boxes whose stacks have to be stable. Small sizes add
     * sub-steps, stiffen contacts and reduce `speculativeDistance`. */
    constructor(options?: ConfigOptions & { smallest?: Num });
    /** Makes a world from bytes, which may come from any source. Bytes that are not a world throw `SNAPSHOT`. */
    static fromBytes(bytes: Uint8Array): World;
    /** The state as bytes. */
    toBytes(): Uint8Array;
    /** A copy of the world. */
    clone(): World;
    /** Adds a body with its shapes, and returns its handle. */
    spawn(options: BodyOptions): BodyId;
    /** Adds a body with the same definition at each pose, or no body if one of them is refused. A recording stores the
     * definition once. */
    spawnEach(options: Omit<BodyOptions, "position" | "angle">, poses: readonly BodyPose[]): BodyId[];
    /** Adds a shape to a body, and returns its handle. */
    addShape(body: BodyId, shape: ShapeDef): ShapeId;
    /** Adds a joint, and returns its handle. */
    addJoint(options: JointOptions): JointId;
    /** Adds a joint with the same definition between each pair of bodies, or no joint if one of them is refused. */
    addJointEach(options: Omit<JointOptions, "a" | "b" | "anchor" | "axis">, pairs: readonly (readonly [BodyId, BodyId])[]): JointId[];
    /** Advances the world by a number of ticks, 1 by default. Only the events of the last one are kept. */
    step(ticks?: number): void;
    /** Executes a list of commands, and returns how many were refused. The list keeps its commands. */
    execute(commands: Commands): number;
    /** Hash of the state: 32 hexadecimal digits, the same on every machine. */
    hash(): string;
    /** Hash of a section: 0 settings, tick and fault count, 1 bodies, 2 shapes, 3 joints, 4 contacts, 5 islands,
     * 6 random numbers. */
    digest(section: number): string;
    /** Number of ticks of the state. `restore` and `fromBytes` set the number that was saved. */
    readonly tick: number;
    /** Number of results of the solver that were clamped since the world was made, plus one for every tick in which
     * `pairLimit` left pairs out. A body at the speed limit does not count. */
    readonly faults: number;
    /** Numbers of bodies, shapes, joints, awake bodies, and pairs of near shapes. */
    counts(): { bodies: number; shapes: number; joints: number; awake: number; pairs: number };
    /** The settings of the world. */
    config(): ConfigInfo;
    /** Changes settings. Settings that are not given keep their values. A limit that differs throws `FIXED_SETTING`. */
    setConfig(options: ConfigOptions): void;
    /** A random number from 0 to below `bound`, from the generator of the world, which is part of its state. */
    random(bound: number): number;
    /** A random number from `low` to below `high`, from the same generator. */
    randomRange(low: Num, high: Num): Fx;
    /** Saves the state in memory. */
    save(): Snapshot;
    /** Saves the state into an existing snapshot, and reuses its memory: the fastest way to save every tick. */
    saveInto(snapshot: Snapshot): void;
    /** Restores a saved state. The world then has no events until its next tick. */
    restore(snapshot: Snapshot): void;
    /** Properties of a body, or undefined if it is not in the world (any more). */
    body(body: BodyId): BodyInfo | undefined;
    /** Name of a body, or undefined if it has none or is not in the world (any more). */
    bodyName(body: BodyId): string | undefined;
    /** Velocity in m/s of the material point of a body at a point of the world, in metres. */
    velocityAt(body: BodyId, point: Vec): Vec2;
    /** Handles of all bodies, in slot order. */
    bodies(): BodyId[];
    /** Handles of all joints, in slot order. */
    joints(): JointId[];
    /** Shapes of a body, in the order in which they were added. A chain has a shape for each line. */
    shapesOf(body: BodyId): ShapeId[];
    /** Joints of a body, in slot order. */
    jointsOf(body: BodyId): JointId[];
    /** Shapes that a sensor overlaps, in slot order. */
    sensorOverlaps(shape: ShapeId): ShapeId[];
    /** Body and definition of a shape. */
    shape(shape: ShapeId): ShapeInfo;
    /** A box around a shape with some margin, in the world, in metres: its lower left and its upper right corner. */
    shapeBox(shape: ShapeId): { lower: Vec2; upper: Vec2 };
    /** Distance between two shapes in metres, negative if they overlap. Undefined if one of them is not in the world,
     * or its body is disabled. */
    shapeDistance(a: ShapeId, b: ShapeId): Fx | undefined;
    /** Type, bodies, anchors and parts of a joint. */
    joint(joint: JointId): JointInfo;
    /** The anchors of a joint in the world, in metres. */
    jointAnchors(joint: JointId): [Vec2, Vec2];
    /** Angle of a joint in rad, including whole turns. Undefined if the joint is not in the world (any more). */
    jointAngle(joint: JointId): Fx | undefined;
    /** Force in N that a joint exerted on body B in the last sub-step, and its torque in N m about B's anchor. Undefined
     * if the joint is not in the world (any more). */
    jointForce(joint: JointId): { force: Vec2; torque: Fx } | undefined;
    /** For drawing: five floats for each enabled body: its handle, x, y, angle in radians, and 1 if it is awake,
     * otherwise 0. With a `target` that is long enough, the result is a part of it. In TypeScript, `poses[5 * i] as
     * BodyId` is a handle. */
    poses(target?: Float64Array): Float64Array;
    /** The events of the last tick: after `step(120)`, those of the 120th tick only. To see all of them, call it after
     * each `step()`. */
    events(): Events;
    /** The first shape that a ray meets, from a point along a translation in metres. */
    castRay(origin: Vec, translation: Vec, filter?: Filter): RayHit | undefined;
    /** Every shape that a ray meets, in the order of the hits along the ray. */
    castRayAll(origin: Vec, translation: Vec, filter?: Filter): RayHit[];
    /** The first shape of the world that a given shape meets as it moves along a translation in metres. */
    castShape(shape: ShapeDef, position: Vec, translation: Vec, options?: Filter & { angle?: Rotation }): CastHit | undefined;
    /** Shapes of the world that overlap a given shape, in slot order. */
    overlapShape(shape: ShapeDef, position: Vec, options?: Filter & { angle?: Rotation }): ShapeId[];
    /** Shapes that overlap a box from its lower left to its upper right corner, in slot order. */
    overlapBox(lower: Vec, upper: Vec, filter?: Filter): ShapeId[];
    /** Shapes that contain a point, in slot order. */
    overlapPoint(point: Vec, filter?: Filter): ShapeId[];
    /** The shape nearest to a point, within a distance in metres. The distance is negative inside a shape. `point` is
     * on the surface, `normal` the unit vector from the given point to the shape. */
    closest(point: Vec, within: Num, filter?: Filter): { shape: ShapeId; body: BodyId; distance: Fx; point: Vec2; normal: Vec2 } | undefined;
}

/** Geometry and abilities of a character, which stays upright. The y axis points up. */
export interface MoverOptions {
    /** Shape of the character. Only its geometry matters. */
    shape: ShapeDef;
    /** Steepest slope that counts as ground, measured from the horizontal; 45 degrees by default. */
    slopeMax?: Rotation;
    /** Height in metres of steps that the character climbs without a jump; 0 by default. */
    stepHeight?: Num;
    /** Largest descent of the ground within a tick that the character follows, in metres; 0.1 by default. */
    snapDistance?: Num;
}
/** A surface that a character has met. */
export interface MoverPlane {
    /** The shape that was met. */
    shape: ShapeId;
    /** The body of the shape. */
    body: BodyId;
    /** Position in metres of the body's origin in the world when the surface was met. */
    bodyPosition: Vec2;
    /** Rotation of the body when the surface was met. */
    bodyAngle: Angle;
    /** Velocity of the surface in m/s. */
    velocity: Vec2;
    /** Outward normal. */
    normal: Vec2;
    /** Point on the surface that is nearest to the character. */
    point: Vec2;
    /** Distance of the character from the surface in metres, negative if they overlap. */
    separation: Fx;
}
/** State of a character, which belongs to the state of the game: save it, and hash it. */
export interface MoverState {
    /** Position of the shape's centre in the world, in metres. */
    position: Vec;
    /** Velocity in m/s: relative to the ground while the character stands on ground, otherwise in the world. */
    velocity?: Vec;
    /** The ground on which the character stands. Without it, the character is in the air. */
    ground?: MoverPlane | undefined;
}
/** Result of `moveCharacter`. */
export interface Moved {
    /** The new state, for the next call. */
    state: {
        /** Position of the shape's centre in the world, in metres. */
        position: Vec2;
        /** Velocity in m/s: relative to the ground while the character stands on ground, otherwise in the world. */
        velocity: Vec2;
        /** The ground on which the character stands. */
        ground: MoverPlane | undefined;
        /** Whether there is a `ground`. */
        isOnGround: boolean;
        /** Whether the character is wedged between two slopes that are both too steep to stand on. */
        isWedged: boolean;
    };
    /** The surfaces that the character has met, in order. */
    met: MoverPlane[];
}
/** Moves a character for one tick at its velocity. The character slides along surfaces, climbs steps, and is carried by
 * moving ground. The game adds gravity to the velocity. The world does not change. */
export function moveCharacter(world: World, mover: MoverOptions, state: MoverState, filter?: Filter): Moved;
/** The state of a character as bytes, for saves and hashes. */
export function encodeMoverState(state: MoverState): Uint8Array;
/** The state of a character from bytes. */
export function decodeMoverState(bytes: Uint8Array): Moved["state"];

/** Bounds on the cost of reading and playing a replay. The defaults allow a day of play. With them, a file made to be
 * slow can take hours to verify: a server should set narrower limits for its game. */
export interface Limits {
    /** Bytes of the file: 64 MiB by default. */
    fileBytes?: number;
    /** Bytes of the setup: 16 MiB by default. */
    setupBytes?: number;
    /** Number of players: 64 by default. */
    players?: number;
    /** Bytes of a block: 16 MiB by default. */
    blockBytes?: number;
    /** Ticks between checkpoints: 3600 by default. */
    blockTicks?: number;
    /** Ticks of the game: 5 184 000 by default, a day at 60 ticks per second. */
    ticks?: number;
    /** Bodies of the world: 2^20 by default. */
    bodies?: number;
    /** Work units of a tick: 10 million by default. A unit takes at most about a microsecond. */
    tickWork?: number;
    /** Work units of the game: 20 000 million by default. */
    totalWork?: number;
}
/** Result of verifying a replay. */
export interface Verdict {
    /** Only `match` means that the file is valid.
     *
     * - `match`: the inputs reproduce every checkpoint, the last state and the results of the file.
     * - `claim_mismatch`: the last state or a result differs from what the file states.
     * - `diverged`: a checkpoint differs.
     * - `incomplete`: the file ends before its trailer; the part that it has is valid.
     * - `malformed`: the bytes are not a replay.
     * - `limit_exceeded`: the file exceeds one of the `Limits`.
     * - `unverifiable`: recorded by another version of the engine, or with other rules. */
    verdict: "match" | "claim_mismatch" | "diverged" | "incomplete" | "malformed" | "limit_exceeded" | "unverifiable";
    /** Number of ticks that were played, for `match`, `claim_mismatch` and `incomplete`; for `diverged`, the tick of
     * the first checkpoint that differs; otherwise 0. */
    ticks: number;
    /** Hash of the last state for `match`, `claim_mismatch` and `incomplete`; otherwise 32 zeros. For a `Replay` this
     * is the hash that was passed to `verdict`. For a `Recording` it covers the world and the number of refused
     * commands, so that it differs from `World.hash()`: compare it with verdicts only. To compare worlds, take
     * `Recording.world().hash()` before `finish`, and `Timeline.world().hash()` at the last tick. */
    hash: string;
    /** The verdict in words. */
    text: string;
}
/** Goes to any tick of a replay of a world: tick t is the state after t ticks. */
export class Timeline extends Handle {
    #private;
    /** Throws a Lockstep2dError with the code RECORD, and the `verdict`, if the file cannot be played. */
    constructor(bytes: Uint8Array, limits?: Limits);
    /** Number of ticks of the replay. */
    readonly ticks: number;
    /** The current tick: 0 at first. */
    readonly tick: number;
    /** Goes to a tick. This is fast if the tick was played before. States on the way are compared with the checkpoints
     * of the file. */
    seek(tick: number): void;
    /** Goes forward by a tick. Returns false at the end. */
    step(): boolean;
    /** Goes back by a tick. Returns false at the start. */
    stepBack(): boolean;
    /** A copy of the world at the current tick, for drawing and queries. The caller has to dispose of the copy. */
    world(): World;
}

/** Verifies a replay of a world. The file may come from any source. */
export function verifyReplay(bytes: Uint8Array, limits?: Limits): Verdict;

/** A world that is recorded while it runs, and changed by lists of commands alone. */
export class Recording extends Handle {
    #private;
    /** `setup` has the commands that build the world; the constructor throws an error if the world refuses one of them.
     * The bodies of the setup have the handles 0, 1, 2 and so on, in order. There is a checkpoint every `interval`
     * ticks, 1 to 3600: 60 by default. */
    constructor(options: { config?: ConfigOptions; setup: Commands; interval?: number });
    /** Executes the commands, advances the world by a tick, and empties the list. Commands that the world refuses are
     * skipped. */
    step(commands: Commands): void;
    /** A copy of the world. The caller has to dispose of the copy. */
    world(): World;
    /** The bytes that were finished since the last call, to be appended to a file. */
    take(): Uint8Array;
    /** Ends the recording, and returns the rest of the bytes. */
    finish(): Uint8Array;
}
/** Inputs of a tick. */
export interface TickInputs {
    /** Inputs of all players or seats, one after another. */
    inputs: Uint8Array;
    /** Bit for each player or seat that nobody plays. The input of such a seat is zeros. */
    absent: bigint;
}
/** Records a game with rules of its own. */
export class Recorder extends Handle {
    #private;
    /** Starts recording. */
    constructor(options: {
        /** Name of the rules. */
        rules: string;
        /** Version of the rules: 1 by default. */
        rulesVersion?: number;
        /** Number of players, 1 to 64. */
        players: number;
        /** Ticks per second: 60 by default. */
        tickRate?: number;
        /** Bytes of an input of a player, 1 to 512. */
        inputBytes: number;
        /** Data from which the game makes its first state: none by default. */
        setup?: Uint8Array;
        /** Hash of the state before the first tick. */
        start: string;
        /** Ticks between checkpoints, 1 to 3600: 60 by default. */
        interval?: number;
    });
    /** Records the inputs of all players, and a bit for each absent player, whose input has to be zeros.
     * `Match.finalInputs` returns both in this form. Returns whether `checkpoint` has to follow. */
    record(inputs: Uint8Array, absent?: bigint): boolean;
    /** Adds a result such as a score, with a name of 1 to 64 bytes. Call it before `finish`. A replay has at most 256
     * results with different names. They can be read without playing the replay. */
    claim(name: string, number: number | bigint): void;
    /** Passes the hash of the state after the tick of `record`, if that returned true. */
    checkpoint(hash: string): void;
    /** The bytes that were finished since the last call, to be appended to a file. */
    take(): Uint8Array;
    /** Ends the replay with the hash of the last state, and returns the rest of the bytes. */
    finish(hash: string): Uint8Array;
}
/** A replay of a game with rules of its own. The game plays it. */
export class Replay extends Handle {
    #private;
    /** Throws a Lockstep2dError with the code RECORD, and the `verdict`, if the file cannot be played. */
    constructor(bytes: Uint8Array, limits?: Limits);
    /** Name of the rules. */
    readonly rules: string;
    /** Version of the rules. */
    readonly rulesVersion: number;
    /** Number of players. */
    readonly players: number;
    /** Ticks per second. */
    readonly tickRate: number;
    /** Bytes of an input of a player. */
    readonly inputBytes: number;
    /** Number of ticks. */
    readonly ticks: number;
    /** Data from which the game makes its first state. */
    readonly setup: Uint8Array;
    /** The results that the file states, which are true if the verdict is `match`. */
    readonly claims: Map<string, bigint>;
    /** The inputs of the next tick, or undefined at the end. */
    next(): TickInputs | undefined;
    /** Compares the hash of the game's state with the file. Call it before the first tick and after every tick, or,
     * while seeking, for each request `checksum`. */
    check(hash: string): void;
    /** Adds a result of the game that was played. The verdict compares all added results with `claims`. */
    claim(name: string, number: number | bigint): void;
    /** The verdict after the last tick, or after a checkpoint that differs. `hash` is the hash of the current state. */
    verdict(hash: string): Verdict;
    /** Starts seeking to a tick: `nextRequest` returns the requests, which `ReplayDriver` fulfils. At the first call
     * the game has to be in the state before the first tick. */
    seek(tick: number): void;
    /** The next request on the way to the tick of `seek`: `save`, `load`, `advance`, or `checksum`, which `check`
     * answers. Throws an error with the code RECORD if the game has diverged from the file. */
    nextRequest(): MatchRequest | undefined;
    /** Sets the interval in ticks at which seeking requests to save the state: 60 by default, or a 256th of the
     * replay's ticks if that is more. */
    setInterval(ticks: number): void;
}
/** A game that a `ReplayDriver` plays. `save` and `hash` have to cover its whole state. */
export interface ReplayGame<Saved = unknown> {
    /** Advances the game by a tick, with the inputs of all players or seats, and a bit for each that nobody plays. */
    step(inputs: Uint8Array, absent: bigint): void;
    /** A copy of the state. */
    save(): Saved;
    /** Restores a copy, which may be restored again later. */
    load(saved: Saved): void;
    /** Frees a copy that is no longer needed. */
    drop?(saved: Saved): void;
    /** Hash of the state: 32 hexadecimal digits. */
    hash(): string;
}
/** Goes to any tick of a replay with a game, which begins in the state before the first tick. */
export class ReplayDriver<Saved = unknown> {
    #private;
    /** The game has to be in the state before the first tick. */
    constructor(replay: Replay, game: ReplayGame<Saved>);
    /** Current tick: the game is in the state after this number of ticks. */
    readonly tick: number;
    /** Goes to a tick. If it was played before, this simulates fewer ticks than the interval of the saved states.
     * Throws an error with the code RECORD if the game diverges from the file. The driver then stays at that tick, and
     * earlier ticks can be reached. */
    seek(tick: number): void;
    /** Goes forward by a tick, which is always simulated, even if its state is saved. Returns false at the end. */
    step(): boolean;
    /** Goes back by a tick. Returns false at the start. */
    stepBack(): boolean;
    /** Frees the saved states. The driver cannot be used afterwards. */
    dispose(): void;
    /** Calls `dispose` at the end of a block. */
    [Symbol.dispose](): void;
}

/** Parameters of a match and of a peer. The numbers of seats, ticks and bytes are integers. */
export interface MatchOptions {
    /** Number of seats of the match, 1 to 64. */
    seats: number;
    /** Number of seats that this peer plays: 1 by default; 0 for a spectator or a dedicated server. */
    ownSeats?: number;
    /** Number of seats that have to be taken before the first tick: 2 by default, or `seats` if that is less. */
    startWith?: number;
    /** Bytes of an input, 1 to 512: 1 by default. */
    inputBytes?: number;
    /** Ticks a second, 1 to 1000: 60 by default. */
    tickRate?: number;
    /** Ticks that may be played with guessed inputs, 0 to 32; 0, the default, is lockstep. Each peer chooses its own
     * number. */
    guess?: number;
    /** Smallest delay of your own inputs in ticks: 0 by default. The delay follows the latency, between `delayMin` and
     * `delayMax`. */
    delayMin?: number;
    /** Largest delay of your own inputs in ticks, at most 60: 20 by default. */
    delayMax?: number;
    /** Interval in ticks at which states are saved, from 1 to half of `history`: 8 by default. */
    saveInterval?: number;
    /** Interval in ticks at which states are compared: a multiple of `saveInterval`, 64 by default. */
    checkInterval?: number;
    /** Ticks that may be played beyond the last final tick, at least 16: 128 by default. */
    history?: number;
    /** Minimum number of final ticks whose inputs are kept for peers that return: 36 000 by default. After a longer
     * absence a peer may have to download a state. */
    logTicks?: number;
    /** Ticks from the tick at which a join takes effect to the first tick of the peer that joins: 8 by default. */
    seatLead?: number;
    /** A peer that lags by at most this many ticks may have a seat: 40 by default. */
    seatWithin?: number;
    /** Distinguishes matches: packets with another tag are ignored. 0 by default. */
    matchTag?: bigint | number;
    /** Milliseconds for which the match waits for a missing peer before the other peers go on without it: 2000 by
     * default. The same for all peers. */
    patience?: number;
    /** Number of this peer, of 32 bits: random by default. A page has to use a new number each time it is loaded. */
    peer?: number | undefined;
    /** Identity of the player, of 64 bits: random by default. A peer that joins again with the same key gets its seat
     * back. */
    key?: bigint | undefined;
    /** Secret numbers of 64 bits: random by default. They protect against packets with forged addresses. */
    secret?: readonly [bigint, bigint] | undefined;
    /** Versions, rules and setup, as at most 512 bytes: none by default. A peer with a different offer is refused. */
    offer?: Uint8Array | undefined;
    /** Address of a participant of the match to join. Without it, or if it is undefined, a new match is opened. */
    contact?: Uint8Array | undefined;
}
/**
 * Status of a peer:
 *
 * - `connecting`: requests to join, or downloads the initial state.
 * - `joining`: follows the match and requests a seat. A peer stays `joining`, without an event, while no seat is free.
 * - `watching`: follows the match and requests no seat.
 * - `waiting`: has a seat, or is a dedicated server, in a match that has not begun.
 * - `playing`: has a seat, or is a dedicated server, in a match that has begun.
 * - `paused`: hears from no majority of the peers, directly or through other peers, and only a majority can continue
 *   the match. A peer that has just downloaded the state may be `paused` for a moment before it is `joining` or
 *   `watching`.
 * - `dropped`: the other peers went on without this peer, which requests its seat again.
 * - `kicked`: removed permanently.
 * - `leaving`: announces its departure.
 * - `left`: has left, and still answers peers that lack packets.
 * - `finished`: all ticks of the match are final, and this peer still answers peers that lack packets. The game has
 *   played all of them when `MatchDriver.ended` is true.
 * - `closed`: sends nothing more; follows `left` and `finished` after some seconds.
 */
export type MatchStatus =
    | "joining" | "watching" | "waiting" | "playing" | "paused" | "dropped" | "kicked" | "leaving" | "left" | "finished" | "closed"
    | "connecting";
/**
 * An event of a match. Fields that are not named for a kind have no meaning: most are 0, the hashes are 32 zeros.
 *
 * - `status`: the status of the match has changed to `status`.
 * - `view`: the voters, the seats, or the start or end of the match have changed; `value` counts the changes.
 * - `seated`, `unseated`: from `tick` on, `peer` has or no longer has `seat`.
 * - `waiting`: play stalls because inputs of `peer` are missing; `value` is 1 if `peer` is heard, also through other
 *   peers: it is connected, but its game does not advance.
 * - `resumed`: play continues.
 * - `pause`: `peer` requests a pause (`value` is 1) or withdraws its request (0).
 * - `end`: the match ends after `tick` ticks.
 * - `desync`: after `tick` ticks, `peer` has the hash `theirs` instead of `ours`.
 * - `conflict`: `peer` has issued two different inputs for `tick`. The input that arrived first counts.
 * - `tooFarBehind`: the other peers no longer keep the inputs that this peer lacks; it has to join again.
 * - `refused`: the contact refuses the request to join, because of `reason`.
 * - `state`: the encoded `state` after `tick` ticks. The game has to load it before further requests are fulfilled.
 * - `badState`: a downloaded state is not valid; it is requested again.
 */
export interface MatchEvent {
    /** Kind of the event. */
    kind:
        | "status" | "view" | "seated" | "unseated" | "waiting" | "resumed" | "pause" | "end" | "desync" | "conflict" | "tooFarBehind"
        | "refused" | "state" | "badState";
    /** Number of the peer that the event names. */
    peer: number;
    /** The seat that the event names, from 0. */
    seat: number;
    /** The tick that the event names. */
    tick: number;
    /** Its meaning depends on the kind. */
    value: number;
    /** Hash of this peer, for the kind `desync`; otherwise 32 zeros. */
    ours: string;
    /** Hash of the other peer, for the kind `desync`; otherwise 32 zeros. */
    theirs: string;
    /** The new status, for the kind `status`. */
    status?: MatchStatus;
    /** `offer`: the versions, rules or setup differ; `full`: too many peers are joining through this contact; `taken`:
     * another peer has this number; `notReady`: the contact is not in a match yet, and the request is repeated. */
    reason?: "offer" | "full" | "taken" | "notReady";
    /** The encoded state, for the kind `state`. */
    state?: Uint8Array;
}
/**
 * A request of the match to the game. Fulfil the requests in order, before you call `advance` again:
 *
 * - `save`: keep a copy of the state before `tick`.
 * - `load`: restore the copy of the state before `tick`.
 * - `advance`: simulate `tick` with the `inputs` of all seats, one after another.
 * - `checksum`: pass the hash of the copy of the state before `tick` to `reportHash`.
 * - `forget`: copies of states before `tick` are no longer needed.
 */
export interface MatchRequest {
    /** Kind of the request. */
    kind: "save" | "load" | "advance" | "checksum" | "forget";
    /** The tick that the request is about, from 0. */
    tick: number;
    /** The inputs of all seats, one after another, for the kind `advance`; otherwise empty. */
    inputs: Uint8Array;
    /** Bit for each seat that nobody plays. The input of such a seat is zeros. */
    absent: bigint;
    /** Bit for each seat whose input is guessed. */
    guessed: bigint;
}
/**
 * One participant of a match. Inputs, states and packets are bytes. `now` is in milliseconds and never decreases, such
 * as `performance.now()`. `MatchDriver` fulfils the requests for a game. Every misuse is a `Lockstep2dError`.
 */
export class Match extends Handle {
    #private;
    /** Opens a match, or joins one if there is a `contact`. An option out of range throws `CONFIG` or `VALUE`. */
    constructor(options: MatchOptions);
    /** Bytes of an input. */
    readonly inputBytes: number;
    /** Sends the request to join to another participant, or again to the same one. */
    ask(contact: Uint8Array): void;
    /** Takes a packet that arrived from an address. Packets that do not belong to the match are ignored. */
    receive(now: number, from: Uint8Array, packet: Uint8Array): void;
    /** Advances the match to the time `now`. Call it every few milliseconds, and after `receive`. */
    update(now: number): void;
    /** Whether it is time for the next tick, and the match can take its inputs. */
    isDue(now: number): boolean;
    /** Issues the inputs of your own seats, one after another, and plays a tick if possible. Returns whether the inputs
     * were issued; if not, they may be passed again. */
    advance(now: number, inputs: Uint8Array): boolean;
    /** The next request to the game. */
    nextRequest(): MatchRequest | undefined;
    /** Passes the hash that the request `checksum` asks for. */
    reportHash(tick: number, hash: string): void;
    /** The next packet to send, and the address to send it to. */
    nextPacket(): { to: Uint8Array; packet: Uint8Array } | undefined;
    /** The next event. */
    nextEvent(): MatchEvent | undefined;
    /** Whether a peer that joins needs a state. If so, call `offerState`. */
    readonly wantsState: boolean;
    /** Offers the encoded state after `tick` final ticks to peers that join. */
    offerState(tick: number, state: Uint8Array): void;
    /** Status of this peer. */
    readonly status: MatchStatus;
    /** Numbers of ticks: `played` counts all ticks played, including those with guessed inputs; `final` counts the
     * ticks whose inputs are final; `confirmed` counts the ticks played with final inputs. While the status is
     * `connecting`, `ticks`, `finalInputs`, `link`, `advance`, `reportHash`, and `leave` and all functions after it
     * throw `NOT_IN_MATCH`. */
    ticks(): { played: number; final: number; confirmed: number };
    /** The final inputs of all seats for a tick, or undefined if they are not kept. */
    finalInputs(tick: number): TickInputs | undefined;
    /** Seats that this peer plays, in ascending order: none before it is seated. */
    readonly seats: number[];
    /** The network path to a peer: the smoothed round trip `ping` in milliseconds (0 if none was measured), and the
     * share of about the last 64 packets that were lost, 0 to 1. `delay` is the current delay of your own inputs in
     * ticks. Undefined if there is no such peer. */
    link(peer: number): { ping: number; loss: number; delay: number } | undefined;
    /** Leaves the match. Call `update` until the status is `closed`, so that the other peers are informed. */
    leave(): void;
    /** Requests an end of the match after a number of ticks. The request is sent two seconds before the end. Until a
     * majority has decided on an end, other peers can get seats. */
    endAt(ticks: number): void;
    /** Requests a pause from all other peers, or withdraws the request. */
    pause(paused: boolean): void;
    /** Votes for going on without a peer that is missing. */
    goOnWithout(peer: number): void;
    /** Votes for removing the player with this key permanently. */
    kick(key: bigint): void;
    /** Changes `guess` of the options. */
    setGuess(ticks: number): void;
}
/** A game that a `MatchDriver` plays. `encode` and `decode` are for peers that join. */
export interface MatchGame<Saved = unknown> extends ReplayGame<Saved> {
    /** The whole state as bytes. */
    encode(): Uint8Array;
    /** Replaces the state by one from bytes, which may come from any source. Decode them before you free the old state:
     * bytes that are not valid have to leave it as it is. */
    decode(bytes: Uint8Array): void;
}
/** Plays a game in a match: saves, restores and advances it as the match requests. */
export class MatchDriver<Saved = unknown> {
    #private;
    /** The game has to be in the state before the first tick. `send` sends a packet to an address. */
    constructor(match: Match, game: MatchGame<Saved>, send: (to: Uint8Array, packet: Uint8Array) => void);
    /** The match of the constructor. */
    readonly match: Match;
    /** Number of ticks that the game has played, also with guessed inputs. */
    readonly tick: number;
    /** Whether the match has ended, and the game has played all its ticks with final inputs. */
    readonly ended: boolean;
    /** Takes a packet that arrived from an address, as `Match.receive`. */
    receive(now: number, from: Uint8Array, packet: Uint8Array): void;
    /** Advances the match to the time `now`, and plays the ticks that are due. Call it every few milliseconds.
     * `readInputs` returns the inputs of your own seats, one after another. Returns the events of the match; the driver
     * has already passed a `state` to `decode`. If the game throws an error, its state is unknown, and every further
     * call throws the same error. */
    update(now: number, readInputs: (seats: number[]) => Uint8Array): MatchEvent[];
}

/** The offer of a native `Peer<G>` (Rust), so that pages and native programs play together. `setup` has the canonical
 * bytes of `G::Setup`, and is empty for `()`. */
export function nativeOffer(options: {
    /** Name of the rules. */
    rules: string;
    /** Version of the rules: 1 by default. */
    rulesVersion?: number;
    /** Canonical bytes of the setup: none by default. */
    setup?: Uint8Array;
    /** Ticks per second: 60 by default. */
    tickRate?: number;
    /** Number of seats of the match. */
    seats: number;
    /** Bytes of an input: 1 by default. */
    inputBytes?: number;
    /** Milliseconds, as in `MatchOptions`. */
    patience?: number;
}): Uint8Array;
/** Encodes the state of a native game whose `Save` is the `Snapshot` of its world, for `MatchGame.encode`. */
export function encodeNativeState(world: World): Uint8Array;
/** Decodes the world from a state of `encodeNativeState` or of a native game, for `MatchGame.decode`. The bytes may
 * come from any source. */
export function decodeNativeState(bytes: Uint8Array): World;

/** A member of a room of a relay (`crates/relay`): carries the packets of a match over a WebSocket. When the connection
 * is lost, the member reconnects; packets are lost meanwhile. */
export class Relay {
    #private;
    private constructor();
    /** Enters a room, and creates it if it does not exist. `url` is `wss://HOST` or `ws://HOST:PORT`, `code` 1 to 32
     * letters, digits and `-`. With the same `secret`, 16 random bytes, a member gets the same address again.
     * `WebSocket` is needed where there is no global one, as in Node before 22. */
    static connect(url: string, code: string, options?: { secret?: Uint8Array | undefined; WebSocket?: unknown }): Promise<Relay>;
    /** Address of this member. */
    readonly own: Uint8Array;
    /** Addresses of the other members of the room, in the order in which they entered. */
    readonly others: Uint8Array[];
    /** Whether there is a connection at the moment. */
    readonly isOpen: boolean;
    /** Called with the address of the sender and the bytes of each packet. */
    onPacket: (from: Uint8Array, packet: Uint8Array) => void;
    /** Called when a member enters or leaves the room, and after a reconnection. */
    onMembers: (others: Uint8Array[]) => void;
    /** Sends a packet to a member. The packet is dropped if there is no connection, if too many bytes wait to be sent,
     * or if `to` does not have the 8 bytes of an address. */
    send(to: Uint8Array, packet: Uint8Array): void;
    /** Leaves the room. */
    close(): void;
}
