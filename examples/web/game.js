// The rules: two players push crates. The whole state is the world.
import { World, box, circle } from "lockstep2d";

export const RULES = "push the crates 1";

export class Game {
    constructor() {
        this.world = new World();
        this.world.spawn({ type: "fixed", position: [0, -1], shapes: [box(8, 1, { friction: "0.8" })] });
        this.players = [-4, 4].map((x) => this.world.spawn({ position: [x, 1], shapes: [circle("0.6", { density: 3 })] }));
        for (let row = 0; row < 5; row++) {
            this.world.spawn({ position: [0, `${row}.5`], shapes: [box("0.5", "0.5")] });
        }
    }

    // Bits of an input: left, right, up.
    step(inputs) {
        this.players.forEach((player, seat) => {
            const input = inputs[seat];
            const body = this.world.body(player);
            const along = ((input >> 1) & 1) - (input & 1);
            const jumps = (input & 4) !== 0 && body.velocity.y.abs().lt("0.05");
            this.world.applyImpulse(player, [along, jumps ? 18 : 0], body.position);
        });
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
        return this.world.toBytes();
    }

    decode(bytes) {
        this.world.dispose();
        this.world = World.fromBytes(bytes);
    }
}
