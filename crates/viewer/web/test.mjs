// Compares the viewer in a browser with the command `lockstep2d`:
//
//     node crates/viewer/web/test.mjs PAGE_DIRECTORY COMMAND SCREENSHOT_DIRECTORY
//
// The page must show the verdicts and hashes that the command prints, for a golden replay and for damaged replays.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createServer } from "node:http";
import { mkdirSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, extname, join, resolve } from "node:path";
import { Browser } from "./browser.mjs";

const [page, command, pictures] = process.argv.slice(2).map((path) => resolve(path));
const SIZE = [1000, 700];
const GOLDEN = resolve("replays/ragdoll.replay");
const OTHER = resolve("replays/game.replay");
const STATE = `(() => {
    const text = (id) => document.getElementById(id)?.textContent ?? "";
    const numbers = text("tick").match(/\\d+/g) ?? [];
    return { name: text("name"), tick: Number(numbers[0]), ticks: Number(numbers[1]), hash: text("hash"),
        verdict: text("verdict"), status: document.querySelector("[role=status]")?.textContent ?? "" };
})()`;

function native(...args) {
    return JSON.parse(execFileSync(command, args, { encoding: "utf8" }));
}

function hashAt(file, tick) {
    return native("seek", "--json", file, "--tick", String(tick)).hash;
}

function serve() {
    const types = { ".html": "text/html", ".js": "text/javascript", ".wasm": "application/wasm" };
    const server = createServer((request, response) => {
        const { pathname } = new URL(request.url, "http://localhost");
        const name = pathname === "/" ? "index.html" : basename(pathname);
        const from = pathname.startsWith("/replays/") ? resolve("replays") : page;
        try {
            const bytes = readFileSync(join(from, name));
            response.writeHead(200, { "content-type": types[extname(name)] ?? "application/octet-stream" }).end(bytes);
        } catch {
            response.writeHead(404).end();
        }
    });
    return new Promise((done) => server.listen(0, "127.0.0.1", () => done(server)));
}

// Bit of the Shift key among the modifiers in Chromium's debugging protocol.
const SHIFT = 8;

// Drops a file on the page.
async function drop(browser, file, modifiers = 0) {
    const data = { items: [], files: [file], dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"]) {
        await browser.send("Input.dispatchDragEvent", { type, x: 400, y: 300, data, modifiers });
    }
}

const settled = (browser, tick) => browser.until(STATE, (state) => state.tick === tick, `tick ${tick}`);

async function scrubsAndMatches(browser) {
    await drop(browser, GOLDEN);
    const verdict = await browser.until(STATE, ({ name, verdict }) => name === basename(GOLDEN) && verdict.startsWith("Match"), "Match");
    const ticks = verdict.ticks;
    const end = hashAt(GOLDEN, ticks);
    console.log(`${verdict.name}: ${verdict.verdict}`);

    await browser.press("End");
    let state = await settled(browser, ticks);
    assert.equal(state.hash, end, "the final hash should equal the native one");
    assert.ok(state.status.includes(end) && state.status.includes("Match"), "the status should show hash and verdict");

    // Ten single ticks back, then to the start, then one second and one tick forward.
    for (let back = 1; back <= 10; back++) {
        await browser.press("ArrowLeft");
        await settled(browser, ticks - back);
    }
    state = await browser.evaluate(STATE);
    assert.equal(state.hash, hashAt(GOLDEN, ticks - 10), "hash ten ticks before the end");
    await browser.press("Home");
    state = await settled(browser, 0);
    assert.equal(state.hash, hashAt(GOLDEN, 0), "hash at the start");
    await browser.press("PageDown");
    await browser.press("ArrowRight");
    state = await settled(browser, 61);
    assert.equal(state.hash, hashAt(GOLDEN, 61), "hash at tick 61");

    // The timeline bar is near the lower border of the canvas, 12 pixels from both sides.
    const [width, height] = await browser.evaluate(
        "[document.getElementById('glcanvas').clientWidth, document.getElementById('glcanvas').clientHeight]");
    const place = (part) => [12 + part * (width - 24), height - 18];
    await browser.mouse("mouseMoved", ...place(0.25));
    await browser.mouse("mousePressed", ...place(0.25));
    for (const part of [0.25, 0.5, 0.75, 0.4]) {
        await browser.mouse("mouseMoved", ...place(part));
        const near = (state) => Math.abs(state.tick - part * ticks) <= 1 + ticks / (width - 24);
        state = await browser.until(STATE, near, `scrubbed to ${part} of ${ticks}`);
    }
    // The button is released below the canvas. After that, moves of the pointer no longer seek.
    await browser.mouse("mouseMoved", place(0.4)[0], height + 12);
    await browser.mouse("mouseReleased", place(0.4)[0], height + 12);
    await browser.mouse("mouseMoved", ...place(0.75));
    await browser.press("ArrowLeft");
    await browser.press("ArrowRight");
    state = await settled(browser, state.tick);
    assert.equal(state.hash, hashAt(GOLDEN, state.tick), "hash at the tick that the pointer scrubbed to");
    console.log(`scrubbed to tick ${state.tick}: ${state.hash}, equal to the command's`);
}

// A file that is dropped while Shift is down is compared with the shown file.
async function compares(browser) {
    await drop(browser, GOLDEN, SHIFT);
    const same = ({ name, status }) => name === basename(GOLDEN) && status.includes("identical up to tick");
    const { verdict } = await browser.until(STATE, same, "identical");
    console.log(`dropped with Shift: ${verdict}`);
}

// Takes a screenshot and checks that it is not blank.
async function look(browser, name) {
    const bytes = await browser.screenshot();
    writeFileSync(join(pictures, name), bytes);
    const counts = await browser.evaluate(`(async () => {
        const image = new Image();
        image.src = "data:image/png;base64,${bytes.toString("base64")}";
        await image.decode();
        const canvas = new OffscreenCanvas(image.width, image.height);
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0);
        const pixels = new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer);
        const counts = new Map();
        pixels.forEach((pixel) => counts.set(pixel, (counts.get(pixel) ?? 0) + 1));
        return [counts.size, Math.max(...counts.values()) / pixels.length];
    })()`);
    const [colours, most] = counts;
    assert.ok(colours > 50 && most < 0.95, `${name} is blank: ${colours} colours, ${most} of one`);
    return bytes;
}

async function refuses(browser) {
    const directory = mkdtempSync(join(tmpdir(), "viewer-files-"));
    const golden = readFileSync(GOLDEN);
    const write = (name, bytes) => {
        writeFileSync(join(directory, name), bytes);
        return join(directory, name);
    };
    const verdictOf = (file) => {
        try {
            return native("verify", "--json", file);
        } catch (error) {
            // The command exits with code 1 and prints the verdict.
            return JSON.parse(error.stdout);
        }
    };
    const flipped = (at) => {
        const bytes = Buffer.from(golden);
        bytes[at] ^= 0x40;
        return bytes;
    };
    const cases = {
        "truncated.replay": golden.subarray(0, golden.length - 20),
        "cut.replay": golden.subarray(0, golden.length / 2),
        "block.replay": flipped(golden.length - 200),
        "setup.replay": flipped(golden.length >> 1),
        "version.replay": flipped(9),
        "garbage.replay": Buffer.from("GIF89a, which is nothing of ours"),
    };
    for (const [name, bytes] of Object.entries(cases)) {
        const file = write(name, bytes);
        const { verdict, why } = verdictOf(file);
        // For a file of an unknown kind, the message names all three kinds.
        const reasons = name === "garbage.replay" ? ["neither a report nor a replay nor a snapshot"]
            : [verdict, why ?? ""];
        await drop(browser, file);
        const says = ({ status }) => status.includes(name) &&
            reasons.every((reason) => status.toLowerCase().includes(reason.toLowerCase()));
        const shown = await browser.until(STATE, says, `${name}: ${reasons}`);
        assert.doesNotMatch(shown.verdict, /Match/, "the error should not be shown beside the verdict of another file");
        console.log(`${name}: ${shown.verdict}`);
    }
}

async function main() {
    mkdirSync(pictures, { recursive: true });
    const server = await serve();
    const address = `http://127.0.0.1:${server.address().port}/`;
    let browser;
    try {
        browser = await Browser.open(address, SIZE);
        await browser.until(STATE, ({ tick, hash }) => tick > 10 && hash !== "", "the first scene plays");
        await look(browser, "scene.png");
        await scrubsAndMatches(browser);
        await look(browser, "golden.png");
        await compares(browser);
        await refuses(browser);
        await look(browser, "refused.png");

        await browser.send("Page.navigate", { url: `${address}?file=replays/${basename(OTHER)}` });
        await browser.until(STATE, ({ name }) => name === basename(OTHER), "?file=");
        await browser.send("Page.navigate", { url: `${address}?scene=pyramid` });
        await browser.until(STATE, ({ name, tick }) => name === "pyramid" && tick > 0, "?scene=");
        await look(browser, "pyramid.png");
        assert.deepEqual(browser.complaints, [], "the page should log no errors");
    } finally {
        await browser?.close();
        server.close();
    }
}

main().then(() => console.log("all page tests passed"), (error) => {
    console.error(error);
    process.exitCode = 1;
});
