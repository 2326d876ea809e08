// Scenes: heaps, each of one kind of shape, between walls, and ragdolls. Numbers are decimal text.

function* heap(count) {
    for (let index = 0; index < count; index++) {
        const row = Math.floor(index / 12);
        yield [`${-9 + (index % 12) + (row % 2)}.${row % 3}`, `${1 + row}.${(index * 3) % 5}`];
    }
}

export const STATIC = [
    { position: ["0", "-1"], half: ["30", "1"] },
    { position: ["-16", "10"], half: ["1", "20"] },
    { position: ["16", "10"], half: ["1", "20"] },
];
const SHAPES = {
    boxes: { kind: "box", half: ["0.4", "0.4"] },
    balls: { kind: "ball", radius: "0.4" },
    hexagons: {
        kind: "polygon",
        points: [["0.4", "0"], ["0.2", "0.35"], ["-0.2", "0.35"], ["-0.4", "0"], ["-0.2", "-0.35"], ["0.2", "-0.35"]],
    },
};

/** Ragdolls: chains of four capsules, joined by hinges. */
function ragdolls(count) {
    const bodies = [];
    const hinges = [];
    for (let index = 0; index < count; index++) {
        const [x, y] = [`${-10 + 2 * (index % 10)}`, 2 + 3 * Math.floor(index / 10)];
        for (let part = 0; part < 4; part++) {
            bodies.push({ position: [x, `${y + Math.floor(part / 2)}.${5 * (part % 2)}`], shape: { kind: "capsule", half: "0.15", radius: "0.1" } });
            if (part > 0) {
                hinges.push({ a: bodies.length - 2, b: bodies.length - 1, anchor: [x, `${y + Math.floor((part - 1) / 2)}.${part % 2 ? 25 : 75}`] });
            }
        }
    }
    return { bodies, hinges };
}

export const SCENES = Object.fromEntries([24, 96, 384].flatMap((count) => [
    ...Object.entries(SHAPES).map(([name, shape]) => [`${name} ${count}`, { bodies: [...heap(count)].map((position) => ({ position, shape })), hinges: [] }]),
    [`ragdolls ${count}`, ragdolls(count / 4)],
]));
