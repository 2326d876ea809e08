// Tests of the parts of examples/web that need no page.
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

/** A stand-in for `RTCPeerConnection` that refuses the ICE candidate "wrong", and every candidate before the remote
 * description is set. */
class Connection {
    static all = [];
    connectionState = "new";
    candidates = [];
    channel = { readyState: "connecting", sent: [], send: (packet) => this.channel.sent.push([...packet]) };

    constructor() {
        Connection.all.push(this);
    }
    createDataChannel() {
        return this.channel;
    }
    async setLocalDescription() {
        this.localDescription = { type: this.remoteDescription ? "answer" : "offer" };
    }
    async setRemoteDescription(description) {
        await undefined;
        this.remoteDescription = description;
    }
    async addIceCandidate(candidate) {
        if (!this.remoteDescription || candidate === "wrong") {
            throw new DOMException("no description", "InvalidStateError");
        }
        this.candidates.push(candidate);
    }
    close() {
        this.connectionState = "closed";
    }
}

function direct(name = 1) {
    Connection.all = [];
    globalThis.RTCPeerConnection = Connection;
    const [own, other] = [Uint8Array.of(name), Uint8Array.of(2)];
    const relay = { own, others: [other], sent: [], send: (to, packet) => relay.sent.push([...packet]) };
    const made = new Direct(relay);
    const signal = (message) => relay.onPacket(other, new TextEncoder().encode(`lockstep2d signal ${JSON.stringify(message)}`));
    return { direct: made, relay, other, signal, settle: () => new Promise((resolve) => setTimeout(resolve, 5)) };
}

test("a text in a data channel is no packet", () => {
    const { direct: made } = direct();
    const sizes = [];
    made.onPacket = (from, { length }) => sizes.push(length);
    made.enable(true);
    const [{ channel }] = Connection.all;
    channel.onmessage({ data: "2000" });
    channel.onmessage({ data: Uint8Array.of(1, 2, 3).buffer });
    assert.deepEqual(sizes, [3]);
});

test("packets go through the relay while the connection has no path", async () => {
    const { direct: made, relay, other, settle } = direct();
    made.enable(true);
    await settle();
    const [connection] = Connection.all;
    relay.sent = [];
    connection.channel.readyState = "open";
    ["connecting", "connected", "disconnected", "connected"].forEach((state, index) => {
        connection.connectionState = state;
        made.send(other, [index]);
        assert.equal(made.count, state === "connected" ? 1 : 0);
    });
    assert.deepEqual([relay.sent, connection.channel.sent], [[[0], [2]], [[1], [3]]]);
});

test("candidates that arrive before the description are kept", async () => {
    const { direct: made, signal, settle } = direct(3);
    made.enable(true);
    signal({ candidate: "first" });
    signal({ candidate: "wrong" });
    await settle();
    signal({ description: { type: "offer" } });
    signal({ candidate: "during" });
    await settle();
    signal({ candidate: "after" });
    signal({ candidate: "wrong" });
    await settle();
    assert.equal(Connection.all.length, 1);
    const [{ candidates, connectionState, localDescription }] = Connection.all;
    assert.deepEqual([candidates.toSorted(), connectionState, localDescription.type], [["after", "during", "first"], "new", "answer"]);
    made.close();
});

test("a signal that is no signal ends one link, without an error", async () => {
    const { direct: made, relay, settle } = direct();
    made.enable(true);
    await settle();
    const noise = new TextEncoder().encode("lockstep2d signal {");
    relay.onPacket(Uint8Array.of(3), noise);
    await settle();
    assert.deepEqual(Connection.all.map(({ connectionState }) => connectionState), ["new"]);
    relay.onPacket(Uint8Array.of(2), noise);
    await settle();
    assert.deepEqual(Connection.all.map(({ connectionState }) => connectionState), ["closed"]);
});

const texts = (relay) => relay.sent.splice(0).map((bytes) => new TextDecoder().decode(Uint8Array.from(bytes)));

test("links end when they are no longer wanted, and can be wanted again", async () => {
    const { direct: made, relay, other, signal, settle } = direct();
    made.enable(true);
    await settle();
    const [connection] = Connection.all;
    connection.channel.readyState = "open";
    connection.connectionState = "connected";
    assert.equal(made.count, 1);
    relay.sent = [];
    made.enable(false);
    made.send(other, [7]);
    assert.deepEqual([made.count, connection.connectionState, connection.channel.sent], [0, "closed", []]);
    assert.deepEqual(texts(relay), ['lockstep2d signal {"refusal":true}', "\x07"]);
    for (const message of [{ wish: true }, { description: { type: "offer" } }, { candidate: "first" }]) {
        signal(message);
    }
    await settle();
    assert.deepEqual(texts(relay), Array(2).fill('lockstep2d signal {"refusal":true}'));
    assert.equal(Connection.all.length, 1);
    made.enable(true);
    await settle();
    assert.equal(Connection.all.length, 2);
});

test("a refused link can be offered again", async () => {
    const { direct: made, signal, settle } = direct();
    made.enable(true);
    await settle();
    signal({ refusal: true });
    await settle();
    signal({ wish: true });
    await settle();
    assert.deepEqual(Connection.all.map(({ connectionState }) => connectionState), ["closed", "new"]);
});

test("an offer replaces an older link", async () => {
    const { direct: made, signal, settle } = direct(3);
    made.enable(true);
    for (let time = 0; time < 2; time++) {
        signal({ description: { type: "offer" } });
        await settle();
    }
    assert.deepEqual(Connection.all.map(({ connectionState }) => connectionState), ["closed", "new"]);
});
