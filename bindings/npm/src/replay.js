// Replays of worlds, and of games with their own rules.
import { byteArray, count, fail, instance, integer, long, object, onlyKnown, string } from "./check.js";
import { writeConfig } from "./definitions.js";
import { Commands } from "./edits.js";
import {
    Handle, call, copy, disposable, failure, fieldAt, give, giveText, hashAt, lastText, optionsOf, scratch, sizeOf, statusOf,
    takeBytes, text, u32, u64, write, writeHash, writer,
} from "./library.js";
import { Lockstep2dError } from "./error.js";
import { STATUS } from "./layout.js";
import { nextRequest } from "./requests.js";
import { Adopted, World } from "./world.js";

const VERDICTS = ["match", "claim_mismatch", "diverged", "incomplete", "malformed", "limit_exceeded", "unverifiable"];
const RECORDER_OPTIONS = ["rules", "rulesVersion", "players", "tickRate", "inputBytes", "setup", "start", "interval"];
const ENCODER = new TextEncoder();
const STRAYED = "the game has failed before, or the replay was read without this driver";

function verdictAt(at) {
    const field = (name) => fieldAt("verdict", at, name);
    const verdict = { verdict: VERDICTS[u32(field("kind"))], ticks: Number(u64(field("ticks"))), hash: hashAt(field("hash")) };
    return { ...verdict, text: lastText() };
}

function openAt(name, bytes, limits) {
    const verdict = 16;
    const limit = verdict + sizeOf("verdict");
    const before = limit + sizeOf("limits");
    const at = give(bytes, before);
    const status = statusOf(name, at + before, bytes.length, limitsAt(at + limit, limits), at, at + verdict);
    // Other failures, such as EXHAUSTED, write no verdict.
    if (status !== STATUS.OK && status !== STATUS.RECORD) {
        throw failure(status);
    }
    if (status === STATUS.RECORD) {
        const found = verdictAt(at + verdict);
        throw Object.assign(new Lockstep2dError("RECORD", found.text), { verdict: found });
    }
    return u32(at);
}

/** Writes limits and returns their address, or 0 for the defaults. */
const limitsAt = writer((at, limits) => {
    if (limits === undefined) {
        return 0;
    }
    onlyKnown(limits, optionsOf("limits"), "`limits`");
    call("ls2d_limits_init", at);
    write("limits", at, limits);
    return at;
});

export function verifyReplay(bytes, limits) {
    const before = sizeOf("verdict") + sizeOf("limits");
    const at = give(bytes, before);
    call("ls2d_replay_verify", at + before, bytes.length, limitsAt(at + sizeOf("verdict"), limits), at);
    return verdictAt(at);
}

export class Recording extends Handle {
    constructor(options) {
        const { config = {}, setup, interval = 60 } = onlyKnown(options, ["config", "setup", "interval"], "a recording");
        instance(setup, Commands, "`setup`");
        const at = scratch(8 + sizeOf("config"));
        call("ls2d_config_init", at + 8);
        writeConfig(at + 8, config);
        call("ls2d_recording_new", at + 8, setup.handle, count(interval, "`interval`"), at);
        super(u32(at));
    }

    step(commands) {
        call("ls2d_recording_step", this.handle, instance(commands, Commands, "the list").handle);
    }

    world() {
        const at = scratch(8);
        call("ls2d_recording_world", this.handle, at);
        return new World(new Adopted(u32(at)));
    }

    take() {
        const at = scratch(8);
        call("ls2d_recording_take", this.handle, at);
        return takeBytes(u32(at));
    }

    finish() {
        const at = scratch(8);
        call("ls2d_recording_finish", this.handle, at);
        return takeBytes(u32(at));
    }
}

function claim(name, handle, what, number) {
    const [at, length] = giveText(what);
    call(name, handle, at + 64, length, BigInt(integer(number, "a claim", -(1n << 63n), (1n << 63n) - 1n)));
}

export class Recorder extends Handle {
    constructor(options) {
        const { rules, rulesVersion = 1, players, tickRate = 60, inputBytes, setup = new Uint8Array(), start, interval = 60 } =
            onlyKnown(options, RECORDER_OPTIONS, "a recorder");
        Object.entries({ rulesVersion, players, tickRate, inputBytes, interval }).forEach(([field, value]) => count(value, `\`${field}\``));
        byteArray(setup, "`setup`");
        const name = ENCODER.encode(string(rules, "`rules`"));
        const all = new Uint8Array(name.length + setup.length);
        all.set(name);
        all.set(setup, name.length);
        const at = give(all);
        writeHash(at, start, "`start`");
        call("ls2d_recorder_new", at + 64, name.length, rulesVersion, players, tickRate, inputBytes, at + 64 + name.length,
            setup.length, at, interval, at + 16);
        super(u32(at + 16));
    }

    record(inputs, absent = 0n) {
        const at = give(inputs, 64, "the inputs");
        call("ls2d_recorder_record", this.handle, at + 64, inputs.length, long(absent, "the absent players"), at);
        return u32(at) === 1;
    }

    claim(name, number) {
        claim("ls2d_recorder_claim", this.handle, name, number);
    }

    #hash(hash) {
        const at = scratch(24);
        writeHash(at, hash);
        return at;
    }

    checkpoint(hash) {
        call("ls2d_recorder_checkpoint", this.handle, this.#hash(hash));
    }

    take() {
        const at = scratch(8);
        call("ls2d_recorder_take", this.handle, at);
        return takeBytes(u32(at));
    }

    soFar(hash) {
        return this.#ended("ls2d_recorder_so_far", hash);
    }

    finish(hash) {
        return this.#ended("ls2d_recorder_finish", hash);
    }

    #ended(name, hash) {
        const at = this.#hash(hash);
        call(name, this.handle, at, at + 16);
        return takeBytes(u32(at + 16));
    }
}

export class Replay extends Handle {
    #inputs;

    constructor(bytes, limits) {
        super(openAt("ls2d_replay_open", bytes, limits));
        this.#describe();
    }

    #describe() {
        const at = scratch(40);
        call("ls2d_replay_rules", this.handle, at, at + 4, at + 8, at + 12, at + 16, at + 24);
        const name = u32(at);
        [this.rulesVersion, this.players, this.tickRate, this.inputBytes] = [4, 8, 12, 16].map((offset) => u32(at + offset));
        this.ticks = Number(u64(at + 24));
        this.#inputs = this.players * this.inputBytes;
        this.rules = text(takeBytes(name));
        const to = scratch(8);
        call("ls2d_replay_setup", this.handle, to);
        this.setup = takeBytes(u32(to));
    }

    get claims() {
        const claims = new Map();
        for (let index = 0; ; index++) {
            const at = scratch(16);
            if (!call("ls2d_replay_claim_at", this.handle, index, at, at + 8)) {
                return claims;
            }
            const number = BigInt.asIntN(64, u64(at + 8));
            claims.set(text(takeBytes(u32(at))), number);
        }
    }

    next() {
        const at = scratch(16 + this.#inputs);
        if (!call("ls2d_replay_next", this.handle, at + 16, this.#inputs, at, at + 8)) {
            return undefined;
        }
        return { inputs: copy(at + 16, this.#inputs), absent: u64(at + 8) };
    }

    seek(tick) {
        call("ls2d_replay_seek", this.handle, long(tick, "a tick"));
    }

    nextRequest() {
        return nextRequest("ls2d_replay_next_request", this.handle, this.#inputs);
    }

    setInterval(ticks) {
        call("ls2d_replay_set_interval", this.handle, count(ticks, "the interval"));
    }

    claim(name, number) {
        claim("ls2d_replay_claim", this.handle, name, number);
    }

    check(hash) {
        const at = scratch(16);
        writeHash(at, hash);
        call("ls2d_replay_check", this.handle, at);
    }

    verdict(hash) {
        const at = scratch(16 + sizeOf("verdict"));
        writeHash(at, hash);
        call("ls2d_replay_verdict", this.handle, at, at + 16);
        return verdictAt(at + 16);
    }
}

export class ReplayDriver {
    #replay;
    #game;
    #saves = new Map();
    #tick = 0;
    #isDisposed = false;

    constructor(replay, game) {
        this.#replay = instance(replay, Replay, "the replay");
        this.#game = object(game, "the game");
    }

    get tick() {
        return this.#tick;
    }

    seek(tick) {
        if (this.#isDisposed) {
            throw new Lockstep2dError("DISPOSED", "this ReplayDriver was disposed");
        }
        this.#replay.seek(tick);
        for (let request = this.#replay.nextRequest(); request !== undefined; request = this.#replay.nextRequest()) {
            this.#answer(request);
        }
        this.#expect(Number(tick));
    }

    step() {
        return this.#by(1);
    }

    stepBack() {
        return this.#by(-1);
    }

    dispose() {
        this.#saves.forEach((saved) => this.#game.drop?.(saved));
        this.#saves.clear();
        this.#isDisposed = true;
    }

    #by(ticks) {
        const tick = this.#tick + ticks;
        if (tick < 0 || tick > this.#replay.ticks) {
            return false;
        }
        this.seek(tick);
        return true;
    }

    #answer({ kind, tick, inputs, absent }) {
        if (kind === "load") {
            this.#load(tick);
            return;
        }
        this.#expect(tick);
        switch (kind) {
            case "save":
                this.#saves.set(tick, this.#game.save());
                break;
            case "advance":
                this.#game.step(inputs, absent);
                this.#tick = tick + 1;
                break;
            default:
                this.#replay.check(this.#game.hash());
        }
    }

    #load(tick) {
        if (!this.#saves.has(tick)) {
            fail(`the game has not saved tick ${tick}: ${STRAYED}`);
        }
        this.#game.load(this.#saves.get(tick));
        this.#tick = tick;
    }

    // Checks that the game and the replay are at the same tick. They differ if a request moved the replay on, but the
    // game failed to fulfil it, or another driver took the request.
    #expect(tick) {
        if (this.#tick !== tick) {
            fail(`the replay is at tick ${tick}, and the game at tick ${this.#tick}: ${STRAYED}`);
        }
    }
}
disposable(ReplayDriver);

export class Timeline extends Handle {
    constructor(bytes, limits) {
        super(openAt("ls2d_timeline_open", bytes, limits));
        const at = scratch(8);
        call("ls2d_timeline_ticks", this.handle, 0, at);
        this.ticks = Number(u64(at));
    }

    get tick() {
        const at = scratch(8);
        call("ls2d_timeline_ticks", this.handle, at, 0);
        return Number(u64(at));
    }

    seek(tick) {
        call("ls2d_timeline_seek", this.handle, long(tick, "a tick"));
    }

    step() {
        return call("ls2d_timeline_step", this.handle);
    }

    stepBack() {
        return call("ls2d_timeline_step_back", this.handle);
    }

    world() {
        const at = scratch(8);
        call("ls2d_timeline_world", this.handle, at);
        return new World(new Adopted(u32(at)));
    }
}
