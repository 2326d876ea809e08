// Worlds.
import assert from "node:assert/strict";
import { test } from "node:test";
import { library } from "../src/library.js";
import { L, fallingBox } from "./common.mjs";

test("a world that is restored goes on with the same bits", () => {
    const { world } = fallingBox();
    const saved = world.save();
    world.step(50);
    const hash = world.hash();
    world.restore(saved);
    world.step(50);
    assert.equal(world.hash(), hash);
    const copy = L.World.fromBytes(world.toBytes());
    const clone = world.clone();
    [world, copy, clone].forEach((each) => each.step(30));
    assert.equal(copy.hash(), world.hash());
    assert.equal(clone.hash(), world.hash());
    world.saveInto(saved);
    assert.equal(saved.hash(), world.hash());
    [world, copy, clone, saved].forEach((each) => each.dispose());
});

test("poses are rows of floats for drawing", () => {
    const { world, box } = fallingBox();
    world.step();
    const poses = world.poses();
    assert.deepEqual([poses.length, poses[5], poses[9]], [10, box, 1]);
    assert.ok(Math.abs(poses[7] - world.body(box).position.y.toNumber()) < 1e-9);
    const target = new Float64Array(100);
    assert.equal(world.poses(target).buffer, target.buffer);
    assert.deepEqual([...target.subarray(0, 10)], [...poses]);
});

test("queries find the shapes", () => {
    const { world, box } = fallingBox();
    const [shape] = world.shapesOf(box);
    const hit = world.castRay([0, 10], [0, -20]);
    assert.deepEqual([hit.body, hit.shape, hit.point.y.toString(), hit.normal.y.toString()], [box, shape, "3.25", "1"]);
    assert.equal(world.castRay([50, 10], [0, -20]), undefined);
    assert.equal(world.castRayAll([0, 10], [0, -20]).length, 2);
    assert.equal(world.castRay([0, 10], [0, -20], { except: [box] }).point.y.toString(), "0");
    assert.deepEqual(world.overlapPoint([0, 3]), [shape]);
    assert.deepEqual(world.overlapBox([-1, 2], [1, 4]), [shape]);
    assert.deepEqual(world.overlapShape(L.circle(1), [0, 4]), [shape]);
    const cast = world.castShape(L.circle("0.5"), [0, 10], [0, -20]);
    assert.equal(cast.body, box);
    assert.equal(world.closest([0, 4], 5).shape, shape);
    assert.deepEqual(world.shape(shape).points.map(({ x }) => x.toNumber()), [-0.25, 0.25, 0.25, -0.25]);
});

test("events tell what happened in the tick", () => {
    const { world, box } = fallingBox();
    world.spawn({ type: "fixed", position: [0, 2], shapes: [L.box(1, "0.1", { sensor: true })] });
    const seen = { contactBegin: 0, sensorBegin: 0, sensorEnd: 0, moved: 0 };
    for (let tick = 0; tick < 120; tick++) {
        world.step();
        const events = world.events();
        Object.keys(seen).forEach((kind) => (seen[kind] += events[kind].length));
        events.moved.forEach(({ body }) => assert.equal(body, box));
    }
    assert.deepEqual({ ...seen, moved: seen.moved > 40 }, { contactBegin: 1, sensorBegin: 1, sensorEnd: 1, moved: true });
});

test("all joints and shapes can be defined", () => {
    const world = new L.World({ tickRate: 120, gravity: [0, "-9.81"], smallest: "0.1" });
    assert.equal(world.config().tickRate, 120);
    const ground = world.spawn({ type: "fixed", shapes: [L.chain([[-20, 0], [0, "-0.5"], [20, 0]], { friction: "0.9" })] });
    const shapes = [L.circle("0.5"), L.capsule([0, 0], [1, 0], "0.2"), L.polygon([[0, 0], [1, 0], [0, 1]], { rounding: "0.05" }),
        L.hull([[0, 0], [0, 1], [1, 0], ["0.1", "0.1"]]), L.box(1, "0.1", { density: 3 })];
    const bodies = shapes.map((shape, index) => world.spawn({ position: [3 * index, 5], name: `b${index}`, shapes: [shape] }));
    // The anchors fit the positions of the bodies. Position errors of metres would cause faults.
    const kinds = [
        { type: "revolute", anchor: [1, 5], limit: ["-0.5", "0.5"], motor: { speed: 1, max: 10 } },
        { type: "prismatic", anchor: [1, 5], axis: [0, 1], spring: { hertz: 2, dampingRatio: "0.5", target: 0 } },
        { type: "distance", rod: 9 },
        { type: "weld", linearSpring: { hertz: 5, dampingRatio: 1 } },
        { type: "wheel", anchor: [4, 4], axis: [0, 1] },
        { type: "motor", linearMotor: { velocity: [1, 0], max: 5 } },
        { type: "filter" },
        { type: "gear", teeth: [10, 20] },
        { type: "rack", radius: "0.5" },
        { type: "pulley", wheels: [[0, 9], [3, 9]], length: 19, ratio: 2 },
    ];
    const joints = kinds.map((kind, index) => world.addJoint({ a: index % 2 ? ground : bodies[0], b: bodies[1 + (index % 4)], ...kind }));
    assert.deepEqual(world.joints(), joints);
    // A joint does not change if its definition is read and set again.
    const before = world.hash();
    joints.forEach((joint) => world.setJoint(joint, world.joint(joint)));
    assert.equal(world.hash(), before);
    world.step(100);
    assert.deepEqual([world.counts().bodies, world.counts().joints, world.faults], [6, 10, 0]);
    world.dispose();
});

test("mistakes are errors with codes", () => {
    const { world, box } = fallingBox();
    world.despawn(box);
    assert.equal(world.body(box), undefined);
    assert.equal(world.bodyName(box), undefined);
    const ends = [1, 2].map((x) => world.spawn({ position: [x, 9], shapes: [L.circle("0.3")] }));
    const joint = world.addJoint({ type: "distance", a: ends[0], b: ends[1], rod: 1 });
    world.removeJoint(joint);
    assert.deepEqual([world.jointForce(joint), world.jointAngle(joint)], [undefined, undefined]);
    assert.throws(() => world.joint(joint), { code: "STALE_JOINT" });
    assert.throws(() => world.wake(box), { code: "STALE_BODY" });
    assert.throws(() => world.spawn({ shapes: [L.circle(0)] }), { code: "GEOMETRY" });
    assert.throws(() => world.spawn({ positon: [0, 1] }), /no option positon/);
    assert.throws(() => world.spawn({ shapes: [L.circle(1, { bouncy: true })] }), { code: "VALUE" });
    assert.throws(() => new L.World({ gravity: [0, 1000000] }), { code: "SETTING" });
    assert.throws(() => L.World.fromBytes(new Uint8Array(100)), { code: "SNAPSHOT" });
    world.dispose();
    world.dispose();
    assert.throws(() => world.step(), { code: "DISPOSED" });
});

test("commands are edits as bytes", () => {
    const [direct, remote] = [fallingBox(), fallingBox()];
    const commands = new L.Commands();
    for (const target of [direct.world, commands]) {
        target.applyImpulse(direct.box, ["0.5", 0], [0, 3]);
        target.spawn({ position: [1, 5], shapes: [L.circle("0.3")] });
        target.setGravity([0, -20]);
    }
    assert.equal(remote.world.execute(new L.Commands().fromBytes(commands.toBytes())), 0);
    [direct, remote].forEach(({ world }) => world.step(60));
    assert.equal(remote.world.hash(), direct.world.hash());
});

test("the mass of shapes is that of a body with them, and can be scaled", () => {
    const world = new L.World();
    const shapes = [L.box("0.25", "0.9"), L.circle("0.5", { density: 3 })];
    const mass = L.massOf(shapes);
    const [body, person] = [world.spawn({ shapes }), world.spawn({ shapes, mass: { ...mass, mass: 80 } })].map((id) => world.body(id));
    assert.deepEqual([mass.mass, mass.centre], [body.mass, body.centre]);
    assert.equal(person.mass.toNumber(), 80);
    const ratio = person.inertia.toNumber() / body.inertia.toNumber();
    assert.ok(Math.abs(ratio - 80 / mass.mass.toNumber()) < 1e-6, `${ratio}`);
    assert.throws(() => L.massOf([L.segment([0, 0], [1, 0])]), { name: "Lockstep2dError" });
});

test("a mass that is set stays until it follows from the shapes again", () => {
    const world = new L.World();
    const commands = new L.Commands();
    const body = world.spawn({ shapes: [L.box("0.5", "0.5")] });
    const mass = () => world.body(body).mass.toNumber();
    world.setMass(body, { mass: 80, centre: [0, "-0.25"], gyration: "0.5" });
    assert.deepEqual([mass(), world.body(body).centre.y.toNumber(), world.body(body).inertia.toNumber()], [80, -0.25, 20]);
    world.addShape(body, L.circle(1));
    assert.equal(mass(), 80);
    commands.setMass(body);
    assert.equal(world.execute(commands), 0);
    assert.ok(Math.abs(mass() - 1 - Math.PI) < 1e-6, `${mass()}`);
    assert.throws(() => world.setMass(body, { mass: 0, gyration: 1 }), { code: "MASS" });
});

test("settings that are not given have their defaults", () => {
    const world = new L.World({ gravity: [0, 0] });
    const body = world.spawn({ lockX: true, linearDamping: 3, velocity: [0, 1], shapes: [L.box("0.5", "0.5")] });
    world.setBody(body, { lockRotation: true });
    world.applyImpulse(body, [1, 0], [0, 1]);
    world.step(10);
    const { velocity, angularVelocity } = world.body(body);
    assert.deepEqual([velocity.x.toNumber(), velocity.y.toNumber(), angularVelocity.toNumber()], [1, 1, 0]);
});

test("a body has a name and a velocity at each point, a shape has a box and distances", () => {
    const world = new L.World();
    const shapes = [L.circle("0.5")];
    const [a, b] = [world.spawn({ name: "wheel", velocity: [1, 0], angularVelocity: 2, shapes }), world.spawn({ position: [3, 0], shapes })];
    assert.deepEqual([world.bodyName(a), world.bodyName(b)], ["wheel", undefined]);
    world.setName(a, "");
    assert.equal(world.bodyName(a), undefined);
    world.setName(a, "0123456789-_abcd");
    assert.equal(world.bodyName(a), "0123456789-_abcd");
    const { x, y } = world.velocityAt(a, [0, "0.5"]);
    assert.ok(Math.abs(x.toNumber()) < 1e-5 && Math.abs(y.toNumber()) < 1e-5, `${x} ${y}`);
    const [[one], [other]] = [world.shapesOf(a), world.shapesOf(b)];
    const { lower, upper } = world.shapeBox(one);
    [lower.x, lower.y].forEach((at) => assert.ok(at.lt("-0.499") && at.gt("-0.7"), `${at}`));
    [upper.x, upper.y].forEach((at) => assert.ok(at.gt("0.499") && at.lt("0.7"), `${at}`));
    assert.ok(Math.abs(world.shapeDistance(one, other).toNumber() - 2) < 1e-6);
    world.setTransform(b, ["0.5", 0]);
    assert.ok(world.shapeDistance(one, other).lt(0));
    world.despawn(b);
    assert.equal(world.shapeDistance(one, other), undefined);
    assert.equal(world.bodyName(b), undefined);
    assert.throws(() => world.velocityAt(b, [0, 0]), { code: "STALE_BODY" });
    assert.throws(() => world.shapeBox(other), { code: "STALE_SHAPE" });
});

test("a joint can be read", () => {
    const world = new L.World();
    const [a, b] = [world.spawn({ type: "fixed" }), world.spawn({ position: [2, 0], shapes: [L.circle("0.5")] })];
    const joint = world.addJoint({ type: "revolute", a, b, anchor: [1, 0], limit: ["-0.5", 1], threshold: { force: 9, breaks: true } });
    const { anchorA, anchorB, limit, ...rest } = world.joint(joint);
    assert.deepEqual([rest.type, rest.a, rest.b, rest.enabled, rest.collide], ["revolute", a, b, true, false]);
    assert.deepEqual([anchorA.x, anchorB.x, ...limit].map((number) => number.toString()), ["1", "-1", "-0.5", "1"]);
    assert.deepEqual(rest.threshold, { force: L.fx(9), breaks: true });
    assert.ok(!("motor" in rest) && !("length" in rest));
    world.setJoint(joint, { ...world.joint(joint), motor: { speed: 1, max: 10 } });
    assert.deepEqual(world.joint(joint).motor, { speed: L.fx(1), max: L.fx(10) });
    const [springForce, softness] = [["-5", 5], { hertz: 30, dampingRatio: 1 }];
    const spring = { hertz: 2, dampingRatio: "0.5", max: 7 };
    const others = [
        { type: "distance", rod: 2, spring: { hertz: 2, dampingRatio: 1, target: 2 }, springForce, softness, collide: true, userData: 7 },
        { type: "motor", linearSpring: spring, angularSpring: { ...spring, hertz: 3 }, motor: { speed: 1, max: 2 }, enabled: false },
        { type: "weld", linearSpring: { hertz: 5, dampingRatio: 1 }, angularSpring: { hertz: 6, dampingRatio: 2 }, angleA: L.degrees(9) },
        { type: "pulley", wheels: [[0, 9], [3, 9]], length: 9, ratio: 2, threshold: { torque: 3 } },
    ];
    for (const other of others) {
        world.setJoint(joint, { a, b, ...other });
        const [read, hash] = [world.joint(joint), world.hash()];
        world.setJoint(joint, { type: "filter", a, b });
        world.setJoint(joint, read);
        assert.equal(world.hash(), hash, other.type);
        Object.keys(other).forEach((name) => assert.ok(name in read, `${other.type} has ${name}`));
    }
    world.removeJoint(joint);
    assert.throws(() => world.joint(joint), { code: "STALE_JOINT" });
});

test("bodies and joints with one definition are added together, or none", () => {
    const world = new L.World();
    const poses = Array.from({ length: 300 }, (_, index) => ({ position: [index, "0.5"], angle: index % 2 === 0 ? 0 : L.degrees(90) }));
    const bodies = world.spawnEach({ shapes: [L.box("0.25", "0.5")], userData: 7 }, poses);
    assert.deepEqual(bodies, world.bodies());
    const last = world.body(bodies[299]);
    assert.deepEqual([last.position.x.toNumber(), last.angle.bits, last.userData], [299, 0x40000000, 7n]);
    const pairs = bodies.slice(1).map((body, index) => [bodies[index], body]);
    const joints = world.addJointEach({ type: "revolute", anchorA: ["0.5", 0], anchorB: ["-0.5", 0] }, pairs);
    assert.deepEqual(joints, world.joints());
    assert.throws(() => world.spawnEach({}, [{ position: [0, 0] }, { position: [2_000_000_000, 0] }]), { name: "Lockstep2dError" });
    assert.throws(() => world.addJointEach({ type: "revolute" }, [[bodies[0], bodies[1]], [bodies[2], bodies[2]]]), { name: "Lockstep2dError" });
    assert.deepEqual([world.counts().bodies, world.counts().joints], [300, 299]);
    assert.deepEqual([world.spawnEach({}, []), world.addJointEach({ type: "revolute" }, [])], [[], []]);
    const wrong = [[bodies[0], bodies[1], bodies[2]], [bodies[3]]];
    assert.throws(() => world.addJointEach({ type: "revolute" }, wrong), { code: "VALUE" });
    assert.throws(() => world.addJointEach({ type: "revolute", anchor: [0, 0] }, pairs), { code: "VALUE" });
    assert.throws(() => world.spawnEach({}, [{ position: [0, 0] }, { angle: 0 }]), { code: "VALUE" });
    assert.deepEqual([world.counts().bodies, world.counts().joints], [300, 299]);
    const commands = new L.Commands();
    assert.equal(commands.spawnEach({}, poses), undefined);
    assert.equal(commands.addJointEach({ type: "revolute" }, pairs), undefined);
    assert.equal(world.execute(commands), 0);
    assert.deepEqual([world.counts().bodies, world.counts().joints], [600, 598]);
});

test("`using` disposes of a world", { skip: !Symbol.dispose }, () => {
    const world = new L.World();
    world[Symbol.dispose]();
    assert.throws(() => world.step(), { code: "DISPOSED" });
});

test("10 000 worlds that are disposed leak nothing", () => {
    const before = L.objectCount();
    const memory = () => library().memory.buffer.byteLength;
    let after;
    for (let count = 0; count < 10_000; count++) {
        const { world } = fallingBox();
        world.save().dispose();
        world.dispose();
        if (count === 1000) {
            after = memory();
        }
    }
    // Not `assert.equal`, because the garbage collector may have freed objects of other tests.
    assert.ok(L.objectCount() <= before, `${L.objectCount() - before} objects more`);
    assert.equal(memory(), after, "the memory of the module has grown");
});

test("a character walks, climbs a step, rides a lift and stops at a wall", () => {
    const world = new L.World();
    world.spawn({ type: "kinematic", position: [0, -1], velocity: [0, 1], shapes: [L.box(3, 1)] });
    world.spawn({ type: "fixed", position: [6, 0], shapes: [L.box(3, "1.2")] });
    world.spawn({ type: "fixed", position: ["9.5", 0], shapes: [L.box(1, 9)] });
    const mover = { shape: L.circle("0.5"), stepHeight: "0.3", slopeMax: L.degrees(50) };
    let [state, onGround, met] = [{ position: [0, "0.6"] }, 0, 0];
    for (let tick = 0; tick < 240; tick++) {
        world.step();
        const velocity = [3, L.fx(state.velocity?.y ?? 0).sub("0.16")];
        const moved = L.moveCharacter(world, mover, { ...state, velocity });
        // Every second state is encoded and decoded, which must not change the result.
        state = tick % 2 === 0 ? L.decodeMoverState(L.encodeMoverState(moved.state)) : moved.state;
        onGround += moved.state.isOnGround ? 1 : 0;
        met += moved.met.length;
    }
    assert.deepEqual([state.position.x.toString().slice(0, 5), state.position.y.toString().slice(0, 4)], ["7.999", "1.70"]);
    assert.ok(onGround > 200 && met > 0 && state.ground.normal.y.toString() === "1");
    assert.throws(() => L.moveCharacter(world, { ...mover, height: 2 }, state), /no option height/);
    assert.throws(() => L.moveCharacter(world, mover, { position: [0.5, 0] }), /text|string/);
    assert.throws(() => L.decodeMoverState(new Uint8Array(3)), /bytes/);
    world.dispose();
});

test("a joint that cannot be fitted is an error, after which the module goes on", () => {
    const { world, box } = fallingBox();
    const other = world.spawn({ position: [1, 3], shapes: [L.circle("0.5")] });
    const before = world.hash();
    for (const wrong of [{ type: "gear", teeth: [0, 1] }, { type: "gear", teeth: [1, 0] }, { type: "rack", radius: 0 }]) {
        assert.throws(() => world.addJoint({ a: box, b: other, anchor: [1, 3], ...wrong }), { name: "Lockstep2dError" });
    }
    assert.equal(world.hash(), before);
    world.step();
});

test("the encoded state of a character has its whole state", () => {
    const { world, box } = fallingBox();
    const [shape] = world.shapesOf(box);
    const frame = { bodyPosition: [0, 3], bodyAngle: L.degrees(5), velocity: [1, 0] };
    const ground = { shape, body: box, ...frame, normal: [0, 1], point: [1, 2], separation: "0.01" };
    for (const state of [{ isWedged: true }, { isWedged: false }, { ground }, { ground, isWedged: true }, { hasLanded: true, passing: [shape] }]) {
        const bytes = L.encodeMoverState({ position: [1, 2], velocity: [3, 4], ...state });
        const decoded = L.decodeMoverState(bytes);
        assert.deepEqual([decoded.isWedged, decoded.isOnGround], [state.isWedged ?? false, state.ground !== undefined]);
        assert.deepEqual([decoded.hasLanded, decoded.passing], [state.hasLanded ?? false, state.passing ?? []]);
        assert.deepEqual(L.encodeMoverState(decoded), bytes);
    }
    const wrong = L.encodeMoverState({ position: [1, 2], passing: [] }).fill(255, -8, -4);
    assert.throws(() => L.decodeMoverState(wrong), { code: "DECODE" });
    assert.throws(() => L.encodeMoverState({ position: [1, 2], passing: Array(9).fill(shape) }), { code: "VALUE" });
});
