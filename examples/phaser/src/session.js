// A match: with both players at this keyboard, or through a relay. It knows nothing of Phaser.
import { Match, MatchDriver, Relay, nativeOffer } from "lockstep2d";
import { Recording } from "./replay.js";
import { Game, RULES, SEATS } from "./rules.js";

const TICK = 1000 / 60;

/** The game of this page, with additional data for drawing that is not part of the state. */
class Shown extends Game {
    /** Poses of the bodies before the last tick, to interpolate between ticks. */
    before = new Float64Array();
    /** Time in ms at which the last tick was played (`performance.now()`). */
    time = 0;
    /** Effects, points and hash by tick. A tick that is played again after a rollback replaces its earlier entry. */
    log = new Map();

    step(inputs) {
        this.before = this.world.poses();
        super.step(inputs);
        this.time = performance.now();
        this.log.set(this.world.tick, { effects: this.effects, points: this.points.slice(), hash: this.hash() });
    }
}

// Returns the identity of this page in a room. It is kept in the session storage, so that the page gets its seat back
// after a reload.
function identity(room) {
    const name = `seesaw ${room}`;
    const stored = sessionStorage.getItem(name);
    const bytes = stored ? Uint8Array.from(stored.split(",").map(Number)) : crypto.getRandomValues(new Uint8Array(24));
    sessionStorage.setItem(name, bytes.join(","));
    return { secret: bytes.slice(0, 16), key: new DataView(bytes.buffer).getBigUint64(16) };
}

export class Session {
    /** Reads the input of a seat. Each result counts for one tick. */
    readPad = () => 0;
    /** Called once for each confirmed tick, with its effects and the points. No rollback can undo these ticks. */
    onTick = () => {};
    game = new Shown();
    /** Undefined if this page has joined a match that had already begun, and so lacks the inputs of its first ticks. */
    recording = new Recording(this.game);
    error = "";
    #confirmed = 0;
    #now = 0;
    #last = performance.now();

    /** A match of two players in this page: one peer has both seats, and no packets are sent. */
    static local() {
        return new Session({ ownSeats: SEATS });
    }

    /** A match through a relay. The first page in the room opens the match, the second joins it. */
    static async online(url, room) {
        const { secret, key } = identity(room);
        const relay = await Relay.connect(url, room, { secret });
        // The page plays up to 8 ticks with guessed inputs of the other player, and corrects them by rollback.
        return new Session({ key, guess: 8, delayMin: 1, contact: relay.others[0] }, relay, room);
    }

    constructor(options, relay, room) {
        this.relay = relay;
        this.room = room;
        this.match = new Match({ seats: SEATS, offer: nativeOffer({ rules: RULES, seats: SEATS }), ...options });
        const contacts = () => relay?.others ?? [];
        this.driver = new MatchDriver(this.match, this.game, (to, packet) => relay?.send(to, packet), { contacts });
        if (relay) {
            // Packets drive the match too, because browsers slow down timers in the background.
            relay.onPacket = (from, packet) => {
                this.driver.receive(this.#clock(), from, packet);
                this.#update();
            };
        }
        // A timer drives the match. The loop of Phaser stops while the page is in the background, and the other player
        // would have to wait.
        this.timer = setInterval(() => this.#update(), 4);
    }

    /** The part of the time between two ticks that has passed, from 0 to 1, for interpolation. */
    get alpha() {
        return Math.min((performance.now() - this.game.time) / TICK, 1);
    }

    get status() {
        return this.match.status;
    }

    leave() {
        this.status === "connecting" ? this.#close() : this.match.leave();
    }

    // The time of the match in ms. Between two calls, a match without a relay advances by at most 100 ms, so it almost
    // stops while the page is in the background, where the browser calls the timer only once a second.
    #clock() {
        const now = performance.now();
        const passed = now - this.#last;
        this.#last = now;
        this.#now += this.relay ? passed : Math.min(passed, 100);
        return this.#now;
    }

    #update() {
        if (this.timer === undefined) {
            return;
        }
        const readInputs = (seats) => Uint8Array.from(seats, (seat) => this.readPad(seat));
        const events = this.driver.update(this.#clock(), readInputs);
        for (const { kind, tick, reason } of events) {
            if (kind === "desync") {
                this.error = `the states differ after ${tick} ticks`;
            } else if (kind === "refused" && reason !== "notReady") {
                // The driver asks another member, which may let this page join.
                this.error = `refused: ${reason}`;
            } else if (kind === "state" && tick === 0) {
                this.error = "";
            } else if (kind === "state") {
                this.error = "";
                // The page has joined a match that had already begun. It lacks the inputs of the first ticks, so it
                // cannot record a replay.
                this.recording = undefined;
                this.#confirmed = tick;
            }
        }
        this.status === "connecting" || this.#confirm();
        this.status === "closed" && this.#close();
    }

    #confirm() {
        for (const { confirmed } = this.match.ticks(); this.#confirmed < confirmed; this.#confirmed++) {
            const entry = this.game.log.get(this.#confirmed + 1);
            this.game.log.delete(this.#confirmed + 1);
            this.recording?.add(this.match.finalInputs(this.#confirmed), entry.hash, entry.points);
            this.onTick(entry);
        }
    }

    #close() {
        clearInterval(this.timer);
        this.timer = undefined;
        this.relay?.close();
    }
}
