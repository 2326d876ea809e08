// Replays of worlds that commands change, and of games with rules of their own.
import { byteArray, count, instance, integer, long, onlyKnown, string } from "./check.js";
import { writeConfig } from "./definitions.js";
import { Commands } from "./edits.js";
import { Handle, call, copy, disposable, fieldAt, give, giveText, hashAt, lastText, optionsOf, scratch, sizeOf, statusOf, takeBytes, text, u32, u64, write, writeHash } from "./library.js";
import { Lockstep2dError } from "./error.js";
import { STATUS } from "./layout.js";
import { nextRequest } from "./requests.js";
import { Adopted, World } from "./world.js";

const VERDICTS = ["match", "claim_mismatch", "diverged", "incomplete", "malformed", "limit_exceeded", "unverifiable"];
const RECORDER_OPTIONS = ["rules", "rulesVersion", "players", "tickRate", "inputBytes", "setup", "start", "interval"];
const ENCODER = new TextEncoder();

function verdictAt(at) {
    const field = (name) => fieldAt("verdict", at, name);
    const verdict = { verdict: VERDICTS[u32(field("kind"))], ticks: Number(u64(field("ticks"))), hash: hashAt(field("hash")) };
    return { ...verdict, text: lastText() };
}

/** Opens a file, and returns the handle. */
function openAt(name, bytes, limits) {
    const verdict = 16;
    const limit = verdict + sizeOf("verdict");
    const before = limit + sizeOf("limits");
    const at = give(bytes, before);
    const status = statusOf(name, at + before, bytes.length, limitsAt(at + limit, limits), at, at + verdict);
    if (status !== STATUS.OK) {
        const found = verdictAt(at + verdict);
        throw Object.assign(new Lockstep2dError("RECORD", found.text), { verdict: found });
    }
    return u32(at);
}

/** Writes limits at an address, and returns the address. Without limits, returns 0, which selects the defaults. */
function limitsAt(at, limits) {
    if (limits === undefined) {
        return 0;
    }
    onlyKnown(limits, optionsOf("limits", ["size"]), "`limits`");
    call("ls2d_limits_init", at);
    write("limits", at, limits);
    return at;
}

/** Verifies a replay of a world from any source. */
export function verifyReplay(bytes, limits) {
    const before = sizeOf("verdict") + sizeOf("limits");
    const at = give(bytes, before);
    call("ls2d_replay_verify", at + before, bytes.length, limitsAt(at + sizeOf("verdict"), limits), at);
    return verdictAt(at);
}

/** A world that is recorded while it runs. Only lists of commands change the world. */
export class Recording extends Handle {
    /** Starts from settings and the commands that set up the world. */
    constructor(options) {
        const { config = {}, setup, interval = 60 } = onlyKnown(options, ["config", "setup", "interval"], "a recording");
        instance(setup, Commands, "`setup`");
        const at = scratch(8 + sizeOf("config"));
        call("ls2d_config_init", at + 8);
        writeConfig(at + 8, config);
        call("ls2d_recording_new", at + 8, setup.handle, count(interval, "`interval`"), at);
        super(u32(at));
    }

    /** Executes the commands and advances by one tick. The list is empty afterwards. */
    step(commands) {
        call("ls2d_recording_step", this.handle, instance(commands, Commands, "the list").handle);
    }

    /** A copy of the world. */
    world() {
        const at = scratch(8);
        call("ls2d_recording_world", this.handle, at);
        return new World(new Adopted(u32(at)));
    }

    /** Returns the bytes that were finished since the last call, to be appended to a file. */
    take() {
        const at = scratch(8);
        call("ls2d_recording_take", this.handle, at);
        return takeBytes(u32(at));
    }

    /** Ends the replay and returns the rest of its bytes. */
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

/** Records a game with rules of its own: the final inputs of every tick, and hashes of its states. */
export class Recorder extends Handle {
    /** `start` is the hash of the state before the first tick. */
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

    /** Records the inputs of all players for the next tick, and a bit for each absent player, whose input has to be
     * zeros. Returns whether `checkpoint` has to follow. */
    record(inputs, absent = 0n) {
        const at = give(inputs, 64, "the inputs");
        call("ls2d_recorder_record", this.handle, at + 64, inputs.length, long(absent, "the absent players"), at);
        return u32(at) === 1;
    }

    /** Adds a result, such as a score, before the end. */
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

    /** Ends the replay with the hash of the last state, and returns the rest of its bytes. */
    finish(hash) {
        const at = this.#hash(hash);
        call("ls2d_recorder_finish", this.handle, at, at + 16);
        return takeBytes(u32(at + 16));
    }
}

/** A replay of a game with rules of its own, from any source. The game plays it. */
export class Replay extends Handle {
    #inputs;

    /** Throws an error with the code RECORD, and the `verdict`, if the file cannot be played. */
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

    /** The results that the file states: true if the verdict is a match. */
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

    /** The inputs of all players for the next tick and a bit for each absent player, or undefined at the end. */
    next() {
        const at = scratch(16 + this.#inputs);
        if (!call("ls2d_replay_next", this.handle, at + 16, this.#inputs, at, at + 8)) {
            return undefined;
        }
        return { inputs: copy(at + 16, this.#inputs), absent: u64(at + 8) };
    }

    /** Starts seeking to a tick: `nextRequest` returns the requests. At the first call the game has to be in the state
     * before the first tick. */
    seek(tick) {
        call("ls2d_replay_seek", this.handle, long(tick, "a tick"));
    }

    /** The next request on the way to a tick: `save`, `load`, `advance`, or `checksum`, which `check` answers. */
    nextRequest() {
        return nextRequest("ls2d_replay_next_request", this.handle, this.#inputs);
    }

    /** Sets the interval in ticks at which seeking requests to save the state. */
    setInterval(ticks) {
        call("ls2d_replay_set_interval", this.handle, count(ticks, "the interval"));
    }

    /** Adds a result of the game that was played. The verdict compares all added results with those in the file. */
    claim(name, number) {
        claim("ls2d_replay_claim", this.handle, name, number);
    }

    /** Compares the hash of the game's state with the file. Call it before the first tick and after every tick, or,
     * while seeking, for each request `checksum`. */
    check(hash) {
        const at = scratch(16);
        writeHash(at, hash);
        call("ls2d_replay_check", this.handle, at);
    }

    /** The verdict after the last tick, or after a checkpoint that differs. `hash` is the hash of the current state. */
    verdict(hash) {
        const at = scratch(16 + sizeOf("verdict"));
        writeHash(at, hash);
        call("ls2d_replay_verdict", this.handle, at, at + 16);
        return verdictAt(at + 16);
    }
}

/** Goes to any tick of a replay with a game, which has
 *
 * - `step(inputs, absent)`: advances by a tick with the inputs of all players;
 * - `save()`, `load(saved)`: copies the whole state, restores it; `drop(saved)`, if there is something to free;
 * - `hash()`: the hash of the whole state, 32 hexadecimal digits.
 *
 * The game begins in the state before the first tick. */
export class ReplayDriver {
    #replay;
    #game;
    #saves = new Map();
    #tick = 0;
    #isDisposed = false;

    constructor(replay, game) {
        this.#replay = instance(replay, Replay, "the replay");
        this.#game = game;
    }

    /** Current tick: the game is in the state after this number of ticks. */
    get tick() {
        return this.#tick;
    }

    /** Goes to a tick. If it was played before, this simulates fewer ticks than the interval of the saved states.
     * Throws an error with the code RECORD if the game diverges from the file. The driver then stays at that tick, and
     * earlier ticks can be reached. */
    seek(tick) {
        if (this.#isDisposed) {
            throw new Lockstep2dError("DISPOSED", "this ReplayDriver was disposed");
        }
        this.#replay.seek(tick);
        for (let request = this.#replay.nextRequest(); request !== undefined; request = this.#replay.nextRequest()) {
            this.#answer(request);
        }
    }

    /** Goes forward by a tick, which is always simulated, even if its state is saved. Returns false at the end. */
    step() {
        return this.#by(1);
    }

    /** Goes back by a tick. Returns false at the start. */
    stepBack() {
        return this.#by(-1);
    }

    /** Frees the saved states. The driver cannot be used afterwards. */
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
        switch (kind) {
            case "save":
                this.#saves.set(tick, this.#game.save());
                break;
            case "load":
                this.#game.load(this.#saves.get(tick));
                this.#tick = tick;
                break;
            case "advance":
                this.#game.step(inputs, absent);
                this.#tick = tick + 1;
                break;
            default:
                this.#replay.check(this.#game.hash());
        }
    }
}
disposable(ReplayDriver);

/** Goes to any tick of a replay of a world: tick t is the state after t ticks. */
export class Timeline extends Handle {
    /** Throws an error with the code RECORD, and the `verdict`, if the file cannot be played. */
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

    /** Goes to a tick. This is fast if the tick was played before. */
    seek(tick) {
        call("ls2d_timeline_seek", this.handle, long(tick, "a tick"));
    }

    /** Goes forward by a tick. Returns false at the end. */
    step() {
        return call("ls2d_timeline_step", this.handle);
    }

    /** Goes back by a tick. Returns false at the start. */
    stepBack() {
        return call("ls2d_timeline_step_back", this.handle);
    }

    /** A copy of the world at the current tick, for drawing and queries. */
    world() {
        const at = scratch(8);
        call("ls2d_timeline_world", this.handle, at);
        return new World(new Adopted(u32(at)));
    }
}
