// Mathematics for the rules of a game.
import { count, integer } from "./check.js";
import { Angle, bitsOf, rawOf, vectorOf, Fx } from "./fx.js";
import { call, fxAt, give, hashAt, library, small, u32, read } from "./library.js";

const vector = (at) => ({ x: fxAt(at), y: fxAt(at + 8) });

export const sqrt = (value) => {
    const at = small();
    call("ls2d_fx_sqrt", rawOf(value), at);
    return fxAt(at);
};
export const hypot = (x, y) => new Fx(library().ls2d_fx_hypot(rawOf(x), rawOf(y)));
export const sin = (angle) => new Fx(library().ls2d_angle_sin(bitsOf(angle)));
export const cos = (angle) => new Fx(library().ls2d_angle_cos(bitsOf(angle)));
export const angleOf = (value) => new Angle(library().ls2d_angle_of(...vectorOf(value)));
export const dot = (a, b) => new Fx(library().ls2d_vec2_dot(...vectorOf(a), ...vectorOf(b)));
export const cross = (a, b) => new Fx(library().ls2d_vec2_cross(...vectorOf(a), ...vectorOf(b)));
export const normalize = (value) => {
    const at = small();
    call("ls2d_vec2_normalize", ...vectorOf(value), at);
    return vector(at);
};
export const rotate = (value, angle) => {
    const at = small();
    call("ls2d_vec2_rotate", ...vectorOf(value), bitsOf(angle), at);
    return vector(at);
};

export class Random {
    constructor(seed) {
        const at = small();
        const bits = BigInt(integer(seed, "a seed", -(1n << 63n), (1n << 64n) - 1n));
        call("ls2d_rng_init", BigInt.asUintN(64, bits), at);
        this.state = read("rng", at);
    }

    #at() {
        const at = small();
        const view = new DataView(library().memory.buffer);
        view.setBigUint64(at, this.state.state, true);
        view.setBigUint64(at + 8, this.state.increment, true);
        return at;
    }

    below(bound) {
        const at = this.#at();
        call("ls2d_rng_below", at, at, count(bound, "the bound"), at + 16);
        this.state = read("rng", at);
        return u32(at + 16);
    }

    range(low, high) {
        const at = this.#at();
        call("ls2d_rng_range", at, at, rawOf(low), rawOf(high), at + 16);
        this.state = read("rng", at);
        return fxAt(at + 16);
    }
}

export function hashBytes(bytes) {
    const at = give(bytes, 64, "the data");
    call("ls2d_hash_bytes", at + 64, bytes.length, at);
    return hashAt(at);
}
