// Compiled with --strict only: the types of matches, relays and replays.
import {
    Commands, type Lockstep2dError, Match, MatchDriver, type MatchGame, Recorder, Recording, Relay, Replay, ReplayDriver,
    type Snapshot, World, decodeNativeState, degrees, encodeNativeState, fx, nativeOffer, verifyReplay,
} from "lockstep2d";

import { World as CoreWorld, type BodyOptions } from "lockstep2d/core";

const body: BodyOptions = { position: [0, "0.5"] };
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
    const contact: Uint8Array | undefined = relay.others[0];
    const match = new Match({ seats: 2, offer: nativeOffer({ rules: "types", seats: 2 }), ...(contact ? { contact } : {}) });
    const driver = new MatchDriver(match, game, (to, packet) => relay.send(to, packet));
    relay.onPacket = (from, packet) => driver.receive(performance.now(), from, packet);
    const events = driver.update(performance.now(), (seats) => Uint8Array.from(seats, () => 0));
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
    const bodies: number[] = world.spawnEach({ shapes: [] }, [{ position: [0, "0.5"], angle: degrees(30) }, { position: [1, 0] }]);
    world.addJointEach({ type: "revolute" }, [[bodies[0]!, bodies[1]!]]);
    const { verdict } = verifyReplay(recording.finish());
    return verdict + fx("0.5").mul(2).toString();
}

export const codeOf = (error: unknown): string => (error as Lockstep2dError).code;
// @ts-expect-error The types cannot refuse a number with a fraction, but they refuse a wrong object.
world.setGravity({ wrong: true });
