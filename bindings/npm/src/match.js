// Matches.
import { byteArray, count, fail, integer, long, micros as microsOf, onlyKnown } from "./check.js";
import { Lockstep2dError } from "./error.js";
import { C } from "./layout.js";
import { Handle, call, copy, give, optionsOf, putBytes, read, scratch, sizeOf, takeBytes, u32, u64, write, writeHash } from "./library.js";
import { nativeOffer } from "./native.js";
import { nextRequest } from "./requests.js";

const STATUS = ["joining", "watching", "waiting", "playing", "paused", "dropped", "kicked", "leaving", "left", "finished", "closed",
    "connecting"];
const EVENTS = ["status", "view", "seated", "unseated", "waiting", "resumed", "pause", "end", "desync", "conflict", "tooFarBehind",
    "refused", "state", "badState"];
const REASONS = ["offer", "full", "taken", "notReady"];
const ADDRESS_MAX = 32;
const PACKET_MAX = 2048;

const MATCH_OPTIONS = ["contact", "offer", "tickRate", ...optionsOf("match_config", ["tick_micros"])];

const micros = (now) => microsOf(now, "the time");

function random(count) {
    return crypto.getRandomValues(new BigUint64Array(count));
}

function identity({ peer, key, secret }) {
    const [a, b, c, d] = random(4);
    if (secret !== undefined && (!Array.isArray(secret) || secret.length !== 2)) {
        fail("a secret is an array of two integers of 64 bits");
    }
    return { peer: peer ?? Number(a & 0xffffffffn), key: key ?? b, secret: secret ?? [c, d] };
}

/** The default offer. It contains the options that have to be equal for all peers. */
const offerOf = ({ seats, inputBytes, tickRate, patience }) => nativeOffer({ rules: "", seats, inputBytes, tickRate, patience });

export class Match extends Handle {
    #inputs;

    constructor(options) {
        const { contact, offer = offerOf(options), peer, key, secret, ...config } = onlyKnown(options, MATCH_OPTIONS, "a match");
        const [seats, inputBytes] = [count(config.seats, "`seats`"), count(config.inputBytes ?? 1, "`inputBytes`")];
        byteArray(offer, "`offer`");
        if (contact !== undefined) {
            byteArray(contact, "`contact`");
        }
        const data = new Uint8Array(offer.length + (contact?.length ?? 0));
        data.set(offer);
        data.set(contact ?? [], offer.length);
        const before = 8 + sizeOf("match_config");
        const at = give(data, before);
        call("ls2d_match_config_init", seats, at + 8);
        const { patience, tickRate, ...plain } = config;
        write("match_config", at + 8, {
            ...plain,
            tickMicros: tickRate === undefined ? undefined : Math.floor(1_000_000 / Number(integer(tickRate, "`tickRate`", 1, 1000))),
            patience: patience === undefined ? undefined : microsOf(patience, "`patience`"),
            ...identity({ peer, key, secret }),
        });
        const to = at + before;
        if (contact === undefined) {
            call("ls2d_match_host", at + 8, to, offer.length, at);
        } else {
            call("ls2d_match_join", at + 8, to, offer.length, to + offer.length, contact.length, at);
        }
        super(u32(at));
        this.#inputs = seats * inputBytes;
        this.inputBytes = inputBytes;
    }

    ask(contact) {
        const at = give(contact, 64, "a contact");
        call("ls2d_match_ask", this.handle, at + 64, contact.length);
    }

    receive(now, from, packet) {
        if (byteArray(packet, "a packet").length > PACKET_MAX) {
            return;
        }
        const at = give(packet, 64, "a packet");
        putAddress(at, from);
        call("ls2d_match_receive", this.handle, micros(now), at, from.length, at + 64, packet.length);
    }

    update(now) {
        call("ls2d_match_update", this.handle, micros(now));
    }

    isDue(now) {
        const at = scratch(8);
        call("ls2d_match_is_due", this.handle, micros(now), at);
        return u32(at) === 1;
    }

    advance(now, inputs) {
        const at = give(inputs, 64, "the inputs");
        call("ls2d_match_advance", this.handle, micros(now), at + 64, inputs.length, at);
        return u32(at) === 1;
    }

    nextRequest() {
        return nextRequest("ls2d_match_next_request", this.handle, this.#inputs);
    }

    reportHash(tick, hash) {
        const at = scratch(16);
        writeHash(at, hash);
        call("ls2d_match_report_hash", this.handle, count(tick, "a tick"), at);
    }

    nextPacket() {
        const at = scratch(16 + ADDRESS_MAX + PACKET_MAX);
        const [to, packet] = [at + 16, at + 16 + ADDRESS_MAX];
        if (!call("ls2d_match_next_packet", this.handle, to, ADDRESS_MAX, at, packet, PACKET_MAX, at + 8)) {
            return undefined;
        }
        return { to: copy(to, u32(at)), packet: copy(packet, u32(at + 8)) };
    }

    nextEvent() {
        const at = scratch(sizeOf("match_event"));
        if (!call("ls2d_match_next_event", this.handle, at)) {
            return undefined;
        }
        const { kind, value, reserved: _, ...rest } = read("match_event", at);
        const event = { ...rest, value, kind: EVENTS[kind] };
        switch (kind) {
            case C.EVENT_STATUS:
                return { ...event, status: STATUS[value] };
            case C.EVENT_REFUSED:
                return { ...event, reason: REASONS[value] };
            case C.EVENT_STATE:
                return { ...event, state: takeBytes(value) };
            default:
                return event;
        }
    }

    get wantsState() {
        const at = scratch(8);
        call("ls2d_match_wants_state", this.handle, at);
        return u32(at) === 1;
    }

    offerState(tick, state) {
        const at = give(state, 64, "the state");
        call("ls2d_match_offer_state", this.handle, count(tick, "a tick"), at + 64, state.length);
    }

    get status() {
        const at = scratch(8);
        call("ls2d_match_status", this.handle, at);
        return STATUS[u32(at)];
    }

    ticks() {
        const at = scratch(16);
        call("ls2d_match_ticks", this.handle, at, at + 4, at + 8);
        return { played: u32(at), final: u32(at + 4), confirmed: u32(at + 8) };
    }

    finalInputs(tick) {
        const at = scratch(16 + this.#inputs);
        if (!call("ls2d_match_final_inputs", this.handle, count(tick, "a tick"), at + 16, this.#inputs, at, at + 8)) {
            return undefined;
        }
        return { inputs: copy(at + 16, u32(at)), absent: u64(at + 8) };
    }

    get seats() {
        const at = scratch(8);
        call("ls2d_match_seats", this.handle, at);
        const bits = u64(at);
        return Array.from({ length: 64 }, (_, seat) => seat).filter((seat) => ((bits >> BigInt(seat)) & 1n) === 1n);
    }

    link(peer) {
        const at = scratch(24);
        if (!call("ls2d_match_link", this.handle, count(peer, "a peer"), at, at + 8, at + 16)) {
            return undefined;
        }
        return { ping: Number(u64(at + 8)) / 1000, loss: u32(at + 16) / 1000, delay: u32(at) };
    }

    leave() {
        call("ls2d_match_leave", this.handle);
    }

    endAt(ticks) {
        call("ls2d_match_end_at", this.handle, count(ticks, "the number of ticks"));
    }

    pause(paused) {
        call("ls2d_match_pause", this.handle, paused ? 1 : 0);
    }

    goOnWithout(peer) {
        call("ls2d_match_go_on_without", this.handle, count(peer, "a peer"));
    }

    kick(key) {
        call("ls2d_match_kick", this.handle, long(key, "a key"));
    }

    setGuess(ticks) {
        call("ls2d_match_set_guess", this.handle, count(ticks, "the number of ticks"));
    }
}

const putAddress = (at, data) => {
    if (!(data instanceof Uint8Array) || data.length > ADDRESS_MAX) {
        throw new Lockstep2dError("VALUE", `an address is a Uint8Array of at most ${ADDRESS_MAX} bytes`);
    }
    putBytes(at, data);
};
