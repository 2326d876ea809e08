// Worlds and snapshots.
import { count as u32Of, fail, given, instance, object, shown } from "./check.js";
import { BODY_FLAGS, writeConfig, writeFilter, writeShape } from "./definitions.js";
import { rawOf, vectorOf } from "./fx.js";
import { readJoint } from "./joints.js";
import { C } from "./layout.js";
import {
    Handle, call, copy, f64s, fieldAt, found, fxAt, give, hashAt, id, idAt, library, list, read, scratch, sizeOf, takeBytes, text, u32,
    u64, write,
} from "./library.js";
import { Commands, Edits } from "./edits.js";

const raws = (vector, what) => vectorOf(vector, what);
const KINDS = ["fixed", "kinematic", "dynamic"];
const OPTIONS = Object.entries(BODY_FLAGS);
const SWEEPS = ["off", "fixed", "bullet", "kinematic"];

export class Snapshot extends Handle {
    hash() {
        const at = scratch(16);
        call("ls2d_snapshot_hash", this.handle, at);
        return hashAt(at);
    }
}

/** Writes a filter and returns its address, or 0 for the defaults. */
function filterAt(at, filter) {
    if (filter === undefined) {
        return 0;
    }
    writeFilter(at, filter);
    return at;
}

const FILTER = () => sizeOf("query_filter");

export class World extends Edits {
    constructor(options = {}) {
        super(options instanceof Adopted ? options.handle : World.#make(options));
    }

    static #make(options) {
        const { smallest, ...settings } = object(options, "the options of a world");
        const at = scratch(8 + sizeOf("config"));
        call("ls2d_config_init", at + 8);
        writeConfig(at + 8, settings);
        if (smallest !== undefined) {
            call("ls2d_config_for_smallest", at + 8, at + 8, rawOf(smallest, "smallest"));
        }
        call("ls2d_world_new", at + 8, at);
        return u32(at);
    }

    static fromBytes(bytes) {
        const at = give(bytes);
        call("ls2d_world_decode", at + 64, bytes.length, at);
        return new World(new Adopted(u32(at)));
    }

    toBytes() {
        const at = scratch(8);
        call("ls2d_world_encode", this.handle, at);
        return takeBytes(u32(at));
    }

    clone() {
        const at = scratch(8);
        call("ls2d_world_clone", this.handle, at);
        return new World(new Adopted(u32(at)));
    }

    step(ticks = 1) {
        call("ls2d_world_steps", this.handle, u32Of(ticks, "the number of ticks"));
    }

    execute(commands) {
        const at = scratch(8);
        call("ls2d_world_execute", this.handle, instance(commands, Commands, "the list").handle, at);
        return u32(at);
    }

    hash() {
        const at = scratch(16);
        call("ls2d_world_hash", this.handle, at);
        return hashAt(at);
    }

    digest(section) {
        const at = scratch(16);
        call("ls2d_world_digest", this.handle, u32Of(section, "a section"), at);
        return hashAt(at);
    }

    get tick() {
        const at = scratch(8);
        call("ls2d_world_tick", this.handle, at);
        return Number(u64(at));
    }

    get faults() {
        const at = scratch(8);
        call("ls2d_world_faults", this.handle, at);
        return Number(u64(at));
    }

    counts() {
        const at = scratch(24);
        call("ls2d_world_counts", this.handle, at, at + 4, at + 8, at + 12, at + 16);
        const [bodies, shapes, joints, awake, pairs] = [0, 4, 8, 12, 16].map((offset) => u32(at + offset));
        return { bodies, shapes, joints, awake, pairs };
    }

    config() {
        const at = scratch(sizeOf("config"));
        call("ls2d_world_config", this.handle, at);
        const { size: _, flags, ...rest } = read("config", at);
        return { ...rest, sleeping: (flags & C.SLEEPING) !== 0, continuous: (flags & C.CONTINUOUS) !== 0 };
    }

    setConfig(options) {
        const at = scratch(sizeOf("config"));
        call("ls2d_world_config", this.handle, at);
        writeConfig(at, options);
        call("ls2d_set_config", this.handle, at);
    }

    random(bound) {
        const at = scratch(8);
        call("ls2d_world_random_below", this.handle, u32Of(bound, "the bound"), at);
        return u32(at);
    }

    randomRange(low, high) {
        const at = scratch(8);
        call("ls2d_world_random_range", this.handle, rawOf(low), rawOf(high), at);
        return fxAt(at);
    }

    save() {
        const at = scratch(8);
        call("ls2d_world_save", this.handle, at);
        return new Snapshot(u32(at));
    }

    saveInto(snapshot) {
        call("ls2d_world_save_into", this.handle, instance(snapshot, Snapshot, "the snapshot").handle);
    }

    restore(snapshot) {
        call("ls2d_world_restore", this.handle, instance(snapshot, Snapshot, "the snapshot").handle);
    }

    body(body) {
        const at = scratch(sizeOf("body_info"));
        if (!found(() => call("ls2d_body_get", this.handle, id(body), at))) {
            return undefined;
        }
        const { kind, flags, continuous, reserved: _, ...info } = read("body_info", at);
        info.type = KINDS[kind];
        info.continuous = SWEEPS[continuous];
        for (const [name, bit] of OPTIONS) {
            info[name] = (flags & bit) !== 0;
        }
        return info;
    }

    bodyName(body) {
        const at = scratch(16);
        const known = found(() => call("ls2d_body_name", this.handle, id(body), at));
        return known ? text(copy(at, 16)).replace(/\0+$/, "") || undefined : undefined;
    }

    velocityAt(body, point) {
        const place = raws(point, "point");
        const at = scratch(16);
        call("ls2d_body_velocity_at", this.handle, id(body), ...place, at);
        return { x: fxAt(at), y: fxAt(at + 8) };
    }

    #ids(name, before = []) {
        const { at, count } = list(8, 0, (items, capacity, length) => library()[name](this.handle, ...before, items, capacity, length));
        return Array.from({ length: count }, (_, index) => idAt(at + 8 * index));
    }

    bodies() {
        return this.#ids("ls2d_world_bodies");
    }

    joints() {
        return this.#ids("ls2d_world_joints");
    }

    shapesOf(body) {
        return this.#ids("ls2d_body_shapes", [id(body)]);
    }

    jointsOf(body) {
        return this.#ids("ls2d_body_joints", [id(body)]);
    }

    sensorOverlaps(shape) {
        return this.#ids("ls2d_sensor_overlaps", [id(shape, "a shape")]);
    }

    shape(shape) {
        const at = scratch(8 + sizeOf("shape_def"));
        call("ls2d_shape_get", this.handle, id(shape, "a shape"), at + 8, at);
        const points = fieldAt("shape_def", at + 8, "points");
        const { size: _, count, ...rest } = read("shape_def", at + 8);
        const used = [0, 2, count, 2, 4][rest.kind] ?? 0;
        const all = Array.from({ length: used }, (_, index) => ({ x: fxAt(points + 16 * index), y: fxAt(points + 16 * index + 8) }));
        return { ...rest, type: ["circle", "segment", "polygon", "capsule", "link"][rest.kind], body: idAt(at), points: all };
    }

    shapeBox(shape) {
        const at = scratch(sizeOf("aabb"));
        call("ls2d_shape_box", this.handle, id(shape, "a shape"), at);
        return read("aabb", at);
    }

    shapeDistance(a, b) {
        const at = scratch(8);
        return call("ls2d_shape_distance", this.handle, id(a, "a shape"), id(b, "a shape"), at) ? fxAt(at) : undefined;
    }

    joint(joint) {
        const at = scratch(sizeOf("joint_def"));
        call("ls2d_joint_get", this.handle, id(joint, "a joint"), at);
        return readJoint(at);
    }

    jointAnchors(joint) {
        const at = scratch(32);
        call("ls2d_joint_anchors", this.handle, id(joint, "a joint"), at, at + 16);
        return [{ x: fxAt(at), y: fxAt(at + 8) }, { x: fxAt(at + 16), y: fxAt(at + 24) }];
    }

    jointAngle(joint) {
        const at = scratch(8);
        return found(() => call("ls2d_joint_angle", this.handle, id(joint, "a joint"), at)) ? fxAt(at) : undefined;
    }

    jointForce(joint) {
        const at = scratch(24);
        const known = found(() => call("ls2d_joint_force", this.handle, id(joint, "a joint"), at, at + 16));
        return known ? { force: { x: fxAt(at), y: fxAt(at + 8) }, torque: fxAt(at + 16) } : undefined;
    }

    poses(target) {
        if (target !== undefined && !(target instanceof Float64Array)) {
            fail(`the target is a Float64Array, and not ${shown(target)}`);
        }
        const ask = (rows, capacity, count) => library().ls2d_draw_poses(this.handle, rows, capacity, count);
        const { at, count } = list(8, 0, ask);
        const found = f64s(at, count);
        if (target === undefined || target.length < count) {
            return found.slice();
        }
        target.set(found);
        return target.subarray(0, count);
    }

    #events(name, struct) {
        const ask = (items, capacity, count) => library()[name](this.handle, items, capacity, count);
        const size = sizeOf(struct);
        const { at, count } = list(size, 0, ask);
        return Array.from({ length: count }, (_, index) => read(struct, at + size * index));
    }

    events() {
        const moved = this.#events("ls2d_events_moved", "pose");
        return {
            moved: moved.map(({ flags, ...rest }) => ({ ...rest, fellAsleep: (flags & C.BODY_ASLEEP) !== 0 })),
            contactBegin: this.#events("ls2d_events_contact_begin", "contact_event"),
            contactEnd: this.#events("ls2d_events_contact_end", "contact_event"),
            hits: this.#events("ls2d_events_hits", "hit_event"),
            sensorBegin: this.#events("ls2d_events_sensor_begin", "sensor_event"),
            sensorEnd: this.#events("ls2d_events_sensor_end", "sensor_event"),
            joints: this.#events("ls2d_events_joints", "joint_event").map(({ broke, ...rest }) => ({ ...rest, broke: broke === 1n })),
        };
    }

    #hit(struct, at) {
        const { startsInside, ...rest } = read(struct, at);
        return { ...rest, startsInside: startsInside === 1n };
    }

    castRay(origin, translation, filter) {
        const ray = [...raws(origin, "origin"), ...raws(translation, "translation")];
        const at = scratch(sizeOf("ray_hit") + FILTER());
        const seen = filterAt(at + sizeOf("ray_hit"), filter);
        return call("ls2d_cast_ray", this.handle, ...ray, seen, at) ? this.#hit("ray_hit", at) : undefined;
    }

    castRayAll(origin, translation, filter) {
        const ray = [...raws(origin, "origin"), ...raws(translation, "translation")];
        const size = sizeOf("ray_hit");
        const ask = (hits, capacity, count, before) =>
            library().ls2d_cast_ray_all(this.handle, ...ray, filterAt(before, filter), hits, capacity, count);
        const { at, count } = list(size, FILTER(), ask);
        return Array.from({ length: count }, (_, index) => this.#hit("ray_hit", at + size * index));
    }

    #probe(at, shape, position, angle = 0) {
        call("ls2d_probe_init", C.CIRCLE, at);
        write("probe", at, { position: given(position, "position"), angle });
        writeShape(fieldAt("probe", at, "shape"), shape);
    }

    castShape(shape, position, translation, options = {}) {
        const { angle, ...filter } = object(options, "the options of a query");
        const [hit, probe] = [sizeOf("cast_hit"), sizeOf("probe")];
        const along = raws(translation, "translation");
        const at = scratch(hit + probe + FILTER());
        this.#probe(at + hit, shape, position, angle);
        const seen = filterAt(at + hit + probe, filter);
        const found = call("ls2d_cast_shape", this.handle, at + hit, ...along, seen, at);
        return found ? this.#hit("cast_hit", at) : undefined;
    }

    #overlaps(before, ask) {
        const { at, count } = list(8, before, ask);
        return Array.from({ length: count }, (_, index) => idAt(at + 8 * index));
    }

    overlapShape(shape, position, options = {}) {
        const { angle, ...filter } = object(options, "the options of a query");
        const probe = sizeOf("probe");
        return this.#overlaps(probe + FILTER(), (shapes, capacity, count, before) => {
            this.#probe(before, shape, position, angle);
            return library().ls2d_overlap_shape(this.handle, before, filterAt(before + probe, filter), shapes, capacity, count);
        });
    }

    overlapBox(lower, upper, filter) {
        return this.#overlaps(32 + FILTER(), (shapes, capacity, count, before) => {
            write("aabb", before, { lower: given(lower, "lower"), upper: given(upper, "upper") });
            return library().ls2d_overlap_box(this.handle, before, filterAt(before + 32, filter), shapes, capacity, count);
        });
    }

    overlapPoint(point, filter) {
        const at = raws(point, "point");
        return this.#overlaps(FILTER(), (shapes, capacity, count, before) =>
            library().ls2d_overlap_point(this.handle, ...at, filterAt(before, filter), shapes, capacity, count));
    }

    closest(point, within, filter) {
        const [size, from] = [sizeOf("closest_point"), raws(point, "point")];
        const at = scratch(size + FILTER());
        const seen = filterAt(at + size, filter);
        const found = call("ls2d_closest", this.handle, ...from, rawOf(within, "within"), seen, at);
        return found ? read("closest_point", at) : undefined;
    }
}

/** Wraps the handle of an existing world. Passed to the constructor of `World`, which then owns the handle and creates
 * no world. */
export class Adopted {
    constructor(handle) {
        this.handle = handle;
    }
}
