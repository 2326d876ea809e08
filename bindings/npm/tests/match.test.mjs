// Peers on a network that drops and delays packets have equal states, even if they join late.
import assert from "node:assert/strict";
import { test } from "node:test";
import { library } from "../src/library.js";
import { L } from "./common.mjs";

const address = (index) => Uint8Array.of(index);

class Push {
    constructor() {
        this.world = new L.World();
        this.world.spawn({ type: "fixed", position: [0, -1], shapes: [L.box(20, 1)] });
        this.boxes = [-2, 0, 2].map((x) => this.world.spawn({ position: [x, 1], shapes: [L.box("0.5", "0.5")] }));
        this.played = 0;
    }
    step(inputs) {
        inputs.forEach((input, seat) => {
            const { position } = this.world.body(this.boxes[seat]);
            this.world.applyImpulse(this.boxes[seat], [(input & 1) - ((input >> 1) & 1), (input >> 2) & 1], position);
        });
        this.world.step();
        this.played++;
    }
    save() {
        return this.world.save();
    }
    load(saved) {
        this.world.restore(saved);
    }
    drop(saved) {
        saved.dispose();
    }
    hash() {
        return this.world.hash();
    }
    encode() {
        return this.world.toBytes();
    }
    decode(bytes) {
        const world = L.World.fromBytes(bytes);
        this.world.dispose();
        this.world = world;
    }
}

class Net {
    now = 0;
    latency = 20;
    peers = [];
    flying = [];
    random = new L.Random(3);

    add(options) {
        const index = this.peers.length;
        const match = new L.Match({ seats: 3, tickRate: 60, guess: 8, peer: index + 1, key: BigInt(index + 1), ...options });
        const send = (to, packet) => {
            if (this.failure !== undefined) {
                throw this.failure;
            }
            if (this.random.below(100) >= 5) {
                this.flying.push({ at: this.now + this.latency + this.random.below(40), from: index, to: to[0], packet });
            }
        };
        const game = new Push();
        const peer = { driver: new L.MatchDriver(match, game, send), game, events: [], match, index };
        this.peers.push(peer);
        return peer;
    }

    run(milliseconds) {
        for (const end = this.now + milliseconds; this.now < end; this.now += 4) {
            const arrived = this.flying.filter(({ at }) => at <= this.now);
            this.flying = this.flying.filter(({ at }) => at > this.now);
            for (const { from, to, packet } of arrived) {
                this.peers[to].driver.receive(this.now, address(from), packet);
            }
            for (const peer of this.peers) {
                const input = () => Uint8Array.of(((this.now >> 7) + peer.index * 3) % 8);
                peer.events.push(...peer.driver.update(this.now, peer.input ?? input));
            }
        }
    }
}

test("two peers and one who joins late have equal states", () => {
    const net = new Net();
    const offer = new TextEncoder().encode(`push 1, semantics ${L.semantics()}`);
    const host = net.add({ offer, ownSeats: 1, startWith: 2 });
    const guest = net.add({ offer, ownSeats: 1, contact: address(0) });
    net.run(3000);
    assert.deepEqual([host.match.status, guest.match.status], ["playing", "playing"]);
    assert.ok(host.driver.tick > 100, `${host.driver.tick} ticks`);
    const { ping, loss, delay } = host.match.link(2);
    assert.ok(ping > 40 && ping < 160 && loss >= 0 && loss < 0.4 && Number.isInteger(delay), `${ping} ms, ${loss}, ${delay}`);
    assert.equal(host.match.link(77), undefined);
    const late = net.add({ offer, ownSeats: 1, contact: address(1) });
    net.run(3000);
    assert.equal(late.match.status, "playing");
    assert.ok(late.events.some(({ kind, tick }) => kind === "state" && tick > 0), "it began in the middle");
    host.match.endAt(400);
    net.run(4000);
    const peers = [host, guest, late];
    assert.deepEqual(peers.map(({ driver }) => driver.tick), [400, 400, 400]);
    const [hash] = peers.map(({ game }) => game.hash());
    assert.deepEqual(peers.map(({ game }) => game.hash()), [hash, hash, hash]);
    assert.ok(peers.every(({ events }) => events.every(({ kind }) => kind !== "desync")));
    assert.ok(host.game.played > 400, "some ticks were guessed wrongly and played again");
});

test("an oversized packet takes no memory", () => {
    const match = new L.Match({ seats: 2 });
    const size = () => library().memory.buffer.byteLength;
    const before = size();
    match.receive(0, address(1), new Uint8Array(1 << 25));
    assert.equal(size(), before);
    assert.throws(() => match.receive(0, address(1), "packet"), { code: "VALUE" });
});

test("each result of `readInputs` counts for one tick, while the input delay grows and shrinks", () => {
    const net = new Net();
    const [host] = [net.add({ startWith: 2, guess: 0 }), net.add({ guess: 0, contact: address(0) })];
    let read = 0;
    const played = [];
    host.input = () => Uint8Array.of(read++ % 256);
    host.game.step = (inputs) => played.push(inputs[0]);
    for (const latency of [20, 150, 20, 150, 20]) {
        net.latency = latency;
        net.run(6000);
    }
    assert.ok(played.length > 600, `${played.length} ticks`);
    assert.deepEqual(played, played.map((_, tick) => tick % 256));
});

test("a peer with another offer is refused", () => {
    const net = new Net();
    net.add({ offer: Uint8Array.of(1), startWith: 2 });
    const other = net.add({ offer: Uint8Array.of(2), contact: address(0) });
    net.run(2000);
    assert.ok(other.events.some(({ kind, reason }) => kind === "refused" && reason === "offer"));
    assert.equal(other.match.status, "connecting");
    assert.throws(() => other.match.link(1), { code: "NOT_IN_MATCH" });
});

test("a state that differs is noticed", () => {
    const net = new Net();
    const host = net.add({ startWith: 2 });
    const guest = net.add({ contact: address(0) });
    net.run(2000);
    guest.game.world.setGravity([0, -9]);
    net.run(2000);
    assert.ok([...host.events, ...guest.events].some(({ kind }) => kind === "desync"));
});

test("options of a match are checked", () => {
    for (const wrong of [
        undefined, { seats: "2" }, { seats: -1 }, { seats: 2, offer: "sumo" }, { seats: 2, contact: "host" }, { seats: 2, rollback: 8 },
        { seats: 2, peer: -1 }, { seats: 2, patience: -5 }, { seats: 2, tickRate: 15.5 }, { seats: 2, secret: [1n] },
    ]) {
        assert.throws(() => new L.Match(wrong), { code: "VALUE" }, JSON.stringify(wrong, (_, value) => (typeof value === "bigint" ? `${value}` : value)));
    }
    assert.throws(() => new L.Match({ seats: 2, ownSeats: 3 }), { code: "VALUE", message: /`ownSeats`/ });
    assert.throws(() => new L.Match({ seats: 2, inputBytes: 70_000 }), { code: "VALUE", message: /`inputBytes`/ });
    assert.throws(() => new L.Match({ seats: 2, guess: 70_000 }), { code: "VALUE", message: /`guess`/ });
    const match = new L.Match({ seats: 2 });
    for (const [game, send] of [[undefined, () => {}], [{}, undefined]]) {
        assert.throws(() => new L.MatchDriver(match, game, send), { code: "VALUE" });
    }
    for (const wrong of [-1, 0.5, NaN, "x"]) {
        assert.throws(() => match.endAt(wrong), { code: "VALUE" });
        assert.throws(() => match.setGuess(wrong), { code: "VALUE" });
    }
    for (const wrong of [-1, NaN, "x", undefined]) {
        assert.throws(() => match.update(wrong), { code: "VALUE" });
    }
});

test("a peer with other parameters is refused", () => {
    for (const differs of [{ seats: 2 }, { inputBytes: 2 }, { tickRate: 30 }, { patience: 3000 }]) {
        const net = new Net();
        const host = net.add({ startWith: 2 });
        const other = net.add({ contact: address(0), ...differs });
        net.run(1000);
        assert.ok(other.events.some(({ reason }) => reason === "offer"), JSON.stringify(differs));
        assert.deepEqual([host.match.status, other.match.status], ["waiting", "connecting"]);
    }
});

test("the offer of a native match is checked", () => {
    const good = { rules: "push", seats: 2 };
    for (const wrong of [
        undefined, null, { seats: 2 }, { rules: "push" }, { ...good, seats: "two" }, { ...good, seats: 2.9 }, { ...good, seats: 65 },
        { ...good, inputBytes: 65537 }, { ...good, rulesversion: 7 }, { ...good, patience: NaN }, { ...good, setup: "x" },
        { ...good, tickRate: 0 }, { ...good, rulesVersion: -1 },
    ]) {
        assert.throws(() => L.nativeOffer(wrong), { code: "VALUE" }, JSON.stringify(wrong));
    }
    assert.equal(L.nativeOffer(good).length, 54);
    for (const call of [() => L.encodeNativeState(), () => L.decodeNativeState(), () => L.decodeNativeState(new Uint8Array(3))]) {
        assert.throws(call, { name: "Lockstep2dError" }, String(call));
    }
});

test("an error of the game stops the driver", () => {
    let isBroken = false;
    const game = { step: () => { if (isBroken) throw new Error("the rules failed"); }, save: () => 0, load: () => {}, hash: () => "0".repeat(32) };
    const driver = new L.MatchDriver(new L.Match({ seats: 1 }), game, () => {});
    const inputs = () => Uint8Array.of(0);
    for (let now = 0; now < 500; now += 10) driver.update(now, inputs);
    assert.ok(driver.tick > 10);
    isBroken = true;
    assert.throws(() => { for (let now = 500; now < 600; now += 10) driver.update(now, inputs); }, /the rules failed/);
    const { tick } = driver;
    isBroken = false;
    assert.throws(() => driver.update(700, inputs), /the rules failed/);
    assert.equal(driver.tick, tick);
});

test("a packet is lost if it cannot be sent", () => {
    const net = new Net();
    const host = net.add({ startWith: 2 });
    const guest = net.add({ contact: address(0) });
    net.run(1000);
    const { tick } = host.driver;
    // RTCDataChannel.send throws this error if the other page was closed.
    net.failure = new DOMException("the channel is closed", "InvalidStateError");
    net.run(100);
    assert.equal(host.driver.sendError, net.failure);
    net.failure = undefined;
    net.run(1000);
    assert.ok([host, guest].every(({ driver }) => driver.tick > tick + 40), `${host.driver.tick} ticks, from ${tick}`);
    assert.deepEqual([host.match.status, guest.match.status], ["playing", "playing"]);
});

test("a match goes on after an error of the inputs, without a loss of events", () => {
    const game = { step: () => {}, save: () => 0, load: () => {}, hash: () => "0".repeat(32) };
    const driver = new L.MatchDriver(new L.Match({ seats: 1 }), game, () => {});
    const broken = () => { throw new Error("no gamepad"); };
    for (const wrong of [broken, () => [0], () => new Uint8Array(2), () => undefined]) {
        assert.throws(() => { for (let now = 0; now < 100; now += 10) driver.update(now, wrong); });
    }
    assert.equal(driver.tick, 0);
    const events = [];
    for (let now = 100; now < 300; now += 10) events.push(...driver.update(now, () => Uint8Array.of(0)));
    assert.ok(driver.tick > 10, `${driver.tick} ticks`);
    assert.ok(events.some(({ status }) => status === "playing"), "an event of the update that failed");
});

test("a match ends for the game when it has played all ticks", () => {
    const game = { step: () => {}, save: () => 0, load: () => {}, hash: () => "0".repeat(32) };
    const match = new L.Match({ seats: 1 });
    const driver = new L.MatchDriver(match, game, () => {});
    match.endAt(30);
    assert.equal(driver.ended, false);
    for (let now = 0; now < 5000 && !driver.ended; now += 10) driver.update(now, () => Uint8Array.of(0));
    assert.ok(driver.ended);
    assert.equal(driver.tick, 30);
});

test("after the end of a match, a driver joins another one", () => {
    const net = new Net();
    const [host, guest] = [net.add({ startWith: 1 }), net.add({ ownSeats: 0, contact: address(0) })];
    host.match.endAt(60);
    net.run(6000);
    assert.deepEqual([host, guest].map(({ driver }) => driver.ended), [true, true]);
    const [other] = [net.add({ startWith: 2 }), net.add({ contact: address(2) })];
    net.run(1000);
    guest.match.ask(address(2));
    assert.deepEqual([guest.match.status, guest.driver.ended], ["connecting", false]);
    net.run(2000);
    assert.deepEqual([guest.match.status, guest.driver.ended], ["watching", false]);
    const { tick } = guest.driver;
    assert.ok(tick > 60 && Math.abs(tick - other.driver.tick) < 20, `${tick} ticks, and ${other.driver.tick}`);
    // After some updates, the spectator has played all final ticks, but `ended` stays false, because the match goes on.
    let isLevel = false;
    for (let i = 0; i < 250; i++) {
        net.run(4);
        isLevel ||= guest.driver.tick === guest.match.ticks().final;
        assert.equal(guest.driver.ended, false);
    }
    assert.ok(isLevel);
    other.match.endAt(other.driver.tick + 200);
    net.run(8000);
    assert.deepEqual([guest.driver.ended, guest.driver.tick], [true, other.driver.tick]);
    assert.equal(guest.game.hash(), other.game.hash());
});

test("only a finished match has ended, also once it is closed", () => {
    const net = new Net();
    const host = net.add({ startWith: 2 });
    net.add({ contact: address(0) });
    net.run(500);
    const spectators = Array.from({ length: 4 }, () => net.add({ ownSeats: 0, contact: address(0) }));
    net.run(2000);
    spectators.forEach(({ match }) => {
        match.leave();
        net.run(16);
    });
    host.match.endAt(300);
    net.run(16_000);
    // Some spectators have played all final ticks that they know of. They have not ended, because they left before the
    // match was finished.
    assert.ok(spectators.some(({ driver, match }) => driver.tick === match.ticks().final));
    assert.deepEqual([host.match.status, host.driver.tick, host.driver.ended], ["closed", 300, true]);
    assert.deepEqual(spectators.map(({ driver, match }) => [match.status, driver.ended]), spectators.map(() => ["closed", false]));
});

test("while a player requests a pause, all wait and keep their seats", () => {
    const net = new Net();
    const host = net.add({ startWith: 2 });
    const guest = net.add({ contact: address(0) });
    const both = [host, guest];
    const ticks = () => both.map(({ driver }) => driver.tick);
    const paused = () => both.map(({ driver }) => driver.isPaused);
    net.run(2000);
    host.driver.pause(true);
    net.run(200);
    assert.deepEqual(paused(), [true, true]);
    const before = ticks();
    guest.input = () => assert.fail("no inputs are read during a pause");
    // The pause is longer than the patience. Both players open their menus, and close them one after the other.
    net.run(3000);
    guest.driver.pause(true);
    net.run(200);
    host.driver.pause(false);
    net.run(3000);
    assert.deepEqual([paused(), ticks()], [[true, true], before]);
    const late = net.add({ ownSeats: 0, contact: address(0) });
    net.run(1000);
    assert.deepEqual([late.match.status, late.driver.isPaused], ["watching", true]);
    guest.input = undefined;
    guest.driver.pause(false);
    net.run(1000);
    assert.deepEqual([paused(), both.map(({ match }) => match.status)], [[false, false], ["playing", "playing"]]);
    ticks().forEach((tick, index) => {
        const played = tick - before[index];
        assert.ok(played > 30 && played < 75, `${played} ticks in a second: play does not catch up`);
    });
    assert.deepEqual(guest.events.filter(({ kind }) => kind === "pause").map(({ peer, value }) => [peer, value]), [[1, 1], [1, 0]]);
    assert.ok(both.every(({ events }) => events.every(({ kind }) => kind !== "unseated" && kind !== "desync")));
    // A player that leaves during its own pause withdraws its request.
    guest.driver.pause(true);
    net.run(200);
    const { tick } = host.driver;
    guest.match.leave();
    net.run(4000);
    assert.deepEqual([host.driver.isPaused, guest.match.status], [false, "closed"]);
    assert.ok(host.driver.tick > tick + 60);
});

test("a pause that is requested while a peer joins begins when it plays", () => {
    const net = new Net();
    const host = net.add({ startWith: 2 });
    const guest = net.add({ contact: address(0) });
    assert.equal(guest.match.status, "connecting");
    guest.driver.pause(true);
    assert.equal(guest.driver.isPaused, true);
    net.run(2000);
    assert.deepEqual([host.driver.isPaused, host.match.status, guest.driver.tick], [true, "playing", 0]);
    guest.driver.pause(false);
    net.run(1000);
    assert.deepEqual([host.driver.isPaused, guest.driver.isPaused], [false, false]);
    assert.ok(guest.driver.tick > 30);
    assert.throws(() => guest.driver.pause(), { code: "VALUE" });
});

test("a pause that is requested while a peer joins a running match begins when it has a seat", () => {
    const net = new Net();
    const host = net.add({ startWith: 1 });
    net.run(4000);
    const guest = net.add({ contact: address(0) });
    const spectator = net.add({ ownSeats: 0, contact: address(0) });
    guest.driver.pause(true);
    net.run(4000);
    assert.deepEqual([guest.match.status, guest.match.seats.length, host.driver.isPaused], ["playing", 1, true]);
    guest.driver.pause(false);
    spectator.driver.pause(true);
    net.run(1000);
    // The request of a spectator stops nobody.
    assert.deepEqual([host.driver.isPaused, spectator.driver.isPaused], [false, false]);
    assert.ok(spectator.driver.tick > host.driver.tick - 20);
});

test("a pause in the last ticks does not keep a match from its end", () => {
    const net = new Net();
    const options = { guess: 0, delayMin: 20, delayMax: 30 };
    const both = [net.add({ startWith: 2, ...options }), net.add({ contact: address(0), ...options })];
    both[0].match.endAt(300);
    while (both[0].driver.tick < 290) net.run(4);
    both[0].driver.pause(true);
    net.run(5000);
    assert.deepEqual(both.map(({ driver }) => [driver.tick, driver.ended, driver.isPaused]), [[300, true, false], [300, true, false]]);
});
