// Tests the lobby of examples/web in headless Chromium: node bindings/npm/test-lobby.mjs RELAY [SCREENSHOT]
//
// Two pages play through the relay (the program `lockstep2d-relay`). One page is reloaded and gets its seat back. Then
// the pages connect by WebRTC, disconnect and connect again, unless WEBRTC=0. Both pages end with the same hash, and
// the replay verifies. A page with another version of the rules shows why it cannot join.
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

async function open(code = "lobby-1") {
    const query = `code=${code}&relay=${encodeURIComponent(url)}`;
    const page = await Browser.open(`${server.address}/examples/web/?${query}`, [760, 640]);
    pages.push(page);
    await enter(page);
    return page;
}

// Opens a match with another offer in the room "lobby-2".
const OTHER = `(async () => {
    const { Match, MatchDriver, Relay, init } = await import("/bindings/npm/src/index.js");
    const { Game } = await import("/examples/web/game.js");
    await init();
    const room = await Relay.connect(${JSON.stringify(url)}, "lobby-2");
    const match = new Match({ seats: 4, offer: Uint8Array.of(1) });
    const driver = new MatchDriver(match, new Game(), (to, packet) => room.send(to, packet));
    room.onPacket = (from, packet) => driver.receive(performance.now(), from, packet);
    setInterval(() => driver.update(performance.now(), (seats) => new Uint8Array(seats.length)), 4);
})()`;

// A page whose offer differs from that of the match shows why it cannot join.
async function refused() {
    const host = await open("lobby-3");
    await host.evaluate(OTHER);
    const page = await open("lobby-2");
    const text = "document.getElementById('text').textContent";
    await page.until(text, (shown) => /refused: the others play another/.test(shown), "the reason");
    assert.deepEqual([host.complaints, page.complaints], [[], []]);
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
        const click = (page) => page.evaluate("document.getElementById('direct').click()");
        await click(first);
        for (const wanted of [1, 0, 1]) {
            await click(second);
            for (const page of pages) {
                await page.until("example.state()", ({ direct }) => direct === wanted, `${wanted} data channels`);
            }
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
    await refused();
} finally {
    await Promise.all(pages.map((page) => page.close()));
    server.close();
    relay.kill("SIGKILL");
}
