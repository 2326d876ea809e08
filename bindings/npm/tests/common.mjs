import { readFileSync } from "node:fs";
import * as lockstep2d from "../src/index.js";

export const L = lockstep2d;
export const root = new URL("../../../", import.meta.url);
export const file = (path) => new Uint8Array(readFileSync(new URL(path, root)));

// VARIANT=plain runs the tests with the module without SIMD.
await L.init({ simd: process.env.VARIANT === "plain" ? false : undefined });

export function fallingBox() {
    const world = new L.World();
    world.spawn({ type: "fixed", position: [0, -1], shapes: [L.box(20, 1)] });
    const box = world.spawn({ position: [0, 3], shapes: [L.box("0.25", "0.25")] });
    return { world, box };
}
