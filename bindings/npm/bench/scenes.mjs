// Scenes that are measured: piles of one shape, and ragdolls.

const GROUND = (L, world) => {
    world.spawn({ type: "fixed", position: [0, -1], shapes: [L.box(30, 1)] });
    world.spawn({ type: "fixed", position: [-16, 10], shapes: [L.box(1, 20)] });
    world.spawn({ type: "fixed", position: [16, 10], shapes: [L.box(1, 20)] });
};

/** Positions of a heap: rows that are shifted against each other. */
function* heap(count) {
    for (let index = 0; index < count; index++) {
        const row = Math.floor(index / 12);
        yield [`${-9 + (index % 12) + (row % 2)}.${row % 3}`, `${1 + row}.${(index * 3) % 5}`];
    }
}

const pile = (count, shape) => (L, world) => {
    GROUND(L, world);
    for (const position of heap(count)) {
        world.spawn({ position, maySleep: false, shapes: [shape(L)] });
    }
};

const SHAPES = {
    boxes: (L) => L.box("0.4", "0.4"),
    balls: (L) => L.circle("0.4"),
    hexagons: (L) => L.polygon([["0.4", 0], ["0.2", "0.35"], ["-0.2", "0.35"], ["-0.4", 0], ["-0.2", "-0.35"], ["0.2", "-0.35"]]),
};

/** Chains of four capsules, joined with limits. */
const ragdolls = (count) => (L, world) => {
    GROUND(L, world);
    for (let index = 0; index < count; index++) {
        const [x, y] = [-10 + 2 * (index % 10), 2 + 3 * Math.floor(index / 10)];
        let last;
        for (let part = 0; part < 4; part++) {
            const body = world.spawn({
                position: [x, `${y + Math.floor(part / 2)}.${5 * (part % 2)}`],
                maySleep: false,
                shapes: [L.capsule([0, "-0.15"], [0, "0.15"], "0.1")],
            });
            if (last !== undefined) {
                const anchor = [x, `${y + Math.floor((part - 1) / 2)}.${part % 2 ? 25 : 75}`];
                world.addJoint({ type: "revolute", a: last, b: body, anchor, limit: ["-0.5", "0.5"] });
            }
            last = body;
        }
    }
};

export const SCENES = {
    ...Object.fromEntries(Object.entries(SHAPES).flatMap(([name, shape]) => [24, 96, 384].map((count) => [`${name} ${count}`, pile(count, shape)]))),
    "ragdolls 24": ragdolls(6),
    "ragdolls 96": ragdolls(24),
};
