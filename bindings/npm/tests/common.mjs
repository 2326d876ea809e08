import { readFileSync } from "node:fs";

const variant = process.env.VARIANT ?? "simd";
export const L = await (variant.startsWith("core") ? import("../src/core.js") : import("../src/index.js"));
export const root = new URL("../../../", import.meta.url);
export const file = (path) => new Uint8Array(readFileSync(new URL(path, root)));

// The scratch memory of each call lies elsewhere than that of the call before, and is followed by `GUARD` bytes that
// nothing may change.
const GUARD = 64;
const PATTERN = 0xa5;
// Size of the memory that mathematics uses. Calculations keep other scratch memory valid.
const SMALL = 64;
let guards = () => [];

/** Throws if the program has written to scratch memory of earlier calls, or behind that of the last call. */
export function checkGuards() {
    const changed = guards().some((bytes) => bytes.some((byte) => byte !== PATTERN));
    guards = () => [];
    if (changed) {
        throw new Error("memory beside the scratch memory of the last call has changed");
    }
}

function guarded({ ls2d_scratch: scratch, memory, ...rest }) {
    let turn = 0;
    const ls2d_scratch = (size) => {
        if (size === SMALL) {
            return scratch(size);
        }
        checkGuards();
        const room = 8 * Math.ceil((size + GUARD) / 8);
        const start = (scratch(SMALL + 2 * room) >>> 0) + SMALL;
        turn = 1 - turn;
        const at = start + turn * room;
        const other = start + (1 - turn) * room;
        const places = [[other, Math.min(room, 4096)], [at + size, GUARD]];
        guards = () => places.map(([from, length]) => new Uint8Array(memory.buffer, from, length));
        guards().forEach((bytes) => bytes.fill(PATTERN));
        return at;
    };
    return { ...rest, memory, ls2d_scratch };
}

const instantiate = WebAssembly.instantiate;
WebAssembly.instantiate = async (...given) => {
    const made = await instantiate(...given);
    return { instance: { exports: guarded((made.instance ?? made).exports) } };
};

/** Errors of calls of `init` with wrong options, before the module is loaded. */
export const initErrors = [];
for (const wrong of [{ SIMD: true }, { simd: "no" }, null, "simd"]) {
    await L.init(wrong).then(() => initErrors.push(undefined), (error) => initErrors.push(error));
}

// VARIANT selects the module: `simd` (the default) or `plain`; for lockstep2d/core, `core` or `core-plain`.
await L.init({ simd: variant.endsWith("plain") ? false : undefined });
WebAssembly.instantiate = instantiate;

export function fallingBox() {
    const world = new L.World();
    world.spawn({ type: "fixed", position: [0, -1], shapes: [L.box(20, 1)] });
    const box = world.spawn({ position: [0, 3], shapes: [L.box("0.25", "0.25")] });
    return { world, box };
}
