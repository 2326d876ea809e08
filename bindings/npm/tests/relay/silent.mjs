// A member alone in a room, which no frame reaches but the answers of the relay: node silent.mjs URL
//
// It keeps its connection for longer than the 15 seconds after which a silent one is opened again.
import assert from "node:assert/strict";
import { Relay } from "../../src/index.js";

const relay = await Relay.connect(process.argv[2], "SILENCE");
let [entered, packets] = [0, 0];
relay.onMembers = () => entered++;
relay.onPacket = () => packets++;
await new Promise((resolve) => setTimeout(resolve, 18_000));
assert.deepEqual([relay.isOpen, entered, packets], [true, 0, 0]);
relay.close();
