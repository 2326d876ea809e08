// Definitions of shapes, bodies, joints and worlds, and their structs.
import { array, fail, flag, given, object, onlyKnown, shown } from "./check.js";
import { Fx, rawOf, vectorOf } from "./fx.js";
import { C } from "./layout.js";
import {
    call, copy as copyOf, fieldAt, fxAt, list, optionsOf, putBytes, putRaw, scratch, sizeOf, statusOf, u32, write, writer,
} from "./library.js";

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
// Types of joints, with the options that only some types have.
const JOINTS = {
    revolute: [C.REVOLUTE, "limit", "motor", "spring"],
    prismatic: [C.PRISMATIC, "limit", "motor", "spring"],
    distance: [C.DISTANCE, "limit", "motor", "spring", "springForce", "rod"],
    weld: [C.WELD, "linearSpring", "angularSpring"],
    wheel: [C.WHEEL, "limit", "motor", "spring"],
    motor: [C.MOTOR, "motor", "linearMotor", "linearSpring", "angularSpring"],
    filter: [C.FILTER],
    gear: [C.GEAR, "teeth"],
    rack: [C.RACK, "radius"],
    pulley: [C.PULLEY, "wheels", "length", "ratio"],
};

function lookup(table, name, what) {
    if (!Object.hasOwn(table, name)) {
        fail(`${what} is one of ${Object.keys(table).join(", ")}, and not ${typeof name === "string" ? name : shown(name)}`);
    }
    return table[name];
}

const optionalLookup = (table, name, what) => (name === undefined ? undefined : lookup(table, name, what));

/** Returns two masks: the bits of the options that are true, and the bits of the options that are false. */
function bitsOfFlags(options, bits) {
    let [set, cleared] = [0, 0];
    for (const [name, bit] of Object.entries(bits)) {
        const value = flag(options[name], name);
        set |= value ? bit : 0;
        cleared |= value === false ? bit : 0;
    }
    return [set, cleared];
}

function flags(at, name, bits, cleared = 0) {
    const field = fieldAt(name, at, "flags");
    write(name, at, { flags: ((u32(field) & ~cleared) | bits) >>> 0 });
}

const shape = (kind, geometry, options = {}) => ({ kind, geometry, options: onlyKnown(options, SHAPE_OPTIONS, "a shape") });
const points = (given) => array(given, "points");

export const circle = (radius, options) => shape(C.CIRCLE, { radius }, options);
export const box = (halfWidth, halfHeight, options) => {
    const half = [rawOf(halfWidth, "half the width of a box"), rawOf(halfHeight, "half the height of a box")];
    return shape(C.RECTANGLE, { points: [half.map((raw) => new Fx(raw))] }, options);
};
export const polygon = (corners, options) => shape(C.POLYGON, { points: points(corners), count: corners.length }, options);
export const hull = (corners, options) => shape(C.HULL, { points: points(corners), count: corners.length }, options);
export const capsule = (a, b, radius, options) => shape(C.CAPSULE, { points: [a, b], radius }, options);
export const segment = (a, b, options) => shape(C.SEGMENT, { points: [a, b] }, options);
export const chain = (corners, given = {}) => {
    const { closed = false, oneSided = false, ...options } = object(given, "the options of a chain");
    flag(closed, "closed");
    flag(oneSided, "oneSided");
    return { points: points(corners), closed, oneSided, options: onlyKnown(options, SHAPE_OPTIONS, "a chain") };
};

const SHAPE_OPTIONS = [
    "offset", "density", "friction", "restitution", "restitutionThreshold", "rollingResistance", "surfaceSpeed", "category",
    "mask", "group", "frictionMixing", "restitutionMixing", "oneWay", "sensor", "area", "contactEvents", "hitEvents",
    "sensorEvents", "detectSensors", "rounding", "userData",
];
const SHAPE_FLAGS = {
    sensor: C.SHAPE_SENSOR, contactEvents: C.SHAPE_CONTACT_EVENTS, hitEvents: C.SHAPE_HIT_EVENTS, sensorEvents: C.SHAPE_SENSOR_EVENTS,
    detectSensors: C.SHAPE_DETECT_SENSORS,
};
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
        onlyKnown(attraction, ["acceleration", "radius", "falloff"], "an attraction");
        write("shape_def", at, {
            attractionAcceleration: attraction.acceleration,
            attractionRadius: attraction.radius,
            attractionFalloff: lookup(FALLOFFS, attraction.falloff ?? "constant", "a falloff"),
        });
    }
}

function shapeOf(value) {
    if (value === null || typeof value !== "object" || !("options" in value)) {
        fail(`a shape is made by circle, box, polygon, hull, capsule, segment or chain, and is not ${shown(value)}`);
    }
    return value;
}

export const writeShape = writer((at, value) => {
    const { kind, geometry, options } = shapeOf(value);
    if (kind === undefined) {
        fail("a chain consists of several shapes, and only one shape is possible here");
    }
    call("ls2d_shape_def_init", kind, at);
    const { rounding, frictionMixing, restitutionMixing, area, ...plain } = options;
    write("shape_def", at, {
        ...plain,
        radius: rounding,
        ...geometry,
        frictionMixing: optionalLookup(MIXING, frictionMixing, "a rule of mixing"),
        restitutionMixing: optionalLookup(MIXING, restitutionMixing, "a rule of mixing"),
    });
    let [set, cleared] = bitsOfFlags(options, SHAPE_FLAGS);
    set |= options.oneWay === undefined ? 0 : C.SHAPE_ONE_WAY;
    set |= options.restitutionThreshold === undefined ? 0 : C.SHAPE_RESTITUTION_THRESHOLD;
    if (area !== undefined) {
        writeArea(at, area);
        set |= C.SHAPE_AREA | C.SHAPE_SENSOR | (area.attraction === undefined ? 0 : C.SHAPE_ATTRACTION);
    }
    flags(at, "shape_def", set, cleared & ~set);
});

/** Replaces each chain of a body by its links, which are encoded structs. */
export function expand(shapes) {
    return array(shapes, "shapes").flatMap((each) => (shapeOf(each).closed === undefined ? [each] : chainLinks(each)));
}

function chainLinks({ points, closed, oneSided, options }) {
    const size = sizeOf("shape_def");
    const corners = points.map((point) => vectorOf(point));
    const before = size + 16 * corners.length;
    const prepare = (at) => {
        writeShape(at, circle(1, options));
        corners.forEach(([x, y], index) => pair(at + size + 16 * index, x, y));
    };
    const ask = (links, capacity, count, at) =>
        statusOf("ls2d_chain_links", at, at + size, corners.length, closed ? 1 : 0, oneSided ? 1 : 0, links, capacity, count);
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

export const BODY_FLAGS = {
    enabled: C.BODY_ENABLED, asleep: C.BODY_ASLEEP, maySleep: C.BODY_MAY_SLEEP, lockX: C.BODY_LOCK_X, lockY: C.BODY_LOCK_Y,
    lockRotation: C.BODY_LOCK_ROTATION,
};

export const writeBody = writer((at, options) => {
    onlyKnown(options, BODY_OPTIONS, "a body");
    call("ls2d_body_def_init", lookup(BODY_KINDS, options.type ?? "dynamic", "the type of a body"), at);
    const { type: _, shapes: __, mass, continuous, ...plain } = options;
    write("body_def", at, {
        ...plain,
        continuous: optionalLookup(SWEEPS, continuous, "`continuous`"),
    });
    if (mass !== undefined) {
        writeMass(at, mass);
    }
    const [set, cleared] = bitsOfFlags(options, BODY_FLAGS);
    flags(at, "body_def", set | (mass === undefined ? 0 : C.BODY_GIVEN_MASS), cleared);
});

function writeMass(at, options) {
    const { mass, centre, gyration } = onlyKnown(options, ["mass", "centre", "gyration"], "`mass`");
    if (mass === undefined || gyration === undefined) {
        fail("`mass` has a `mass` in kg and a radius of `gyration` in m; `massOf` computes them");
    }
    write("body_def", at, { mass, massCentre: centre, massGyration: gyration });
}

/** Writes a body and its shapes into memory. Returns the addresses of the body and of the shapes, the number of shapes,
 * and the address of `room` free bytes after the shapes. */
export function writeBodyAndShapes(options, room = 0) {
    const shapes = expand(onlyKnown(options, BODY_OPTIONS, "a body").shapes ?? []);
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

export function massOf(shapes) {
    const { rest, shapes: at, count } = writeBodyAndShapes({ shapes }, 32);
    call("ls2d_shapes_mass", at, count, rest, rest + 8, rest + 24);
    return { mass: fxAt(rest), centre: { x: fxAt(rest + 8), y: fxAt(rest + 16) }, gyration: fxAt(rest + 24) };
}

export const bodyKind = (name) => lookup(BODY_KINDS, name, "the type of a body");

const JOINT_OPTIONS = [
    "type", "a", "b", "anchorA", "anchorB", "angleA", "angleB", "softness", "collide", "enabled", "threshold", "userData",
];

const JOINT_PARTS = {
    motor: ["speed", "max"], spring: ["hertz", "dampingRatio", "target"], softness: ["hertz", "dampingRatio"],
    threshold: ["force", "torque", "breaks"], linearMotor: ["velocity", "max"], linearSpring: ["hertz", "dampingRatio", "max"],
    angularSpring: ["hertz", "dampingRatio", "max"],
};

function checkJoint(options, known) {
    onlyKnown(options, [...known, ...JOINT_OPTIONS], `a joint of type ${options.type}`);
    for (const [part, known] of Object.entries(JOINT_PARTS)) {
        if (options[part] !== undefined) {
            onlyKnown(options[part], known, `\`${part}\` of a joint`);
        }
    }
    for (const name of ["motor", "linearMotor"]) {
        if (options[name] !== undefined && options[name].max === undefined) {
            fail(`\`${name}\` of a joint needs \`max\`, its largest force or torque`);
        }
    }
    for (const name of ["limit", "springForce", "teeth", "wheels"]) {
        const items = options[name] === undefined ? [0, 0] : array(options[name], name);
        if (items.length !== 2) {
            fail(`${name} has 2 items, and not ${items.length}`);
        }
        items.forEach((item, index) => given(item, `${name}[${index}]`));
    }
}

/** Writes a joint. With `isPlaced`, a pulley needs no `length`, because the length follows from the poses of the
 * bodies. */
export const writeJoint = writer((at, options, isPlaced = false) => {
    const [kind, ...known] = lookup(JOINTS, object(options, "a joint").type, "the type of a joint");
    checkJoint(options, known);
    if (kind === C.PULLEY && (options.wheels === undefined || (options.length === undefined && !isPlaced))) {
        fail("a pulley needs `wheels` and, without `anchor`, a `length`");
    }
    call("ls2d_joint_def_init", kind, at);
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
    flag(options.enabled, "enabled");
    const parts = [
        [flag(options.collide, "collide"), C.JOINT_COLLIDE], [limit, C.JOINT_LIMIT], [motor, C.JOINT_MOTOR], [spring, C.JOINT_SPRING],
        [springForce, C.JOINT_SPRING_FORCE], [rod, C.JOINT_ROD], [softness, C.JOINT_SOFTNESS],
        [threshold?.force, C.JOINT_THRESHOLD_FORCE], [threshold?.torque, C.JOINT_THRESHOLD_TORQUE],
        [flag(threshold?.breaks, "breaks"), C.JOINT_BREAKS], [linearMotor, C.JOINT_LINEAR_MOTOR], [linearSpring, C.JOINT_LINEAR_SPRING],
        [angularSpring, C.JOINT_ANGULAR_SPRING],
    ];
    const set = parts.reduce((bits, [part, bit]) => bits | (part === undefined || part === false ? 0 : bit), 0);
    flags(at, "joint_def", set, options.enabled === false ? C.JOINT_ENABLED : 0);
});

export const writeConfig = writer((at, options) => {
    const known = [...optionsOf("config", ["flags"]), "sleeping", "continuous"];
    const { sleeping: _, continuous: __, ...plain } = onlyKnown(options, known, "a world");
    write("config", at, plain);
    flags(at, "config", ...bitsOfFlags(options, { sleeping: C.SLEEPING, continuous: C.CONTINUOUS }));
});

const OVERLAPS = { resist: C.OVERLAP_RESIST, report: C.OVERLAP_REPORT, ignore: C.OVERLAP_IGNORE };

export const writeFilter = writer((at, filter) => {
    onlyKnown(filter, ["category", "mask", "sensors", "except", "initialOverlap"], "a filter");
    const { category, mask, sensors, except = [], initialOverlap } = filter;
    call("ls2d_query_filter_init", at);
    write("query_filter", at, {
        category, mask, except: array(except, "except"), exceptCount: except.length,
        flags: flag(sensors, "sensors") ? C.QUERY_SENSORS : 0,
        initialOverlap: optionalLookup(OVERLAPS, initialOverlap, "`initialOverlap`"),
    });
});
