// Plays the example in headless Chromium: node examples/phaser/test.mjs FOLDER RELAY SCREENSHOT_DIRECTORY
//
// FOLDER is a copy of this folder with `node_modules` and `dist`. The first page plays a match of two players at one
// keyboard. Its replay must lead to the same hash in a new page and in Node. Then two pages from Vite's development
// server play a match through the relay, and must end with the same hash.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";
import { serve } from "../../bindings/npm/serve.mjs";
import { Browser } from "../../crates/viewer/web/browser.mjs";

const [folder, program, pictures] = process.argv.slice(2).map((path) => resolve(path));
const load = (path) => import(pathToFileURL(join(folder, path)));
const SIZE = [960, 588];
const KEY_CODES = { a: 65, d: 68, s: 83, w: 87, 1: 49, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40 };
const pages = [];

async function open(url) {
    const page = await Browser.open(url, SIZE);
    pages.push(page);
    await page.until("globalThis.example !== undefined", Boolean, "the page");
    return page;
}

// Sends a key event. Phaser reads `keyCode`, which Chromium sets from `windowsVirtualKeyCode`.
const key = (page, type, name) =>
    page.send("Input.dispatchKeyEvent", { type, key: name, windowsVirtualKeyCode: KEY_CODES[name] });

async function picture(page, name) {
    mkdirSync(pictures, { recursive: true });
    writeFileSync(join(pictures, name), await page.screenshot());
}

const STATE = `(() => {
    const { driver, status, error, recording } = example.session() ?? {};
    return { tick: driver?.tick ?? 0, status, error, ended: driver?.ended, recorded: recording?.ticks };
})()`;
const playing = (page, ticks) =>
    page.until(STATE, ({ status, tick }) => status === "playing" && tick >= ticks, `it plays ${ticks} ticks`);

// Presses and releases the keys of both players in turn until the game has reached the tick `ticks`.
async function rollAndJump(page, ticks) {
    const names = ["d", "ArrowLeft", "w", "ArrowUp", "s", "a", "ArrowRight", "ArrowDown"];
    for (let turn = 0; (await page.evaluate(STATE)).tick < ticks; turn++) {
        await key(page, "rawKeyDown", names[turn % names.length]);
        await new Promise((done) => setTimeout(done, 120));
        await key(page, "keyUp", names[(turn * 3 + 1) % names.length]);
    }
    for (const name of names) {
        await key(page, "keyUp", name);
    }
}

// Returns the replay of a page. The recording of the page then ends.
const replayOf = async (page) => Uint8Array.from(await page.evaluate("[...example.session().recording.finish()]"));

// Verifies a replay in the page and in Node. The verdict compares the last state with the hash of the live game.
async function verified(page, replay) {
    const here = await page.evaluate(`example.verify(Uint8Array.of(${replay}))`);
    assert.equal(here.verdict, "match", here.text);
    assert.deepEqual(verify(replay), here, "Node and the page compute the same states");
    return here;
}

/** For each player, the bits of all keys that the player has pressed in a replay. */
function pressed(replay) {
    const [inputs, bits] = [new Replay(replay), [0, 0]];
    for (let tick = inputs.next(); tick !== undefined; tick = inputs.next()) {
        tick.inputs.forEach((input, seat) => (bits[seat] |= input));
    }
    return bits;
}

/** Returns a forged replay: the hashes of `replay`, but other inputs. */
function forged(replay) {
    const [inputs, game] = [new Replay(replay), new Game()];
    const recording = new Recording(game);
    for (let tick = inputs.next(); tick !== undefined; tick = inputs.next()) {
        game.step(tick.inputs);
        recording.add({ ...tick, inputs: tick.inputs.map((bits) => bits ^ 2) }, game.hash(), game.points);
    }
    return recording.finish();
}

async function local(url) {
    const first = await open(url);
    await first.until("example.game.scene.isActive('title')", Boolean, "the title");
    await picture(first, "title.png");
    await key(first, "rawKeyDown", "1");
    await key(first, "keyUp", "1");
    await playing(first, 1);
    await rollAndJump(first, 300);
    await picture(first, "local.png");
    const sprites = await first.evaluate(`(() => {
        const { sprites, session } = example.game.scene.getScene("arena");
        return [sprites.size, session.game.world.bodies().length];
    })()`);
    assert.ok(sprites[0] >= 4 && Math.abs(sprites[0] - sprites[1]) <= 1, `a sprite for each body: ${sprites}`);
    const replay = await replayOf(first);
    const { ticks, hash } = await verified(await open(url), replay);
    assert.ok(ticks >= 300, `${ticks} ticks`);
    assert.deepEqual(pressed(replay), [15, 15], "every key of both players sets its bit");
    assert.equal(verify(forged(replay)).verdict, "diverged", "other inputs lead to other states");
    console.log(`at one keyboard: ${ticks} ticks, ${hash}, also in a new page and in Node`);
}

async function match(url, relay) {
    const address = `${url}?room=TEST&relay=${encodeURIComponent(relay)}`;
    const both = [await open(address)];
    await both[0].until(STATE, ({ status }) => status === "waiting", "the first page waits");
    both.push(await open(address));
    for (const page of both) {
        await playing(page, 30);
    }
    await Promise.all(both.map((page) => rollAndJump(page, 240)));
    await picture(both[1], "match.png");
    const { tick } = await both[0].evaluate(STATE);
    await both[0].evaluate(`example.session().match.endAt(${tick + 180})`);
    const ends = [];
    for (const page of both) {
        const ended = ({ ended, tick, recorded }) => ended && tick === recorded;
        const { tick: ticks, error } = await page.until(STATE, ended, "the end");
        assert.equal(error, "");
        const hash = await page.evaluate("example.session().game.hash()");
        const replay = await replayOf(page);
        const verdict = await verified(page, replay);
        assert.deepEqual([verdict.ticks, verdict.hash], [ticks, hash]);
        ends.push({ ticks, hash, replay });
    }
    assert.deepEqual(ends[0], ends[1], "both pages end in the same state, with the same replay");
    console.log(`through the relay: ${ends[0].ticks} ticks in two pages, ${ends[0].hash}`);
}

const { Replay, init } = await load("node_modules/lockstep2d/src/index.js");
await init();
const { Game } = await load("src/rules.js");
const { Recording, verify } = await load("src/replay.js");
const relay = spawn(program, ["--listen", "127.0.0.1:0", "--json"], { stdio: ["ignore", "pipe", "inherit"] });
const relayAddress = new Promise((done, reject) => {
    relay.on("error", reject);
    createInterface({ input: relay.stdout }).once("line", (line) => done(JSON.parse(line).address));
});
const built = await serve(pathToFileURL(`${folder}/dist/`));
const { createServer } = await load("node_modules/vite/dist/node/index.js");
const development = await createServer({ root: folder, logLevel: "warn", server: { port: 0, hmr: false } });
try {
    await local(`${built.address}/`);
    await development.listen();
    await match(development.resolvedUrls.local[0], await relayAddress);
    for (const page of pages) {
        assert.deepEqual(page.complaints, [], "the pages log no errors");
    }
} finally {
    await Promise.all(pages.map((page) => page.close()));
    built.close();
    await development.close();
    relay.kill("SIGKILL");
}
