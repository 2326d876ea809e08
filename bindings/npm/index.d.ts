// lockstep2d: deterministic 2D physics for the web.

// Declarations for `using`, equal to those of TypeScript's library `esnext.disposable`, which a project may lack.
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
    x: Fx;
    y: Fx;
}
/** Bytes that do not share their buffer with other data. From TypeScript 5.7 on, the type is
 * `Uint8Array<ArrayBuffer>`. */
export type Bytes = ReturnType<Uint8Array["slice"]>;
declare const handleBrand: unique symbol;
/** Handle of a body. It is valid until the body is despawned, or until a rollback to a state from before the spawn of
 * the body. After such a rollback, another body may get the same handle, so a table of sprites should also compare
 * `userData`. The first bodies have the handles 0, 1, 2 and so on. Convert a plain number, such as one of `poses()`, by
 * `as BodyId`. */
export type BodyId = number & { readonly [handleBrand]: "body" };
/** Handle of a shape. */
export type ShapeId = number & { readonly [handleBrand]: "shape" };
/** Handle of a joint. */
export type JointId = number & { readonly [handleBrand]: "joint" };
/** A rotation, counter-clockwise: `degrees(45)`, `radians("0.5")`, `turns("0.25")`, or 0. */
export type Rotation = Angle | 0;

/** Options of `init`. */
export interface InitOptions {
    /** Whether to load the module with SIMD. By default, it is loaded if the machine supports SIMD. */
    simd?: boolean | undefined;
    /** A module that replaces the inlined one: a `WebAssembly.Module`, a `Response`, an `ArrayBuffer` or a view. */
    wasm?: object | undefined;
}
/** Loads the wasm module. Call it before all functions except `fx`, `degrees`, `radians`, `turns` and `loaded`. */
export function init(options?: InitOptions): Promise<void>;
/** The loaded module; `given` is `InitOptions.wasm`. Undefined before `init`. */
export function loaded(): "simd" | "plain" | "given" | undefined;
/** Version of the engine's arithmetic: programs with different versions compute different states. */
export function semantics(): number;
/** Number of objects that neither `dispose` nor the garbage collector has freed. */
export function objectCount(): number;

/** An error with a code. */
export class Lockstep2dError extends Error {
    /** Name of an error of the C API without `LS2D_`, or `FLOAT`, `INIT`, `DISPOSED`, `MEMORY`, `RELAY`. */
    readonly code: string;
    /** The verdict on a replay that cannot be played. */
    readonly verdict?: Verdict;
}

/** A fixed-point number with 32 fraction bits: -2^31 to just below 2^31, in steps of 2.3e-10. Immutable. Arithmetic is
 * rounded to nearest and saturates. */
export class Fx {
    #private;
    private constructor(raw: bigint);
    /** The number of `raw` units of 2^-32. */
    static fromRaw(raw: bigint | number): Fx;
    /** The number in units of 2^-32. */
    readonly raw: bigint;
    add(other: Num): Fx;
    sub(other: Num): Fx;
    mul(other: Num): Fx;
    /** Division by zero throws `NUMBER`. */
    div(other: Num): Fx;
    neg(): Fx;
    abs(): Fx;
    min(other: Num): Fx;
    max(other: Num): Fx;
    /** -1 if this number is less, 0 if equal, otherwise 1. */
    compare(other: Num): -1 | 0 | 1;
    lt(other: Num): boolean;
    gt(other: Num): boolean;
    eq(other: Num): boolean;
    /** Rounded down to an integer, which may enter the simulation. */
    floor(): number;
    /** A float for drawing. It must not enter the simulation. */
    toNumber(): number;
    /** Decimal text with up to 10 decimals, from which `fx` makes the same number again. */
    toString(): string;
    toJSON(): string;
}
/** Makes a fixed-point number: `fx("1.25")`. Numbers out of range are errors. */
export function fx(value: Num): Fx;

/** A rotation in units of 2^-32 turn, counter-clockwise. Immutable. Sums and differences wrap around at a whole
 * turn. */
export class Angle {
    #private;
    constructor(bits: number);
    /** 0 to 2^32 - 1. */
    readonly bits: number;
    add(other: Rotation): Angle;
    sub(other: Rotation): Angle;
    neg(): Angle;
    /** Degrees, above -180 and up to 180, without rounding. */
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
/** A number of degrees, rounded to nearest. */
export function degrees(value: Num): Angle;
/** A number of radians, rounded to nearest. */
export function radians(value: Num): Angle;
/** A number of full turns: `turns("0.25")` is a right angle. */
export function turns(value: Num): Angle;

/** Square root, rounded to nearest. A negative number throws `NUMBER`. */
export function sqrt(value: Num): Fx;
/** Length of a vector, rounded to nearest. */
export function hypot(x: Num, y: Num): Fx;
export function sin(angle: Rotation): Fx;
export function cos(angle: Rotation): Fx;
/** Angle of a vector from the x axis; 0 for the zero vector. */
export function angleOf(vector: Vec): Angle;
/** `a.x b.x + a.y b.y`, rounded once. */
export function dot(a: Vec, b: Vec): Fx;
/** `a.x b.y - a.y b.x`, rounded once. */
export function cross(a: Vec, b: Vec): Fx;
/** The unit vector of a direction. The zero vector throws `NUMBER`. */
export function normalize(vector: Vec): Vec2;
/** The vector turned by an angle. */
export function rotate(vector: Vec, angle: Rotation): Vec2;
/** Hash of bytes: 32 hexadecimal digits. */
export function hashBytes(bytes: Uint8Array): string;
/** A random number generator. Keep `state` in the state of the game. */
export class Random {
    /** `seed` is an integer of 64 bits, with or without a sign. */
    constructor(seed: number | bigint);
    /** State of the generator. Assign a saved state to continue from it. */
    state: { state: bigint; increment: bigint };
    /** A uniform integer from 0 to below `bound`. */
    below(bound: number): number;
    /** A uniform number from `low` to below `high`. */
    range(low: Num, high: Num): Fx;
}

/** Rule that combines the values `a` and `b` of two shapes. `average` is `(a + b) / 2`, `geometricMean` is `sqrt(a b)`,
 * `minimum` the smaller value, `product` is `a b`, `maximum` the larger value. If the shapes have different rules, the
 * one that comes later in this list applies. */
export type Mixing = "average" | "geometricMean" | "minimum" | "product" | "maximum";
/** Effects of an area, a sensor that acts on dynamic bodies. The effects on a body are in proportion to the part of its
 * shapes that is in the area. Vectors are along the axes of the area's body. Effects are 0 by default. */
export interface AreaOptions {
    /** Acceleration in m/s² besides gravity, within ±10 000 on each axis. */
    acceleration?: Vec;
    /** Force in N per m² of the part of a body that is in the area, within ±2^20 on each axis. */
    force?: Vec;
    /** Velocity of the medium relative to the area's body in m/s, within ±400 on each axis. It acts only through
     * `linearDrag`. */
    flow?: Vec;
    /** Rate per second at which the velocity of a body in the area approaches the velocity of the medium, 0 to 1000. */
    linearDrag?: Num;
    /** Rate per second at which the angular velocity of a body in the area approaches that of the area's body, 0 to
     * 1000. */
    angularDrag?: Num;
    /** Density of the medium in kg/m², for buoyancy, 0 to 2^20. */
    density?: Num;
    /** Acceleration in m/s² towards the centre (±10 000), at the distance `radius` in metres (0.01 to 2^20). Nearer to
     * the centre, the acceleration decreases linearly to 0. Farther away it is constant, or decreases with the distance
     * or its square (`falloff`: `constant` by default). */
    attraction?: { acceleration: Num; radius: Num; falloff?: "constant" | "inverse" | "inverseSquare" };
}
/** Properties of a shape. */
export interface ShapeOptions {
    /** Centre in the body's frame, in metres: within ±128 on each axis if the body can move. The origin by default. */
    offset?: Vec;
    /** Mass per area in kg/m², 0 to 2^20: 1 by default. Segments and chains have no area. */
    density?: Num;
    /** Friction coefficient, 0 to 16: 0.6 by default. */
    friction?: Num;
    /** `geometricMean` by default. */
    frictionMixing?: Mixing;
    /** Fraction of the approach speed that a bounce returns, 0 to 1.5: 0 by default. */
    restitution?: Num;
    /** `maximum` by default. */
    restitutionMixing?: Mixing;
    /** Approach speed in m/s below which the shape does not bounce, 0 to 400: the world's `restitutionThreshold` by
     * default. For two shapes, the smaller of their values applies. */
    restitutionThreshold?: Num;
    /** Rolling resistance of a round shape as a fraction of its radius, 0 to 1: 0 by default. */
    rollingResistance?: Num;
    /** Speed of the surface around the shape, clockwise, in m/s, within ±400: 0 by default. */
    surfaceSpeed?: Num;
    /** Categories of the shape, one bit each, up to 64: 1 by default. Two shapes collide if the mask of each shape has
     * a category of the other shape. */
    category?: bigint | number;
    /** Bits of the categories that the shape collides with: all by default. */
    mask?: bigint | number;
    /** Two shapes with the same positive group always collide, two shapes with the same negative group never do. A
     * signed integer of 32 bits: 0, no group, by default. */
    group?: number;
    /** Direction in the body's frame in which other shapes pass through; `degrees(90)` is up. */
    oneWay?: Rotation;
    /** Whether the shape detects overlaps and does not collide: false by default. A sensor has mass like any other
     * shape, unless its density is 0. */
    sensor?: boolean;
    /** Makes the shape a sensor that acts on bodies. Segments and chains cannot be areas. */
    area?: AreaOptions;
    /** Whether contacts of the shape are in `contactBegin` and `contactEnd`: true by default. A contact is reported if
     * at least one of its two shapes has this option. */
    contactEvents?: boolean;
    /** Whether hits of the shape are in `hits`: false by default. A hit is reported if at least one of its two shapes
     * has this option. */
    hitEvents?: boolean;
    /** Whether sensors detect the shape: true by default. */
    sensorEvents?: boolean;
    /** Whether a sensor detects other sensors: false by default. */
    detectSensors?: boolean;
    /** Radius in metres by which a polygon, hull or box is rounded outwards: 0 by default. */
    rounding?: Num;
    /** A number of 64 bits that the game may choose freely: 0 by default. */
    userData?: bigint | number;
}
declare const shapeBrand: unique symbol;
/** A shape, made by `circle`, `box` and so on. */
export interface ShapeDef {
    readonly [shapeBrand]: true;
}
/** A chain of lines. */
export interface ChainDef {
    readonly [shapeBrand]: false;
}
/** A disc with a radius in metres, 0.002 to 110. */
export function circle(radius: Num, options?: ShapeOptions): ShapeDef;
/** A rectangle with half its width and height in metres, each up to 110. */
export function box(halfWidth: Num, halfHeight: Num, options?: ShapeOptions): ShapeDef;
/** A convex polygon of 3 to 8 points in counter-clockwise order, in metres from the shape's centre, within ±110. */
export function polygon(points: readonly Vec[], options?: ShapeOptions): ShapeDef;
/** The convex hull of 3 to 8 points in any order, in metres from the shape's centre, within ±110. */
export function hull(points: readonly Vec[], options?: ShapeOptions): ShapeDef;
/** All points within `radius` metres of the line from `a` to `b`. Radius and length are at least 0.002. */
export function capsule(a: Vec, b: Vec, radius: Num, options?: ShapeOptions): ShapeDef;
/** A line without mass, at least 0.002 m long. It does not collide with segments and chains. */
export function segment(a: Vec, b: Vec, options?: ShapeOptions): ShapeDef;
/** A smooth outline of up to 4096 lines without mass, for ground and walls. `closed` connects the last point with the
 * first. `oneSided` makes the chain solid only from the right, looking along the points. Both are false by default. */
export function chain(points: readonly Vec[], options?: ShapeOptions & { closed?: boolean; oneSided?: boolean }): ChainDef;

/** Mass in kg, centre of mass and radius of gyration in metres of a dynamic body with some shapes. `{
 * ...massOf(shapes), mass: 80 }` is a mass of 80 kg that is distributed like that of the shapes. */
export function massOf(shapes: readonly ShapeDef[]): { mass: Fx; centre: Vec2; gyration: Fx };

/** `kinematic` bodies move at their velocity, which forces and contacts do not change. `dynamic` bodies are moved by
 * forces, contacts and joints. */
export type BodyType = "fixed" | "kinematic" | "dynamic";
/** Mass of a body, instead of the mass of its shapes. */
export interface MassOptions {
    /** Mass in kg, 1e-5 to 2^30. */
    mass: Num;
    /** Centre of mass in the body's frame in metres, within ±128 on each axis. The origin by default. */
    centre?: Vec;
    /** Radius of gyration about the centre of mass in metres, 0.002 to 512: `sqrt(inertia / mass)`. */
    gyration: Num;
}
/** Settings of a body, for `setBody`. */
export interface BodySettings {
    /** Decay rate of the velocity, per second, 0 to 1000: 0 by default. */
    linearDamping?: Num;
    /** Decay rate of the angular velocity, per second, 0 to 1000: 0 by default. */
    angularDamping?: Num;
    /** Factor on the world's gravity, within ±1000: 1 by default. */
    gravityScale?: Num;
    /** Speed in m/s below which the body becomes ready to sleep, 0 to 400: 0.05 by default. */
    sleepSpeed?: Num;
    /** Bodies through which the body cannot tunnel: `fixed` by default. `bullet`: all bodies except bullets.
     * `kinematic`: fixed and kinematic bodies. */
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
    /** Velocity of the centre of mass in m/s, up to the world's `speedMax`: zero by default. */
    velocity?: Vec;
    /** Angular velocity in rad/s, counter-clockwise: 0 by default. */
    angularVelocity?: Num;
    /** Mass, instead of the mass of the shapes. Without this option, a dynamic body needs a shape that has both an area
     * and a density. Otherwise its mass is 0, and forces, contacts and joints do not move it. */
    mass?: MassOptions;
    /** True by default. */
    enabled?: boolean;
    /** Whether a dynamic body begins asleep: false by default. */
    asleep?: boolean;
    /** A number of 64 bits that the game may choose freely: 0 by default. */
    userData?: bigint | number;
    /** Name in reports: at most 16 ASCII letters, digits, `-` and `_`. */
    name?: string;
    /** Shapes of the body, at most 4096; each link of a chain counts. None by default. */
    shapes?: readonly (ShapeDef | ChainDef)[];
}

/** A damped spring of a joint. */
export interface Spring {
    /** Frequency in Hz, above 0 and up to 1000. */
    hertz: Num;
    /** Damping ratio, 0 to 100: 0 by default, 1 is critical. */
    dampingRatio?: Num;
    /** Rest position in rad or m: 0 by default. */
    target?: Num;
}
/** Definition of a joint. On each body, it has an anchor, and a frame with an angle. An option that the type of the
 * joint does not have throws `VALUE`; a value out of range throws `JOINT`. */
export interface JointOptions {
    /** - `revolute`: a hinge.
     * - `prismatic`: B slides along the x axis of the joint's frame on A, and does not turn.
     * - `distance`: a rod (`rod`), a rope (`limit`) or a spring between the anchors.
     * - `weld`: B keeps its pose relative to A, rigidly or by springs.
     * - `wheel`: B slides along the x axis of the joint's frame on A, and turns.
     * - `motor`: B is driven relative to A with limited force.
     * - `filter`: only keeps the bodies from colliding with each other.
     * - `gear`: the wheels about the anchors turn in a fixed ratio.
     * - `rack`: the wheel about A's anchor rolls along the x axis of the joint's frame on B.
     * - `pulley`: a rope over two wheels that are fixed in the world. */
    type: "revolute" | "prismatic" | "distance" | "weld" | "wheel" | "motor" | "filter" | "gear" | "rack" | "pulley";
    a: BodyId;
    /** Body B. The joint has no effect while neither body is dynamic. */
    b: BodyId;
    /** Position of both anchors in the world, in metres, at the current poses. Only for `World.addJoint`. Sets
     * `anchorA`, `anchorB`, `angleA` and `angleB`, so do not pass these four options as well. */
    anchor?: Vec;
    /** With `anchor`: direction in the world of the axis of a prismatic joint, wheel or rack. The x axis by default;
     * [0, 1] for the wheels of a car. */
    axis?: Vec;
    /** Anchor in the frame of body A, in metres, within ±128 on each axis, or ±2^30 on a fixed body. The origin by
     * default. */
    anchorA?: Vec;
    /** Anchor in the frame of body B, like `anchorA`. */
    anchorB?: Vec;
    /** Angle of the joint's frame on A, in the frame of body A: 0 by default. */
    angleA?: Rotation;
    /** Angle of the joint's frame on B, in the frame of body B: 0 by default. */
    angleB?: Rotation;
    /** Range of the angle in rad (revolute), the translation in m (prismatic, wheel), or the length in m, 0 or more
     * (distance). */
    limit?: readonly [Num, Num];
    /** Target speed, and largest torque or force: rad/s and N m (revolute, wheel, motor), or m/s and N (prismatic,
     * distance). */
    motor?: { speed: Num; max: Num };
    /** Spring on the angle in rad (revolute), the translation in m (prismatic, wheel) or the length in m (distance). */
    spring?: Spring;
    /** Smallest force (0 or less) and largest force (0 or more) of the spring in N (distance). Positive forces push the
     * anchors apart. Unlimited by default. */
    springForce?: readonly [Num, Num];
    /** Length in metres that is held rigidly, at least 0.001 (distance). */
    rod?: Num;
    /** Frequency in Hz, above 0 and up to 1000, and damping ratio, 0 to 100, of the rigid constraints (all types):
     * `jointHertz` and `jointDampingRatio` of the world by default. */
    softness?: { hertz: Num; dampingRatio: Num };
    /** Whether the bodies collide with each other (all types): false by default. */
    collide?: boolean;
    /** Whether the joint acts (all types): true by default. */
    enabled?: boolean;
    /** Force in N and torque in N m beyond which the joint is reported in `Events.joints` or, with `breaks`, also
     * removed (all types). The load in the last sub-step of a tick counts: a shock within a tick may go unnoticed. */
    threshold?: { force?: Num; torque?: Num; breaks?: boolean };
    /** Target velocity of B's anchor relative to A in m/s, along the axes of the world, and largest force in N
     * (motor). */
    linearMotor?: { velocity: Vec; max: Num };
    /** Spring between the anchors: frequency in Hz, damping ratio (weld, motor), and largest force in N (motor, 0 by
     * default). Without it the anchors of a weld are rigid. */
    linearSpring?: { hertz: Num; dampingRatio: Num; max?: Num };
    /** Spring on the angle: frequency in Hz, damping ratio (weld, motor), and largest torque in N m (motor, 0 by
     * default). Without it the angle of a weld is rigid. */
    angularSpring?: { hertz: Num; dampingRatio: Num; max?: Num };
    /** Teeth of the wheels, 1 to 1000, or -1 to -1000 for a ring around the other wheel (gear). [1, 1] by default. */
    teeth?: readonly [number, number];
    /** Radius of the wheel in metres, 0.001 to 128, negative for a rack on the other side (rack). */
    radius?: Num;
    /** Positions of the wheels on the sides of A and B, in the world, in metres (pulley, required). */
    wheels?: readonly [Vec, Vec];
    /** Length of the rope in metres, 0 to 2^20, without the part between the wheels (pulley). Required, unless `anchor`
     * is given: then the length follows from the poses of the bodies. */
    length?: Num;
    /** The length on A's side plus `ratio` times the length on B's side is at most `length` (pulley). 0.25 to 4: 1 by
     * default. */
    ratio?: Num;
    /** A number of 64 bits that the game may choose freely: 0 by default. */
    userData?: bigint | number;
}
/** A joint as `World.joint` returns it, for `setJoint` with changes. The fields are those of `JointOptions`; parts that
 * the joint does not have are missing. */
export interface JointInfo {
    type: JointOptions["type"];
    a: BodyId;
    b: BodyId;
    /** In the frame of body A, in metres. */
    anchorA: Vec2;
    /** In the frame of body B, in metres. */
    anchorB: Vec2;
    angleA: Angle;
    angleB: Angle;
    collide: boolean;
    enabled: boolean;
    userData: bigint;
    limit?: [Fx, Fx];
    motor?: { speed: Fx; max: Fx };
    spring?: { hertz: Fx; dampingRatio: Fx; target: Fx };
    springForce?: [Fx, Fx];
    rod?: Fx;
    softness?: { hertz: Fx; dampingRatio: Fx };
    threshold?: { force?: Fx; torque?: Fx; breaks?: boolean };
    linearMotor?: { velocity: Vec2; max: Fx };
    linearSpring?: { hertz: Fx; dampingRatio: Fx; max?: Fx };
    angularSpring?: { hertz: Fx; dampingRatio: Fx; max?: Fx };
    teeth?: [number, number];
    radius?: Fx;
    wheels?: [Vec2, Vec2];
    length?: Fx;
    ratio?: Fx;
}

/** Settings of a world. A value out of range throws `SETTING`. */
export interface ConfigOptions {
    /** Ticks per second, 10 to 1000: 60 by default. */
    tickRate?: number;
    /** Gravity in m/s², within ±100 000 on each axis: [0, -10] by default. */
    gravity?: Vec;
    /** Sub-steps of a tick, 1 to 64: 4 by default. `tickRate` times `subSteps` is 60 to 4000. */
    subSteps?: number;
    /** Iterations of a sub-step, 1 to 16: 1 by default. More sub-steps usually improve the result more. */
    iterations?: number;
    /** Contact constraints: 0 for soft (the default), 1 for Baumgarte contacts. */
    contact?: number;
    /** Stiffness of soft contacts in Hz, 1 to 1000: 30 by default. The solver limits it to an eighth of the number of
     * sub-steps per second. For Baumgarte contacts, share of the overlap corrected in each sub-step, 0 to 1. */
    contactStiffness?: Num;
    /** Damping ratio of soft contacts, 0 to 100: 10 by default. For Baumgarte contacts, overlap in metres that is not
     * corrected, 0 to 1. */
    contactDamping?: Num;
    /** Largest speed in m/s with which contacts push shapes apart, 0 to 400: 3 by default. */
    contactPushSpeed?: Num;
    /** Stiffness of joints in Hz, 1 to 1000: 60 by default. The solver limits it to a quarter of the number of
     * sub-steps per second. */
    jointHertz?: Num;
    /** Damping ratio of joints, 0 to 100: 2 by default. */
    jointDampingRatio?: Num;
    /** Approach speed in m/s below which shapes do not bounce, 0 to 400: 1 by default. */
    restitutionThreshold?: Num;
    /** Largest speed of a body in m/s, 1 to 400: 400 by default. Below 27 ticks per second, also at most 15 m per
     * tick. */
    speedMax?: Num;
    /** Distance in metres at which shapes get contact points before they touch, 0.001 to 1: 0.02 by default. The
     * distance is larger for shapes that approach each other. */
    speculativeDistance?: Num;
    /** Largest margin in metres of the bounding boxes in the broad phase, 0.001 to 10: 0.1 by default. */
    fatMargin?: Num;
    /** Lowest approach speed of a hit event in m/s, 0 to 400: 1 by default. */
    hitSpeed?: Num;
    /** Largest number of bodies, at most 2^20, the default. `setConfig` cannot change limits. */
    bodyLimit?: number;
    /** Largest number of shapes, at most 2^20, the default. */
    shapeLimit?: number;
    /** Largest number of joints, at most 2^20, the default. */
    jointLimit?: number;
    /** Largest number of pairs of shapes with overlapping fat AABBs in a tick, at most 2^20: 2^18 by default. A tick
     * with more pairs ignores the pairs of the shapes in the largest slots, and counts as a fault (`World.faults`). */
    pairLimit?: number;
    /** Whether bodies at rest fall asleep: true by default. */
    sleeping?: boolean;
    /** Whether fast bodies are swept so that they do not pass through shapes: true by default. */
    continuous?: boolean;
}
export type ConfigInfo = {
    [Name in keyof ConfigOptions]-?: [Num] extends [ConfigOptions[Name]] ? Fx
        : [Vec] extends [ConfigOptions[Name]] ? Vec2 : Exclude<ConfigOptions[Name], undefined>;
};

/** An object of the library. `dispose` frees the object at once, the garbage collector frees it at some later time. */
declare class Handle {
    #private;
    protected constructor();
    /** Frees the object. Every later use except `dispose` throws `DISPOSED`. */
    dispose(): void;
    /** Calls `dispose` at the end of a block: `using world = new World();`. */
    [Symbol.dispose](): void;
}

// Types without values: the classes cannot be imported at run time.
export type { Edits, Handle };

/** A pose for `spawnEach`. */
export interface BodyPose {
    /** Origin of the body in the world, in metres. */
    position: Vec;
    /** No rotation by default. */
    angle?: Rotation;
}

/** Edits. A world executes them at once, a list of commands collects them. A world throws `STALE_BODY`, `STALE_SHAPE`
 * or `STALE_JOINT` for an unknown handle, and does not change. A list accepts every handle. */
declare class Edits extends Handle {
    #private;
    /** Removes a body with its shapes and joints. */
    despawn(body: BodyId): void;
    /** Removes a shape. The mass of its body changes, unless it was given (`BodyOptions.mass`). */
    removeShape(shape: ShapeId): void;
    /** Replaces the definition of a shape: omitted options have their defaults. */
    setShape(shape: ShapeId, definition: ShapeDef): void;
    removeJoint(joint: JointId): void;
    /** Replaces the definition of a joint, but not its bodies: `setJoint(joint, { ...world.joint(joint), motor })`.
     * Omitted options have their defaults. */
    setJoint(joint: JointId, options: Omit<JointOptions, "anchor" | "axis">): void;
    enableJoint(joint: JointId): void;
    /** Disables a joint: it keeps its handle and has no effect. */
    disableJoint(joint: JointId): void;
    /** A force in N during the next tick, at a point of the world in metres. Forces add up. Throws `WRONG_KIND` unless
     * the body is dynamic and enabled, as do `applyTorque`, `applyImpulse` and `applyAngularImpulse`. */
    applyForce(body: BodyId, force: Vec, point: Vec): void;
    /** A torque in N m during the next tick, counter-clockwise. */
    applyTorque(body: BodyId, torque: Num): void;
    /** An impulse in N s at a point of the world in metres: changes the velocity at once. */
    applyImpulse(body: BodyId, impulse: Vec, point: Vec): void;
    /** An angular impulse in N m s: changes the angular velocity at once. */
    applyAngularImpulse(body: BodyId, impulse: Num): void;
    /** Sets the velocity of the centre of mass in m/s, and the angular velocity in rad/s (0 by default). Throws
     * `WRONG_KIND` for a fixed body, and `SPEED` if the speed, or the angular velocity times the radius of gyration,
     * exceeds the world's `speedMax`. */
    setVelocity(body: BodyId, velocity: Vec, angular?: Num): void;
    /** Moves the origin of a body at once to a position in metres, with an angle (0 by default). */
    setTransform(body: BodyId, position: Vec, angle?: Rotation): void;
    /** Moves a kinematic body to a pose during the next tick. After this tick its velocity is 0. Throws `WRONG_KIND`
     * for other bodies, and `SPEED` if the body cannot reach the pose in one tick at the world's `speedMax`. Use
     * `setTransform` for such a distance. */
    moveTo(body: BodyId, position: Vec, angle?: Rotation): void;
    /** Replaces the settings of a body, and wakes it. Omitted settings have their defaults. Throws `VALUE` for other
     * properties, such as the remaining ones that `World.body` returns. */
    setBody(body: BodyId, settings: BodySettings): void;
    /** Changes the type of a body. A body that becomes fixed stops. */
    setType(body: BodyId, type: BodyType): void;
    /** Sets the mass of a body; without `mass`, the mass of its shapes. */
    setMass(body: BodyId, mass?: MassOptions): void;
    setUserData(body: BodyId, data: bigint | number): void;
    /** Sets the name of a body: at most 16 letters, digits, `-` and `_`, otherwise throws `NAME`. `""` removes the
     * name. */
    setName(body: BodyId, name: string): void;
    /** Returns a body to the simulation. */
    enable(body: BodyId): void;
    /** Takes a body out of the simulation: it keeps its pose and velocity, collides with nothing, and queries do not
     * find it. */
    disable(body: BodyId): void;
    /** Wakes a body, together with the dynamic bodies that are connected to it by contacts and joints. */
    wake(body: BodyId): void;
    /** Puts a dynamic body to sleep, together with the dynamic bodies that are connected to it by contacts and
     * joints. */
    sleep(body: BodyId): void;
    /** Sets the gravity in m/s², and wakes all bodies. */
    setGravity(gravity: Vec): void;
    /** Applies impulses away from `centre`, in N s per metre of the width of a shape as seen from `centre`. The impulse
     * is full within `radius` metres and falls to 0 over the next `falloff` metres; `radius` and `falloff` are 0 to
     * 1000, and 1 by default. `mask` has the categories of the shapes that the explosion acts on: all by default. */
    explode(options: { centre: Vec; impulse: Num; radius?: Num; falloff?: Num; mask?: bigint | number }): void;
}

/** A list of edits, for replays and networks. If a new world executes a list that removes nothing, the spawned bodies
 * have the handles 0, 1, 2 and so on: `0 as BodyId` is the first body. The same holds for shapes and joints. */
export class Commands extends Edits {
    #private;
    constructor();
    /** Adds a body. */
    spawn(options: BodyOptions): undefined;
    /** Adds a body at each pose, all with one definition. */
    spawnEach(options: Omit<BodyOptions, "position" | "angle">, poses: readonly BodyPose[]): undefined;
    addShape(body: BodyId, shape: ShapeDef): undefined;
    /** Adds a joint. Its anchors are given by `anchorA` and `anchorB`. */
    addJoint(options: Omit<JointOptions, "anchor" | "axis">): undefined;
    /** Adds a joint between each pair of bodies, all with one definition. */
    addJointEach(options: Omit<JointOptions, "a" | "b" | "anchor" | "axis">, pairs: readonly (readonly [BodyId, BodyId])[]): undefined;
    readonly length: number;
    clear(): void;
    toBytes(): Bytes;
    /** Replaces the contents of the list by the commands that `toBytes` has encoded. The bytes may come from an
     * untrusted source. */
    fromBytes(bytes: Uint8Array): this;
}

export class Snapshot extends Handle {
    #private;
    private constructor();
    hash(): string;
}

export interface BodyInfo {
    type: BodyType;
    position: Vec2;
    angle: Angle;
    velocity: Vec2;
    angularVelocity: Fx;
    /** In the world, in metres. */
    centre: Vec2;
    /** In kg; 0 for a body that is not dynamic, or has no mass (`BodyOptions.mass`). */
    mass: Fx;
    /** Moment of inertia about the centre of mass in kg m². */
    inertia: Fx;
    /** Number of shapes. */
    shapes: number;
    userData: bigint;
    enabled: boolean;
    asleep: boolean;
    linearDamping: Fx;
    angularDamping: Fx;
    gravityScale: Fx;
    sleepSpeed: Fx;
    continuous: "off" | "fixed" | "bullet" | "kinematic";
    maySleep: boolean;
    lockX: boolean;
    lockY: boolean;
    lockRotation: boolean;
}
/** A shape of a world. A link is a line of a chain. */
export interface ShapeInfo {
    /** Kind of geometry. Boxes and hulls are polygons. */
    type: "circle" | "segment" | "polygon" | "capsule" | "link";
    body: BodyId;
    /** In metres from the shape's centre: the ends of a segment or capsule, the corners of a polygon, or the ends of a
     * link and the far ends of its neighbours (zero without a neighbour). Empty for a circle. */
    points: Vec2[];
    /** Radius of a circle or capsule, or rounding, in metres. */
    radius: Fx;
    offset: Vec2;
    density: Fx;
    friction: Fx;
    restitution: Fx;
    rollingResistance: Fx;
    surfaceSpeed: Fx;
    category: bigint;
    mask: bigint;
    group: number;
    userData: bigint;
}
/** Shapes that a query sees: by default, those of enabled bodies except sensors. */
export interface Filter {
    /** Bits of the query's categories: all by default. */
    category?: bigint | number;
    /** Bits of the categories to see: all by default. */
    mask?: bigint | number;
    /** Whether the query sees sensors: false by default. */
    sensors?: boolean;
    /** Bodies not to see, at most 8: none by default. */
    except?: readonly BodyId[];
    /** Treatment of shapes that a ray or a cast starts in. `report`: these shapes are hits. `ignore`: the query does
     * not see them. `resist`, the default: they are hits of a ray, and of a cast only if it would move deeper into
     * them. */
    initialOverlap?: "resist" | "report" | "ignore";
}
/** Hit of a ray. */
export interface RayHit {
    shape: ShapeId;
    body: BodyId;
    /** Fraction of the translation at the hit, 0 to 1. */
    fraction: Fx;
    /** Point in the world, in metres. */
    point: Vec2;
    /** Outward normal of the surface; zero for a ray that starts inside. */
    normal: Vec2;
    /** Whether the ray or cast starts in the shape. */
    startsInside: boolean;
}
/** Hit of a moving shape. */
export interface CastHit extends RayHit {
    /** Displacement of the moving shape up to the hit, in metres. */
    travelled: Vec2;
}
/** Two shapes. A handle is stale if its shape was removed. */
export interface ContactEvent {
    /** The shape in the smaller slot. */
    shapeA: ShapeId;
    shapeB: ShapeId;
}
/** A sensor and a shape. A handle is stale if its shape was removed. */
export interface SensorEvent {
    sensor: ShapeId;
    visitor: ShapeId;
    /** Time at which the overlap began or ceased, as a fraction of the tick from 0 to 1. */
    fraction: Fx;
}
/** The events of the last tick. */
export interface Events {
    /** Bodies that moved or fell asleep, in slot order. */
    moved: { body: BodyId; position: Vec2; angle: Angle; fellAsleep: boolean }[];
    /** Shapes that began to touch, sorted by shape A, then by shape B. Shapes within 5 mm touch, also if
     * they do not hit each other. See `contactEvents`. */
    contactBegin: ContactEvent[];
    /** Shapes that ceased to touch, sorted like `contactBegin`. */
    contactEnd: ContactEvent[];
    /** Shapes that hit each other at `hitSpeed` or faster, sorted like `contactBegin`. See `hitEvents`. `point` is in
     * the world, in metres; `normal` is the unit vector from A to B; `impulse` is along the normal over the tick, in N
     * s; `approachSpeed` is in m/s. */
    hits: (ContactEvent & { point: Vec2; normal: Vec2; approachSpeed: Fx; impulse: Fx })[];
    /** Shapes that began to overlap a sensor, sorted by `fraction`. */
    sensorBegin: SensorEvent[];
    /** Shapes that ceased to overlap a sensor, sorted by `fraction`. */
    sensorEnd: SensorEvent[];
    /** Joints whose force in N on body B or torque in N m exceeded the `threshold`, in slot order. A joint that broke
     * has a stale handle. */
    joints: { joint: JointId; force: Vec2; torque: Fx; broke: boolean }[];
}

/** A physics world. Units are metres, kilograms, seconds and radians. */
export class World extends Edits {
    #private;
    /** `smallest` is the size in metres of the smallest boxes whose stacks have to be stable. Small sizes add
     * sub-steps, stiffen contacts and reduce `speculativeDistance`. */
    constructor(options?: ConfigOptions & { smallest?: Num });
    /** Makes a world from the bytes of `toBytes`. The bytes may come from an untrusted source. Wrong bytes throw
     * `SNAPSHOT`. */
    static fromBytes(bytes: Uint8Array): World;
    toBytes(): Bytes;
    clone(): World;
    /** Adds a body, and returns its handle. */
    spawn(options: BodyOptions): BodyId;
    /** Adds a body at each pose, all with the definition `options`. If the world refuses one of the bodies, it adds
     * none of them. A recording stores the definition only once. */
    spawnEach(options: Omit<BodyOptions, "position" | "angle">, poses: readonly BodyPose[]): BodyId[];
    /** Adds a shape to a body, and returns its handle. */
    addShape(body: BodyId, shape: ShapeDef): ShapeId;
    /** Adds a joint, and returns its handle. */
    addJoint(options: JointOptions): JointId;
    /** Adds a joint between each pair of bodies, all with one definition. If the world refuses one of the joints, it
     * adds none of them. */
    addJointEach(options: Omit<JointOptions, "a" | "b" | "anchor" | "axis">, pairs: readonly (readonly [BodyId, BodyId])[]): JointId[];
    /** Advances the world by a number of ticks, 1 by default. Afterwards, `events` returns the events of the last
     * tick. */
    step(ticks?: number): void;
    /** Executes a list of commands, and returns the number of commands that the world refused. The list keeps its
     * commands. */
    execute(commands: Commands): number;
    /** Hash of the state: 32 hexadecimal digits. */
    hash(): string;
    /** Hash of one section of the state. `section` is 0 (settings, tick and fault count), 1 (bodies), 2 (shapes), 3
     * (joints), 4 (contacts), 5 (islands), or 6 (random number generator). */
    digest(section: number): string;
    /** Number of ticks since the world was made. `restore` and `fromBytes` set it to the number in the saved state. */
    readonly tick: number;
    /** Number of faults: results of the solver that were clamped to the range of their number format, and ticks with
     * more pairs than `pairLimit`. Limiting a body to `speedMax` does not count. */
    readonly faults: number;
    /** `pairs` counts pairs of shapes with overlapping fat AABBs. */
    counts(): { bodies: number; shapes: number; joints: number; awake: number; pairs: number };
    config(): ConfigInfo;
    /** Changes the given settings. A different limit throws `FIXED_SETTING`. */
    setConfig(options: ConfigOptions): void;
    /** A random integer below `bound`, from the generator of the world, which is part of its state. */
    random(bound: number): number;
    /** A random number from `low` to below `high`. */
    randomRange(low: Num, high: Num): Fx;
    save(): Snapshot;
    /** Saves the state into an existing snapshot, whose memory is reused. */
    saveInto(snapshot: Snapshot): void;
    /** Restores a saved state. There are no events until the next tick. */
    restore(snapshot: Snapshot): void;
    /** Undefined if the body is not in the world. */
    body(body: BodyId): BodyInfo | undefined;
    /** Undefined if the body has no name or is not in the world. */
    bodyName(body: BodyId): string | undefined;
    /** Velocity in m/s of a body at a point of the world, in metres. */
    velocityAt(body: BodyId, point: Vec): Vec2;
    /** In slot order. */
    bodies(): BodyId[];
    /** In slot order. */
    joints(): JointId[];
    /** In the order in which they were added. A chain has a shape for each line. */
    shapesOf(body: BodyId): ShapeId[];
    /** In slot order. */
    jointsOf(body: BodyId): JointId[];
    /** Shapes that a sensor overlaps, in slot order. */
    sensorOverlaps(shape: ShapeId): ShapeId[];
    /** Body and definition of a shape. */
    shape(shape: ShapeId): ShapeInfo;
    /** The fat AABB of a shape: its axis-aligned bounding box in the world with a margin, in metres. */
    shapeBox(shape: ShapeId): { lower: Vec2; upper: Vec2 };
    /** Distance in metres, negative if the shapes overlap. Undefined if one of the shapes is disabled or not in the
     * world. */
    shapeDistance(a: ShapeId, b: ShapeId): Fx | undefined;
    joint(joint: JointId): JointInfo;
    /** In the world, in metres. */
    jointAnchors(joint: JointId): [Vec2, Vec2];
    /** Angle of the joint's frame on B relative to its frame on A in rad, including whole turns. Undefined if the joint
     * is not in the world. */
    jointAngle(joint: JointId): Fx | undefined;
    /** Force in N on body B in the last sub-step, and torque in N m about B's anchor. Undefined if the joint is not in
     * the world. */
    jointForce(joint: JointId): { force: Vec2; torque: Fx } | undefined;
    /** For drawing, five floats for each enabled body: handle, x and y in metres, angle in radians, and 1 if the body
     * is awake, otherwise 0. If `target` is long enough, the floats are written to `target`, and the result is a view
     * of the written part. */
    poses(target?: ReturnType<Float64Array["slice"]>): ReturnType<Float64Array["slice"]>;
    poses(target: Float64Array): Float64Array;
    /** The events of the last tick: after `step(120)`, those of the 120th tick. */
    events(): Events;
    /** The first shape that a ray from `origin` to `origin` plus `translation` meets, in metres. */
    castRay(origin: Vec, translation: Vec, filter?: Filter): RayHit | undefined;
    /** Every shape that a ray meets, in order along the ray. */
    castRayAll(origin: Vec, translation: Vec, filter?: Filter): RayHit[];
    /** The first shape of the world that `shape` meets when it moves from `position` by `translation`, in metres. */
    castShape(shape: ShapeDef, position: Vec, translation: Vec, options?: Filter & { angle?: Rotation }): CastHit | undefined;
    /** Shapes that overlap a given shape, in slot order. */
    overlapShape(shape: ShapeDef, position: Vec, options?: Filter & { angle?: Rotation }): ShapeId[];
    /** Shapes that overlap a box between two corners, in slot order. */
    overlapBox(lower: Vec, upper: Vec, filter?: Filter): ShapeId[];
    /** Shapes that contain a point, in slot order. */
    overlapPoint(point: Vec, filter?: Filter): ShapeId[];
    /** The shape nearest to a point, if its distance is at most `within` metres. `distance` is negative inside the
     * shape, `point` is on its surface, and `normal` is the unit vector from the given point to the shape. */
    closest(point: Vec, within: Num, filter?: Filter): { shape: ShapeId; body: BodyId; distance: Fx; point: Vec2; normal: Vec2 } | undefined;
}

/** Geometry and abilities of a character, which stays upright. */
export interface MoverOptions {
    /** Geometry of the character. Other options of the shape have no effect. */
    shape: ShapeDef;
    /** Steepest slope that counts as ground, measured from the horizontal; 45 degrees by default. */
    slopeMax?: Rotation;
    /** Height in metres of steps that the character climbs without a jump, 0 to 100; 0 by default. */
    stepHeight?: Num;
    /** Largest descent of the ground within a tick that the character follows, in metres, 0 to 100; 0.1 by default. */
    snapDistance?: Num;
}
/** A surface that a character has met. */
export interface MoverPlane {
    shape: ShapeId;
    body: BodyId;
    /** Origin of the body when the character met the surface, in the world, in metres. */
    bodyPosition: Vec2;
    /** Rotation of the body when the character met the surface. */
    bodyAngle: Angle;
    /** Velocity of the surface in m/s. */
    velocity: Vec2;
    /** Outward normal. */
    normal: Vec2;
    /** Nearest point on the surface. */
    point: Vec2;
    /** Distance of the character from the surface in metres, negative if they overlap. */
    separation: Fx;
}
/** State of a character, part of the state of the game. */
export interface MoverState {
    /** Position of the shape's centre in the world, in metres. */
    position: Vec;
    /** In m/s: relative to the ground while the character stands on ground, otherwise in the world. */
    velocity?: Vec;
    /** The ground on which the character stands; undefined in the air. */
    ground?: MoverPlane | undefined;
    /** Whether the last move has brought the character from the air onto ground. */
    hasLanded?: boolean;
    /** Shapes solid from one side that the character overlaps and passes through until it has left them, at most 8. */
    passing?: readonly ShapeId[];
}
export interface Moved {
    /** The new state, for the next call. */
    state: {
        /** Position of the shape's centre in the world, in metres. */
        position: Vec2;
        /** In m/s: relative to the ground while the character stands on ground, otherwise in the world. */
        velocity: Vec2;
        ground: MoverPlane | undefined;
        /** Whether there is a `ground`. */
        isOnGround: boolean;
        /** Whether the character is wedged between two slopes that are too steep to stand on. */
        isWedged: boolean;
        /** Whether this move has brought the character from the air onto ground. */
        hasLanded: boolean;
        /** Shapes solid from one side that the character overlaps and passes through until it has left them. */
        passing: ShapeId[];
    };
    /** The surfaces, in the order in which the character has met them. */
    met: MoverPlane[];
}
/** Moves a character for one tick at its velocity: it slides along surfaces, climbs steps, and is carried by moving
 * ground. The game adds gravity to the velocity. Call `moveCharacter` after `step`. Sensors, areas and events do not
 * notice a character. To find sensors, use `overlapShape` with `sensors: true`. To trigger events, let a kinematic body
 * follow the character, and leave this body out by `except` of the filter. To push bodies, apply impulses to the bodies
 * in `met`. */
export function moveCharacter(world: World, mover: MoverOptions, state: MoverState, filter?: Filter): Moved;
/** Encodes the state of a character, for saves and hashes. */
export function encodeMoverState(state: MoverState): Bytes;
export function decodeMoverState(bytes: Uint8Array): Moved["state"];

/** Upper limits on the size of a replay and on the cost of playing it. The defaults allow a day of play. With the
 * defaults, a malicious file can take hours to verify: a server should set narrower limits. */
export interface Limits {
    /** Bytes of the file: 64 MiB by default. */
    fileBytes?: number;
    /** Bytes of the setup: 16 MiB by default. */
    setupBytes?: number;
    /** Number of players: 64 by default. */
    players?: number;
    /** Bytes of a block, the part of the file with the inputs between two checkpoints: 16 MiB by default. */
    blockBytes?: number;
    /** Ticks between checkpoints: 3600 by default. */
    blockTicks?: number;
    /** Ticks of the game: 5 184 000 by default, a day at 60 ticks per second. */
    ticks?: number;
    /** Bodies of the world: 2^20 by default. */
    bodies?: number;
    /** Work units of a tick: 10 million by default. A unit takes about a microsecond or less. */
    tickWork?: number;
    /** Work units of the game: 20 000 million by default. */
    totalWork?: number;
}
/** Result of verifying a replay. */
export interface Verdict {
    /** - `match`: valid. The inputs reproduce every checkpoint, the last state and the results of the file.
     * - `claim_mismatch`: the last state or a result differs from the file.
     * - `diverged`: a checkpoint differs.
     * - `incomplete`: the file ends before its trailer, but is valid up to its end.
     * - `malformed`: the bytes are not a replay.
     * - `limit_exceeded`: the file exceeds one of the `Limits`.
     * - `unverifiable`: the file was recorded with another version of the engine, or with other rules. */
    verdict: "match" | "claim_mismatch" | "diverged" | "incomplete" | "malformed" | "limit_exceeded" | "unverifiable";
    /** Ticks played, for `match`, `claim_mismatch` and `incomplete`; tick of the first checkpoint that differs, for
     * `diverged`; otherwise 0. */
    ticks: number;
    /** Hash of the last state for `match`, `claim_mismatch` and `incomplete`; otherwise 32 zeros. For a `Replay`, this
     * is the hash that was passed to `verdict`. For the file of a `Recording`, it differs from `World.hash()`, because
     * it also covers the number of refused commands. */
    hash: string;
    /** The verdict in words. */
    text: string;
}
/** Goes to any tick of a replay of a world. Tick t is the state after t ticks. */
export class Timeline extends Handle {
    #private;
    /** Throws `RECORD`, with the `verdict`, if the file cannot be played. */
    constructor(bytes: Uint8Array, limits?: Limits);
    readonly ticks: number;
    /** The current tick, 0 at first. */
    readonly tick: number;
    /** Goes to a tick. Compares the states of the ticks that it plays with the checkpoints of the file. */
    seek(tick: number): void;
    /** Returns false at the end. */
    step(): boolean;
    /** Returns false at the start. */
    stepBack(): boolean;
    /** A copy of the world, to be disposed of by the caller. */
    world(): World;
}

/** Verifies a replay of a world. The replay may come from an untrusted source. */
export function verifyReplay(bytes: Uint8Array, limits?: Limits): Verdict;

/** A world whose inputs are lists of commands, recorded while it runs. */
export class Recording extends Handle {
    #private;
    /** `setup` has the commands that build the world. The constructor throws if the world refuses one of them. The
     * bodies of `setup` have the handles 0, 1, 2 and so on. There is a checkpoint every `interval` ticks, 1 to 3600: 60
     * by default. */
    constructor(options: { config?: ConfigOptions; setup: Commands; interval?: number });
    /** Executes and empties the list, and advances the world by a tick. Skips commands that the world refuses. */
    step(commands: Commands): void;
    /** A copy of the world, to be disposed of by the caller. */
    world(): World;
    /** The bytes finished since the last call, to be appended to a file. */
    take(): Bytes;
    /** Ends the recording, and returns the remaining bytes. */
    finish(): Bytes;
}
/** Inputs of a tick. */
export interface TickInputs {
    /** Inputs of all players or seats, in order. */
    inputs: Bytes;
    /** Bit for each empty seat, whose input is zeros. */
    absent: bigint;
}
/** Records a game with its own rules. */
export class Recorder extends Handle {
    #private;
    constructor(options: {
        rules: string;
        /** 1 by default. */
        rulesVersion?: number;
        /** Number of players, 1 to 64. */
        players: number;
        /** Ticks per second: 60 by default. */
        tickRate?: number;
        /** Bytes of a player's input, 1 to 512. */
        inputBytes: number;
        /** Data from which the game makes its first state: none by default. */
        setup?: Uint8Array;
        /** Hash of the state before the first tick. */
        start: string;
        /** Ticks between checkpoints, 1 to 3600: 60 by default. */
        interval?: number;
    });
    /** Records the inputs of all players, and a bit for each absent player, whose input has to be zeros.
     * `Match.finalInputs` returns these two values. `record` returns whether the caller then has to call
     * `checkpoint`. */
    record(inputs: Uint8Array, absent?: bigint): boolean;
    /** Adds a result such as a score, with a name of 1 to 64 bytes. A replay has at most 256 results, and their names
     * must differ. The results can be read without playing the replay. */
    claim(name: string, number: number | bigint): void;
    /** Passes the hash of the state after the last recorded tick. */
    checkpoint(hash: string): void;
    /** The bytes finished since the last call, to be appended to a file. */
    take(): Bytes;
    /** The bytes that `finish` would return now; the recording goes on. After the bytes taken so far, they complete a
     * replay of the ticks so far. */
    soFar(hash: string): Bytes;
    /** Ends the replay with the hash of the last state, and returns the remaining bytes. */
    finish(hash: string): Bytes;
}
/** A replay of a game with its own rules. */
export class Replay extends Handle {
    #private;
    /** Throws `RECORD`, with the `verdict`, if the file cannot be played. */
    constructor(bytes: Uint8Array, limits?: Limits);
    readonly rules: string;
    readonly rulesVersion: number;
    readonly players: number;
    readonly tickRate: number;
    readonly inputBytes: number;
    readonly ticks: number;
    /** Data from which the game makes its first state. */
    readonly setup: Bytes;
    /** Results in the file. They are verified only if the verdict is `match`. */
    readonly claims: Map<string, bigint>;
    /** The inputs of the next tick; undefined at the end. */
    next(): TickInputs | undefined;
    /** Compares a state hash with the file. Call it before the first tick and after every tick, or, while seeking, for
     * each request `checksum`. */
    check(hash: string): void;
    /** Adds a result of the game that was simulated. The verdict compares these results with `claims`. */
    claim(name: string, number: number | bigint): void;
    /** The verdict after the last tick, or after a checkpoint that differs. `hash` is the hash of the current state. */
    verdict(hash: string): Verdict;
    /** Starts seeking to a tick. Then fulfil the requests of `nextRequest`, or let a `ReplayDriver` do both. At the
     * first call the game has to be in its first state. */
    seek(tick: number): void;
    /** The next request of `seek`: `save`, `load`, `advance`, or `checksum`, which `check` answers. Undefined when the
     * tick is reached. Throws `RECORD` if the game has diverged from the file. */
    nextRequest(): MatchRequest | undefined;
    /** Sets the interval in ticks at which seeking saves the state: 60 by default, or a 256th of the replay if that is
     * more. */
    setInterval(ticks: number): void;
}
/** A game. `save` and `hash` have to cover its whole state. */
export interface ReplayGame<Saved = unknown> {
    /** Advances by a tick, with the inputs of all seats, and a bit for each empty seat. */
    step(inputs: Bytes, absent: bigint): void;
    save(): Saved;
    /** Restores a copy. The driver may restore the same copy again later. */
    load(saved: Saved): void;
    /** Frees a copy. */
    drop?(saved: Saved): void;
    /** 32 hexadecimal digits. */
    hash(): string;
}
/** Plays a replay with a game, and goes to any of its ticks. */
export class ReplayDriver<Saved = unknown> {
    #private;
    /** The game has to be in the state before the first tick. Nothing may have been read from the replay before. From
     * now on, do not call `next`, `seek` or `nextRequest` of the replay yourself. */
    constructor(replay: Replay, game: ReplayGame<Saved>);
    /** The number of ticks that led to the current state. */
    readonly tick: number;
    /** Goes to a tick: restores a saved state if this saves time, and simulates the ticks after it. Throws `RECORD` if
     * the game diverges from the file. The driver then stays at the checkpoint that differs, and only earlier ticks can
     * be reached. An error of the game is thrown unchanged. After such an error, or if the replay was read without this
     * driver, `seek` can only continue from a saved state, and throws `VALUE` if it would have to continue from the
     * current state. */
    seek(tick: number): void;
    /** Goes forward by a tick. The game simulates this tick. Returns false at the end. */
    step(): boolean;
    /** Returns false at the start. */
    stepBack(): boolean;
    /** Frees the saved states, and makes the driver unusable. */
    dispose(): void;
    /** Calls `dispose` at the end of a block. */
    [Symbol.dispose](): void;
}

/** Parameters of a match and of a peer. `seats`, `inputBytes`, `tickRate`, `patience` and `matchTag` have to be equal
 * for all peers. `checkInterval` should be equal, because peers compare states only in ticks at which both check. */
export interface MatchOptions {
    /** Number of seats of the match, 1 to 64. */
    seats: number;
    /** Number of seats of this peer: 1 by default; 0 for a spectator or a dedicated server. */
    ownSeats?: number;
    /** Number of taken seats at which the match begins: 2 by default, or `seats` if that is less. Seats of the host
     * count. */
    startWith?: number;
    /** Bytes of an input, 1 to 512: 1 by default. */
    inputBytes?: number;
    /** Ticks a second, 1 to 1000: 60 by default. */
    tickRate?: number;
    /** Ticks that may be played with guessed inputs, 0 to 32; 0, the default, means lockstep. Peers may have different
     * values. */
    guess?: number;
    /** Smallest delay of your own inputs in ticks: 0 by default. The delay follows the latency. */
    delayMin?: number;
    /** Largest delay in ticks, at most 60: 20 by default. */
    delayMax?: number;
    /** Interval in ticks at which states are saved, from 1 to half of `history`. The default is that of a native `Peer`:
     * 1 if `guess` is more than 0; otherwise the largest divisor of `checkInterval` up to 8, or 6 without
     * `checkInterval`. */
    saveInterval?: number;
    /** Interval in ticks at which states are compared: a multiple of `saveInterval`. The default is that of a native
     * `Peer`: the largest multiple of `saveInterval` up to 10, or `saveInterval` if it is more than 10. If neither
     * option is given, it is 6 in lockstep. */
    checkInterval?: number;
    /** Ticks that may be played beyond the last final tick, at least 16: 128 by default. */
    history?: number;
    /** Minimum number of final ticks whose inputs are kept for peers that return: 36 000 by default. */
    logTicks?: number;
    /** When a peer joins, its first tick lies three round trips and this number of ticks after the agreement on its
     * seat: 8 by default. */
    seatLead?: number;
    /** A peer may get a seat if it lags by at most this many ticks: 40 by default. */
    seatWithin?: number;
    /** Packets with another tag are ignored. 0 by default. */
    matchTag?: bigint | number;
    /** Milliseconds for which the other peers wait for a missing peer before they go on without it: 2000 by default. */
    patience?: number;
    /** Number of this peer, of 32 bits: random by default. Use a new one each time the page is loaded. */
    peer?: number | undefined;
    /** Identity of the player, of 64 bits: random by default. A peer that joins with the same key gets its seat back,
     * if the seat is free. */
    key?: bigint | undefined;
    /** Secret numbers of 64 bits against packets with forged addresses: random by default. */
    secret?: readonly [bigint, bigint] | undefined;
    /** Data that all peers have to agree on, at most 512 bytes. A peer with a different offer is refused. The default
     * is the `nativeOffer` of the options that have to be equal, without rules and setup. An offer of your own should
     * contain these options as well. */
    offer?: Uint8Array | undefined;
    /** Address of a participant of the match to join. Without `contact`, the constructor opens a match. */
    contact?: Uint8Array | undefined;
}
/** Status of a peer:
 *
 * - `connecting`: requests to join, or downloads the initial state.
 * - `joining`: follows the match and requests a seat, until one is free.
 * - `watching`: follows the match without a seat.
 * - `waiting`: has a seat, or is a dedicated server, in a match that has not begun.
 * - `playing`: has a seat, or is a dedicated server, in a match that has begun.
 * - `paused`: no messages of a majority of the peers arrive, directly or through others. A peer may have this status
 *   for a moment after it has joined.
 * - `dropped`: the other peers went on without this peer, which requests its seat again.
 * - `kicked`: removed by a vote.
 * - `leaving`: announces its departure.
 * - `left`: has left, and still answers peers that lack packets.
 * - `finished`: all ticks are final, and this peer still answers other peers. See `MatchDriver.ended`.
 * - `closed`: sends nothing more; follows `left` and `finished` after some seconds. */
export type MatchStatus =
    | "joining" | "watching" | "waiting" | "playing" | "paused" | "dropped" | "kicked" | "leaving" | "left" | "finished" | "closed"
    | "connecting";
/** An event of a match. Other fields than those named here have no meaning.
 *
 * - `status`: the new `status`.
 * - `view`: voters, seats, start or end of the match have changed. `value` is the number of the new view, which each
 *   change increases by one.
 * - `seated`: from `tick` on, `peer` has `seat`. `unseated`: from `tick` on, `peer` no longer has `seat`.
 * - `waiting`: play stalls, because inputs of `peer` are missing. `value` is 1 if messages of this peer still arrive,
 *   directly or through other peers; otherwise 0.
 * - `resumed`: play continues.
 * - `pause`: `peer` requests a pause (`value` is 1) or withdraws its request (0).
 * - `end`: the match ends after `tick` ticks.
 * - `desync`: after `tick` ticks, the state of `peer` has the hash `theirs`, and the state of this peer the hash
 *   `ours`.
 * - `conflict`: `peer` has issued two different inputs for `tick`. The input that arrived first counts.
 * - `tooFarBehind`: this peer is so far behind that the others may have dropped inputs that it lacks. It has to join
 *   again.
 * - `refused`: the contact refuses the request to join, because of `reason`.
 * - `state`: the encoded `state` after `tick` ticks, to be loaded before the next request.
 * - `badState`: a downloaded state is not valid. This peer requests the state again. */
export interface MatchEvent {
    kind:
        | "status" | "view" | "seated" | "unseated" | "waiting" | "resumed" | "pause" | "end" | "desync" | "conflict" | "tooFarBehind"
        | "refused" | "state" | "badState";
    peer: number;
    /** From 0. */
    seat: number;
    tick: number;
    value: number;
    /** Hash of this peer. */
    ours: string;
    /** Hash of the other peer. */
    theirs: string;
    status?: MatchStatus;
    /** `offer`: the offers differ; `full`: too many peers are joining through this contact; `taken`: another peer has
     * this number; `notReady`: the contact is not in a match yet, and the request is repeated. */
    reason?: "offer" | "full" | "taken" | "notReady";
    state?: Bytes;
}
/** A request to the game. Fulfil the requests in the order of `nextRequest`, before you call `advance` again:
 *
 * - `save`: keep a copy of the state before `tick`.
 * - `load`: restore the copy of the state before `tick`.
 * - `advance`: simulate `tick` with the `inputs` of all seats in order.
 * - `checksum`: pass the hash of the copy of the state before `tick` to `reportHash`.
 * - `forget`: copies for ticks below `tick` are no longer needed. */
export interface MatchRequest {
    kind: "save" | "load" | "advance" | "checksum" | "forget";
    /** From 0. */
    tick: number;
    /** Empty except for `advance`. */
    inputs: Bytes;
    /** Bit for each empty seat, whose input is zeros. */
    absent: bigint;
    /** Bit for each seat whose input is guessed. */
    guessed: bigint;
}
/** One participant of a match. Inputs, states and packets are bytes. `now` is in milliseconds and must not decrease,
 * like `performance.now()`. `MatchDriver` fulfils the requests. Misuse throws a `Lockstep2dError`. While the status is
 * `connecting`, these functions throw `NOT_IN_MATCH`: `ticks`, `finalInputs`, `link`, `advance`, `reportHash`, `leave`,
 * and all functions below `leave`. */
export class Match extends Handle {
    #private;
    /** Opens a match, or joins one through a `contact`. An option out of range throws `CONFIG` or `VALUE`. */
    constructor(options: MatchOptions);
    readonly inputBytes: number;
    /** Requests to join a match through this participant. Discards a match in progress, with its requests and
     * events. */
    ask(contact: Uint8Array): void;
    /** Processes a packet that arrived from an address. Ignores packets that do not belong to the match, and packets of
     * more than 2048 bytes. */
    receive(now: number, from: Uint8Array, packet: Uint8Array): void;
    /** Advances the match to `now`. Call it every few milliseconds, and after `receive`. */
    update(now: number): void;
    /** Whether the next tick is due, and the match can take its inputs. */
    isDue(now: number): boolean;
    /** Issues the inputs of your own seats in order, and plays a tick if possible. Returns whether the inputs were
     * issued; otherwise the same inputs may be passed again. Issued inputs count for one tick, so clear recorded key
     * presses when the inputs were issued. While the input delay grows, `isDue` remains true, and each further call
     * takes the inputs of one more tick before the next tick is played. */
    advance(now: number, inputs: Uint8Array): boolean;
    nextRequest(): MatchRequest | undefined;
    /** Passes the hash for a request `checksum`. */
    reportHash(tick: number, hash: string): void;
    nextPacket(): { to: Bytes; packet: Bytes } | undefined;
    nextEvent(): MatchEvent | undefined;
    /** Whether `offerState` is needed for a peer that joins. */
    readonly wantsState: boolean;
    /** Offers the encoded state after `tick` final ticks to peers that join. */
    offerState(tick: number, state: Uint8Array): void;
    readonly status: MatchStatus;
    /** Numbers of ticks: `played` ticks were played, `final` ticks have final inputs, and `confirmed` ticks were played
     * with final inputs. */
    ticks(): { played: number; final: number; confirmed: number };
    /** The final inputs of all seats for a tick; undefined if they are not final yet or no longer stored. */
    finalInputs(tick: number): TickInputs | undefined;
    /** Seats of this peer, in ascending order. */
    readonly seats: number[];
    /** The network path to a peer: smoothed round trip `ping` in milliseconds (0 if none was measured), lost share of
     * about the last 64 packets, and delay of your own inputs in ticks. Undefined if there is no such peer. */
    link(peer: number): { ping: number; loss: number; delay: number } | undefined;
    /** Leaves the match. Call `update` until the status is `closed`, to inform the other peers. */
    leave(): void;
    /** Requests an end of the match after a number of ticks. The request is sent two seconds before the end. Until a
     * majority has decided on the end, other peers can get seats. One peer with a vote (a player with a seat, or a
     * dedicated server) can request the end for all, and the request cannot be withdrawn, so base it on the state of a
     * confirmed tick (`ticks().confirmed`). Without a vote, the request has no effect until this peer gets a seat, and
     * none if its tick has passed by then. */
    endAt(ticks: number): void;
    /** Tells the other peers that this peer requests a pause, or withdraws its request. The match plays on: during a
     * pause, the program of each peer calls `update` and does not call `advance`. With a driver, use
     * `MatchDriver.pause`. */
    pause(paused: boolean): void;
    /** Votes for going on without a missing peer. */
    goOnWithout(peer: number): void;
    /** Votes for removing the player with this key. The vote counts only while this peer is a voter. */
    kick(key: bigint): void;
    /** Changes `guess` of the options. */
    setGuess(ticks: number): void;
}
/** A game for `MatchDriver`. `encode` and `decode` are for peers that join. */
export interface MatchGame<Saved = unknown> extends ReplayGame<Saved> {
    encode(): Uint8Array;
    /** Replaces the state by an encoded state, which may come from an untrusted source. Decode the bytes before you
     * free the old state: if the bytes are not valid, throw an error and keep the old state. */
    decode(bytes: Bytes): void;
}
/** Plays a game in a match: saves, restores and advances it as the match requests. */
export class MatchDriver<Saved = unknown> {
    #private;
    /** The game has to be in the state before the first tick. `send` sends a packet to an address. If it throws, the
     * packet is lost, and the match goes on. `contacts` returns the addresses of members of the match, such as
     * `relay.others`; the first one is the `contact` of the match. The driver asks the next of them if nothing arrives
     * for two seconds while the status is `connecting`, after the event `refused`, and after `tooFarBehind`. */
    constructor(
        match: Match,
        game: MatchGame<Saved>,
        send: (to: Bytes, packet: Bytes) => void,
        options?: { contacts?: (() => Uint8Array[]) | undefined },
    );
    readonly match: Match;
    /** Number of ticks played, including those with guessed inputs. */
    readonly tick: number;
    /** Whether the match is finished, and the game has played all its ticks with final inputs. */
    readonly ended: boolean;
    /** The last error that `send` has thrown. */
    readonly sendError: unknown;
    /** Whether this peer or another player requests a pause. False once the match is `finished`. */
    readonly isPaused: boolean;
    /** Requests a pause, or withdraws the request. The other peers get the event `pause`. While any player requests a
     * pause, `update` plays no ticks and does not call `readInputs`; continue to call it, so that no player loses its
     * seat. A request counts only while the player has a seat: spectators, players that are still catching up with a
     * running match, and players that have left cannot pause the match. */
    pause(paused: boolean): void;
    /** Frees the saved states, and makes the driver unusable. The match remains. */
    dispose(): void;
    /** Calls `dispose` at the end of a block. */
    [Symbol.dispose](): void;
    /** Passes a packet from an address to the match. */
    receive(now: number, from: Uint8Array, packet: Uint8Array): void;
    /** Advances the match to `now`, and plays the ticks that are due. Call it every few milliseconds. `readInputs`
     * returns the inputs of your own seats in order. Each result counts for one tick, so clear recorded key presses in
     * `readInputs`. While the input delay grows, an update calls `readInputs` several times. Returns the events. For an
     * event `state`, the game has already decoded the state. After an error of the game, every further call throws that
     * error. An error of `readInputs` is thrown once. The next call continues the match, and also returns the events of
     * the call that threw the error. A time that is no number, or is more than a second less than an earlier time,
     * throws `VALUE` and changes nothing. */
    update(now: number, readInputs: (seats: number[]) => Uint8Array): MatchEvent[];
}

/** The offer of a native `Peer<G>` (Rust), with the version of the engine's arithmetic. `setup` has the canonical bytes
 * of `G::Setup`, and is empty for `()`. */
export function nativeOffer(options: {
    /** Name of the rules. */
    rules: string;
    /** 1 by default. */
    rulesVersion?: number;
    setup?: Uint8Array;
    /** Ticks per second: 60 by default. */
    tickRate?: number;
    seats: number;
    /** 1 by default. */
    inputBytes?: number;
    /** Milliseconds, as in `MatchOptions`: 2000 by default. */
    patience?: number;
}): Bytes;
/** The state of a native game whose `Save` is the `Snapshot` of its world, for `MatchGame.encode`. */
export function encodeNativeState(world: World): Bytes;
/** Decodes the world from a state of `encodeNativeState` or of a native game, for `MatchGame.decode`. The bytes may
 * come from an untrusted source. */
export function decodeNativeState(bytes: Uint8Array): World;

/** A member of a room of a relay (`crates/relay`), which carries packets over a WebSocket. It reconnects when the
 * connection is lost or the relay does not answer for 15 seconds. Packets are lost in the meantime. */
export class Relay {
    #private;
    private constructor();
    /** Enters a room, and creates it if necessary. `url` is `wss://HOST` or `ws://HOST:PORT`, `code` 1 to 32 letters,
     * digits and `-`. `secret` has 16 bytes, random by default: a member that enters again with the same `secret` gets
     * the same address. Node before 22 needs the option `WebSocket`. Throws `RELAY` if the relay refuses the connection
     * or does not answer within ten seconds, or if the page cannot open the URL, such as `ws://` in a page loaded over
     * https. */
    static connect(url: string, code: string, options?: { secret?: Uint8Array | undefined; WebSocket?: unknown }): Promise<Relay>;
    /** Address of this member. */
    readonly own: Bytes;
    /** Addresses of the other members, in the order in which they entered. */
    readonly others: Bytes[];
    /** Whether there is a connection. `Relay` opens a lost connection again, unless `isClosed` is true. */
    readonly isOpen: boolean;
    /** Whether the connection has ended for ever: after `close`, or because the same `secret` has entered the room
     * again, for example in a duplicate of the tab. */
    readonly isClosed: boolean;
    /** Called with the sender and the bytes of each packet. */
    onPacket: (from: Bytes, packet: Bytes) => void;
    /** Called when a member enters or leaves the room, and after a reconnection. */
    onMembers: (others: Bytes[]) => void;
    /** Sends a packet to a member. The packet is dropped if there is no connection, if more than 512 KiB wait to be
     * sent, or if `to` does not have the 8 bytes of an address. */
    send(to: Uint8Array, packet: Uint8Array): void;
    close(): void;
}
