// A test of the types: this file is compiled, but not run.
import {
    type BodyId, type Bytes, Commands, type Edits, Handle, type JointId, type Lockstep2dError, Match, MatchDriver, type MatchGame,
    type MoverState, Recorder, Recording, Relay, Replay, ReplayDriver, type ShapeId, type Snapshot, World, box, decodeNativeState,
    degrees, encodeNativeState, fx, moveCharacter, nativeOffer, verifyReplay,
} from "lockstep2d";

import { World as CoreWorld, massOf, type BodyOptions, type BodyPose } from "lockstep2d/core";

const body: BodyOptions = { position: [0, "0.5"], mass: { ...massOf([box(1, 1)]), mass: 80 } };
export const pose: BodyPose = { position: [0, "0.5"] };
export const core = (made: CoreWorld): number => made.spawn(body);
let world = new World();
const game: MatchGame<Snapshot> = {
    step: (inputs) => world.step(inputs.length > 0 ? 1 : 0),
    save: () => world.save(),
    load: (saved) => world.restore(saved),
    drop: (saved) => saved.dispose(),
    hash: () => world.hash(),
    encode: () => encodeNativeState(world),
    decode: (bytes) => {
        world = decodeNativeState(bytes);
    },
};

export async function play(url: string): Promise<number> {
    const relay = await Relay.connect(url, "ABCD");
    const match = new Match({ seats: 2, offer: nativeOffer({ rules: "types", seats: 2 }), contact: relay.others[0] });
    const driver = new MatchDriver(match, game, (to, packet) => relay.send(to, packet));
    relay.onPacket = (from, packet) => driver.receive(performance.now(), from, packet);
    const events = driver.update(performance.now(), (seats) => Uint8Array.from(seats, () => 0));
    const ping: number | undefined = match.link(events[0]?.peer ?? 0)?.ping;
    if (driver.ended || (ping ?? 0) > 1000) {
        match.leave();
    }
    return events.filter(({ kind }) => kind === "desync").length;
}

export function record(): string {
    const setup = new Commands();
    const recording = new Recording({ setup });
    recording.step(setup);
    const recorder = new Recorder({ rules: "types", players: 1, inputBytes: 1, start: world.hash() });
    recorder.record(Uint8Array.of(0));
    recorder.claim("score", 1);
    const replay = new Replay(recorder.finish(world.hash()));
    const driver = new ReplayDriver(replay, game);
    driver.seek(replay.ticks);
    const score: bigint | undefined = replay.claims.get("score");
    replay.claim("score", score ?? 0);
    const bodies = world.spawnEach({ shapes: [] }, [{ position: [0, "0.5"], angle: degrees(30) }, { position: [1, 0] }]);
    world.addJointEach({ type: "revolute" }, [[bodies[0]!, bodies[1]!]]);
    const { verdict } = verifyReplay(recording.finish());
    return verdict + fx("0.5").mul(2).toString();
}

export function handles(): number {
    const [crate, post] = [world.spawn({ shapes: [box(1, 1)] }), world.spawn({ type: "fixed" })];
    const sizes = new Map([[crate, 2], [post, 1]]);
    const poses = world.poses();
    const [shape] = world.shapesOf(crate);
    const joint: JointId = world.addJoint({ type: "revolute", a: post, b: crate, anchor: [0, 1] });
    world.setJoint(joint, { ...world.joint(joint), motor: { speed: 1, max: 10 } });
    const { linearDamping, continuous, lockX } = world.body(crate)!;
    world.setBody(crate, { linearDamping, continuous, lockX, lockRotation: true });
    world.setMass(crate, massOf([box(1, 1)]));
    world.setMass(crate);
    world.setConfig({ ...world.config(), tickRate: world.config().tickRate * 2, gravity: world.config().gravity });
    let state: MoverState = { position: [0, 2] };
    state = moveCharacter(world, { shape: box(1, 1) }, { ...state, velocity: [1, 0] }).state;
    const known: ShapeId | undefined = shape;
    // @ts-expect-error A shape is not a body.
    world.wake(known);
    // @ts-expect-error A number is not a handle.
    world.wake(0);
    // @ts-expect-error A body is not a joint.
    world.enableJoint(crate);
    // @ts-expect-error A world is not a snapshot.
    world.restore(world);
    // @ts-expect-error The position is not a setting.
    world.setBody(crate, { position: [0, 0] });
    // @ts-expect-error A list of commands does not know the poses of bodies, which `anchor` needs.
    new Commands().addJoint({ type: "weld", a: 0 as BodyId, b: 1 as BodyId, anchor: [0, 0] });
    return (sizes.get(poses[0] as BodyId) ?? 0) + crate + world.shapeBox(shape!).lower.x.toNumber();
}

export function brief(file: Uint8Array): string {
    using brief = new World();
    using replay = new Replay(file);
    using driver = new ReplayDriver(replay, game);
    driver.step();
    return brief.hash();
}

/** The library returns bytes in buffers of their own, which `postMessage`, `RTCDataChannel` and `Blob` require. */
export function bytes(recording: Recording, match: Match, channel: RTCDataChannel): Blob {
    const floats = world.poses();
    postMessage(floats, "*", [floats.buffer]);
    const shared: Float64Array = world.poses(new Float64Array(new SharedArrayBuffer(800)));
    const send = (_: Uint8Array, packet: Bytes): void => channel.send(packet);
    const driver = new MatchDriver(match, game, send);
    driver.pause(!driver.isPaused && shared.length > 0);
    driver.dispose();
    return new Blob([recording.take(), world.toBytes(), recording.finish()]);
}

export const weightless = (edits: Edits, { dispose }: Handle): void => (edits.setGravity([0, 0]), dispose());
// @ts-expect-error The class has a type, but no value that a program could import.
export const handle: unknown = Handle;

export const codeOf = (error: unknown): string => (error as Lockstep2dError).code;
// @ts-expect-error The types cannot refuse a number with a fraction, but they refuse a wrong object.
world.setGravity({ wrong: true });
