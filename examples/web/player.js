// One player of a match through a relay.
import { Match, MatchDriver, Relay } from "lockstep2d";
import { Direct } from "./direct.js";
import { Game, SEATS, offer } from "./game.js";
import { MatchRecording } from "./recording.js";

// Returns the identity of this page in a room. It is kept in the session storage, so that the page gets its seat back
// after a reload. But if the page that opened a match of two players is reloaded, the match pauses for good: the other
// player alone has no majority and cannot give the seat back.
function identity(code) {
    const name = `lockstep2d ${code.toUpperCase()}`;
    const stored = sessionStorage.getItem(name);
    const bytes = stored ? Uint8Array.from(stored.split(",").map(Number)) : crypto.getRandomValues(new Uint8Array(24));
    sessionStorage.setItem(name, bytes.join(","));
    return { secret: bytes.slice(0, 16), key: new DataView(bytes.buffer).getBigUint64(16) };
}

export class Player {
    desyncs = 0;
    // Why the others do not let this player join; undefined if they do.
    refusal;
    isOver = false;
    #input;

    /** Opens a match if the room is empty, otherwise joins. `input` returns the bits of the held keys for a tick. */
    static async enter(url, code, input) {
        const { secret, key } = identity(code);
        const relay = await Relay.connect(url, code, { secret });
        return new Player(relay, key, input);
    }

    constructor(relay, key, input) {
        this.#input = input;
        this.relay = relay;
        this.game = new Game();
        this.recording = new MatchRecording();
        this.direct = new Direct(relay);
        this.match = new Match({ seats: SEATS, guess: 8, delayMin: 1, key, offer: offer(), contact: relay.others[0] });
        const contacts = () => relay.others;
        this.driver = new MatchDriver(this.match, this.game, (to, packet) => this.direct.send(to, packet), { contacts });
        // Packets also drive the match, because browsers slow down timers in the background.
        this.direct.onPacket = (from, packet) => {
            this.driver.receive(performance.now(), from, packet);
            this.update();
        };
        this.timer = setInterval(() => this.update(), 4);
    }

    set guess(ticks) {
        this.match.status === "connecting" || this.match.setGuess(ticks);
    }

    update() {
        const input = (seats) => Uint8Array.from(seats, () => this.#input());
        const events = this.driver.update(performance.now(), input);
        this.desyncs += events.filter(({ kind }) => kind === "desync").length;
        // The driver asks another member, which may let this player join.
        this.refusal ??= events.find(({ kind, reason }) => kind === "refused" && reason !== "notReady")?.reason;
        this.refusal = this.match.status === "connecting" ? this.refusal : undefined;
        this.recording.follow(this.match);
        if (this.match.status === "closed") {
            this.close();
        }
    }

    leave() {
        this.match.status === "connecting" ? this.close() : this.match.leave();
    }

    close() {
        this.isOver = true;
        clearInterval(this.timer);
        this.direct.close();
        this.relay.close();
    }

    state() {
        const { match, driver, direct, desyncs, refusal } = this;
        const inside = match.status !== "connecting";
        const { final } = inside ? match.ticks() : { final: 0 };
        const seats = inside ? match.seats : [];
        return { status: match.status, refusal, tick: driver.tick, final, seats, desyncs, direct: direct.count };
    }
}
