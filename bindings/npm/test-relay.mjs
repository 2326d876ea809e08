// A match through the relay: node bindings/npm/test-relay.mjs RELAY PUSH LOCKSTEP2D
//
// The arguments are paths of `lockstep2d-relay`, of its example `push`, and of the command `lockstep2d`. Two peers in
// Node and a native one play 3000 ticks. The first peer in Node stops its updates for five seconds. The second quits,
// and is started again with the same key. All three peers end with the same hash. The peers that play from the first
// tick write equal replays, which `lockstep2d verify` accepts. Meanwhile, a member of another room sends nothing and
// keeps its connection.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import * as L from "./src/index.js";

const [relayProgram, pushProgram, command] = process.argv.slice(2);
const TICKS = 3000;
const CODE = "ROOM-7";
const folder = mkdtempSync(join(tmpdir(), "relay-"));
const children = [];

function start(program, ...args) {
    const child = spawn(program, args, { stdio: ["ignore", "pipe", "inherit"] });
    children.push(child);
    const lines = [];
    const reader = createInterface({ input: child.stdout });
    reader.on("line", (line) => lines.push(line));
    const first = () => (lines.length > 0 ? Promise.resolve() : new Promise((resolve) => reader.once("line", resolve)));
    const ended = new Promise((resolve, reject) => {
        child.on("error", reject);
        child.on("close", (code) => (code === 0 ? resolve(lines) : reject(new Error(`${program} ${args.join(" ")}: exit code ${code}`))));
    });
    return { child, lines, first, ended, last: async () => JSON.parse((await ended).at(-1)) };
}

// Node 20 has a WebSocket behind a flag.
const flags = typeof WebSocket === "undefined" ? ["--experimental-websocket", "--no-warnings"] : [];
const FOLDER = fileURLToPath(new URL("tests/relay/", import.meta.url));
const node = (name, ...args) => start(process.execPath, ...flags, join(FOLDER, `${name}.mjs`), ...args);
const peer = (...args) => node("peer", ...args);

/** Computes the hash of a `Sandbox` (Rust) from the hash of its world. It also covers the number of refused commands,
 * here 0. */
function sandboxHash(world) {
    const bytes = (digits) => Buffer.from(digits, "hex").reverse();
    return L.hashBytes(Buffer.concat([bytes(world), bytes(L.hashBytes(new Uint8Array(8)))]));
}

async function play() {
    const relay = start(relayProgram, "--listen", "127.0.0.1:0", "--json");
    await relay.first();
    const { address } = JSON.parse(relay.lines[0]);
    const silent = node("silent", address);
    const file = (name) => join(folder, `${name}.replay`);
    const native = start(pushProgram, address, CODE, "--ticks", String(TICKS), "-o", file("native"));
    // The first member of the room opens the match.
    await native.first();
    const paused = peer(address, CODE, "1", "--pause-at", "700", "-o", file("paused"));
    // Peers that play from the first tick write a replay.
    await paused.first();
    await peer(address, CODE, "2", "--quit-at", "1500").ended;
    const again = peer(address, CODE, "2");
    const ends = await Promise.all([native, paused, again].map((each) => each.last()));
    await silent.ended;
    relay.child.kill("SIGINT");
    await relay.ended;
    return { ends, files: ["native", "paused"].map(file) };
}

try {
    const { ends, files } = await play();
    const [native, paused, again] = ends;
    assert.deepEqual(ends.map(({ ticks }) => ticks), [TICKS, TICKS, TICKS]);
    assert.deepEqual(ends.map(({ hash }) => hash), [native.hash, native.hash, native.hash]);
    assert.deepEqual([paused.desyncs, again.desyncs], [0, 0]);
    assert.ok(paused.statuses.includes("dropped"), `the pause is longer than the patience: ${paused.statuses}`);
    assert.ok(again.joinedAt > 1000, `it returned in the middle, at ${again.joinedAt}`);
    const [a, b] = files.map((path) => readFileSync(path));
    assert.ok(a.equals(b), "the replays are equal");
    const verdict = JSON.parse(execFileSync(command, ["verify", "--json", files[0]], { encoding: "utf8" }).split("\n")[0]);
    await L.init();
    assert.deepEqual([verdict.verdict, verdict.ticks, verdict.hash], ["match", TICKS, sandboxHash(native.hash)]);
    console.log(`relay: ${TICKS} ticks, ${native.hash}, ${a.length} bytes of replay verified; returned at tick ${again.joinedAt}`);
} finally {
    children.forEach((child) => child.exitCode ?? child.kill("SIGKILL"));
    rmSync(folder, { recursive: true, force: true });
}
