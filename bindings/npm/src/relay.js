// A member of a room of a relay.
import { byteArray, fail, onlyKnown, string } from "./check.js";
import { Lockstep2dError } from "./error.js";

const ADDRESS = 8;
const SECRET = 16;
// First pause before a reconnection, in milliseconds. Each failure doubles the pause.
const PAUSE_MIN = 250;
// Longest pause in milliseconds.
const PAUSE_MAX = 8000;
// Longest wait for the list of members after a connection was opened, in milliseconds.
const CONNECT_MAX = 10_000;
// If no frame has arrived for this time in milliseconds, the member sends a probe to the relay.
const ASK_AFTER = 5000;
// If no answer arrives within this time in milliseconds after a probe, the connection counts as lost.
const LOST_AFTER = 10_000;
// Interval at which `#watch` runs, in milliseconds.
const WATCH = 1000;
// While more bytes than this wait to be sent, further packets are dropped.
const BUFFERED_MAX = 512 * 1024;
// Close codes after which the member does not reconnect: a wrong secret, and a newer connection of the same member.
const FINAL = [4000, 4003];

const addressOf = (digits) => Uint8Array.from({ length: ADDRESS }, (_, index) => parseInt(digits.slice(2 * index, 2 * index + 2), 16));
const unusable = (why) => new Lockstep2dError("RELAY", `the relay cannot be used: ${why}`);

export class Relay {
    #url;
    #secret;
    #WebSocket;
    #socket;
    #pause = PAUSE_MIN;
    #timer;
    #watcher;
    // Time of the last frame.
    #heard;
    // Time of the probe that was sent since the last frame; undefined if none was sent.
    #asked;
    // Whether the answer to the probe is overdue.
    #isOverdue = false;
    // Whether the relay has sent the list of members.
    #entered = false;
    #closed = false;
    #ready;
    own;
    others = [];
    onPacket = () => {};
    onMembers = () => {};

    static async connect(url, code, options = {}) {
        const { secret = crypto.getRandomValues(new Uint8Array(SECRET)), WebSocket = globalThis.WebSocket } =
            onlyKnown(options, ["secret", "WebSocket"], "a connection");
        if (typeof WebSocket !== "function") {
            fail("there is no WebSocket here; pass one as option");
        }
        if (!/^wss?:\/\//.test(string(url, "the address of the relay"))) {
            fail(`the address of the relay is wss://HOST or ws://HOST:PORT, and not ${url}`);
        }
        if (!/^[0-9A-Za-z-]{1,32}$/.test(string(code, "a code")) || byteArray(secret, "a secret").length !== SECRET) {
            fail(`a code is 1 to 32 letters, digits and -, a secret ${SECRET} bytes`);
        }
        const relay = new Relay(`${url.replace(/\/+$/, "")}/${code}`, secret, WebSocket);
        try {
            await new Promise((resolve, reject) => {
                relay.#ready = { resolve, reject };
                relay.#open();
            });
        } catch (error) {
            relay.close();
            throw error;
        }
        return relay;
    }

    constructor(url, secret, WebSocket) {
        this.#url = url;
        this.#secret = secret;
        this.#WebSocket = WebSocket;
    }

    get isOpen() {
        return this.#socket?.readyState === 1;
    }

    get isClosed() {
        return this.#closed;
    }

    #open() {
        let socket;
        try {
            socket = new this.#WebSocket(this.#url);
        } catch (error) {
            // The URL is bad, or begins with ws:// in a page that was loaded over https.
            throw unusable(error.message);
        }
        socket.binaryType = "arraybuffer";
        this.#socket = socket;
        this.#entered = false;
        this.#hear();
        this.#watcher ??= setInterval(() => this.#watch(), WATCH);
        socket.onopen = () => socket.send(this.#secret);
        socket.onmessage = ({ data }) => socket === this.#socket && this.#frame(data);
        // Without a listener, the package `ws` would throw the error.
        socket.onerror = () => {};
        socket.onclose = ({ code, reason }) => socket === this.#socket && this.#lost(code, reason);
    }

    #hear() {
        this.#heard = performance.now();
        this.#asked = undefined;
        this.#isOverdue = false;
    }

    // Detects a dead connection, whose socket would otherwise stay open for minutes. A page cannot send WebSocket
    // pings. Instead, the member sends an empty datagram to itself as a probe, which the relay returns. Silence alone
    // does not mean that the connection is lost, because the page may have been suspended. Only an unanswered probe
    // means a lost connection.
    #watch() {
        if (this.#socket === undefined) {
            return;
        }
        const now = performance.now();
        if (!this.#entered) {
            now - this.#heard < CONNECT_MAX || this.#abandon();
        } else if (this.#asked !== undefined) {
            if (now - this.#asked >= LOST_AFTER) {
                // After a suspension of the page, the answer may be queued behind this timer, so the member waits for
                // one more interval.
                this.#isOverdue ? this.#abandon() : (this.#isOverdue = true);
            }
        } else if (now - this.#heard >= ASK_AFTER) {
            this.#asked = now;
            this.send(this.own, new Uint8Array());
        }
    }

    // Does not wait until the socket is closed, because the other side may never confirm the end of the connection.
    #abandon() {
        const socket = this.#socket;
        this.#lost(1006, "it does not answer");
        socket.close();
    }

    #frame(data) {
        this.#hear();
        if (typeof data === "string") {
            this.#members(JSON.parse(data));
        } else {
            this.#packet(new Uint8Array(data));
        }
    }

    #members({ you, others }) {
        this.#pause = PAUSE_MIN;
        this.#entered = true;
        this.own = addressOf(you);
        this.others = others.map(addressOf);
        this.#ready?.resolve();
        this.#ready = undefined;
        this.onMembers(this.others);
    }

    #packet(bytes) {
        const isAnswer = bytes.length === ADDRESS && this.own?.every((byte, index) => byte === bytes[index]);
        if (bytes.length >= ADDRESS && !isAnswer) {
            this.onPacket(bytes.slice(0, ADDRESS), bytes.slice(ADDRESS));
        }
    }

    #lost(code, reason) {
        this.#socket = undefined;
        if (this.#ready !== undefined) {
            this.#ready.reject(unusable(reason || `code ${code}`));
            return;
        }
        if (this.#closed || FINAL.includes(code)) {
            this.#closed = true;
            clearInterval(this.#watcher);
            return;
        }
        this.#retry();
    }

    // If the WebSocket cannot be created, for example for lack of memory, this counts as a failed attempt to connect.
    #retry() {
        this.#timer = setTimeout(() => {
            try {
                this.#open();
            } catch {
                this.#retry();
            }
        }, this.#pause);
        this.#pause = Math.min(2 * this.#pause, PAUSE_MAX);
    }

    send(to, packet) {
        if (!this.isOpen || to.length !== ADDRESS || this.#socket.bufferedAmount > BUFFERED_MAX) {
            return;
        }
        const frame = new Uint8Array(ADDRESS + packet.length);
        frame.set(to);
        frame.set(packet, ADDRESS);
        this.#socket.send(frame);
    }

    close() {
        this.#closed = true;
        clearTimeout(this.#timer);
        clearInterval(this.#watcher);
        this.#socket?.close();
    }
}
