// Time of a step in Node in milliseconds, for several engines or for several builds of the wasm module:
//
//     npm ci && node steps.mjs             this package, rapier2d, planck, matter-js
//     node steps.mjs A.wasm B.wasm ...     builds of the module
//
// In each round, every engine or build runs in a new process. The time of a tick is its shortest time over the rounds,
// because load on the machine makes ticks longer. A printed figure is the mean of these times over the ticks, with the
// ratio to the first column in brackets. ROUNDS is 5 by default. The hashes of a scene have to be equal in all rounds
// and builds.
import { execFileSync } from "node:child_process";
import { fileURLToPath } from "node:url";
import { ENGINES, measure, moduleOf } from "./engines.mjs";

const ROUNDS = Number(process.env.ROUNDS ?? 5);
const TICKS = 240;

const run = (name) => {
    const text = execFileSync(process.execPath, [fileURLToPath(import.meta.url), "--one", name], { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
    return JSON.parse(text.slice(text.indexOf("[{")));
};

function compare(names) {
    const shortest = {};
    const hashes = {};
    for (let round = 0; round < ROUNDS; round++) {
        for (const name of names) {
            for (const { name: scene, times, hash } of run(name)) {
                const best = ((shortest[scene] ??= {})[name] ??= times);
                times.forEach((time, tick) => (best[tick] = Math.min(best[tick], time)));
                if (hash !== undefined && (hashes[scene] ??= hash) !== hash) {
                    throw new Error(`${scene}: ${name} has another hash`);
                }
            }
        }
    }
    print(names, shortest);
}

function print(names, shortest) {
    const mean = (times) => times.reduce((sum, time) => sum + time, 0) / times.length;
    const product = names.map(() => 1);
    console.log(`| | ${names.join(" | ")} |\n|---${"|---".repeat(names.length)}|`);
    for (const [scene, each] of Object.entries(shortest)) {
        const [first, ...rest] = names.map((name) => mean(each[name]));
        rest.forEach((time, index) => (product[index] *= time / first));
        const cells = rest.map((time) => `${time.toFixed(3)} (${(time / first).toFixed(2)})`);
        console.log(`| ${[scene, first.toFixed(3), ...cells].join(" | ")} |`);
    }
    const scenes = Object.keys(shortest).length;
    const means = product.slice(0, -1).map((each) => (each ** (1 / scenes)).toFixed(2));
    console.log(`| geometric mean | 1 | ${means.join(" | ")} |`);
}

if (process.argv[2] === "--one") {
    console.log(JSON.stringify(await measure(ENGINES[process.argv[3]] ?? moduleOf(process.argv[3]), TICKS)));
} else {
    compare(process.argv.length > 2 ? process.argv.slice(2) : Object.keys(ENGINES));
}
