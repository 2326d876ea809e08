// Matches with native programs: the data that `lockstep2d::peer::Peer<G>` sends besides inputs.
import { Lockstep2dError } from "./error.js";
import { library } from "./library.js";
import { hashBytes } from "./maths.js";
import { World } from "./world.js";

const ENCODER = new TextEncoder();

/** Little-endian bytes of a hash. */
const hashOf = (digits) => Uint8Array.from({ length: 16 }, (_, index) => parseInt(digits.slice(30 - 2 * index, 32 - 2 * index), 16));

export function nativeOffer({ rules, rulesVersion = 1, setup = new Uint8Array(), tickRate = 60, seats, inputBytes = 1, patience = 2000 }) {
    const name = ENCODER.encode(rules);
    const bytes = new Uint8Array(4 + 8 + name.length + 4 + 16 + 4 + 4 + 2 + 8);
    const view = new DataView(bytes.buffer);
    view.setUint32(0, library().ls2d_semantics(), true);
    view.setBigUint64(4, BigInt(name.length), true);
    bytes.set(name, 12);
    const at = 12 + name.length;
    view.setUint32(at, rulesVersion, true);
    bytes.set(hashOf(hashBytes(setup)), at + 4);
    view.setUint32(at + 20, tickRate, true);
    view.setUint32(at + 24, seats, true);
    view.setUint16(at + 28, inputBytes, true);
    view.setBigUint64(at + 30, BigInt(Math.floor(patience * 1000)), true);
    return bytes;
}

export function encodeNativeState(world) {
    const saved = world.toBytes();
    const bytes = new Uint8Array(24 + saved.length);
    bytes.set(hashOf(world.hash()));
    new DataView(bytes.buffer).setBigUint64(16, BigInt(saved.length), true);
    bytes.set(saved, 24);
    return bytes;
}

export function decodeNativeState(bytes) {
    const world = World.fromBytes(bytes.subarray(24));
    const hash = hashOf(world.hash());
    if (!hash.every((byte, index) => byte === bytes[index])) {
        world.dispose();
        throw new Lockstep2dError("SNAPSHOT", "the hash of the state is another one");
    }
    return world;
}
