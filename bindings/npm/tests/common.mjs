import { readFileSync } from "node:fs";

const variant = process.env.VARIANT ?? "simd";
export const L = await (variant.startsWith("core") ? import("../src/core.js") : import("../src/index.js"));
export const root = new URL("../../../", import.meta.url);
export const file = (path) => new Uint8Array(readFileSync(new URL(path, root)));

/** Errors of calls of `init` with wrong options, before the module is loaded. */
export const initErrors = [];
for (const wrong of [{ SIMD: true }, { simd: "no" }, null, "simd"]) {
    await L.init(wrong).then(() => initErrors.push(undefined), (error) => initErrors.push(error));
}

// VARIANT selects the module: `simd` (the default) or `plain`; for lockstep2d/core, `core` or `core-plain`.
await L.init({ simd: variant.endsWith("plain") ? false : undefined });

export function fallingBox() {
    const world = new L.World();
    world.spawn({ type: "fixed", position: [0, -1], shapes: [L.box(20, 1)] });
    const box = world.spawn({ position: [0, 3], shapes: [L.box("0.25", "0.25")] });
    return { world, box };
}
