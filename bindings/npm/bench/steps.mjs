// Milliseconds of a step in Node for each wasm module given: node bindings/npm/bench/steps.mjs A.wasm [B.wasm ...]
//
// Each module runs in processes of its own, in turns. The simulation is deterministic, so the time of a tick is the
// shortest one of the rounds: a busy machine only makes ticks longer. The hashes have to be equal.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { SCENES } from "./scenes.mjs";

const ROUNDS = Number(process.env.ROUNDS ?? 7);
const TICKS = 240;

function play(L, build, ticks) {
    const world = new L.World();
    build(L, world);
    const times = [];
    for (let tick = 0; tick < ticks; tick++) {
        const start = performance.now();
        world.step();
        times.push(performance.now() - start);
    }
    const hash = world.hash();
    world.dispose();
    return { times, hash };
}

async function measure(path) {
    const L = await import("../src/index.js");
    await L.init({ wasm: readFileSync(path) });
    // The engine compiles a function again, with optimisations, once it is used often.
    Object.values(SCENES).forEach((build) => play(L, build, 60));
    const rows = Object.entries(SCENES).map(([name, build]) => ({ name, ...play(L, build, TICKS) }));
    console.log(JSON.stringify(rows));
}

function compare(paths) {
    const shortest = {};
    const hashes = {};
    for (let round = 0; round < ROUNDS; round++) {
        for (const path of paths) {
            const rows = JSON.parse(execFileSync(process.execPath, [fileURLToPath(import.meta.url), "--one", path], { encoding: "utf8" }));
            for (const { name, times, hash } of rows) {
                const best = ((shortest[name] ??= {})[path] ??= times);
                times.forEach((time, tick) => (best[tick] = Math.min(best[tick], time)));
                if ((hashes[name] ??= hash) !== hash) {
                    throw new Error(`${name}: ${path} has another hash`);
                }
            }
        }
    }
    const mean = (times) => times.reduce((sum, time) => sum + time, 0) / times.length;
    const product = paths.map(() => 1);
    for (const [name, each] of Object.entries(shortest)) {
        const [first, ...rest] = paths.map((path) => mean(each[path]));
        rest.forEach((time, index) => (product[index] *= time / first));
        const ratios = rest.map((time) => `${time.toFixed(3)} (${(time / first).toFixed(2)})`);
        console.log([name.padEnd(16), first.toFixed(3), ...ratios].join("  "));
    }
    const count = Object.keys(shortest).length;
    console.log(`geometric mean of the ratios: ${product.slice(0, -1).map((each) => (each ** (1 / count)).toFixed(3)).join(" ")}`);
}

if (process.argv[2] === "--one") {
    await measure(process.argv[3]);
} else {
    compare(process.argv.slice(2));
}
