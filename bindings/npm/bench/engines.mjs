// Scenes in each engine: `build` returns `step`, which simulates 1/60 s, and `hash` if the engine has one.
import { SCENES, STATIC } from "./scenes.mjs";

const number = Number;
const pair = ([x, y]) => ({ x: number(x), y: number(y) });

async function lockstep2d(options) {
    const L = await import("../src/index.js");
    await L.init(options);
    const shapes = {
        box: ({ half }) => L.box(...half),
        ball: ({ radius }) => L.circle(radius),
        polygon: ({ points }) => L.polygon(points),
        capsule: ({ half, radius }) => L.capsule([0, `-${half}`], [0, half], radius),
    };
    return ({ bodies, hinges }) => {
        const world = new L.World({ gravity: [0, -10] });
        STATIC.forEach(({ position, half }) => world.spawn({ type: "fixed", position, shapes: [L.box(...half)] }));
        const ids = bodies.map(({ position, shape }) => world.spawn({ position, maySleep: false, shapes: [shapes[shape.kind](shape)] }));
        hinges.forEach(({ a, b, anchor }) => world.addJoint({ type: "revolute", a: ids[a], b: ids[b], anchor, limit: ["-0.5", "0.5"] }));
        return { step: () => world.step(), hash: () => world.hash() };
    };
}

async function rapier(name) {
    const { default: R } = await import(name);
    await R.init();
    const shapes = {
        box: ({ half }) => R.ColliderDesc.cuboid(...half.map(number)),
        ball: ({ radius }) => R.ColliderDesc.ball(number(radius)),
        polygon: ({ points }) => R.ColliderDesc.convexHull(Float32Array.from(points.flat().map(number))),
        capsule: ({ half, radius }) => R.ColliderDesc.capsule(number(half), number(radius)),
    };
    return ({ bodies, hinges }) => {
        const world = new R.World({ x: 0, y: -10 });
        world.timestep = 1 / 60;
        STATIC.forEach(({ position, half }) =>
            world.createCollider(R.ColliderDesc.cuboid(...half.map(number)).setTranslation(...position.map(number))));
        const made = bodies.map(({ position, shape }) => {
            const body = world.createRigidBody(R.RigidBodyDesc.dynamic().setTranslation(...position.map(number)).setCanSleep(false));
            world.createCollider(shapes[shape.kind](shape), body);
            return body;
        });
        hinges.forEach(({ a, b, anchor }) => {
            const local = (body) => ({ x: number(anchor[0]) - body.translation().x, y: number(anchor[1]) - body.translation().y });
            const joint = world.createImpulseJoint(R.JointData.revolute(local(made[a]), local(made[b])), made[a], made[b], true);
            joint.setLimits(-0.5, 0.5);
            joint.setContactsEnabled(false);
        });
        return { step: () => world.step() };
    };
}

async function planck() {
    const P = await import("planck");
    const shapes = {
        box: ({ half }) => [new P.Box(...half.map(number))],
        ball: ({ radius }) => [new P.Circle(number(radius))],
        polygon: ({ points }) => [new P.Polygon(points.map(pair))],
        capsule: ({ half, radius }) => [
            new P.Box(number(radius), number(half)),
            ...[-1, 1].map((sign) => new P.Circle({ x: 0, y: sign * number(half) }, number(radius))),
        ],
    };
    return ({ bodies, hinges }) => {
        const world = new P.World({ gravity: { x: 0, y: -10 }, allowSleep: false });
        STATIC.forEach(({ position, half }) => world.createBody({ position: pair(position) }).createFixture(new P.Box(...half.map(number))));
        const made = bodies.map(({ position, shape }) => {
            const body = world.createDynamicBody({ position: pair(position) });
            shapes[shape.kind](shape).forEach((each) => body.createFixture(each, { density: 1, friction: 0.6 }));
            return body;
        });
        const limits = { enableLimit: true, lowerAngle: -0.5, upperAngle: 0.5 };
        hinges.forEach(({ a, b, anchor }) => world.createJoint(new P.RevoluteJoint(limits, made[a], made[b], pair(anchor))));
        return { step: () => world.step(1 / 60, 8, 3) };
    };
}

async function matter() {
    const { default: M } = await import("matter-js");
    // Units are pixels, and the y axis points down.
    const SCALE = 50;
    const place = ([x, y]) => [SCALE * number(x), -SCALE * number(y)];
    const shapes = {
        box: (at, { half: [x, y] }) => M.Bodies.rectangle(...at, 2 * SCALE * number(x), 2 * SCALE * number(y)),
        ball: (at, { radius }) => M.Bodies.circle(...at, SCALE * number(radius)),
        polygon: (at, { points }) => M.Bodies.fromVertices(...at, [points.map((point) => pair(place(point)))]),
        // Matter has no capsules.
        capsule: (at, { half, radius }) => M.Bodies.rectangle(...at, 2 * SCALE * number(radius), 2 * SCALE * (number(half) + number(radius)),
            { chamfer: { radius: SCALE * number(radius) * 0.99 } }),
    };
    return ({ bodies, hinges }) => {
        const engine = M.Engine.create();
        STATIC.forEach(({ position, half: [x, y] }) =>
            M.Composite.add(engine.world, M.Bodies.rectangle(...place(position), 2 * SCALE * number(x), 2 * SCALE * number(y), { isStatic: true })));
        const made = bodies.map(({ position, shape }) => shapes[shape.kind](place(position), shape));
        M.Composite.add(engine.world, made);
        hinges.forEach(({ a, b, anchor }) => {
            const at = pair(place(anchor));
            const [pointA, pointB] = [made[a], made[b]].map(({ position }) => M.Vector.sub(at, position));
            M.Composite.add(engine.world, M.Constraint.create({ bodyA: made[a], bodyB: made[b], pointA, pointB, length: 0 }));
        });
        return { step: () => M.Engine.update(engine, 1000 / 60) };
    };
}

export const ENGINES = {
    "lockstep2d": () => lockstep2d(),
    "rapier2d-deterministic": () => rapier("@dimforge/rapier2d-deterministic-compat"),
    "rapier2d-simd": () => rapier("@dimforge/rapier2d-simd-compat"),
    "planck": planck,
    "matter-js": matter,
};

/** Milliseconds of each tick, and the hash of the last state. */
export async function measure(make, ticks) {
    const build = await make();
    const play = (scene, count) => {
        const { step, hash } = build(scene);
        const times = Array.from({ length: count }, () => {
            const start = performance.now();
            step();
            return performance.now() - start;
        });
        return { times, hash: hash?.() };
    };
    // Warm-up: functions are optimised after many calls.
    Object.values(SCENES).forEach((scene) => play(scene, 60));
    return Object.entries(SCENES).map(([name, scene]) => ({ name, ...play(scene, ticks) }));
}

export const moduleOf = (path) => async () => {
    const { readFileSync } = await import("node:fs");
    return lockstep2d({ wasm: readFileSync(path) });
};
