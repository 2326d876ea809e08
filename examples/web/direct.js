// WebRTC data channels between the members of a room. The relay carries the signals (offers, answers and candidates),
// and packets between members without an open channel.
//
// Two members are linked only if both want links: a link shows their addresses to each other.
// A channel is unordered and does not resend lost packets. A member has the same address over a channel as over the
// relay. A signal is JSON after a prefix with which no packet of a match begins.
const SIGNAL = new TextEncoder().encode("lockstep2d signal ");
const DECODER = new TextDecoder();
// Members in different networks need a STUN server: { iceServers: [{ urls: "stun:HOST:PORT" }] }.
const CONFIG = {};
// Maximum number of candidates of a member that are kept until its description arrives.
const CANDIDATES_MAX = 64;
const CHANNEL = { negotiated: true, id: 0, ordered: false, maxRetransmits: 0 };

const nameOf = (address) => address.join(".");
// If the state of the connection is "disconnected", packets do not arrive, although the channel is still open.
const isUsable = ({ connection, channel }) => channel.readyState === "open" && connection.connectionState === "connected";
const isSignal = (bytes) => bytes.length > SIGNAL.length && SIGNAL.every((byte, index) => bytes[index] === byte);

export class Direct {
    #relay;
    #links = new Map();
    // For each member, the candidates that have arrived before its description.
    #early = new Map();
    #wanted = false;
    onPacket = () => {};

    constructor(relay) {
        this.#relay = relay;
        relay.onPacket = (from, bytes) => {
            if (isSignal(bytes)) {
                this.#signalled(from, bytes.subarray(SIGNAL.length)).catch(() => this.#drop(from));
            } else {
                this.onPacket(from, bytes);
            }
        };
        relay.onMembers = () => this.#connect();
    }

    /** Number of members to which packets are sent through a channel and not through the relay. */
    get count() {
        return [...this.#links.values()].filter(isUsable).length;
    }

    /** Whether this member wants links. If not, its links end, and all packets go through the relay. */
    enable(wanted) {
        this.#wanted = wanted;
        wanted || [...this.#links.values()].forEach(({ address }) => this.#refuse(address));
        this.#connect();
    }

    send(to, packet) {
        const link = this.#links.get(nameOf(to));
        if (link && isUsable(link)) {
            link.channel.send(packet);
        } else {
            this.#relay.send(to, packet);
        }
    }

    close() {
        [...this.#links.values()].forEach(({ connection }) => connection.close());
        this.#links.clear();
        this.#early.clear();
    }

    // In a pair of members, the one whose address is first in the order of texts makes the offer. The other one requests
    // the offer with a `wish`.
    #connect() {
        const names = new Set(this.#relay.others.map(nameOf));
        // After a restart of the relay, members return one by one. Links that work do not depend on the relay.
        const isGone = (link) => !names.has(link.name) && !isUsable(link);
        [...this.#links.values()].filter(isGone).forEach(({ address }) => this.#drop(address));
        [...this.#early.keys()].filter((name) => !names.has(name)).forEach((name) => this.#early.delete(name));
        for (const address of this.#wanted ? this.#relay.others : []) {
            if (this.#links.has(nameOf(address))) {
                continue;
            }
            if (nameOf(this.#relay.own) < nameOf(address)) {
                this.#call(address);
            } else {
                this.#signal(address, { wish: true });
            }
        }
    }

    #link(address) {
        const name = nameOf(address);
        const found = this.#links.get(name);
        if (found) {
            return found;
        }
        const connection = new RTCPeerConnection(CONFIG);
        const channel = connection.createDataChannel("match", CHANNEL);
        channel.binaryType = "arraybuffer";
        // Ignores text messages: `new Uint8Array` would convert the text to a number, and use it as a length.
        channel.onmessage = ({ data }) => data instanceof ArrayBuffer && this.onPacket(address, new Uint8Array(data));
        connection.onicecandidate = ({ candidate }) => candidate && this.#signal(address, { candidate });
        connection.onconnectionstatechange = () => ["failed", "closed"].includes(connection.connectionState) && this.#drop(address);
        const link = { name, address, connection, channel };
        this.#links.set(name, link);
        return link;
    }

    async #call(address) {
        // `setLocalDescription` creates an offer, or an answer if this member has received an offer.
        const { connection } = this.#link(address);
        await connection.setLocalDescription();
        this.#signal(address, { description: connection.localDescription });
    }

    #signal(to, message) {
        const text = new TextEncoder().encode(JSON.stringify(message));
        const bytes = new Uint8Array(SIGNAL.length + text.length);
        bytes.set(SIGNAL);
        bytes.set(text, SIGNAL.length);
        this.#relay.send(to, bytes);
    }

    async #signalled(from, bytes) {
        const { wish, refusal, description, candidate } = JSON.parse(DECODER.decode(bytes));
        if (refusal) {
            this.#drop(from);
            return;
        }
        if (!this.#wanted) {
            // Candidates follow an offer, which was refused.
            candidate || this.#refuse(from);
            return;
        }
        if (wish) {
            this.#links.has(nameOf(from)) || (await this.#call(from));
            return;
        }
        if (candidate) {
            await this.#reachable(from, candidate);
            return;
        }
        if (description?.type === "offer") {
            // The other member has no link any more if it makes an offer again.
            this.#drop(from);
        }
        const { connection } = this.#link(from);
        await connection.setRemoteDescription(description);
        const early = this.#early.get(nameOf(from)) ?? [];
        this.#early.delete(nameOf(from));
        await Promise.all(early.map((each) => this.#reachable(from, each)));
        if (description.type === "offer") {
            await this.#call(from);
        }
    }

    // Adds a candidate to the connection with its sender, or keeps it until the connection has a description. If the
    // connection refuses the candidate, for example because it belongs to an earlier connection, this error is ignored.
    async #reachable(from, candidate) {
        const connection = this.#links.get(nameOf(from))?.connection;
        if (connection?.remoteDescription) {
            await connection.addIceCandidate(candidate).catch(() => {});
            return;
        }
        const early = this.#early.get(nameOf(from)) ?? [];
        this.#early.set(nameOf(from), [...early, candidate].slice(-CANDIDATES_MAX));
    }

    // Ends the link with a member, or declines its wish or offer. Thereby the member can be asked again later.
    #refuse(address) {
        this.#drop(address);
        this.#signal(address, { refusal: true });
    }

    #drop(address) {
        const link = this.#links.get(nameOf(address));
        this.#links.delete(nameOf(address));
        link?.connection.close();
    }
}
