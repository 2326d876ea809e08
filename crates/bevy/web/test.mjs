// A page plays against a native player over WebRTC: node test.mjs PAGE BOT SCREENSHOT
//
// During the match, the page is loaded again and joins again. Both players have the same last state, and the replay of
// the native player verifies.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";
import { Browser } from "../../viewer/web/browser.mjs";
import { serve } from "../../../bindings/npm/serve.mjs";

const [page, bot, screenshot] = process.argv.slice(2).map((path) => resolve(path));
const TICKS = 1500;
const STATUS = "document.getElementById('status')?.textContent";

const native = spawn(bot, ["0", String(TICKS)], { stdio: ["ignore", "pipe", "inherit"] });
const ended = once(native, "exit");
const lines = createInterface(native.stdout)[Symbol.asyncIterator]();
const signalling = (await lines.next()).value.split(",")[0];

const { address, close } = await serve(pathToFileURL(`${page}/`));
const browser = await Browser.open(`${address}/?server=${signalling}#bot`, [1000, 720]);
try {
    const tickOf = (status) => Number(/Playing, tick (\d+)/.exec(status ?? "")?.[1] ?? 0);
    await browser.until(STATUS, (status) => tickOf(status) > 200, "200 ticks");
    await browser.press("ArrowRight");
    writeFileSync(screenshot, await browser.screenshot());
    await browser.send("Page.reload");
    await browser.until(STATUS, (status) => tickOf(status) === 0, "the page is loaded again");
    await browser.until(STATUS, (status) => tickOf(status) > 400, "the match goes on");
    const end = await browser.until(STATUS, (status) => /the end/.test(status), "the end");
    const [, tick, hash] = /the end, tick (\d+), ([0-9a-f]{32})/.exec(end);
    assert.equal((await lines.next()).value, `tick ${tick}, ${hash}`);
    assert.equal(Number(tick), TICKS);
    assert.deepEqual(await ended, [0, null]);
    assert.deepEqual(browser.complaints, []);
    console.log(`page and native player: ${tick} ticks, ${hash}`);
} finally {
    await browser.close();
    native.kill();
    close();
}
