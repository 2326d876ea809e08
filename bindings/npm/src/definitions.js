// Definitions of shapes, bodies, joints and worlds as objects, and their structs.
import { Lockstep2dError } from "./error.js";
import { vectorOf } from "./fx.js";
import { C } from "./layout.js";
import { call, copy as copyOf, fieldAt, fxAt, list, putBytes, putRaw, scratch, sizeOf, statusOf, struct, u32, write } from "./library.js";

const BODY_KINDS = { fixed: C.FIXED, kinematic: C.KINEMATIC, dynamic: C.DYNAMIC };
const SWEEPS = { off: C.SWEEP_OFF, fixed: C.SWEEP_FIXED, bullet: C.SWEEP_BULLET, kinematic: C.SWEEP_KINEMATIC };
const MIXING = {
    average: C.MIX_AVERAGE,
    geometricMean: C.MIX_GEOMETRIC_MEAN,
    minimum: C.MIX_MINIMUM,
    product: C.MIX_PRODUCT,
    maximum: C.MIX_MAXIMUM,
};
const FALLOFFS = { constant: C.FALLOFF_CONSTANT, inverse: C.FALLOFF_INVERSE, inverseSquare: C.FALLOFF_INVERSE_SQUARE };
const JOINT_KINDS = {
    revolute: C.REVOLUTE,
    prismatic: C.PRISMATIC,
    distance: C.DISTANCE,
    weld: C.WELD,
    wheel: C.WHEEL,
    motor: C.MOTOR,
    filter: C.FILTER,
    gear: C.GEAR,
    rack: C.RACK,
    pulley: C.PULLEY,
};

function lookup(table, name, what) {
    if (!Object.hasOwn(table, name)) {
        throw new Lockstep2dError("VALUE", `${what} is one of ${Object.keys(table).join(", ")}, and not ${name}`);
    }
    return table[name];
}

const optionalLookup = (table, name, what) => (name === undefined ? undefined : lookup(table, name, what));

/** Throws an error for a misspelt option, which would otherwise be ignored. */
function onlyKnown(options, known, what) {
    const unknown = Object.keys(options).find((key) => !known.includes(key));
    if (unknown !== undefined) {
        throw new Lockstep2dError("VALUE", `${what} has no option ${unknown}; there are ${known.join(", ")}`);
    }
}

function flags(at, name, bits, cleared = 0) {
    const field = fieldAt(name, at, "flags");
    write(name, at, { flags: ((u32(field) & ~cleared) | bits) >>> 0 });
}

const shape = (kind, geometry, options = {}) => ({ kind, geometry, options });

/** A disc with a radius in metres. */
export const circle = (radius, options) => shape(C.CIRCLE, { radius }, options);
/** A rectangle with half its width and height in metres. */
export const box = (halfWidth, halfHeight, options) => shape(C.RECTANGLE, { points: [[halfWidth, halfHeight]] }, options);
/** A convex polygon of 3 to 8 points, counter-clockwise. */
export const polygon = (points, options) => shape(C.POLYGON, { points, count: points.length }, options);
/** The convex hull of 3 to 8 points in any order. */
export const hull = (points, options) => shape(C.HULL, { points, count: points.length }, options);
/** A capsule: all points within a radius of a line. */
export const capsule = (a, b, radius, options) => shape(C.CAPSULE, { points: [a, b], radius }, options);
/** A line without area. */
export const segment = (a, b, options) => shape(C.SEGMENT, { points: [a, b] }, options);
/** A smooth outline of any length, for ground and walls. */
export const chain = (points, { closed = false, oneSided = false, ...options } = {}) => ({ points, closed, oneSided, options });

const SHAPE_OPTIONS = [
    "offset", "density", "friction", "restitution", "restitutionThreshold", "rollingResistance", "surfaceSpeed", "category",
    "mask", "group", "frictionMixing", "restitutionMixing", "oneWay", "sensor", "area", "contactEvents", "hitEvents",
    "sensorEvents", "detectSensors", "rounding", "userData",
];
const AREA_OPTIONS = ["acceleration", "force", "flow", "linearDrag", "angularDrag", "density", "attraction"];

function writeArea(at, area) {
    onlyKnown(area, AREA_OPTIONS, "an area");
    const { acceleration, force, flow, linearDrag, angularDrag, density, attraction } = area;
    write("shape_def", at, {
        areaAcceleration: acceleration,
        areaForce: force,
        areaFlow: flow,
        areaLinearDrag: linearDrag,
        areaAngularDrag: angularDrag,
        areaDensity: density,
    });
    if (attraction !== undefined) {
        write("shape_def", at, {
            attractionAcceleration: attraction.acceleration,
            attractionRadius: attraction.radius,
            attractionFalloff: lookup(FALLOFFS, attraction.falloff ?? "constant", "a falloff"),
        });
    }
}

/** Writes one shape. */
export function writeShape(at, { kind, geometry, options }) {
    if (kind === undefined) {
        throw new Lockstep2dError("VALUE", "a shape is made by circle, box, polygon, hull, capsule, segment or chain");
    }
    onlyKnown(options, SHAPE_OPTIONS, "a shape");
    call("ls2d_shape_def_init", kind, at);
    const { rounding, frictionMixing, restitutionMixing, area, ...plain } = options;
    write("shape_def", at, {
        ...plain,
        radius: rounding,
        ...geometry,
        frictionMixing: optionalLookup(MIXING, frictionMixing, "a rule of mixing"),
        restitutionMixing: optionalLookup(MIXING, restitutionMixing, "a rule of mixing"),
    });
    let [set, cleared] = [0, 0];
    const flag = (value, bit) => {
        set |= value ? bit : 0;
        cleared |= value === false ? bit : 0;
    };
    flag(options.sensor, C.SHAPE_SENSOR);
    flag(options.oneWay !== undefined, C.SHAPE_ONE_WAY);
    flag(options.restitutionThreshold !== undefined, C.SHAPE_RESTITUTION_THRESHOLD);
    flag(options.contactEvents, C.SHAPE_CONTACT_EVENTS);
    flag(options.hitEvents, C.SHAPE_HIT_EVENTS);
    flag(options.sensorEvents, C.SHAPE_SENSOR_EVENTS);
    flag(options.detectSensors, C.SHAPE_DETECT_SENSORS);
    if (area !== undefined) {
        writeArea(at, area);
        set |= C.SHAPE_AREA | C.SHAPE_SENSOR | (area.attraction === undefined ? 0 : C.SHAPE_ATTRACTION);
    }
    flags(at, "shape_def", set, cleared & ~set);
}

/** Replaces the chains among the shapes of a body by their links, as bytes. */
export function expand(shapes) {
    return shapes.flatMap((each) => (each.closed === undefined ? [each] : chainLinks(each)));
}

function chainLinks({ points, closed, oneSided, options }) {
    const size = sizeOf("shape_def");
    const before = size + 16 * points.length;
    const prepare = (at) => {
        writeShape(at, circle(1, options));
        points.forEach((point, index) => {
            const [x, y] = vectorOf(point);
            pair(at + size + 16 * index, x, y);
        });
    };
    const ask = (links, capacity, count, at) =>
        statusOf("ls2d_chain_links", at, at + size, points.length, closed ? 1 : 0, oneSided ? 1 : 0, links, capacity, count);
    const { at, count } = list(size, before, ask, prepare);
    return Array.from({ length: count }, (_, index) => ({ bytes: copyOf(at + index * size, size) }));
}

const pair = (at, x, y) => {
    putRaw(at, x);
    putRaw(at + 8, y);
};

const BODY_OPTIONS = [
    "type", "position", "angle", "velocity", "angularVelocity", "mass", "linearDamping", "angularDamping", "gravityScale",
    "sleepSpeed", "userData", "name", "continuous", "enabled", "asleep", "maySleep", "lockX", "lockY", "lockRotation", "shapes",
];

/** Writes a body definition. */
export function writeBody(at, options) {
    onlyKnown(options, BODY_OPTIONS, "a body");
    call("ls2d_body_def_init", lookup(BODY_KINDS, options.type ?? "dynamic", "the type of a body"), at);
    const { type: _, shapes: __, mass, continuous, ...plain } = options;
    write("body_def", at, {
        ...plain,
        continuous: optionalLookup(SWEEPS, continuous, "`continuous`"),
        mass: mass?.mass,
        massCentre: mass?.centre,
        massGyration: mass?.gyration,
    });
    let [set, cleared] = [mass === undefined ? 0 : C.BODY_GIVEN_MASS, 0];
    const bits = { enabled: C.BODY_ENABLED, asleep: C.BODY_ASLEEP, maySleep: C.BODY_MAY_SLEEP, lockX: C.BODY_LOCK_X,
        lockY: C.BODY_LOCK_Y, lockRotation: C.BODY_LOCK_ROTATION };
    for (const [name, bit] of Object.entries(bits)) {
        set |= options[name] ? bit : 0;
        cleared |= options[name] === false ? bit : 0;
    }
    flags(at, "body_def", set, cleared);
}

/** Writes a body and its shapes into memory. Returns their addresses, the number of shapes, and the address `rest` of
 * `room` bytes after them. */
export function writeBodyAndShapes(options, room = 0) {
    const shapes = expand(options.shapes ?? []);
    const [body, each] = [sizeOf("body_def"), sizeOf("shape_def")];
    const at = scratch(8 + body + each * shapes.length + room);
    writeBody(at + 8, options);
    shapes.forEach((one, index) => {
        const place = at + 8 + body + each * index;
        if (one.bytes === undefined) {
            writeShape(place, one);
        } else {
            putBytes(place, one.bytes);
        }
    });
    const after = at + 8 + body;
    return { id: at, body: at + 8, shapes: after, count: shapes.length, rest: after + each * shapes.length };
}

/** Mass, centre of mass and radius of gyration of a dynamic body with some shapes, for the option `mass`. */
export function massOf(shapes) {
    const { rest, shapes: at, count } = writeBodyAndShapes({ shapes }, 32);
    call("ls2d_shapes_mass", at, count, rest, rest + 8, rest + 24);
    return { mass: fxAt(rest), centre: { x: fxAt(rest + 8), y: fxAt(rest + 16) }, gyration: fxAt(rest + 24) };
}

export const bodyKind = (name) => lookup(BODY_KINDS, name, "the type of a body");

const JOINT_OPTIONS = [
    "type", "a", "b", "anchor", "axis", "anchorA", "anchorB", "angleA", "angleB", "limit", "motor", "spring", "springForce",
    "rod", "softness", "collide", "enabled", "threshold", "linearMotor", "linearSpring", "angularSpring", "teeth", "radius",
    "wheels", "length", "ratio", "userData",
];

/** Writes a joint definition. */
export function writeJoint(at, options) {
    onlyKnown(options, JOINT_OPTIONS, "a joint");
    call("ls2d_joint_def_init", lookup(JOINT_KINDS, options.type, "the type of a joint"), at);
    const { a, b, anchorA, anchorB, angleA, angleB, limit, motor, spring, springForce, rod, softness } = options;
    const { threshold, linearMotor, linearSpring, angularSpring, teeth, radius, wheels, length, ratio, userData } = options;
    write("joint_def", at, {
        bodyA: a, bodyB: b, anchorA, anchorB, angleA, angleB, radius, ratio, userData,
        limitLower: limit?.[0], limitUpper: limit?.[1],
        motorSpeed: motor?.speed, motorMax: motor?.max,
        springHertz: spring?.hertz, springDampingRatio: spring?.dampingRatio, springTarget: spring?.target,
        springForceLower: springForce?.[0], springForceUpper: springForce?.[1],
        length: rod ?? length,
        hertz: softness?.hertz, dampingRatio: softness?.dampingRatio,
        thresholdForce: threshold?.force, thresholdTorque: threshold?.torque,
        linearVelocity: linearMotor?.velocity, linearMotorMax: linearMotor?.max,
        linearHertz: linearSpring?.hertz, linearDampingRatio: linearSpring?.dampingRatio, linearMax: linearSpring?.max,
        angularHertz: angularSpring?.hertz, angularDampingRatio: angularSpring?.dampingRatio, angularMax: angularSpring?.max,
        teethA: teeth?.[0], teethB: teeth?.[1],
        wheelA: wheels?.[0], wheelB: wheels?.[1],
    });
    const parts = [
        [options.collide, C.JOINT_COLLIDE], [limit, C.JOINT_LIMIT], [motor, C.JOINT_MOTOR], [spring, C.JOINT_SPRING],
        [springForce, C.JOINT_SPRING_FORCE], [rod, C.JOINT_ROD], [softness, C.JOINT_SOFTNESS],
        [threshold?.force, C.JOINT_THRESHOLD_FORCE], [threshold?.torque, C.JOINT_THRESHOLD_TORQUE],
        [threshold?.breaks, C.JOINT_BREAKS], [linearMotor, C.JOINT_LINEAR_MOTOR], [linearSpring, C.JOINT_LINEAR_SPRING],
        [angularSpring, C.JOINT_ANGULAR_SPRING],
    ];
    const set = parts.reduce((bits, [part, bit]) => bits | (part === undefined || part === false ? 0 : bit), 0);
    flags(at, "joint_def", set, options.enabled === false ? C.JOINT_ENABLED : 0);
}

/** Writes the given settings of a world, and keeps all others. */
export function writeConfig(at, options) {
    const known = Object.keys(struct("config").fields).map((name) => name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase()));
    const { sleeping, continuous, ...plain } = options;
    onlyKnown(plain, known.filter((name) => !["size", "flags"].includes(name)), "a world");
    write("config", at, plain);
    const set = (sleeping ? C.SLEEPING : 0) | (continuous ? C.CONTINUOUS : 0);
    const cleared = (sleeping === false ? C.SLEEPING : 0) | (continuous === false ? C.CONTINUOUS : 0);
    flags(at, "config", set, cleared);
}

const OVERLAPS = { resist: C.OVERLAP_RESIST, report: C.OVERLAP_REPORT, ignore: C.OVERLAP_IGNORE };

/** Writes a filter of a query. */
export function writeFilter(at, filter) {
    onlyKnown(filter, ["category", "mask", "sensors", "except", "initialOverlap"], "a filter");
    const { category, mask, sensors, except = [], initialOverlap } = filter;
    call("ls2d_query_filter_init", at);
    write("query_filter", at, {
        category, mask, except, exceptCount: except.length, flags: sensors ? C.QUERY_SENSORS : 0,
        initialOverlap: optionalLookup(OVERLAPS, initialOverlap, "`initialOverlap`"),
    });
}
