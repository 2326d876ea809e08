// Tests what happens when the library has no free handles, or no memory.
import assert from "node:assert/strict";
import { test } from "node:test";
import { library } from "../src/library.js";
import { L } from "./common.mjs";

function files() {
    const setup = new L.Commands();
    const recorder = new L.Recorder({ rules: "none", players: 1, inputBytes: 1, start: "0".repeat(32) });
    return { ofWorld: new L.Recording({ setup }).finish(), ofGame: recorder.finish("0".repeat(32)) };
}

test("without a free handle no replay is opened, and the error has no verdict", () => {
    const { ofWorld, ofGame } = files();
    const exports = library();
    const at = exports.ls2d_scratch(8);
    const handles = [];
    while (exports.ls2d_bytes_new(0, 0, at) === 0) {
        handles.push(new DataView(exports.memory.buffer).getUint32(at, true));
    }
    for (const open of [() => new L.Replay(ofGame), () => new L.Timeline(ofWorld)]) {
        assert.throws(open, ({ code, verdict, message }) => code === "EXHAUSTED" && verdict === undefined && /too many objects/.test(message));
    }
    handles.forEach((handle) => exports.ls2d_free(handle));
    assert.equal(new L.Replay(ofGame).ticks, 0);
});

test("bytes that do not fit into memory are freed", async (t) => {
    const real = library();
    // `scarce` is a second instance of the JavaScript module on the same wasm instance. It gets no scratch memory of
    // more than 50 000 bytes, as if the memory were full.
    const exports = { ...real, ls2d_scratch: (size) => (size > 50_000 ? 0 : real.ls2d_scratch(size)) };
    t.mock.method(WebAssembly, "instantiate", async () => ({ instance: { exports } }));
    const scarce = await import("../src/library.js?scarce");
    await scarce.initializer({})({ wasm: {} });
    const at = real.ls2d_scratch(100_000);
    real.ls2d_bytes_new(at, 90_000, at);
    const handle = new DataView(real.memory.buffer).getUint32(at, true);
    const before = L.objectCount();
    assert.throws(() => scarce.takeBytes(handle), { code: "MEMORY" });
    assert.equal(L.objectCount(), before - 1);
});
