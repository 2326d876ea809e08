// A member that is alone in a room, so that it gets frames only from the relay: node silent.mjs URL
//
// The member keeps its connection for more than 15 seconds. If the relay did not answer, the member would reconnect
// then.
import assert from "node:assert/strict";
import { Relay } from "../../src/index.js";

const relay = await Relay.connect(process.argv[2], "SILENCE");
let [entered, packets] = [0, 0];
relay.onMembers = () => entered++;
relay.onPacket = () => packets++;
await new Promise((resolve) => setTimeout(resolve, 18_000));
assert.deepEqual([relay.isOpen, entered, packets], [true, 0, 0]);
relay.close();
