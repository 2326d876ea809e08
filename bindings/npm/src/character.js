// Characters.
import { array, byteArray, fail, flag, given, instance, onlyKnown } from "./check.js";
import { writeFilter, writeShape } from "./definitions.js";
import { Lockstep2dError } from "./error.js";
import { C } from "./layout.js";
import {
    call, copy, fieldAt, give, idAt, library, list, optionsOf, read, scratch, sizeOf, struct, write, writer,
} from "./library.js";
import { World } from "./world.js";

const STATE_FIELDS = ["position", "velocity", "ground", "isOnGround", "isWedged", "hasLanded", "passing"];
const PASSING_MAX = struct("mover_state").fields.passing[2];
const PLANE = optionsOf("mover_plane");
const MOVER_OPTIONS = ["shape", "slopeMax", "stepHeight", "snapDistance"];

const writeMover = writer((at, options) => {
    onlyKnown(options, MOVER_OPTIONS, "a mover");
    call("ls2d_mover_init", C.CIRCLE, at);
    const { shape, ...abilities } = options;
    write("mover", at, abilities);
    writeShape(fieldAt("mover", at, "shape"), shape);
});

const writeState = writer((at, state) => {
    const { position, velocity = [0, 0], ground, isWedged, hasLanded, passing = [] } = onlyKnown(state, STATE_FIELDS, "the state of a character");
    if (position === undefined) {
        fail("the state of a character has a position");
    }
    call("ls2d_mover_state_init", 0n, 0n, at);
    const flags = (ground === undefined ? 0 : C.MOVER_ON_GROUND)
        | (flag(isWedged, "isWedged") ? C.MOVER_WEDGED : 0)
        | (flag(hasLanded, "hasLanded") ? C.MOVER_LANDED : 0);
    write("mover_state", at, { position, velocity, flags, passing: array(passing, "passing"), passingCount: passing.length });
    if (ground !== undefined) {
        onlyKnown(ground, PLANE, "`ground`");
        PLANE.forEach((name) => given(ground[name], `ground.${name}`));
        write("mover_plane", fieldAt("mover_state", at, "ground"), ground);
    }
});

function readState(at) {
    const { position, velocity, flags, passingCount } = read("mover_state", at);
    const isOnGround = (flags & C.MOVER_ON_GROUND) !== 0;
    const ground = isOnGround ? readPlane(fieldAt("mover_state", at, "ground")) : undefined;
    const [isWedged, hasLanded] = [C.MOVER_WEDGED, C.MOVER_LANDED].map((bit) => (flags & bit) !== 0);
    const ids = fieldAt("mover_state", at, "passing");
    const passing = Array.from({ length: passingCount }, (_, index) => idAt(ids + 8 * index));
    return { position, velocity, ground, isOnGround, isWedged, hasLanded, passing };
}

function readPlane(at) {
    const { reserved: _, ...plane } = read("mover_plane", at);
    return plane;
}

export function moveCharacter(world, mover, state, filter = {}) {
    const [abilities, pose, plane] = [sizeOf("mover"), sizeOf("mover_state"), sizeOf("mover_plane")];
    const before = abilities + 2 * pose + sizeOf("query_filter");
    instance(world, World, "the world");
    let to;
    const prepare = (at) => {
        writeMover(at, mover);
        writeState(at + abilities, state);
        writeFilter(at + abilities + 2 * pose, filter);
    };
    const ask = (met, capacity, count, at) => {
        const from = at + abilities;
        to = from + pose;
        return library().ls2d_move_character(world.handle, at, from, to + pose, to, met, capacity, count);
    };
    const { at, count } = list(plane, before, ask, prepare);
    return { state: readState(to), met: Array.from({ length: count }, (_, index) => readPlane(at + index * plane)) };
}

export function encodeMoverState(state) {
    const at = scratch(sizeOf("mover_state"));
    writeState(at, state);
    return copy(at, sizeOf("mover_state"));
}

/** Decodes the state of a character. `moveCharacter` checks its values. */
export function decodeMoverState(bytes) {
    if (byteArray(bytes, "the argument").length !== sizeOf("mover_state")) {
        throw new Lockstep2dError("DECODE", `the state of a character has ${sizeOf("mover_state")} bytes, and not ${bytes.length}`);
    }
    const at = give(bytes, 0);
    if (read("mover_state", at).passingCount > PASSING_MAX) {
        throw new Lockstep2dError("DECODE", `the state of a character lists at most ${PASSING_MAX} shapes that it passes`);
    }
    return readState(at);
}
