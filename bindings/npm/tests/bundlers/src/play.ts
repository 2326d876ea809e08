import { World, box, init } from "lockstep2d";

/** Height and hash of the falling box of the README after two seconds. */
export async function play(): Promise<string> {
    await init();
    const world = new World({ gravity: [0, -10] });
    world.spawn({ type: "fixed", position: [0, -1], shapes: [box(20, 1)] });
    const crate = world.spawn({ position: [0, 3], shapes: [box("0.25", "0.25")] });
    for (let tick = 0; tick < 120; tick++) {
        world.step();
    }
    const y = world.body(crate)?.position.y;
    return `${y?.toNumber()} ${world.hash()}`;
}
