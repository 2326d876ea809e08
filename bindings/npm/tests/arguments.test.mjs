// Wrong arguments give errors with a code and the name of the argument. Without these checks, WebAssembly would convert
// wrong arguments to integers.
import assert from "node:assert/strict";
import { test } from "node:test";
import { library } from "../src/library.js";
import { L, checkGuards, initErrors } from "./common.mjs";

const world = () => new L.World({ gravity: [0, -10] });

/** Values that are not unsigned integers of 32 bits. */
const NO_COUNTS = [-1, 0.5, 16.67, "2", "x", NaN, null, {}, 2 ** 32, true];

test("a number of ticks and a bound are integers", () => {
    const w = world();
    for (const wrong of NO_COUNTS) {
        assert.throws(() => w.step(wrong), { code: "VALUE", message: /number of ticks/ }, String(wrong));
        assert.throws(() => w.random(wrong), { code: "VALUE", message: /bound/ }, String(wrong));
        assert.throws(() => new L.Random(1).below(wrong), { code: "VALUE", message: /bound/ }, String(wrong));
    }
    assert.equal(w.tick, 0);
    w.step(3);
    assert.equal(w.tick, 3);
});

test("integers of options keep their range", () => {
    assert.throws(() => new L.World({ bodyLimit: 2 ** 40 }), { code: "VALUE", message: /bodyLimit/ });
    assert.throws(() => new L.World({ tickRate: -60 }), { code: "VALUE", message: /tickRate .* -60/ });
    const spawn = (options) => world().spawn({ ...options, shapes: [L.circle(1)] });
    assert.throws(() => spawn({ userData: 1n << 64n }), { code: "VALUE", message: /userData/ });
    assert.throws(() => L.circle(1, 5), { code: "VALUE" });
    for (const wrong of [{ category: 1n << 64n }, { group: 1e10 }]) {
        assert.throws(() => world().spawn({ shapes: [L.circle(1, wrong)] }), { code: "VALUE", message: /category|group/ });
    }
    assert.throws(() => spawn({ name: "a very long name of a body" }), { code: "VALUE", message: /name/ });
    assert.throws(() => spawn({ enabled: "no" }), { code: "VALUE", message: /enabled/ });
    assert.throws(() => spawn({ mass: 5 }), { code: "VALUE", message: /`mass`/ });
    assert.throws(() => spawn({ mass: { mass: 5 } }), { code: "VALUE", message: /gyration/ });
});

test("a missing argument is an error with a code", () => {
    const w = world();
    for (const call of [
        () => w.spawn(), () => w.addJoint(), () => new L.World(null), () => new L.World("x"), () => L.box(1, 1, null), () => L.polygon(),
        () => L.polygon("abc"), () => w.spawn({ shapes: L.box(1, 1) }), () => w.spawn({ shapes: [null] }), () => w.setConfig(),
        () => w.castRay([0, 0], [1, 0], { except: 1 }), () => w.restore(), () => w.restore({}), () => w.saveInto(), () => w.execute(),
        () => w.setBody(0), () => w.explode(), () => w.spawnEach({}, 1), () => new L.Random(), () => new L.Random(0.5),
        () => L.Fx.fromRaw(0.5), () => new L.Angle(), () => new L.Angle(0.5), () => w.poses(new Float32Array(10)),
        () => L.moveCharacter(w, undefined, { position: [0, 0] }), () => L.moveCharacter({}, {}, {}), () => L.fx(2 ** 31), () => L.fx(NaN),
    ]) {
        assert.throws(call, (error) => error instanceof L.Lockstep2dError && error.code !== undefined, String(call));
    }
    assert.equal(L.fx(-(2 ** 31)).toString(), "-2147483648");
});

test("a query needs its whole place", () => {
    const w = world();
    w.spawn({ position: [5, 5], shapes: [L.circle(1)] });
    for (const call of [
        // In the first two cases, the second call lacks an argument. If it did not fail, it would read the argument
        // that the first call left in memory.
        () => [w.overlapBox([4, 4], [6, 6]), w.overlapBox([-2, -2])],
        () => [w.overlapBox([4, 4], [6, 6]), w.overlapBox(undefined, [9, 9])],
        () => w.overlapBox(), () => w.overlapShape(L.circle(1)), () => w.castShape(L.circle(1), undefined, [1, 0]),
        () => w.castShape(L.circle(1), [0, 0]), () => w.closest([0, 0]), () => w.castRay([0, 0]),
        () => w.overlapPoint(), () => w.spawnEach({}, [{}]),
    ]) {
        assert.throws(call, { code: "VALUE" }, String(call));
    }
});

test("a pair of numbers of a joint has both", () => {
    const w = world();
    const [a, b] = [0, 2].map((x) => w.spawn({ position: [x, 5], shapes: [L.circle("0.5")] }));
    for (const wrong of [
        { type: "revolute", limit: [undefined, 1] }, { type: "revolute", limit: [0, undefined] },
        { type: "gear", teeth: [undefined, 7] }, { type: "distance", spring: { hertz: 1 }, springForce: [, 7] },
        { type: "pulley", length: 9, wheels: [undefined, [1, 10]] },
    ]) {
        const expected = { code: "VALUE", message: /\[[01]\] is missing/ };
        assert.throws(() => w.addJoint({ ...wrong, a, b }), expected, JSON.stringify(wrong));
    }
    assert.equal(w.joints().length, 0);
});

test("a joint needs both of its bodies and knows its options", () => {
    const w = world();
    const [a, b] = [0, 2].map((x) => w.spawn({ position: [x, 5], shapes: [L.circle("0.5")] }));
    for (const wrong of [{ b }, { a }, { a, b: undefined }, { a, b: null }, { a, b: NaN }]) {
        assert.throws(() => w.addJoint({ type: "weld", ...wrong }), { code: "VALUE" }, JSON.stringify(wrong));
    }
    assert.throws(() => w.addJoint({ type: "revolute", a, b, motor: { speed: 1, maxTorque: 2 } }), /no option maxTorque/);
    assert.throws(() => w.addJoint({ type: "revolute", a, b, threshold: { force: 1, break: true } }), /no option break/);
    assert.throws(() => w.addJoint({ type: "revolute", a, b, motor: { speed: 1 } }), /`motor` of a joint needs `max`/);
    assert.throws(() => new L.Commands().addJoint({ type: "weld", a, b, anchor: [1, 5] }), /use `anchorA` and `anchorB`/);
    assert.throws(() => w.setBody(a, { ...w.body(a) }), /`setBody` has no option position/);
    assert.throws(() => w.addJoint({ type: "revolute", a, b, limit: [0] }), /limit has 2 items/);
    assert.throws(() => w.addJoint({ type: "revolute", a, b, teeth: [1, 2] }), /type revolute has no option teeth/);
    assert.throws(() => w.addJoint({ type: "weld", a, b, anchor: [1, 5], anchorA: [1, 0] }), /either `anchor` or `anchorA`/);
    assert.throws(() => w.addJoint({ type: "wheel", a, b, axis: [0, 1] }), /`axis` of a joint needs `anchor`/);
    assert.equal(w.joints().length, 0);
    const joint = w.addJoint({ type: "revolute", a, b, anchor: [1, 5] });
    assert.throws(() => w.setJoint(joint, { ...w.joint(joint), anchor: [2, 5] }), /no option anchor/);
    w.setJoint(joint, { ...w.joint(joint), limit: [0, 1] });
});

test("settings of a body are read and set as a whole", () => {
    const w = world();
    const body = w.spawn({ gravityScale: "0.5", lockX: true, continuous: "bullet", shapes: [L.circle(1)] });
    const { gravityScale, lockX, continuous, linearDamping, maySleep } = w.body(body);
    assert.deepEqual([gravityScale.toString(), lockX, continuous, linearDamping.toString(), maySleep], ["0.5", true, "bullet", "0", true]);
    w.setBody(body, { gravityScale, lockX, continuous, linearDamping: 1 });
    assert.deepEqual([w.body(body).lockX, w.body(body).linearDamping.toString()], [true, "1"]);
    w.setBody(body, {});
    assert.deepEqual([w.body(body).lockX, w.body(body).linearDamping.toString()], [false, "0"]);
    for (const ignored of [{ mass: L.massOf([L.circle(1)]) }, { type: "fixed" }, { name: "x" }, { position: [0, 0] }]) {
        assert.throws(() => w.setBody(body, ignored), { code: "VALUE", message: /no option/ });
    }
});

test("a hole in a list is an error", () => {
    const w = world();
    const [a, b] = [0, 2].map((x) => w.spawn({ position: [x, 5], shapes: [L.circle("0.5")] }));
    const before = w.hash();
    for (const call of [
        () => w.spawnEach({}, [{ position: [0, 0] }, , { position: [1, 0] }]), () => w.spawnEach({}, new Array(2)),
        () => w.addJointEach({ type: "weld" }, [[a, b], , ]), () => w.addJointEach({ type: "weld" }, [[a, ,]]),
        () => w.spawn({ shapes: [L.chain([[0, 0], , [2, 0], [3, 0]])] }), () => w.spawn({ shapes: [L.circle(1), , ] }),
        () => w.spawn({ shapes: [L.polygon([[0, 0], , [1, 0], [0, 1]])] }), () => w.castRay([0, 0], [1, 0], { except: [a, , b] }),
    ]) {
        assert.throws(call, { code: "VALUE" }, String(call));
    }
    assert.equal(w.hash(), before);
});

class Polar {
    constructor(radius, angle) {
        Object.assign(this, { radius, angle });
    }
    get x() {
        return L.rotate([this.radius, 0], this.angle).x;
    }
    get y() {
        return L.rotate([this.radius, 0], this.angle).y;
    }
}

test("getters of a vector may calculate, and other calls in them are errors", () => {
    const [w, plain, polar] = [world(), ({ x, y }) => [x, y], new Polar(3, L.degrees(30))];
    const [body, same] = [polar, plain(polar)].map((position) => w.spawn({ position, velocity: position, shapes: [L.circle(1)] }));
    assert.deepEqual([w.body(body).position, w.body(body).velocity], [w.body(same).position, w.body(same).velocity]);
    w.despawn(same);
    const [low, high] = [new Polar(6, L.degrees(-135)), new Polar(6, L.degrees(45))];
    assert.deepEqual([w.overlapBox(low, high), w.overlapBox(plain(low), plain(high))], [w.shapesOf(body), w.shapesOf(body)]);
    const other = { y: 0, get x() { return w.body(body).position.x; } };
    assert.throws(() => w.spawn({ position: other }), { code: "VALUE", message: /getter/ });
    assert.throws(() => w.overlapBox(other, [9, 9]), { code: "VALUE", message: /getter/ });
});

test("a getter of an option that calls the library is an error", () => {
    const w = world();
    const body = w.spawn({ shapes: [L.circle(1)] });
    const joint = w.addJoint({ type: "weld", a: body, b: w.spawn({}) });
    const before = w.hash();
    const stray = (key, rest = {}) => Object.defineProperty({ ...rest }, key, { enumerable: true, get: () => w.tick });
    for (const call of [
        () => w.spawn(stray("userData")), () => w.spawn({ shapes: [L.circle(1, stray("userData"))] }),
        () => w.spawn(stray("type")), () => w.setBody(body, stray("lockX")),
        () => w.setMass(body, stray("mass", { gyration: 1 })), () => w.addShape(body, L.circle(1, stray("oneWay"))),
        () => w.setJoint(joint, stray("collide", { type: "weld" })),
        () => w.addJoint({ type: "revolute", a: body, b: body, motor: stray("speed", { max: 1 }) }),
        () => w.setConfig(stray("sleeping")), () => w.castRay([0, 0], [1, 0], stray("sensors")),
        () => L.encodeMoverState({ position: [0, 0], ground: stray("shape") }),
    ]) {
        assert.throws(call, { code: "VALUE", message: /a getter of an argument calls the library/ }, String(call));
    }
    assert.equal(w.hash(), before);
    checkGuards();
});

test("getters of a point may call the library", () => {
    const w = world();
    const body = w.spawn({ angularVelocity: 1, shapes: [L.circle(1)] });
    const clone = w.clone();
    const point = { y: 0, get x() { return w.body(body).position.x; } };
    assert.deepEqual(w.velocityAt(body, point), w.velocityAt(body, [0, 0]));
    checkGuards();
    w.explode({ centre: point, impulse: 1, radius: 2 });
    checkGuards();
    clone.explode({ centre: [0, 0], impulse: 1, radius: 2 });
    assert.equal(w.hash(), clone.hash());
});

test("an empty list adds nothing, and writes nothing behind the scratch memory", () => {
    const [w, list] = [world(), new L.Commands()];
    const calls = [(to) => to.spawnEach({ shapes: [L.circle(1)] }, []), (to) => to.addJointEach({ type: "weld" }, [])];
    for (const call of calls) {
        for (const [to, added] of [[w, []], [list, undefined]]) {
            assert.deepEqual(call(to), added, String(call));
            checkGuards();
        }
    }
    assert.deepEqual([w.counts().bodies, w.counts().joints, list.length], [0, 0, 2]);
});

test("a key that nothing reads is an error", () => {
    const w = world();
    assert.throws(() => w.spawnEach({}, [{ position: [0, 0] }, { position: [1, 0], rotation: 0 }]), /pose 1 has no option rotation/);
    assert.equal(w.counts().bodies, 0);
});

test("an integer that a number cannot represent is to be a BigInt", () => {
    const w = world();
    assert.throws(() => w.spawn({ userData: 2 ** 53 }), { code: "VALUE", message: /pass a BigInt/ });
    assert.throws(() => w.spawn({ userData: 2 ** 64 }), { code: "VALUE", message: /from 0 to 18446744073709551615/ });
    assert.equal(w.body(w.spawn({ userData: 2n ** 53n })).userData, 2n ** 53n);
});

test("a pulley has wheels and a length", () => {
    const w = world();
    const [a, b] = [0, 4].map((x) => w.spawn({ position: [x, 5], shapes: [L.circle("0.5")] }));
    const pulley = { type: "pulley", a, b, wheels: [[0, 10], [4, 10]] };
    assert.throws(() => w.addJoint(pulley), { code: "VALUE", message: /`length`/ });
    assert.throws(() => w.addJoint({ ...pulley, wheels: undefined, length: 10 }), { code: "VALUE", message: /`wheels`/ });
    assert.throws(() => w.addJointEach({ ...pulley, a: undefined, b: undefined }, [[a, b]]), { code: "VALUE" });
    const joint = w.addJoint({ ...pulley, anchor: [0, 5] });
    w.setJoint(joint, w.joint(joint));
    assert.ok(w.joint(joint).length.gt(9));
});

test("null in place of an argument is an error with a code", () => {
    const w = world();
    const state = { position: [0, 0], velocity: [0, 0], ground: null };
    for (const call of [
        () => w.castShape(null, [0, 0], [1, 0]), () => w.castShape(L.circle(1), null, [1, 0]), () => w.castShape(L.circle(1), [0, 0], null),
        () => w.castShape(L.circle(1), [0, 0], [1, 0], null), () => w.overlapShape(L.circle(1), [0, 0], null), () => L.chain([], null),
        () => w.castRay([0, 0], [1, 0], null), () => w.castRayAll([0, 0], [1, 0], null), () => w.overlapPoint([0, 0], null),
        () => w.overlapBox([0, 0], [1, 1], null), () => w.closest([0, 0], 1, null), () => w.castRay([0, 0], [1, 0], { except: null }),
        () => L.moveCharacter(w, { shape: L.circle(1) }, state), () => L.moveCharacter(w, null, { position: [0, 0] }),
        () => L.encodeMoverState(state), () => L.encodeMoverState({ position: [0, 0], ground: { point: null } }),
        () => L.encodeMoverState(null), () => L.decodeMoverState(null), () => w.setMass(0, null), () => w.setName(0, null),
    ]) {
        assert.throws(call, { name: "Lockstep2dError" }, String(call));
    }
});

test("options of `init` are checked", () => {
    assert.deepEqual(initErrors.map((error) => error?.code), ["VALUE", "VALUE", "VALUE", "VALUE"]);
    assert.match(initErrors[0].message, /`init` has no option SIMD/);
});

test("a name with a zero character is an error", () => {
    const w = world();
    const body = w.spawn({ name: "ball" });
    for (const wrong of ["ab\0cd", "ab\0", "\0"]) {
        assert.throws(() => w.spawn({ name: wrong }), { code: "VALUE", message: /name contains a zero character/ });
        assert.throws(() => w.setName(body, wrong), { code: "NAME" });
    }
    assert.deepEqual([w.bodies().length, w.bodyName(body)], [1, "ball"]);
    w.setName(body, "");
    assert.equal(w.bodyName(body), undefined);
});

test("a long list of small items reserves no memory for large ones", () => {
    const w = world();
    w.spawnEach({ type: "fixed" }, Array.from({ length: 100_000 }, (_, x) => ({ position: [x % 300, Math.floor(x / 300)] })));
    assert.equal(w.poses().length, 500_000);
    const before = library().memory.buffer.byteLength;
    w.spawn({ type: "fixed", shapes: [L.chain([[0, 0], [1, 0], [2, 0], [3, 0], [4, 0]])] });
    const grown = library().memory.buffer.byteLength - before;
    assert.ok(grown < 32 * 2 ** 20, `${grown} bytes`);
});
