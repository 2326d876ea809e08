// The rules: two players on a seesaw push each other into the water. Every peer executes the rules with the same inputs
// and must get the same state, so they use no floats, no `Math.random`, no clock and nothing of Phaser.
import { World, box, circle, hashBytes, polygon } from "lockstep2d";

export const RULES = "seesaw";
export const SEATS = 2;
/** Number of points that win a match. */
export const WIN = 5;
/** Bits of an input. The input of a player for a tick is one byte. */
export const [LEFT, RIGHT, JUMP, SLAM] = [1, 2, 4, 8];
/** Names of the kinds of bodies and of their textures. The `userData` of a body is the index of its kind. */
export const KINDS = ["post", "plank", "amber", "blue", "crate", "box"];
/** The y coordinate of the water surface in metres. */
export const WATER = "-2.25";

// Number of ticks between two crates, and number of ticks from a point to the next round.
const [CRATE_EVERY, REST] = [150, 100];
const CRATES_MAX = 6;
const encoder = new TextEncoder();

export class Game {
    /** State outside of the world: points of each player; ticks until the next round (`rest`, 0 during a round). */
    points = new Uint8Array(SEATS);
    rest = 0;
    /** Effects of the last tick, for drawing. They are not part of the state. */
    effects = [];

    constructor() {
        const world = new World({ gravity: [0, -20], hitSpeed: 2 });
        // The water is a sensor that slows down everything that falls into it.
        const water = box(40, 4, { offset: [0, -4], area: { linearDrag: 6 } });
        this.post = world.spawn({
            type: "fixed",
            position: [0, WATER],
            userData: KINDS.indexOf("post"),
            shapes: [polygon([["-0.7", "-1.5"], ["0.7", "-1.5"], ["0.15", 2], ["-0.15", 2]]), water],
        });
        const plank = box("4.5", "0.2", { friction: "0.9", density: 2 });
        this.plank = world.spawn({ userData: KINDS.indexOf("plank"), shapes: [plank] });
        world.addJoint({
            type: "revolute", a: this.post, b: this.plank, anchor: [0, 0],
            limit: ["-0.3", "0.3"], spring: { hertz: "0.5", dampingRatio: "0.5" },
        });
        const disc = circle("0.5", {
            density: 4, friction: "0.9", restitution: "0.4", rollingResistance: "0.05", hitEvents: true,
        });
        this.players = ["amber", "blue"].map((kind) =>
            world.spawn({ userData: KINDS.indexOf(kind), shapes: [disc], angularDamping: 1, maySleep: false }));
        this.world = world;
        this.#newRound();
    }

    /** Advances the game by a tick. */
    step(inputs) {
        this.players.forEach((player, seat) => this.#move(player, inputs[seat]));
        this.#addCrate();
        this.world.step();
        const { hits, sensorBegin, moved } = this.world.events();
        this.effects = hits.map(({ point, approachSpeed }) => ({ kind: "hit", at: point, speed: approachSpeed }));
        // The water is the only sensor, so each visitor has fallen into the water.
        const fallen = sensorBegin.map(({ visitor }) => this.world.shape(visitor).body);
        for (const body of fallen) {
            this.effects.push({ kind: "splash", at: this.world.body(body).position });
        }
        const sunk = moved.filter(({ body, position }) => position.y.lt(-5) && !this.players.includes(body));
        sunk.forEach(({ body }) => this.world.despawn(body));
        if (this.rest > 0) {
            this.rest -= 1;
            this.rest === 0 && this.#newRound();
        } else {
            this.#score(this.players.findIndex((player) => fallen.includes(player)));
        }
    }

    #move(player, input) {
        const { world } = this;
        const { position, velocity, angularVelocity, mass } = world.body(player);
        const stands = world.castRay(position, [0, "-0.65"], { except: [player] }) !== undefined;
        const along = (input & RIGHT ? 1 : 0) - (input & LEFT ? 1 : 0);
        if (along !== 0 && velocity.x.mul(along).lt(6)) {
            world.applyImpulse(player, [mass.mul(stands ? "0.5" : "0.2").mul(along), 0], position);
        }
        if (input & JUMP && stands && velocity.y.lt(3)) {
            world.setVelocity(player, [velocity.x, 9], angularVelocity);
        } else if (input & SLAM && !stands && velocity.y.gt(-14)) {
            // A player who slams one end of the plank throws up everything at the other end.
            world.setVelocity(player, [velocity.x.mul("0.5"), -14], angularVelocity);
        }
    }

    #addCrate() {
        const { world } = this;
        if (world.tick % CRATE_EVERY === CRATE_EVERY - 1 && world.counts().bodies < 2 + SEATS + CRATES_MAX) {
            // The random numbers come from the world, because its generator is part of the state.
            const isCrate = world.random(2) === 0;
            const size = isCrate ? "0.4" : "0.3";
            world.spawn({
                position: [world.randomRange(-4, 4), 8],
                userData: KINDS.indexOf(isCrate ? "crate" : "box"),
                shapes: [box(size, size, { friction: "0.7", hitEvents: true })],
            });
        }
    }

    #score(loser) {
        if (loser >= 0) {
            const seat = 1 - loser;
            this.points[seat] += 1;
            this.rest = REST;
            this.effects.push({ kind: this.points[seat] >= WIN ? "win" : "point", seat });
        }
    }

    #newRound() {
        const { world } = this;
        if (this.points.some((points) => points >= WIN)) {
            this.points.fill(0);
        }
        world.bodies().slice(2 + SEATS).forEach((crate) => world.despawn(crate));
        world.setTransform(this.plank, [0, 0]);
        world.setVelocity(this.plank, [0, 0]);
        this.players.forEach((player, seat) => {
            world.setTransform(player, [seat === 0 ? -3 : 3, 1]);
            world.setVelocity(player, [0, 0]);
        });
    }

    // `MatchDriver` and `ReplayDriver` call the functions below, which save, load and hash the whole state.

    save() {
        return { world: this.world.save(), points: this.points.slice(), rest: this.rest };
    }

    load(saved) {
        this.world.restore(saved.world);
        this.points.set(saved.points);
        this.rest = saved.rest;
    }

    drop(saved) {
        saved.world.dispose();
    }

    hash() {
        return hashBytes(Uint8Array.of(...this.points, this.rest, ...encoder.encode(this.world.hash())));
    }

    /** The state as bytes, for a peer that joins. */
    encode() {
        const world = this.world.toBytes();
        const bytes = new Uint8Array(SEATS + 1 + world.length);
        bytes.set([...this.points, this.rest]);
        bytes.set(world, SEATS + 1);
        return bytes;
    }

    decode(bytes) {
        const world = World.fromBytes(bytes.subarray(SEATS + 1));
        if (!this.players.every((player) => world.body(player))) {
            throw new Error("a state without the players");
        }
        this.world.dispose();
        this.world = world;
        this.points = bytes.slice(0, SEATS);
        this.rest = bytes[SEATS];
    }
}
