// A member of a room of a relay.
import { byteArray, fail, onlyKnown, string } from "./check.js";
import { Lockstep2dError } from "./error.js";

const ADDRESS = 8;
const SECRET = 16;
// First pause in milliseconds before a reconnection, doubled with each failure.
const PAUSE_MIN = 250;
// Longest pause in milliseconds.
const PAUSE_MAX = 8000;
// Largest number of bytes that wait to be sent.
const BUFFERED_MAX = 512 * 1024;
// Close codes without reconnection: a wrong secret, and another connection of the same member.
const FINAL = [4000, 4003];

const addressOf = (digits) => Uint8Array.from({ length: ADDRESS }, (_, index) => parseInt(digits.slice(2 * index, 2 * index + 2), 16));

export class Relay {
    #url;
    #secret;
    #WebSocket;
    #socket;
    #pause = PAUSE_MIN;
    #timer;
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
        relay.#ready = undefined;
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

    #open() {
        const socket = new this.#WebSocket(this.#url);
        socket.binaryType = "arraybuffer";
        this.#socket = socket;
        socket.onopen = () => socket.send(this.#secret);
        socket.onmessage = ({ data }) => (typeof data === "string" ? this.#members(JSON.parse(data)) : this.#packet(new Uint8Array(data)));
        // The package `ws` throws errors without a listener.
        socket.onerror = () => {};
        socket.onclose = ({ code, reason }) => socket === this.#socket && this.#lost(code, reason);
    }

    #members({ you, others }) {
        this.#pause = PAUSE_MIN;
        this.own = addressOf(you);
        this.others = others.map(addressOf);
        this.#ready?.resolve();
        this.onMembers(this.others);
    }

    #packet(bytes) {
        if (bytes.length >= ADDRESS) {
            this.onPacket(bytes.slice(0, ADDRESS), bytes.slice(ADDRESS));
        }
    }

    #lost(code, reason) {
        this.#ready?.reject(new Lockstep2dError("RELAY", `the relay cannot be used: ${reason || `code ${code}`}`));
        if (this.#closed || FINAL.includes(code)) {
            this.#closed = true;
            return;
        }
        this.#timer = setTimeout(() => this.#open(), this.#pause);
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
        this.#socket?.close();
    }
}
