// Tests of `MatchDriver` with a game that has no world.
import assert from "node:assert/strict";
import { test } from "node:test";
import { L } from "./common.mjs";

const address = (index) => Uint8Array.of(index);

test("a wrong time is an error, and the match goes on", () => {
    const game = { step: () => {}, save: () => 0, load: () => {}, hash: () => "0".repeat(32) };
    const driver = new L.MatchDriver(new L.Match({ seats: 1 }), game, () => {});
    const inputs = () => Uint8Array.of(0);
    for (let now = 5000; now < 5500; now += 10) driver.update(now, inputs);
    const { tick } = driver;
    assert.ok(tick > 10);
    for (const wrong of [NaN, undefined, "5510", -1, Infinity, 4000]) {
        assert.throws(() => driver.update(wrong, inputs), { code: "VALUE" });
        assert.throws(() => driver.receive(wrong, address(1), new Uint8Array(1)), { code: "VALUE" });
    }
    // The timestamp of a frame may be a little less than the time of a packet that was processed before.
    driver.update(5400, inputs);
    for (let now = 5500; now < 6000; now += 10) driver.update(now, inputs);
    assert.ok(driver.tick > tick + 20, `${driver.tick} ticks`);
});

test("a driver that is disposed of frees its saves", () => {
    let kept = 0;
    const game = { step: () => {}, save: () => ++kept, load: () => {}, drop: () => kept--, hash: () => "0".repeat(32) };
    const match = new L.Match({ seats: 1 });
    const driver = new L.MatchDriver(match, game, () => {});
    for (let now = 0; now < 500; now += 10) driver.update(now, () => Uint8Array.of(0));
    assert.ok(kept > 0);
    driver.dispose();
    driver.dispose();
    assert.equal(kept, 0);
    const packet = new Uint8Array(1);
    for (const use of [() => driver.update(510, () => packet), () => driver.receive(510, address(1), packet), () => driver.pause(true)]) {
        assert.throws(use, { code: "DISPOSED" });
    }
    assert.equal(match.status, "playing", "the match belongs to the caller");
});

test("a driver asks the next contact if one does not answer, refuses it, or has no match", () => {
    const game = () => ({
        step: () => {}, save: () => 0, load: () => {}, hash: () => "0".repeat(32), encode: () => new Uint8Array(1), decode: () => {},
    });
    const driver = (options, contacts) => {
        const sent = [];
        const match = new L.Match({ seats: 2, ...options });
        const send = (to, packet) => sent.push({ to: to[0], packet });
        return { match, sent, driver: new L.MatchDriver(match, game(), send, contacts && { contacts }) };
    };
    // Nobody is at address 1. At 2 is a peer that joins itself, at 3 the host of another game.
    const members = new Map([
        [2, driver({ contact: address(9) })],
        [3, driver({ offer: Uint8Array.of(7) })],
        [4, driver({})],
        [5, driver({ contact: address(1) }, () => [1, 2, 3, 4].map(address))],
    ]);
    const guest = members.get(5).match;
    for (let now = 0; now < 12_000; now += 10) {
        for (const [from, member] of members) {
            member.driver.update(now, (seats) => new Uint8Array(seats.length));
            for (const { to, packet } of member.sent.splice(0)) {
                members.get(to)?.driver.receive(now, address(from), packet);
            }
        }
    }
    assert.equal(guest.status, "playing");
    assert.throws(() => new L.MatchDriver(guest, game(), () => {}, { contact: 1 }), { code: "VALUE" });
});
