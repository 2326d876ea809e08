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

    /** `game` is in the state before the first tick. */
    constructor(game) {
        this.#last = game;
        this.#recorder = new Recorder({ rules: RULES, players: SEATS, inputBytes: 1, start: game.hash() });
    }

    /** Adds a tick, with the hash and the points after it. Has no effect after `finish`. */
    add({ inputs, absent }, hash, points) {
        if (this.#file === undefined) {
            this.ticks += 1;
            this.#recorder.record(inputs, absent) && this.#recorder.checkpoint(hash);
            this.#last = { hash: () => hash, points };
        }
    }

    /** The replay. Ends the recording; further calls return this replay again. */
    finish() {
        if (this.#file === undefined) {
            claim(this.#last.points, this.#recorder);
            this.#file = this.#recorder.finish(this.#last.hash());
        }
        return this.#file;
    }
}

/** The verdict on a file, which may come from any source. */
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

// The points at the end can be read from the file, and the verdict compares them with those of the game.
function claim([amber, blue], target) {
    target.claim("amber", amber);
    target.claim("blue", blue);
}
