// Matches with native programs: the data that `lockstep2d::peer::Peer<G>` sends besides inputs.
import { byteArray, count, instance, integer, micros, onlyKnown, string } from "./check.js";
import { Lockstep2dError } from "./error.js";
import { library } from "./library.js";
import { hashBytes } from "./maths.js";
import { World } from "./world.js";

const ENCODER = new TextEncoder();
const OFFER_OPTIONS = ["rules", "rulesVersion", "setup", "tickRate", "seats", "inputBytes", "patience"];

/** Little-endian bytes of a hash. */
const hashOf = (digits) => Uint8Array.from({ length: 16 }, (_, index) => parseInt(digits.slice(30 - 2 * index, 32 - 2 * index), 16));

export function nativeOffer(options) {
    const { rules, rulesVersion = 1, setup = new Uint8Array(), tickRate = 60, seats, inputBytes = 1, patience = 2000 } =
        onlyKnown(options, OFFER_OPTIONS, "an offer");
    const name = ENCODER.encode(string(rules, "`rules`"));
    const bytes = new Uint8Array(4 + 8 + name.length + 4 + 16 + 4 + 4 + 2 + 8);
    const view = new DataView(bytes.buffer);
    view.setUint32(0, library().ls2d_semantics(), true);
    view.setBigUint64(4, BigInt(name.length), true);
    bytes.set(name, 12);
    const at = 12 + name.length;
    view.setUint32(at, count(rulesVersion, "`rulesVersion`"), true);
    bytes.set(hashOf(hashBytes(byteArray(setup, "`setup`"))), at + 4);
    view.setUint32(at + 20, Number(integer(tickRate, "`tickRate`", 1, 1000)), true);
    view.setUint32(at + 24, Number(integer(seats, "`seats`", 1, 64)), true);
    view.setUint16(at + 28, Number(integer(inputBytes, "`inputBytes`", 1, 512)), true);
    view.setBigUint64(at + 30, micros(patience, "`patience`"), true);
    return bytes;
}

export function encodeNativeState(world) {
    const saved = instance(world, World, "the world").toBytes();
    const bytes = new Uint8Array(24 + saved.length);
    bytes.set(hashOf(world.hash()));
    new DataView(bytes.buffer).setBigUint64(16, BigInt(saved.length), true);
    bytes.set(saved, 24);
    return bytes;
}

export function decodeNativeState(bytes) {
    const world = World.fromBytes(byteArray(bytes, "the state").subarray(24));
    const hash = hashOf(world.hash());
    if (!hash.every((byte, index) => byte === bytes[index])) {
        world.dispose();
        throw new Lockstep2dError("SNAPSHOT", "the state does not have the hash that the bytes begin with");
    }
    return world;
}
