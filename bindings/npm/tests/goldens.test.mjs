// Replays of seven golden scenes, or of all with LOCKSTEP2D_LONG=1, and the falling box.
import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { test } from "node:test";
import { L, fallingBox, file, root } from "./common.mjs";

const lines = new TextDecoder().decode(file("tests/goldens.txt")).split("\n").map((line) => line.split(" "));
const goldens = new Map(lines.filter(([semantics]) => semantics === String(L.semantics())).map(([, name, ticks, hash]) => [name, { ticks, hash }]));
const quick = ["ragdoll", "bridge", "character", "box_stack", "waterworks", "spring_leg", "hundred_polygons"];
const all = readdirSync(new URL("replays/", root)).filter((name) => name.endsWith(".replay")).map((name) => name.slice(0, -7));

for (const name of process.env.LOCKSTEP2D_LONG ? all : quick) {
    test(`${name} ends in its golden (${L.loaded()})`, () => {
        const verdict = L.verifyReplay(file(`replays/${name}.replay`));
        assert.equal(verdict.verdict, "match", verdict.text);
        assert.deepEqual([String(verdict.ticks), verdict.hash], [goldens.get(name).ticks, goldens.get(name).hash]);
    });
}

test("the falling box has the hash that it has in C and in Rust", () => {
    const { world } = fallingBox();
    world.step(120);
    const expected = new TextDecoder().decode(file("bindings/c/falling_box.hash")).trim();
    assert.equal(world.hash(), expected);
});
