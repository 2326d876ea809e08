// The rules: players push crates. The whole state is the world. `crates/relay/examples/push.rs` has the same rules in
// Rust.
import { World, box, circle, decodeNativeState, encodeNativeState, nativeOffer } from "lockstep2d";

export const RULES = "push the crates";
export const SEATS = 4;

export const offer = () => nativeOffer({ rules: RULES, seats: SEATS });

/** Adds the level to a world or to a list of commands. */
export function setUp(edits) {
    edits.spawn({ type: "fixed", position: [0, -1], shapes: [box(8, 1, { friction: "0.8" })] });
    for (const x of [-4, 4, -6, 6]) {
        edits.spawn({ position: [x, 1], shapes: [circle("0.6", { density: 3 })] });
    }
    for (let row = 0; row < 5; row++) {
        edits.spawn({ position: [0, `${row}.5`], shapes: [box("0.5", "0.5")] });
    }
}

export class Game {
    constructor() {
        this.world = new World();
        setUp(this.world);
        this.players = [...this.world.bodies()].slice(1, 1 + SEATS);
    }

    // Applies the inputs of a tick to `edits`, a world or a list of commands. Bits of an input: 1 left, 2 right, 4 up.
    apply(inputs, edits) {
        this.players.forEach((player, seat) => {
            const input = inputs[seat];
            const body = this.world.body(player);
            const along = ((input >> 1) & 1) - (input & 1);
            const jumps = (input & 4) !== 0 && body.velocity.y.abs().lt("0.05");
            if (along !== 0 || jumps) {
                edits.applyImpulse(player, [along, jumps ? 18 : 0], body.position);
            }
        });
    }

    step(inputs) {
        this.apply(inputs, this.world);
        this.world.step();
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
        return encodeNativeState(this.world);
    }

    decode(bytes) {
        const world = decodeNativeState(bytes);
        this.world.dispose();
        this.world = world;
    }
}
