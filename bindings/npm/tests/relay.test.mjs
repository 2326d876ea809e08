// A member of a room notices that its connection is dead. The test replaces the WebSocket and the clock.
import assert from "node:assert/strict";
import { test } from "node:test";
import { L } from "./common.mjs";

const [YOU, OTHER] = ["0102030405060708", "1112131415161718"];
const bytesOf = (digits) => [...Buffer.from(digits, "hex")];

/** A stand-in for a WebSocket. It reports its end only when the test calls `onclose`, like the socket of a dead
 * connection. */
class Socket {
    static all = [];
    readyState = 0;
    bufferedAmount = 0;
    sent = [];

    constructor() {
        Socket.check?.();
        Socket.all.push(this);
    }

    enter() {
        this.readyState = 1;
        this.onopen();
        this.onmessage({ data: JSON.stringify({ you: YOU, others: [OTHER] }) });
    }

    frame(from, datagram = []) {
        this.onmessage({ data: Uint8Array.of(...bytesOf(from), ...datagram).buffer });
    }

    send(data) {
        this.sent.push([...data]);
    }

    close() {
        this.readyState = 2;
    }
}

/** Returns a function that lets time pass, in seconds. */
function clock(t) {
    let now = 1000;
    Socket.all = [];
    // Node resets the mocks of a test by itself, Deno does not.
    t.after(() => t.mock.reset());
    t.mock.timers.enable({ apis: ["setTimeout", "setInterval"] });
    t.mock.method(performance, "now", () => now);
    return (seconds) => {
        for (let i = 0; i < 10 * seconds; i++) {
            now += 100;
            t.mock.timers.tick(100);
        }
    };
}

async function enter() {
    const connecting = L.Relay.connect("wss://relay.example", "ABCD", { WebSocket: Socket });
    Socket.all.at(-1).enter();
    const relay = await connecting;
    const packets = [];
    relay.onPacket = (from, packet) => packets.push([...packet]);
    return { relay, packets, socket: Socket.all.at(-1) };
}

test("a silent relay is asked, and its answer is no packet", async (t) => {
    const pass = clock(t);
    const { relay, packets, socket } = await enter();
    pass(4);
    assert.equal(socket.sent.length, 1, "only the secret");
    for (let i = 2; i < 6; i++) {
        pass(6);
        assert.deepEqual([socket.sent.length, socket.sent.at(-1)], [i, bytesOf(YOU)]);
        socket.frame(YOU);
    }
    socket.frame(OTHER, [7]);
    socket.frame(OTHER);
    socket.frame(YOU, [8]);
    assert.deepEqual([packets, Socket.all.length, relay.isOpen], [[[7], [], [8]], 1, true]);
    relay.close();
});

test("a connection without an answer is opened again", async (t) => {
    const pass = clock(t);
    const { relay, packets, socket: dead } = await enter();
    const members = t.mock.fn();
    relay.onMembers = members;
    pass(14);
    assert.equal(relay.isOpen, true);
    pass(4);
    assert.deepEqual([dead.readyState, Socket.all.length, relay.isOpen], [2, 2, false]);
    const again = Socket.all[1];
    again.enter();
    assert.deepEqual([relay.isOpen, members.mock.callCount(), again.sent], [true, 1, dead.sent.slice(0, 1)]);
    // Minutes later, the first socket reports its end, with the code for a newer connection of the same member.
    dead.frame(OTHER, [1]);
    dead.onclose({ code: 4003, reason: "" });
    again.frame(OTHER, [2]);
    assert.deepEqual([packets, relay.isOpen], [[[2]], true]);
    // The relay accepts connections, but then sends nothing.
    pass(17);
    assert.equal(Socket.all.length, 3);
    pass(11);
    assert.equal(Socket.all.length, 4);
    relay.close();
    pass(60);
    assert.equal(Socket.all.length, 4);
});

test("a WebSocket that cannot be made is tried again", async (t) => {
    const pass = clock(t);
    const { relay, socket } = await enter();
    let failures = 0;
    Socket.check = () => {
        if (failures < 3) {
            failures++;
            throw new DOMException("no memory", "OperationError");
        }
    };
    t.after(() => (Socket.check = undefined));
    socket.onclose({ code: 1006, reason: "" });
    // The pauses before the attempts: 0.25, 0.5, 1 and 2 seconds.
    pass(3);
    assert.deepEqual([failures, Socket.all.length], [3, 1]);
    pass(1);
    assert.equal(Socket.all.length, 2);
    Socket.all[1].enter();
    assert.deepEqual([relay.isOpen, relay.isClosed], [true, false]);
    relay.close();
});

test("a page that was suspended keeps its connection", async (t) => {
    const pass = clock(t);
    const { relay, socket } = await enter();
    const { now } = performance;
    t.mock.method(performance, "now", () => now() + 3_600_000);
    pass(1);
    assert.deepEqual([socket.sent.at(-1), relay.isOpen], [bytesOf(YOU), true]);
    socket.frame(YOU);
    pass(4);
    assert.deepEqual([Socket.all.length, relay.isOpen], [1, true]);
    relay.close();
});

test("a relay that does not answer cannot be entered", async (t) => {
    const pass = clock(t);
    const connecting = L.Relay.connect("wss://relay.example", "ABCD", { WebSocket: Socket });
    const refused = assert.rejects(connecting, { code: "RELAY", message: /not answer/ });
    pass(11);
    await refused;
    pass(60);
    assert.deepEqual(Socket.all.map(({ readyState }) => readyState), [2]);
});

test("an address that the page cannot open is an error of the relay", async () => {
    class Refusing {
        constructor() {
            throw new DOMException("insecure", "SecurityError");
        }
    }
    await assert.rejects(L.Relay.connect("ws://relay.example", "ABCD", { WebSocket: Refusing }), { code: "RELAY", message: /insecure/ });
});

test("a member that has entered elsewhere is closed", async (t) => {
    const pass = clock(t);
    const { relay, socket } = await enter();
    assert.equal(relay.isClosed, false);
    socket.onclose({ code: 1006, reason: "" });
    assert.deepEqual([relay.isOpen, relay.isClosed], [false, false]);
    pass(1);
    Socket.all.at(-1).enter();
    Socket.all.at(-1).onclose({ code: 4003, reason: "" });
    assert.deepEqual([relay.isOpen, relay.isClosed], [false, true]);
});
