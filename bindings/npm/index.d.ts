// lockstep2d: deterministic 2D physics for the web.

/** A fixed-point number as an argument: an integer, decimal text such as `"0.1"`, or an `Fx`. A float is an error. */
export type Num = number | string | Fx;
/** A vector as an argument. */
export type Vec = readonly [Num, Num] | { readonly x: Num; readonly y: Num };
/** A vector as a result. */
export interface Vec2 {
    x: Fx;
    y: Fx;
}
/** Handle of a body: a number that its world never uses again. */
export type BodyId = number;
/** Handle of a shape. */
export type ShapeId = number;
/** Handle of a joint. */
export type JointId = number;
/** A rotation as an argument. */
export type Rotation = Angle | 0;

export interface InitOptions {
    /** Chooses the module with or without SIMD; by default, with SIMD if the machine has it. */
    simd?: boolean;
    /** A module to use instead of the inlined one. */
    wasm?: WebAssembly.Module | Response | BufferSource;
}
/** Loads the wasm module. Call it once before all other functions except `fx`, `degrees`, `radians` and `turns`. */
export function init(options?: InitOptions): Promise<void>;
/** The module that was loaded: with SIMD, without SIMD, or `InitOptions.wasm`. Undefined before `init`. */
export function loaded(): "simd" | "plain" | "given" | undefined;
/** Version of the engine's arithmetic: programs with different versions compute different states. */
export function semantics(): number;
/** Number of objects that have not been disposed of. */
export function objectCount(): number;

/** An error with a code, such as `FLOAT`, `STALE_BODY`, `GEOMETRY`, `DISPOSED`. */
export class Lockstep2dError extends Error {
    readonly code: string;
    /** The verdict on a replay that cannot be played. */
    readonly verdict?: Verdict;
}

/** A fixed-point number of 64 bits with 32 fraction bits. Immutable. */
export class Fx {
    private constructor(raw: bigint);
    static fromRaw(raw: bigint | number): Fx;
    /** The number in units of 2^-32. */
    readonly raw: bigint;
    add(other: Num): Fx;
    sub(other: Num): Fx;
    mul(other: Num): Fx;
    div(other: Num): Fx;
    neg(): Fx;
    abs(): Fx;
    min(other: Num): Fx;
    max(other: Num): Fx;
    compare(other: Num): -1 | 0 | 1;
    lt(other: Num): boolean;
    gt(other: Num): boolean;
    eq(other: Num): boolean;
    floor(): number;
    /** A float for drawing. It must not enter the simulation. */
    toNumber(): number;
    toString(): string;
    toJSON(): string;
}
/** Makes a fixed-point number: `fx("1.25")`. */
export function fx(value: Num): Fx;

/** A rotation in units of 2^-32 turn. Immutable. */
export class Angle {
    constructor(bits: number);
    readonly bits: number;
    add(other: Rotation): Angle;
    sub(other: Rotation): Angle;
    neg(): Angle;
    /** Radians for drawing. */
    toNumber(): number;
    toJSON(): number;
}
export function degrees(value: Num): Angle;
export function radians(value: Num): Angle;
export function turns(value: Num): Angle;

export function sqrt(value: Num): Fx;
export function hypot(x: Num, y: Num): Fx;
export function sin(angle: Rotation): Fx;
export function cos(angle: Rotation): Fx;
/** The direction of a vector. */
export function angleOf(vector: Vec): Angle;
export function dot(a: Vec, b: Vec): Fx;
export function cross(a: Vec, b: Vec): Fx;
export function normalize(vector: Vec): Vec2;
export function rotate(vector: Vec, angle: Rotation): Vec2;
/** Hash of bytes: 32 hexadecimal digits. */
export function hashBytes(bytes: Uint8Array): string;
/** A random number generator. Keep `state` in the state of the game. */
export class Random {
    constructor(seed: number | bigint);
    state: { state: bigint; increment: bigint };
    below(bound: number): number;
    range(low: Num, high: Num): Fx;
}

export type Mixing = "average" | "geometricMean" | "minimum" | "product" | "maximum";
export interface AreaOptions {
    /** Acceleration in m/s² of bodies in the area. */
    acceleration?: Vec;
    /** Force in N per m² of the part of a body that is inside the area. */
    force?: Vec;
    /** Velocity of the medium in m/s. */
    flow?: Vec;
    /** Rate per second at which the velocity of bodies approaches that of the medium. */
    linearDrag?: Num;
    /** Rate per second at which the angular velocity of bodies approaches that of the medium. */
    angularDrag?: Num;
    /** Density of the medium in kg/m², for buoyancy. */
    density?: Num;
    /** Acceleration in m/s² towards the centre of the area, at the distance `radius` in metres. */
    attraction?: { acceleration: Num; radius: Num; falloff?: "constant" | "inverse" | "inverseSquare" };
}
export interface ShapeOptions {
    /** Centre in the body's frame, in metres. */
    offset?: Vec;
    /** Mass per area in kg/m². */
    density?: Num;
    /** Friction coefficient. */
    friction?: Num;
    frictionMixing?: Mixing;
    /** Fraction of the approach speed that a bounce returns. */
    restitution?: Num;
    restitutionMixing?: Mixing;
    /** Approach speed in m/s below which the shape does not bounce. */
    restitutionThreshold?: Num;
    /** Rolling resistance of a round shape. */
    rollingResistance?: Num;
    /** Speed of the surface around the shape, clockwise, in m/s. */
    surfaceSpeed?: Num;
    /** Bits of the categories that the shape belongs to. `mask` has the categories that the shape collides with. */
    category?: bigint | number;
    mask?: bigint | number;
    /** Shapes with the same group other than 0 always collide if the number is positive, and never if it is
     * negative. */
    group?: number;
    /** Direction in which other shapes pass through a one-way platform. */
    oneWay?: Rotation;
    sensor?: boolean;
    area?: AreaOptions;
    contactEvents?: boolean;
    hitEvents?: boolean;
    sensorEvents?: boolean;
    detectSensors?: boolean;
    /** Radius in metres by which a polygon is rounded. */
    rounding?: Num;
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
export function circle(radius: Num, options?: ShapeOptions): ShapeDef;
export function box(halfWidth: Num, halfHeight: Num, options?: ShapeOptions): ShapeDef;
export function polygon(points: readonly Vec[], options?: ShapeOptions): ShapeDef;
export function hull(points: readonly Vec[], options?: ShapeOptions): ShapeDef;
export function capsule(a: Vec, b: Vec, radius: Num, options?: ShapeOptions): ShapeDef;
export function segment(a: Vec, b: Vec, options?: ShapeOptions): ShapeDef;
export function chain(points: readonly Vec[], options?: ShapeOptions & { closed?: boolean; oneSided?: boolean }): ChainDef;

/** Mass in kg, centre of mass and radius of gyration in metres of a dynamic body with some shapes, for the option
 * `mass`: `{ ...massOf(shapes), mass: 80 }` is a mass of 80 kg with the distribution of the shapes. */
export function massOf(shapes: readonly ShapeDef[]): { mass: Fx; centre: Vec2; gyration: Fx };

export type BodyType = "fixed" | "kinematic" | "dynamic";
export interface BodyOptions {
    /** `dynamic` by default. */
    type?: BodyType;
    /** Origin of the body in the world, in metres. */
    position?: Vec;
    angle?: Rotation;
    /** Velocity of the centre of mass in m/s. */
    velocity?: Vec;
    /** Angular velocity in rad/s, counter-clockwise. */
    angularVelocity?: Num;
    /** Mass, centre of mass and radius of gyration, instead of the values that follow from the shapes. */
    mass?: { mass: Num; centre?: Vec; gyration: Num };
    /** Decay rate of the velocity, per second. */
    linearDamping?: Num;
    /** Decay rate of the angular velocity, per second. */
    angularDamping?: Num;
    /** Factor on the world's gravity. */
    gravityScale?: Num;
    /** Speed in m/s below which the body becomes ready to sleep. */
    sleepSpeed?: Num;
    /** Bodies through which the body cannot tunnel: `fixed` by default. `bullet`: all except bullets. `kinematic`:
     * fixed and kinematic bodies. */
    continuous?: "off" | "fixed" | "bullet" | "kinematic";
    enabled?: boolean;
    asleep?: boolean;
    maySleep?: boolean;
    lockX?: boolean;
    lockY?: boolean;
    lockRotation?: boolean;
    userData?: bigint | number;
    /** Name of the body in reports: at most 16 letters, digits, `-` and `_`. */
    name?: string;
    shapes?: readonly (ShapeDef | ChainDef)[];
}

export interface Spring {
    /** Frequency in Hz. */
    hertz: Num;
    dampingRatio?: Num;
    /** Rest position of the spring, in rad or m. */
    target?: Num;
}
export interface JointOptions {
    type: "revolute" | "prismatic" | "distance" | "weld" | "wheel" | "motor" | "filter" | "gear" | "rack" | "pulley";
    a: BodyId;
    b: BodyId;
    /** Anchor in world coordinates at the current poses. Prismatic and wheel joints also need `axis`. Only a world
     * accepts `anchor` and `axis`; `Commands` refuse them. */
    anchor?: Vec;
    axis?: Vec;
    /** Anchors and angles in the frames of the bodies. */
    anchorA?: Vec;
    anchorB?: Vec;
    angleA?: Rotation;
    angleB?: Rotation;
    /** Lower and upper end of the range, in rad or m. */
    limit?: readonly [Num, Num];
    /** Target speed in rad/s or m/s, and largest torque in N m or force in N. */
    motor?: { speed: Num; max: Num };
    spring?: Spring;
    /** Smallest and largest force of the spring in N. */
    springForce?: readonly [Num, Num];
    /** Length of a rod in metres. */
    rod?: Num;
    /** Frequency in Hz and damping ratio of the rigid constraints of the joint. */
    softness?: { hertz: Num; dampingRatio: Num };
    /** Whether the two bodies collide with each other. */
    collide?: boolean;
    enabled?: boolean;
    /** Force in N and torque in N m beyond which the joint is reported or, with `breaks`, removed. */
    threshold?: { force?: Num; torque?: Num; breaks?: boolean };
    /** Target velocity in m/s and largest force in N of a motor joint. */
    linearMotor?: { velocity: Vec; max: Num };
    /** Spring between the anchors: frequency in Hz, damping ratio, largest force in N. */
    linearSpring?: { hertz: Num; dampingRatio: Num; max?: Num };
    /** Spring on the angle: frequency in Hz, damping ratio, largest torque in N m. */
    angularSpring?: { hertz: Num; dampingRatio: Num; max?: Num };
    /** Teeth of A's wheel and of B's wheel of a gear. */
    teeth?: readonly [number, number];
    /** Radius of the wheel of a rack in metres. */
    radius?: Num;
    /** Wheels of a pulley on A's side and on B's side, in world coordinates. */
    wheels?: readonly [Vec, Vec];
    /** Length of the rope of a pulley in metres. */
    length?: Num;
    /** Ratio of a pulley: the length on A's side plus `ratio` times the length on B's side is at most `length`. */
    ratio?: Num;
    userData?: bigint | number;
}

export interface ConfigOptions {
    /** Ticks per second, 10 to 1000. */
    tickRate?: number;
    /** Gravity in m/s². */
    gravity?: Vec;
    /** Sub-steps of a tick. */
    subSteps?: number;
    /** Iterations of a sub-step. */
    iterations?: number;
    /** 0 soft, 1 Baumgarte. */
    contact?: number;
    /** Stiffness of soft contacts in Hz, or share of the overlap that Baumgarte contacts correct in each sub-step. */
    contactStiffness?: Num;
    /** Damping ratio of soft contacts, or overlap in metres that Baumgarte contacts leave uncorrected. */
    contactDamping?: Num;
    /** Largest speed in m/s with which contacts push shapes apart. */
    contactPushSpeed?: Num;
    /** Stiffness of joints in Hz. */
    jointHertz?: Num;
    jointDampingRatio?: Num;
    /** Approach speed in m/s below which shapes do not bounce. */
    restitutionThreshold?: Num;
    /** Largest speed of a body in m/s. */
    speedMax?: Num;
    /** Largest distance in metres at which shapes have speculative contact points. */
    speculativeDistance?: Num;
    /** Largest margin in metres of the bounding boxes in the broad phase. */
    fatMargin?: Num;
    /** Lowest approach speed of a hit event in m/s. */
    hitSpeed?: Num;
    bodyLimit?: number;
    shapeLimit?: number;
    jointLimit?: number;
    /** Largest number of pairs of near shapes. */
    pairLimit?: number;
    sleeping?: boolean;
    continuous?: boolean;
}

/** An object that the library stores. `dispose` frees it at once; otherwise the garbage collector frees it later. */
declare class Handle {
    protected constructor();
    dispose(): void;
}

/** Pose of a body that `spawnEach` adds. */
export interface BodyPose {
    position: Vec;
    /** No rotation by default. */
    angle?: Rotation;
}

/** Edits, which a world executes at once and a list of commands collects. */
declare class Edits extends Handle {
    despawn(body: BodyId): void;
    removeShape(shape: ShapeId): void;
    setShape(shape: ShapeId, definition: ShapeDef): void;
    removeJoint(joint: JointId): void;
    setJoint(joint: JointId, options: JointOptions): void;
    enableJoint(joint: JointId): void;
    disableJoint(joint: JointId): void;
    /** A force in N during the next tick, at a point of the world. */
    applyForce(body: BodyId, force: Vec, point: Vec): void;
    /** A torque in N m during the next tick. */
    applyTorque(body: BodyId, torque: Num): void;
    /** An impulse in N s at a point of the world. */
    applyImpulse(body: BodyId, impulse: Vec, point: Vec): void;
    /** An angular impulse in N m s. */
    applyAngularImpulse(body: BodyId, impulse: Num): void;
    /** Sets the velocity of the centre of mass in m/s, and the angular velocity in rad/s. */
    setVelocity(body: BodyId, velocity: Vec, angular?: Num): void;
    setTransform(body: BodyId, position: Vec, angle?: Rotation): void;
    /** Gives a kinematic body the velocity with which it reaches this pose in the next tick. */
    moveTo(body: BodyId, position: Vec, angle?: Rotation): void;
    setBody(body: BodyId, options: Omit<BodyOptions, "shapes">): void;
    setType(body: BodyId, type: BodyType): void;
    setUserData(body: BodyId, data: bigint | number): void;
    setName(body: BodyId, name: string): void;
    enable(body: BodyId): void;
    disable(body: BodyId): void;
    wake(body: BodyId): void;
    sleep(body: BodyId): void;
    setGravity(gravity: Vec): void;
    /** Applies impulses away from `centre`, in N s per metre of the width of a shape as seen from there. The impulse
     * is full within `radius` metres, and falls to 0 over the next `falloff` metres. */
    explode(options: { centre: Vec; impulse: Num; radius?: Num; falloff?: Num; mask?: bigint | number }): void;
}

/** A list of edits, for replays and networks. */
export class Commands extends Edits {
    constructor();
    spawn(options: BodyOptions): undefined;
    spawnEach(options: Omit<BodyOptions, "position" | "angle">, poses: BodyPose[]): undefined;
    addShape(body: BodyId, shape: ShapeDef): undefined;
    addJoint(options: JointOptions): undefined;
    addJointEach(options: Omit<JointOptions, "a" | "b" | "anchor" | "axis">, pairs: [BodyId, BodyId][]): undefined;
    readonly length: number;
    clear(): void;
    toBytes(): Uint8Array;
    /** Replaces the list by a list that is decoded from bytes. */
    fromBytes(bytes: Uint8Array): this;
}

/** A saved state in memory. */
export class Snapshot extends Handle {
    hash(): string;
}

export interface BodyInfo {
    type: BodyType;
    /** Origin in the world, in metres. */
    position: Vec2;
    angle: Angle;
    /** Velocity of the centre of mass in m/s. */
    velocity: Vec2;
    /** Angular velocity in rad/s. */
    angularVelocity: Fx;
    /** Centre of mass in the world, in metres. */
    centre: Vec2;
    /** Mass in kg. */
    mass: Fx;
    /** Moment of inertia about the centre of mass in kg m². */
    inertia: Fx;
    /** Number of shapes. */
    shapes: number;
    userData: bigint;
    enabled: boolean;
    asleep: boolean;
}
export interface Filter {
    /** Categories that the query belongs to. */
    category?: bigint | number;
    /** Categories that the query sees. */
    mask?: bigint | number;
    sensors?: boolean;
    /** At most 8 bodies. */
    except?: readonly BodyId[];
    /** Treatment of shapes that a ray or a cast starts in. */
    initialOverlap?: "resist" | "report" | "ignore";
}
export interface RayHit {
    shape: ShapeId;
    body: BodyId;
    /** Fraction of the translation, 0 to 1. */
    fraction: Fx;
    /** Point in the world, in metres. */
    point: Vec2;
    /** Outward normal of the surface; zero for a ray that starts inside. */
    normal: Vec2;
    startsInside: boolean;
}
export interface CastHit extends RayHit {
    /** Displacement up to the hit, in metres. */
    travelled: Vec2;
}
export interface ContactEvent {
    shapeA: ShapeId;
    shapeB: ShapeId;
}
export interface SensorEvent {
    sensor: ShapeId;
    visitor: ShapeId;
    /** Time within the tick at which the overlap began or ceased, 0 to 1. */
    fraction: Fx;
}
export interface Events {
    moved: { body: BodyId; position: Vec2; angle: Angle; fellAsleep: boolean }[];
    contactBegin: ContactEvent[];
    contactEnd: ContactEvent[];
    /** `impulse` is along the normal and summed over the tick, in N s; `approachSpeed` is in m/s. */
    hits: (ContactEvent & { point: Vec2; normal: Vec2; approachSpeed: Fx; impulse: Fx })[];
    sensorBegin: SensorEvent[];
    sensorEnd: SensorEvent[];
    joints: { joint: JointId; force: Vec2; torque: Fx; broke: boolean }[];
}

/** A physics world. */
export class World extends Edits {
    /** `smallest` is the size in metres of the smallest boxes whose stacks have to be stable. Small sizes add
     * sub-steps. */
    constructor(options?: ConfigOptions & { smallest?: Num });
    /** Makes a world from bytes, which may come from any source. */
    static fromBytes(bytes: Uint8Array): World;
    toBytes(): Uint8Array;
    clone(): World;
    spawn(options: BodyOptions): BodyId;
    /** Adds a body with the same definition at each pose, or no body if one of them is refused. A recording stores the
     * definition once. */
    spawnEach(options: Omit<BodyOptions, "position" | "angle">, poses: BodyPose[]): BodyId[];
    addShape(body: BodyId, shape: ShapeDef): ShapeId;
    addJoint(options: JointOptions): JointId;
    /** Adds a joint with the same definition between each pair of bodies, or no joint if one of them is refused. */
    addJointEach(options: Omit<JointOptions, "a" | "b" | "anchor" | "axis">, pairs: [BodyId, BodyId][]): JointId[];
    step(ticks?: number): void;
    /** Executes a list of commands, and returns how many were refused. */
    execute(commands: Commands): number;
    /** Hash of the state: 32 hexadecimal digits, the same on every machine. */
    hash(): string;
    /** Hash of a section: 0 settings, 1 bodies, 2 shapes, 3 joints, 4 contacts, 5 islands, 6 random numbers. */
    digest(section: number): string;
    readonly tick: number;
    /** Number of results of the solver that were clamped since the world was made. A body at the speed limit does
     * not count. */
    readonly faults: number;
    counts(): { bodies: number; shapes: number; joints: number; awake: number; pairs: number };
    config(): Record<string, unknown>;
    setConfig(options: ConfigOptions): void;
    /** A random number from 0 to below `bound`, from the generator of the world, which is part of its state. */
    random(bound: number): number;
    randomRange(low: Num, high: Num): Fx;
    save(): Snapshot;
    saveInto(snapshot: Snapshot): void;
    restore(snapshot: Snapshot): void;
    body(body: BodyId): BodyInfo | undefined;
    bodies(): BodyId[];
    joints(): JointId[];
    shapesOf(body: BodyId): ShapeId[];
    jointsOf(body: BodyId): JointId[];
    /** Shapes that a sensor overlaps, in slot order. */
    sensorOverlaps(shape: ShapeId): ShapeId[];
    shape(shape: ShapeId): { type: "circle" | "segment" | "polygon" | "capsule" | "link"; body: BodyId; points: Vec2[]; radius: Fx; offset: Vec2 };
    /** The anchors of a joint in the world, in metres. */
    jointAnchors(joint: JointId): [Vec2, Vec2];
    /** Angle of a joint in rad, including whole turns. */
    jointAngle(joint: JointId): Fx | undefined;
    /** Force in N and torque in N m of a joint on body B in the last tick. */
    jointForce(joint: JointId): { force: Vec2; torque: Fx } | undefined;
    /** For drawing: five floats for each enabled body: its handle, x, y, angle in radians, and 1 if it is awake. */
    poses(target?: Float64Array): Float64Array;
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
    /** The shape nearest to a point, within a distance in metres. The distance is negative inside a shape. */
    closest(point: Vec, within: Num, filter?: Filter): { shape: ShapeId; body: BodyId; distance: Fx; point: Vec2; normal: Vec2 } | undefined;
}

/** Geometry and abilities of a character, which stays upright. The y axis points up. */
export interface MoverOptions {
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
    shape: ShapeId;
    body: BodyId;
    /** Position in metres of the body's origin in the world when the surface was met. */
    bodyPosition: Vec2;
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
    ground?: MoverPlane;
}
export interface Moved {
    state: {
        position: Vec2;
        velocity: Vec2;
        ground: MoverPlane | undefined;
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

export interface Limits {
    fileBytes?: number;
    setupBytes?: number;
    players?: number;
    blockBytes?: number;
    /** Ticks between checkpoints. */
    blockTicks?: number;
    /** Ticks of the game. */
    ticks?: number;
    /** Bodies of the world. */
    bodies?: number;
    /** Work units of a tick. */
    tickWork?: number;
    /** Work units of the game. */
    totalWork?: number;
}
export interface Verdict {
    /** Only `match` means that the file is valid. */
    verdict: "match" | "claim_mismatch" | "diverged" | "incomplete" | "malformed" | "limit_exceeded" | "unverifiable";
    ticks: number;
    hash: string;
    text: string;
}
/** Goes to any tick of a replay of a world: tick t is the state after t ticks. */
export class Timeline extends Handle {
    /** Throws a Lockstep2dError with the code RECORD, and the `verdict`, if the file cannot be played. */
    constructor(bytes: Uint8Array, limits?: Limits);
    readonly ticks: number;
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
    constructor(options: { config?: ConfigOptions; setup: Commands; interval?: number });
    step(commands: Commands): void;
    /** A copy of the world. */
    world(): World;
    take(): Uint8Array;
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
    constructor(options: {
        rules: string;
        rulesVersion?: number;
        players: number;
        tickRate?: number;
        inputBytes: number;
        setup?: Uint8Array;
        /** Hash of the state before the first tick. */
        start: string;
        interval?: number;
    });
    /** Records the inputs of all players, and a bit for each absent player, whose input has to be zeros.
     * `Match.finalInputs` returns both in this form. Returns whether `checkpoint` has to follow. */
    record(inputs: Uint8Array, absent?: bigint): boolean;
    /** Adds a result such as a score, with a name of 1 to 64 bytes. Call it before `finish`. A replay has at most 256
     * results with different names. They can be read without playing the replay. */
    claim(name: string, number: number | bigint): void;
    checkpoint(hash: string): void;
    take(): Uint8Array;
    finish(hash: string): Uint8Array;
}
/** A replay of a game with rules of its own. The game plays it. */
export class Replay extends Handle {
    constructor(bytes: Uint8Array, limits?: Limits);
    readonly rules: string;
    readonly rulesVersion: number;
    readonly players: number;
    readonly tickRate: number;
    readonly inputBytes: number;
    readonly ticks: number;
    readonly setup: Uint8Array;
    /** The results that the file states, which are true if the verdict is `match`. */
    readonly claims: Map<string, bigint>;
    next(): TickInputs | undefined;
    /** Compares the hash of the game's state with the file. Call it before the first tick and after every tick, or,
     * while seeking, for each request `checksum`. */
    check(hash: string): void;
    /** Adds a result of the game that was played. The verdict compares all added results with `claims`. */
    claim(name: string, number: number | bigint): void;
    verdict(hash: string): Verdict;
    /** Starts seeking to a tick: `nextRequest` returns the requests, which `ReplayDriver` fulfils. At the first call
     * the game has to be in the state before the first tick. */
    seek(tick: number): void;
    /** The next request on the way to the tick of `seek`: `save`, `load`, `advance`, or `checksum`, which `check`
     * answers. Throws an error with the code RECORD if the game has diverged from the file. */
    nextRequest(): MatchRequest | undefined;
    /** Sets the interval in ticks at which seeking requests to save the state: 60 by default, or more for replays that
     * would otherwise need more than 256 saved states. */
    setInterval(ticks: number): void;
}
/** A game that a `ReplayDriver` plays. `save` and `hash` have to cover its whole state. */
export interface ReplayGame<Saved = unknown> {
    step(inputs: Uint8Array, absent: bigint): void;
    save(): Saved;
    load(saved: Saved): void;
    drop?(saved: Saved): void;
    hash(): string;
}
/** Goes to any tick of a replay with a game, which begins in the state before the first tick. */
export class ReplayDriver<Saved = unknown> {
    constructor(replay: Replay, game: ReplayGame<Saved>);
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
}

export interface MatchOptions {
    /** Number of seats of the match, 1 to 64. */
    seats: number;
    /** Number of seats that this peer plays: 1 by default; 0 for a spectator or a dedicated server. */
    ownSeats?: number;
    /** Number of seats that have to be taken before the first tick: 2 by default, or `seats` if that is less. */
    startWith?: number;
    /** Bytes of an input, 1 to 512: 1 by default. */
    inputBytes?: number;
    /** Ticks a second: 60 by default. */
    tickRate?: number;
    /** Ticks that may be played with guessed inputs; 0, the default, is lockstep. Each peer chooses its own. */
    guess?: number;
    /** Smallest delay of your own inputs in ticks. The delay follows the latency, between `delayMin` and `delayMax`. */
    delayMin?: number;
    /** Largest delay of your own inputs in ticks. */
    delayMax?: number;
    /** Interval in ticks at which states are saved. */
    saveInterval?: number;
    /** Interval in ticks at which states are compared: a multiple of `saveInterval`. */
    checkInterval?: number;
    /** Ticks that may be played beyond the last final tick, at least 16. */
    history?: number;
    /** Number of final ticks whose inputs are kept for peers that return. After a longer absence a peer downloads a
     * state. */
    logTicks?: number;
    /** Ticks from the cut, where a change of the players takes effect, to the first tick that a joining peer plays. */
    seatLead?: number;
    /** A peer that lags by at most this many ticks may have a seat. */
    seatWithin?: number;
    /** Distinguishes matches: packets with another tag are ignored. */
    matchTag?: bigint | number;
    /** Milliseconds for which the match waits for a missing peer before the other peers go on without it. */
    patience?: number;
    /** Number of this peer: random by default. A page has to use a new number each time it is loaded. */
    peer?: number;
    /** Identity of the player: random by default. A peer that joins again with the same key gets its seat back. */
    key?: bigint;
    /** Secret numbers: random by default. They protect against packets with forged addresses. */
    secret?: readonly [bigint, bigint];
    /** Versions, rules and setup, as bytes. A peer with a different offer is refused. */
    offer?: Uint8Array;
    /** Address of a participant of the match to join. Without it, a new match is opened. */
    contact?: Uint8Array;
}
/**
 * Status of a peer:
 *
 * - `connecting`: requests to join, or downloads the initial state.
 * - `joining`: follows the match and requests a seat.
 * - `watching`: follows the match and requests no seat.
 * - `waiting`: has a seat in a match that has not begun.
 * - `paused`: receives no packets from a majority, and only a majority can continue the match.
 * - `dropped`: the other peers went on without this peer, which requests its seat again.
 * - `kicked`: removed permanently.
 * - `leaving`: announces its departure.
 * - `left`, `finished`: still answers peers that lack packets.
 * - `closed`: sends nothing more.
 */
export type MatchStatus =
    | "joining" | "watching" | "waiting" | "playing" | "paused" | "dropped" | "kicked" | "leaving" | "left" | "finished" | "closed"
    | "connecting";
/**
 * An event of a match. Fields that are not named for a kind are 0 or `""`.
 *
 * - `status`: the status of the match has changed to `status`.
 * - `view`: the seats of the peers have changed.
 * - `seated`, `unseated`: from `tick` on, `peer` has or no longer has `seat`.
 * - `waiting`: play stalls because inputs of `peer` are missing; `value` is 1 if its packets arrive, so that its game
 *   is slow.
 * - `resumed`: play continues.
 * - `pause`: `peer` requests a pause (`value` is 1) or withdraws its request (0).
 * - `end`: the match ends after `tick` ticks.
 * - `desync`: after `tick` ticks, `peer` has the hash `theirs` instead of `ours`.
 * - `conflict`: `peer` has issued two different inputs for `tick`. Its inputs are no longer accepted.
 * - `tooFarBehind`: the other peers no longer keep the inputs that this peer lacks; it has to join again.
 * - `refused`: the contact refuses the request to join, because of `reason`.
 * - `state`: the encoded `state` after `tick` ticks. The game has to load it before further requests are fulfilled.
 * - `badState`: a downloaded state is not valid; it is requested again.
 */
export interface MatchEvent {
    kind:
        | "status" | "view" | "seated" | "unseated" | "waiting" | "resumed" | "pause" | "end" | "desync" | "conflict" | "tooFarBehind"
        | "refused" | "state" | "badState";
    peer: number;
    seat: number;
    tick: number;
    value: number;
    ours: string;
    theirs: string;
    status?: MatchStatus;
    /** `offer`: the versions, rules or setup differ; `full`: too many peers are joining through this contact; `taken`:
     * another peer has this number; `notReady`: the contact is not in a match yet, and the request is repeated. */
    reason?: "offer" | "full" | "taken" | "notReady";
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
    kind: "save" | "load" | "advance" | "checksum" | "forget";
    tick: number;
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
    constructor(options: MatchOptions);
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
    readonly status: MatchStatus;
    /** Numbers of ticks: `played`, also with guessed inputs; `final`, whose inputs are final; `confirmed`, played with
     * final inputs. */
    ticks(): { played: number; final: number; confirmed: number };
    /** The final inputs of all seats for a tick, or undefined if they are not kept. */
    finalInputs(tick: number): TickInputs | undefined;
    /** Seats that this peer plays. */
    readonly seats: number[];
    /** Leaves the match. Call `update` until the status is `closed`, so that the other peers are informed. */
    leave(): void;
    /** Requests an end of the match after a number of ticks. The end is decided two seconds before; until then, other
     * peers can join. */
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
    encode(): Uint8Array;
    decode(bytes: Uint8Array): void;
}
/** Plays a game in a match: saves, restores and advances it as the match requests. */
export class MatchDriver<Saved = unknown> {
    constructor(match: Match, game: MatchGame<Saved>, send: (to: Uint8Array, packet: Uint8Array) => void);
    readonly match: Match;
    readonly tick: number;
    receive(now: number, from: Uint8Array, packet: Uint8Array): void;
    /** Advances the match to the time `now`, and plays the ticks that are due. Call it every few milliseconds.
     * `readInputs` returns the inputs of your own seats, one after another. */
    update(now: number, readInputs: (seats: number[]) => Uint8Array): MatchEvent[];
}

/** The offer of a native `Peer<G>` (Rust), so that pages and native programs play together. `setup` has the canonical
 * bytes of `G::Setup`, and is empty for `()`. */
export function nativeOffer(options: {
    rules: string;
    rulesVersion?: number;
    setup?: Uint8Array;
    tickRate?: number;
    seats: number;
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
    private constructor();
    /** Enters a room, and creates it if it does not exist. `url` is `wss://HOST` or `ws://HOST:PORT`, `code` 1 to 32
     * letters, digits and `-`. With the same `secret`, 16 random bytes, a member gets the same address again.
     * `WebSocket` is needed where there is no global one, as in Node before 22. */
    static connect(url: string, code: string, options?: { secret?: Uint8Array; WebSocket?: unknown }): Promise<Relay>;
    readonly own: Uint8Array;
    /** Addresses of the other members of the room, in the order in which they entered. */
    readonly others: Uint8Array[];
    readonly isOpen: boolean;
    onPacket: (from: Uint8Array, packet: Uint8Array) => void;
    /** Called when a member enters or leaves the room, and after a reconnection. */
    onMembers: (others: Uint8Array[]) => void;
    send(to: Uint8Array, packet: Uint8Array): void;
    close(): void;
}
