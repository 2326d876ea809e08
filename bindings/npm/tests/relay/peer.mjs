// A player of examples/web in a process of its own:
//
//     node peer.mjs URL CODE KEY [--pause-at TICK] [--quit-at TICK] [-o FILE]
//
// Prints a line of JSON when it starts to play, and another one at the end. `--pause-at` stops the updates for five
// seconds. `--quit-at` ends the process without leaving the match.
import { writeFileSync } from "node:fs";
import { parseArgs } from "node:util";
import { register } from "node:module";
import * as L from "../../src/index.js";

// Resolves the name `lockstep2d`, by which the page imports the package.
const here = JSON.stringify(new URL("../../src/index.js", import.meta.url).href);
register(`data:text/javascript,${encodeURIComponent(`export const resolve = (name, context, next) =>
    name === "lockstep2d" ? { url: ${here}, shortCircuit: true } : next(name, context);`)}`);
const { Game, SEATS, offer } = await import("../../../../examples/web/game.js");
const { MatchRecording } = await import("../../../../examples/web/recording.js");

const { values, positionals: [url, code, key] } = parseArgs({
    allowPositionals: true,
    options: { "pause-at": { type: "string" }, "quit-at": { type: "string" }, output: { type: "string", short: "o" } },
});
const PAUSE = 5000;
const [pauseAt, quitAt] = [values["pause-at"], values["quit-at"]].map((tick) => (tick === undefined ? Infinity : Number(tick)));
const sleep = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

await L.init();
const relay = await L.Relay.connect(url, code);
const game = new Game();
const match = new L.Match({ seats: SEATS, guess: 8, delayMin: 1, key: BigInt(key), offer: offer(), contact: relay.others[0] });
const driver = new L.MatchDriver(match, game, (to, packet) => relay.send(to, packet));
const recording = new MatchRecording();
const counts = {};
let [paused, joinedAt] = [false, undefined];
const statuses = [];
const started = performance.now();
relay.onPacket = (from, packet) => paused || driver.receive(performance.now(), from, packet);

const input = () => Uint8Array.of([1, 2, 5, 2, 1, 6][Math.floor((driver.tick + 7 * Number(key)) / 30) % 6]);
while (match.status !== "closed") {
    for (const event of driver.update(performance.now(), input)) {
        counts[event.kind] = (counts[event.kind] ?? 0) + 1;
        if (event.kind === "status") {
            statuses.push(event.status);
            // On a slow machine, the first status may be another one, such as `waiting`.
            if (statuses.indexOf("playing") === statuses.length - 1) {
                console.log(JSON.stringify({ playing: driver.tick }));
            }
        }
        if (event.kind === "state") {
            joinedAt = event.tick;
        }
    }
    recording.follow(match);
    if (driver.tick >= quitAt) {
        process.exit(0);
    }
    if (driver.tick >= pauseAt && counts.paused === undefined) {
        counts.paused = 1;
        paused = true;
        await sleep(PAUSE);
        paused = false;
    }
    if (performance.now() - started > 180_000) {
        console.error(`no end: ${match.status}, tick ${driver.tick}`);
        process.exit(1);
    }
    await sleep(4);
}
if (values.output !== undefined && !recording.broken) {
    writeFileSync(values.output, recording.finish());
}
console.log(JSON.stringify({ ticks: driver.tick, hash: game.hash(), desyncs: counts.desync ?? 0, joinedAt, statuses, recorded: recording.ticks }));
relay.close();
