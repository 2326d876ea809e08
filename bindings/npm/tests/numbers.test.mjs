// Arithmetic in JavaScript gives the same results as the library, and floats are refused.
import assert from "node:assert/strict";
import { test } from "node:test";
import { inspect } from "node:util";
import { L, fallingBox, file } from "./common.mjs";
import { library, fxAt, giveText, scratch, call } from "../src/library.js";

const random = new L.Random(7);
const number = () => L.Fx.fromRaw(((BigInt(random.below(2 ** 32 - 1)) << 32n) | BigInt(random.below(2 ** 32 - 1))) >> BigInt(random.below(64)));

test("products and quotients are those of the library", () => {
    for (let i = 0; i < 2000; i++) {
        const [a, b] = [number(), number()];
        assert.equal(a.mul(b).raw, library().ls2d_fx_mul(a.raw, b.raw), `${a} * ${b}`);
        assert.equal(a.add(b).raw, library().ls2d_fx_add(a.raw, b.raw));
        if (b.raw !== 0n) {
            const at = scratch(8);
            call("ls2d_fx_div", a.raw, b.raw, at);
            assert.equal(a.div(b).raw, fxAt(at).raw, `${a} / ${b}`);
        }
    }
});

test("decimal texts are read and written as by the library", () => {
    for (let i = 0; i < 2000; i++) {
        const value = number();
        assert.equal(L.fx(value.toString()).raw, value.raw, value.toString());
        const digits = `${i % 2 ? "-" : ""}${random.below(1000)}.${random.below(1e9)}${random.below(1e9)}`;
        const [at, length] = giveText(digits);
        call("ls2d_fx_parse", at + 64, length, at);
        assert.equal(L.fx(digits).raw, fxAt(at).raw, digits);
    }
});

test("angles are those of the library", () => {
    for (let i = 0; i < 500; i++) {
        const value = L.Fx.fromRaw(number().raw >> 20n);
        assert.equal(L.degrees(value).bits, library().ls2d_angle_from_degrees(value.raw) >>> 0, `${value} degrees`);
        assert.equal(L.radians(value).bits, library().ls2d_angle_from_radians(value.raw) >>> 0, `${value} rad`);
    }
    const angles = Array.from({ length: 500 }, () => new L.Angle(Number(number().raw & 0xffffffffn)));
    for (const angle of [...angles, ...["0", "0.25", "0.5", "0.75"].map(L.turns), new L.Angle(0x7fffffff), new L.Angle(0x80000001)]) {
        assert.equal(angle.toDegrees().raw, library().ls2d_angle_to_degrees(angle.bits), `${angle.bits} in degrees`);
        assert.equal(angle.toRadians().raw, library().ls2d_angle_to_radians(angle.bits), `${angle.bits} in rad`);
    }
    assert.deepEqual([180, -90].map((value) => L.degrees(value).toDegrees()), [L.fx(180), L.fx(-90)]);
    assert.equal(L.sin(L.degrees(90)).toNumber(), 1);
    assert.deepEqual([180, -90].map((degrees) => L.degrees(degrees).toNumber()), [Math.PI, -Math.PI / 2]);
    assert.deepEqual(L.rotate([2, 0], L.degrees(90)), { x: L.fx(0), y: L.fx(2) });
    assert.equal(L.sqrt("6.25").toString(), "2.5");
});

test("numbers and angles are readable in a console", () => {
    assert.equal(inspect(L.fx("1.25")), "Fx(1.25)");
    assert.equal(inspect([L.degrees("-22.5")]), "[ Angle(-22.5 degrees) ]");
    assert.equal(`${L.degrees(45)}`, "45");
});

test("a float is an error that says why", () => {
    const world = new L.World();
    const body = world.spawn({});
    for (const call of [
        () => L.fx(0.1),
        () => world.setVelocity(body, [0, Math.sin(1)]),
        () => world.spawn({ position: { x: 0.5, y: 0 } }),
        () => world.castRay([0, 0], [0, Number.NaN]),
        () => world.setGravity([Infinity, 0]),
    ]) {
        assert.throws(call, (error) => error.code === "FLOAT" && /floats differ between machines/.test(error.message));
    }
    assert.throws(() => L.fx(1) + 1, { code: "FLOAT" });
    assert.throws(() => L.fx("1e3"), { code: "TEXT" });
    assert.throws(() => L.sqrt(-1), { code: "NUMBER" });
    world.dispose();
});

test("numbers and angles have no operators", () => {
    const [speed, angle] = [L.fx(2), L.degrees(45)];
    for (const call of [
        () => speed < L.fx(3), () => speed * 2, () => `${speed}` + speed, () => angle < L.degrees(90), () => angle + angle, () => angle * 2,
        () => -angle, () => angle == 0,
    ]) {
        assert.throws(call, { code: "FLOAT", message: /has no operators: use add, sub/ }, String(call));
    }
});

test("the README tells how a body is written as JSON", () => {
    const { world, box } = fallingBox();
    const readme = new TextDecoder().decode(file("bindings/npm/README.md"));
    const [, replacer] = /JSON\.stringify\(world\.body\(crate\), (.*)\);/.exec(readme);
    const text = JSON.stringify(world.body(box), new Function(`return ${replacer}`)());
    const { position, userData, type } = JSON.parse(text);
    assert.deepEqual([position, userData, type], [{ x: "0", y: "3" }, "0", "dynamic"]);
    assert.equal(L.fx(position.y).raw, world.body(box).position.y.raw);
});
