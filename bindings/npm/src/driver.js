// A driver that plays a game in a match.
import { callable, fail, flag, given, instance, micros, object, onlyKnown } from "./check.js";
import { Lockstep2dError } from "./error.js";
import { disposable } from "./library.js";
import { Match } from "./match.js";

// A time that lies at most this many milliseconds before an earlier time is not an error: the timestamp of a frame or
// an event may be a little less than an earlier result of `performance.now()`.
const BACK_MAX = 1000;
// A contact that does not answer for this time in milliseconds, or does not admit this peer, is replaced by the next.
const CONTACT_PATIENCE = 2000;

export class MatchDriver {
    #match;
    #game;
    #send;
    #saves = new Map();
    #tick = 0;
    #events = [];
    #isFinished = false;
    #failure;
    #sendError;
    // Inputs that were read but not issued. They are passed again, so that each key press counts exactly once.
    #unissued;
    // Largest time passed so far, in milliseconds.
    #latest = 0;
    #isDisposed = false;
    // `#pauses`: whether this peer requests a pause. `#pausing`: the other peers that request one.
    #pauses = false;
    #pausing = new Set();
    // Returns the addresses of possible contacts. The first one is the contact of the constructor of `Match`.
    #contacts;
    #turn = 0;
    // Times of the last request by `#seek`, and of the last packet.
    #asked = -Infinity;
    #heard;
    // Whether the contact refuses this peer, or this peer is too far behind to go on.
    #isStranded = false;

    constructor(match, game, send, options = {}) {
        this.#match = instance(match, Match, "the match");
        this.#game = object(game, "the game");
        this.#send = callable(send, "`send`");
        const { contacts } = onlyKnown(options, ["contacts"], "a driver");
        this.#contacts = contacts === undefined ? undefined : callable(contacts, "`contacts`");
        this.#keep(0);
    }

    get match() {
        return this.#match;
    }

    get tick() {
        return this.#tick;
    }

    get ended() {
        // After `ask`, there is no match until the state arrives, and `ticks` would throw.
        return this.#isFinished && this.#match.status !== "connecting" && this.#tick === this.#match.ticks().final;
    }

    get sendError() {
        return this.#sendError;
    }

    get isPaused() {
        // Once all inputs are final, requests for a pause no longer count. Otherwise a player who closes the page
        // during a pause would keep the other players from playing the last ticks.
        return !this.#isFinished && ((this.#pauses && this.#mayHaveSeat()) || this.#pausing.size > 0);
    }

    pause(paused) {
        this.#check();
        this.#pauses = flag(given(paused, "`paused`"), "`paused`");
        // A peer that is still joining passes its request when it has received the state.
        if (this.#match.status !== "connecting") {
            this.#match.pause(paused);
        }
    }

    dispose() {
        this.#forget(() => true);
        this.#isDisposed = true;
    }

    receive(now, from, packet) {
        this.#check();
        this.#time(now);
        this.#heard = now;
        this.#match.receive(now, from, packet);
    }

    update(now, readInputs) {
        this.#check();
        callable(readInputs, "`readInputs`");
        if (this.#failure !== undefined) {
            throw this.#failure.error;
        }
        this.#time(now);
        let missing;
        try {
            missing = this.#update(now, readInputs);
        } catch (error) {
            this.#failure = { error };
            throw error;
        }
        if (missing !== undefined) {
            throw missing.error;
        }
        return this.#events.splice(0);
    }

    // A peer that joins a running match gets its seat after it has caught up. Until then, its own request for a pause
    // does not count, because a paused peer could not catch up.
    #mayHaveSeat() {
        return this.#match.status === "connecting" || this.#match.seats.length > 0;
    }

    #check() {
        if (this.#isDisposed) {
            throw new Lockstep2dError("DISPOSED", "this MatchDriver was disposed");
        }
    }

    // Checks a time before it is passed to the match. A time that is only a little earlier than before is not an error:
    // the time of the match never decreases.
    #time(now) {
        micros(now, "the time");
        if (now < this.#latest - BACK_MAX) {
            fail(`the time is ${now} ms, and was ${this.#latest} ms before: it must not decrease`);
        }
        this.#latest = Math.max(this.#latest, now);
    }

    #update(now, readInputs) {
        this.#match.update(now);
        for (let event = this.#match.nextEvent(); event !== undefined; event = this.#match.nextEvent()) {
            if (event.kind === "state") {
                this.#resume(event.tick, event.state);
            }
            if (event.kind === "pause") {
                event.value === 1 ? this.#pausing.add(event.peer) : this.#pausing.delete(event.peer);
            }
            this.#isFinished ||= event.status === "finished";
            this.#isStranded ||= event.kind === "refused" || event.kind === "tooFarBehind";
            this.#events.push(event);
        }
        this.#fulfil();
        const missing = this.#play(now, readInputs);
        if (this.#match.wantsState) {
            this.#offer();
        }
        this.#transmit();
        this.#seek(now);
        return missing;
    }

    // Asks the next contact if the last one does not answer or does not admit this peer, or if this peer is so far
    // behind that it has to join again.
    #seek(now) {
        this.#heard ??= now;
        const isSilent = this.#match.status === "connecting" && now - Math.max(this.#heard, this.#asked) >= CONTACT_PATIENCE;
        if (!(isSilent || (this.#isStranded && now - this.#asked >= CONTACT_PATIENCE))) {
            return;
        }
        const others = this.#contacts?.() ?? [];
        if (others.length > 0) {
            this.#turn++;
            this.#asked = now;
            this.#isStranded = false;
            this.#match.ask(others[this.#turn % others.length]);
        }
    }

    // Plays the ticks that are due. Returns errors of `readInputs` and of wrong inputs instead of throwing them: no
    // inputs were issued, so the match can continue with the next inputs.
    #play(now, readInputs) {
        while (!this.isPaused && this.#match.isDue(now)) {
            const { seats, inputBytes } = this.#match;
            let issued;
            try {
                if (this.#unissued?.length !== seats.length * inputBytes) {
                    this.#unissued = seats.length === 0 ? new Uint8Array() : readInputs(seats);
                }
                issued = this.#match.advance(now, this.#unissued);
            } catch (error) {
                this.#unissued = undefined;
                return { error };
            }
            if (issued) {
                this.#unissued = undefined;
            }
            const before = this.#tick;
            this.#fulfil();
            if (!issued && this.#tick === before) {
                break;
            }
        }
        return undefined;
    }

    // An error of `send` is stored, and the packet counts as lost in the network: `send` of a data channel, for
    // example, throws if the other page is gone.
    #transmit() {
        for (let sent = this.#match.nextPacket(); sent !== undefined; sent = this.#match.nextPacket()) {
            try {
                this.#send(sent.to, sent.packet);
            } catch (error) {
                this.#sendError = error;
            }
        }
    }

    #keep(tick) {
        this.#forget((kept) => kept === tick);
        this.#saves.set(tick, { saved: this.#game.save(), hash: this.#game.hash() });
    }

    #forget(condition) {
        for (const [tick, { saved }] of this.#saves) {
            if (condition(tick)) {
                this.#game.drop?.(saved);
                this.#saves.delete(tick);
            }
        }
    }

    #resume(tick, state) {
        this.#game.decode(state);
        this.#isFinished = false;
        this.#isStranded = false;
        this.#tick = tick;
        this.#forget(() => true);
        this.#keep(tick);
        // Requests of an earlier match of this peer do not count in this match.
        this.#pausing.clear();
        this.#match.pause(this.#pauses);
    }

    #fulfil() {
        for (let request = this.#match.nextRequest(); request !== undefined; request = this.#match.nextRequest()) {
            this.#answer(request);
        }
    }

    #answer({ kind, tick, inputs, absent }) {
        switch (kind) {
            case "save":
                this.#keep(tick);
                break;
            case "load":
                this.#game.load(this.#saved(tick).saved);
                this.#forget((kept) => kept > tick);
                this.#tick = tick;
                break;
            case "advance":
                this.#game.step(inputs, absent);
                this.#tick = tick + 1;
                break;
            case "checksum":
                this.#match.reportHash(tick, this.#saved(tick).hash);
                break;
            default:
                // Keeps the newest state up to this tick, for peers that join.
                this.#forgetBefore(tick);
        }
    }

    #forgetBefore(tick) {
        const newest = Math.max(-1, ...[...this.#saves.keys()].filter((kept) => kept <= tick));
        this.#forget((kept) => kept < Math.min(newest, tick));
    }

    #saved(tick) {
        const found = this.#saves.get(tick);
        if (found === undefined) {
            throw new Lockstep2dError("VALUE", `there is no state of tick ${tick}`);
        }
        return found;
    }

    // Offers the newest final state as bytes, and then restores the current state of the game.
    #offer() {
        const { confirmed } = this.#match.ticks();
        const tick = Math.max(-1, ...[...this.#saves.keys()].filter((kept) => kept <= confirmed));
        if (tick < 0) {
            return;
        }
        const now = this.#game.save();
        this.#game.load(this.#saves.get(tick).saved);
        const state = this.#game.encode();
        this.#game.load(now);
        this.#game.drop?.(now);
        this.#match.offerState(tick, state);
    }
}
disposable(MatchDriver);
