// Records the final inputs of a match as commands to a world. The replay can be verified (`lockstep2d verify`) and
// viewed without the rules of the game.
import { Commands, Recording } from "lockstep2d";
import { Game, setUp } from "./game.js";

export class MatchRecording {
    #game = new Game();
    #commands = new Commands();
    #recording;
    #parts = [];
    #file;
    /** Number of recorded ticks. */
    ticks = 0;
    /** Whether ticks are missing, for example because this peer has joined late. */
    broken = false;

    constructor() {
        const setup = new Commands();
        setUp(setup);
        this.#recording = new Recording({ setup });
    }

    /** Records the final ticks that are not recorded yet. Call it every few seconds, because the match keeps inputs
     * only for minutes. Has no effect after `finish`. */
    follow(match) {
        if (this.broken || this.#file !== undefined || match.status === "connecting") {
            return;
        }
        for (const { confirmed } = match.ticks(); this.ticks < confirmed; this.ticks++) {
            const final = match.finalInputs(this.ticks);
            if (final === undefined) {
                this.broken = true;
                return;
            }
            const { inputs } = final;
            this.#game.apply(inputs, this.#commands);
            this.#recording.step(this.#commands);
            this.#game.step(inputs);
        }
        const bytes = this.#recording.take();
        if (bytes.length > 0) {
            this.#parts.push(bytes);
        }
    }

    /** Ends the recording and returns the replay of the recorded ticks. Further calls return the same replay. */
    finish() {
        this.#file ??= this.#finish();
        return this.#file;
    }

    #finish() {
        const parts = [...this.#parts, this.#recording.finish()];
        const bytes = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
        parts.reduce((at, part) => (bytes.set(part, at), at + part.length), 0);
        return bytes;
    }
}
