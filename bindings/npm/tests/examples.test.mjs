// The parts of examples/web that need no page.
import assert from "node:assert/strict";
import { register } from "node:module";
import { test } from "node:test";
import { L } from "./common.mjs";

// The examples import the package by its name.
const source = JSON.stringify(new URL("../src/index.js", import.meta.url).href);
register(`data:text/javascript,${encodeURIComponent(`export const resolve = (name, context, next) =>
    name === "lockstep2d" ? { url: ${source}, shortCircuit: true } : next(name, context);`)}`);
const { Direct } = await import("../../../examples/web/direct.js");
const { MatchRecording } = await import("../../../examples/web/recording.js");

/** A stand-in for a match that has dropped the inputs of the ticks below `kept`. */
const matchOf = (confirmed, kept = 0) => ({
    status: "playing",
    ticks: () => ({ confirmed }),
    finalInputs: (tick) => (tick < kept ? undefined : { inputs: Uint8Array.of(tick % 8, 1, 0, 2), absent: 0n }),
});

test("a replay that is saved during the match ends there, and the match goes on", () => {
    const recording = new MatchRecording();
    recording.follow(matchOf(90));
    const file = recording.finish();
    const { verdict, ticks } = L.verifyReplay(file);
    assert.deepEqual([verdict, ticks], ["match", 90]);
    recording.follow(matchOf(200));
    assert.deepEqual([recording.finish(), recording.ticks, recording.broken], [file, 90, false]);
});

test("a recording without the first ticks is broken", () => {
    const recording = new MatchRecording();
    recording.follow(matchOf(90, 5));
    assert.deepEqual([recording.broken, recording.ticks], [true, 0]);
});

test("a text in a data channel is no packet", () => {
    const channel = {};
    globalThis.RTCPeerConnection = class {
        createDataChannel() {
            return channel;
        }
        setLocalDescription() {}
    };
    const relay = { own: Uint8Array.of(1), others: [Uint8Array.of(2)], send() {} };
    const direct = new Direct(relay);
    const sizes = [];
    direct.onPacket = (from, { length }) => sizes.push(length);
    direct.enable();
    channel.onmessage({ data: "2000" });
    channel.onmessage({ data: Uint8Array.of(1, 2, 3).buffer });
    assert.deepEqual(sizes, [3]);
});
