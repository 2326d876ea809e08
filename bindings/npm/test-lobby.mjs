// Tests the lobby of examples/web in headless Chromium: node bindings/npm/test-lobby.mjs RELAY [SCREENSHOT]
//
// Two pages play through the relay (the program `lockstep2d-relay`). One page is reloaded and gets its seat back. Then
// the pages connect by WebRTC, unless WEBRTC=0. Both pages end with the same hash, and the replay verifies.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { writeFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { Browser } from "../../crates/viewer/web/browser.mjs";
import { serve } from "./serve.mjs";

const [program, screenshot] = process.argv.slice(2);
const relay = spawn(program, ["--listen", "127.0.0.1:0", "--json"], { stdio: ["ignore", "pipe", "inherit"] });
const url = await new Promise((resolve, reject) => {
    relay.on("error", reject);
    createInterface({ input: relay.stdout }).once("line", (line) => resolve(JSON.parse(line).address));
});
const server = await serve(new URL("../../", import.meta.url));
const pages = [];

const playing = (page, ticks) =>
    page.until("globalThis.example?.state()", (state) => state?.status === "playing" && state.tick >= ticks, `it plays ${ticks} ticks`);
const enter = async (page) => {
    await page.until("typeof globalThis.example", (type) => type === "object", "the page");
    await page.evaluate("example.enter()");
};

async function open() {
    const page = await Browser.open(`${server.address}/examples/web/?code=lobby-1&relay=${encodeURIComponent(url)}`, [760, 640]);
    pages.push(page);
    await enter(page);
    return page;
}

async function play() {
    const first = await open();
    const second = await open();
    await playing(first, 60);
    const { seats } = await playing(second, 60);
    await second.press("ArrowUp");
    await second.send("Page.reload", {});
    await enter(second);
    const again = await playing(second, 120);
    assert.deepEqual(again.seats, seats, "the page has its seat again");
    if (process.env.WEBRTC !== "0") {
        await second.evaluate("example.direct()");
        for (const page of pages) {
            await page.until("example.state()", ({ direct }) => direct === 1, "a data channel");
        }
    }
    const { tick } = await first.evaluate("example.state()");
    await playing(first, tick + 120);
    if (screenshot) {
        writeFileSync(screenshot, await first.screenshot());
    }
    await first.evaluate(`example.end(${tick + 240})`);
    const ends = [];
    for (const page of pages) {
        await page.until("example.state()", ({ status }) => status === "closed", "the end");
        ends.push({ ...(await page.evaluate("example.state()")), hash: await page.evaluate("example.hash()") });
        assert.deepEqual(page.complaints, []);
    }
    const [a, b] = ends;
    assert.deepEqual([a.tick, a.hash, a.desyncs, b.desyncs], [b.tick, b.hash, 0, 0]);
    const verdict = await second.evaluate(
        `(async () => (await import("/bindings/npm/src/index.js")).verifyReplay(new Uint8Array(${JSON.stringify(await first.evaluate("example.replay()"))})))()`);
    assert.deepEqual([verdict.verdict, verdict.ticks], ["match", a.tick]);
    console.log(`examples/web: ${a.tick} ticks between two pages, ${a.hash}`);
}

try {
    await play();
} finally {
    await Promise.all(pages.map((page) => page.close()));
    server.close();
    relay.kill("SIGKILL");
}
