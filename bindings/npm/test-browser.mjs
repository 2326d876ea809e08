// Tests the package in a headless Chromium: node bindings/npm/test-browser.mjs [SCREENSHOT]
//
// The modules with and without SIMD verify a golden replay, and examples/web/local.html plays a match of two peers.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { Browser } from "../../crates/viewer/web/browser.mjs";
import { serve } from "./serve.mjs";

const root = new URL("../../", import.meta.url);
const { address, close } = await serve(root);
const golden = readFileSync(new URL("tests/goldens.txt", root), "utf8").split("\n").filter((line) => / ragdoll /.test(line)).at(-1).split(" ");

async function goldens(simd) {
    const browser = await Browser.open(`${address}/blank.html`, [800, 600]);
    await browser.until("location.pathname", (path) => path === "/blank.html", "the page");
    const found = await browser.evaluate(`(async () => {
        const L = await import("/bindings/npm/src/index.js");
        await L.init({ simd: ${simd} });
        const file = await (await fetch("/replays/ragdoll.replay")).arrayBuffer();
        return { ...L.verifyReplay(new Uint8Array(file)), module: L.loaded() };
    })()`);
    assert.deepEqual([found.module, found.verdict, found.hash], [simd ? "simd" : "plain", "match", golden[3]]);
    await browser.close();
    console.log(`${found.module}: ragdoll ends in its golden`);
}

async function match(screenshot) {
    const browser = await Browser.open(`${address}/examples/web/local.html`, [920, 560]);
    await browser.until("globalThis.example?.state()", (state) => state?.every(({ status }) => status === "playing"), "both play");
    await browser.press("ArrowUp");
    const state = await browser.until("example.state()", (state) => state.every(({ tick }) => tick > 200), "200 ticks");
    assert.ok(state.every(({ desyncs }) => desyncs === 0), "the states are equal");
    if (screenshot) {
        writeFileSync(screenshot, await browser.screenshot());
    }
    const verdict = await browser.evaluate("example.verify()");
    assert.match(verdict, /^match: \d+ ticks/);
    assert.deepEqual(browser.complaints, []);
    await browser.close();
    console.log(`examples/web/local.html: ${verdict}`);
}

await goldens(true);
await goldens(false);
await match(process.argv[2]);
close();
