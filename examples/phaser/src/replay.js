// Replays: the inputs of a match, with hashes of its states. This file needs no page, so a server can verify replays.
import { Recorder, Replay, ReplayDriver } from "lockstep2d";
import { Game, RULES, SEATS } from "./rules.js";

/** Records the confirmed ticks of a match. */
export class Recording {
    #recorder;
    #last;
    #file;
    /** Number of recorded ticks. */
    ticks = 0;

    /** Starts a recording. `game` must be in the state before the first tick. */
    constructor(game) {
        this.#last = game;
        this.#recorder = new Recorder({ rules: RULES, players: SEATS, inputBytes: 1, start: game.hash() });
    }

    /** Adds the inputs of a tick, and the hash and the points after this tick. Has no effect after `finish`. */
    add({ inputs, absent }, hash, points) {
        if (this.#file === undefined) {
            this.ticks += 1;
            this.#recorder.record(inputs, absent) && this.#recorder.checkpoint(hash);
            this.#last = { hash: () => hash, points };
        }
    }

    /** Ends the recording and returns the replay. Further calls return the same replay. */
    finish() {
        if (this.#file === undefined) {
            claim(this.#last.points, this.#recorder);
            this.#file = this.#recorder.finish(this.#last.hash());
        }
        return this.#file;
    }
}

/** Verifies a replay, which may come from an untrusted source. Returns the verdict and a text that explains it. */
export function verify(bytes) {
    const game = new Game();
    let replay;
    try {
        replay = new Replay(bytes);
        if (replay.rules !== RULES || replay.players !== SEATS || replay.inputBytes !== 1) {
            return { verdict: "unverifiable", text: `a replay of another game: ${replay.rules}` };
        }
        new ReplayDriver(replay, game).seek(replay.ticks);
    } catch (error) {
        if (error.code !== "RECORD") {
            throw error;
        }
        // Either the file cannot be read, or the game differs from a hash in the file.
        return error.verdict ?? replay.verdict(game.hash());
    }
    claim(game.points, replay);
    return replay.verdict(game.hash());
}

// Passes the points at the end as claims: a recorder writes them to the file, a replay compares them with the file.
function claim([amber, blue], target) {
    target.claim("amber", amber);
    target.claim("blue", blue);
}
