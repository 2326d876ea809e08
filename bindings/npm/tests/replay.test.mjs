// Replays of worlds, and of games whose rules are in JavaScript.
import assert from "node:assert/strict";
import { test } from "node:test";
import { library } from "../src/library.js";
import { L, file } from "./common.mjs";

const join = (...parts) => Uint8Array.from(parts.flatMap((part) => [...part]));

test("a recorded world verifies, and a changed file does not", () => {
    const setup = new L.Commands();
    setup.spawn({ type: "fixed", shapes: [L.box(20, 1)] });
    setup.spawn({ position: [0, 3], shapes: [L.box("0.25", "0.25")] });
    const recording = new L.Recording({ setup, config: { tickRate: 50 } });
    const commands = new L.Commands();
    const parts = [];
    for (let tick = 0; tick < 150; tick++) {
        if (tick % 50 === 10) {
            commands.spawn({ position: [0, 5], shapes: [L.circle("0.5")] });
        }
        recording.step(commands);
        parts.push(recording.take());
    }
    assert.equal(recording.world().tick, 150);
    const last = recording.world().hash();
    const replay = join(...parts, recording.finish());
    assert.deepEqual([L.verifyReplay(replay).verdict, L.verifyReplay(replay).ticks], ["match", 150]);
    assert.equal(L.verifyReplay(replay.slice(0, -20)).verdict, "incomplete");
    const damaged = replay.slice();
    damaged[damaged.length >> 1] ^= 1;
    assert.equal(L.verifyReplay(damaged).verdict, "malformed");
    const limited = L.verifyReplay(replay, { ticks: 100 });
    assert.equal(limited.verdict, "limit_exceeded");
    assert.match(limited.text, /at most 100 are allowed/);
    assert.throws(() => recording.step(commands), { code: "RECORD" });

    const timeline = new L.Timeline(replay);
    assert.deepEqual([timeline.tick, timeline.ticks], [0, 150]);
    const hashes = [];
    do {
        const world = timeline.world();
        hashes.push(world.hash());
        world.dispose();
    } while (timeline.step());
    assert.equal(hashes.length, 151);
    assert.equal(hashes[150], last);
    for (const tick of [70, 69, 149, 0, 150]) {
        timeline.seek(tick);
        assert.deepEqual([timeline.tick, timeline.world().hash()], [tick, hashes[tick]]);
    }
    assert.ok(timeline.stepBack());
    assert.equal(timeline.world().hash(), hashes[149]);
    assert.throws(() => timeline.seek(151), { code: "VALUE" });
    assert.throws(() => new L.Timeline(damaged), (error) => error.code === "RECORD" && error.verdict.verdict === "malformed");
    timeline.dispose();
});

// Sums the inputs of each player and counts the ticks with an absent player.
class Sums {
    sums = [0, 0, 0];
    step(inputs, absent) {
        inputs.forEach((input, player) => (this.sums[player] = (this.sums[player] * 3 + input) >>> 0));
        this.sums[2] += absent === 0n ? 0 : 1;
    }
    hash() {
        return L.hashBytes(new Uint8Array(Uint32Array.from(this.sums).buffer));
    }
    save() {
        return [...this.sums];
    }
    load(saved) {
        this.sums = [...saved];
    }
}

const inputsAt = (tick) => (tick % 50 < 20 ? [Uint8Array.of(tick % 7, 0), 2n] : [Uint8Array.of(tick % 7, tick % 11), 0n]);

function record(ticks) {
    const game = new Sums();
    const recorder = new L.Recorder({ rules: "sums", players: 2, inputBytes: 1, setup: Uint8Array.of(1, 2), start: game.hash() });
    for (let tick = 0; tick < ticks; tick++) {
        const [inputs, absent] = inputsAt(tick);
        const due = recorder.record(inputs, absent);
        game.step(inputs, absent);
        if (due) {
            recorder.checkpoint(game.hash());
        }
    }
    assert.equal(new L.Replay(recorder.soFar(game.hash())).ticks, ticks, "the recording goes on");
    recorder.claim("score", -7);
    recorder.claim("größe", 1n << 62n);
    assert.throws(() => recorder.claim("half", 0.5), { code: "VALUE" });
    assert.throws(() => recorder.claim("score", 1), { code: "VALUE" });
    assert.throws(() => recorder.record(Uint8Array.of(1, 1), 2n), { code: "INPUTS" });
    const whole = recorder.soFar(game.hash());
    assert.deepEqual(recorder.finish(game.hash()), whole);
    return whole;
}

function play(bytes, cheat = () => {}, score = -7) {
    const replay = new L.Replay(bytes);
    const game = new Sums();
    replay.check(game.hash());
    for (let next = replay.next(), tick = 0; next !== undefined; next = replay.next(), tick++) {
        cheat(game, tick);
        game.step(next.inputs, next.absent);
        replay.check(game.hash());
    }
    replay.claim("größe", 1n << 62n);
    replay.claim("score", score);
    return { replay, verdict: replay.verdict(game.hash()) };
}

test("a game with rules in JavaScript records, and its replay verifies", () => {
    const bytes = record(150);
    const { replay, verdict } = play(bytes);
    assert.deepEqual([replay.rules, replay.players, replay.ticks, [...replay.setup]], ["sums", 2, 150, [1, 2]]);
    assert.deepEqual([...replay.claims], [["größe", 1n << 62n], ["score", -7n]]);
    assert.deepEqual([verdict.verdict, verdict.ticks], ["match", 150]);
    assert.equal(play(bytes, undefined, -6).verdict.verdict, "claim_mismatch");
    const other = play(bytes, (game, tick) => tick === 100 && (game.sums[0] += 1)).verdict;
    assert.deepEqual([other.verdict, other.ticks], ["diverged", 120]);
    assert.throws(() => new L.Replay(bytes.slice(0, 30)), { code: "RECORD" });
    assert.throws(() => new L.Replay(file("replays/ragdoll.replay")), (error) => error.verdict.verdict === "unverifiable");
});

test("a game with rules in JavaScript goes to any tick of its replay", () => {
    const states = [new Sums()];
    for (let tick = 0; tick < 300; tick++) {
        const next = new Sums();
        next.load(states[tick].sums);
        next.step(...inputsAt(tick));
        states.push(next);
    }
    const replay = new L.Replay(record(300));
    const game = new Sums();
    let dropped = 0;
    game.drop = () => dropped++;
    const driver = new L.ReplayDriver(replay, game);
    const at = (tick) => assert.deepEqual([driver.tick, game.sums], [tick, states[tick].sums]);
    for (const tick of [70, 300, 69, 180, 181, 0, 299]) {
        driver.seek(tick);
        at(tick);
    }
    assert.ok(driver.step());
    at(300);
    assert.ok(!driver.step());
    assert.ok(driver.stepBack());
    at(299);
    driver.seek(0);
    assert.ok(!driver.stepBack());
    assert.throws(() => driver.seek(301), { code: "VALUE" });
    driver.dispose();
    assert.equal(dropped, 6);

    // After a checkpoint that differs, earlier ticks can still be reached.
    const wrong = new Sums();
    const other = new L.ReplayDriver(new L.Replay(record(300)), wrong);
    other.seek(130);
    wrong.sums[0] ^= 1;
    assert.throws(() => other.seek(200), { code: "RECORD" });
    other.seek(100);
    assert.deepEqual(wrong.sums, states[100].sums);
});

/** Seeks to a tick, and returns whether the driver has arrived there. Checks that the game is at the tick of the
 * driver, even if the seek failed. */
function arrives(driver, game, tick) {
    let error;
    try {
        driver.seek(tick);
    } catch (caught) {
        error = caught;
        assert.match(error.message, /no sprite|the game has failed before/);
    }
    const sound = new Sums();
    for (let played = 0; played < driver.tick; played++) {
        sound.step(...inputsAt(played));
    }
    assert.deepEqual(game.sums, sound.sums);
    assert.ok(error !== undefined || driver.tick === tick);
    return error === undefined;
}

test("a replay that another driver has moved is an error", () => {
    const bytes = record(200);
    for (const tick of [45, 40, 0, 100]) {
        const [replay, game] = [new L.Replay(bytes), new Sums()];
        const first = new L.ReplayDriver(replay, new Sums());
        first.seek(40);
        first.dispose();
        const second = new L.ReplayDriver(replay, game);
        assert.ok(!arrives(second, game, tick), `${tick}`);
        [0, 70, 100].forEach((other) => arrives(second, game, other));
        assert.throws(() => new L.ReplayDriver(replay), { code: "VALUE" });
    }
});

test("a driver is at the tick of its game after the game has failed", () => {
    for (const [name, before, failing] of [["step", 19, 25], ["save", 59, 65], ["hash", 59, 65], ["load", 125, 10]]) {
        const game = new Sums();
        const driver = new L.ReplayDriver(new L.Replay(record(200)), game);
        driver.seek(before);
        game[name] = () => {
            delete game[name];
            throw new Error("no sprite");
        };
        assert.ok(!arrives(driver, game, failing), name);
        [before + 1, before + 5, before + 70].forEach((tick) => arrives(driver, game, tick));
        // Tick 10 can be reached from a state that was saved before the failure.
        assert.ok(arrives(driver, game, 10), name);
    }
});

test("files are opened and refused, although reading them moves the memory", () => {
    const setup = new L.Commands();
    for (let x = 0; x < 2000; x++) {
        setup.spawn({ position: [x, 0], shapes: [L.circle("0.25")] });
    }
    const recording = new L.Recording({ setup, interval: 1 });
    for (let tick = 0; tick < 20; tick++) {
        recording.step(setup);
    }
    const replay = recording.finish();
    const damaged = replay.slice();
    damaged[damaged.length - 10] ^= 1;
    const kept = [];
    let moved = 0;
    for (let attempt = 0; attempt < 20; attempt++) {
        const before = library().memory.buffer;
        assert.throws(() => new L.Timeline(damaged), (error) => error.code === "RECORD" && error.verdict.verdict === "malformed");
        // The timelines are kept, so that the free memory is used up and has to grow.
        kept.push(new L.Timeline(replay));
        assert.equal(kept.at(-1).ticks, 20);
        moved += library().memory.buffer === before ? 0 : 1;
    }
    assert.ok(moved > 0, "the memory has not moved");
    [...kept, recording, setup].forEach((object) => object.dispose());
});

test("the replay of a game with rules of its own is not verified as a world's", () => {
    const recorder = new L.Recorder({ rules: "my game", players: 1, inputBytes: 1, start: new L.World().hash() });
    recorder.record(Uint8Array.of(1));
    const { verdict, text } = L.verifyReplay(recorder.finish(new L.World().hash()));
    assert.equal(verdict, "unverifiable");
    assert.match(text, /"host" stands for rules in the game's own program/);
});
