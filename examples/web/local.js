import { Match, MatchDriver, init, loaded, verifyReplay } from "lockstep2d";
import { draw } from "./draw.js";
import { Game, SEATS, offer } from "./game.js";
import { MatchRecording } from "./recording.js";

const element = (id) => document.getElementById(id);
const KEYS = [{ KeyA: 1, KeyD: 2, KeyW: 4 }, { ArrowLeft: 1, ArrowRight: 2, ArrowUp: 4 }];
const pressed = new Set();
addEventListener("keydown", ({ code }) => pressed.add(code));
addEventListener("keyup", ({ code }) => pressed.delete(code));
// A page gets no event for a key that is released while another window has the focus.
addEventListener("blur", () => pressed.clear());
const pad = (seat) => Object.entries(KEYS[seat]).reduce((bits, [code, bit]) => bits | (pressed.has(code) ? bit : 0), 0);

// A network in memory. The page sets its latency in ms and its loss in percent.
const network = {
    peers: [],
    send(from, to, packet) {
        const [delay, loss] = [Number(element("delay").value), Number(element("loss").value)];
        if (Math.random() * 100 >= loss) {
            const arrive = () => this.peers[to]?.driver.receive(performance.now(), Uint8Array.of(from), packet);
            setTimeout(arrive, delay * (0.75 + Math.random() / 2));
        }
    },
};

class Peer {
    constructor(seat, name) {
        this.seat = seat;
        this.name = name;
        this.game = new Game();
        this.desyncs = 0;
        const contact = seat === 0 ? undefined : Uint8Array.of(0);
        const match = new Match({ seats: SEATS, guess: 8, delayMin: 1, offer: offer(), contact });
        this.driver = new MatchDriver(match, this.game, (to, packet) => network.send(seat, to[0], packet));
    }

    update() {
        this.driver.match.status === "playing" && this.driver.match.setGuess(element("rollback").checked ? 8 : 0);
        const events = this.driver.update(performance.now(), () => Uint8Array.of(pad(this.seat)));
        this.desyncs += events.filter(({ kind }) => kind === "desync").length;
    }

    draw() {
        draw(element(this.name), this.game, 24);
        const { tick, match } = this.driver;
        const final = match.status === "connecting" ? 0 : match.ticks().final;
        element(`${this.name}-text`).textContent =
            `${match.status}, tick ${tick}, final ${final}\n${this.game.hash()}${this.desyncs ? "\nthe states differ" : ""}`;
    }
}

const verify = (bytes) => verifyReplay(bytes).text;

await init();
const peers = [new Peer(0, "left"), new Peer(1, "right")];
network.peers = peers;
let recording = new MatchRecording();
setInterval(() => {
    peers.forEach((peer) => peer.update());
    recording.follow(peers[0].driver.match);
}, 4);
const frame = () => {
    peers.forEach((peer) => peer.draw());
    // If a recording begins late in the match, it lacks the first inputs and cannot be saved.
    element("save").disabled = recording.broken;
    requestAnimationFrame(frame);
};
requestAnimationFrame(frame);

function save() {
    const bytes = recording.finish();
    recording = new MatchRecording();
    return bytes;
}
element("save").addEventListener("click", () => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([save()]));
    link.download = "push.replay";
    link.click();
});
element("open").addEventListener("change", async ({ target }) => {
    element("verdict").textContent = verify(new Uint8Array(await target.files[0].arrayBuffer()));
});

// For the test of this page.
globalThis.example = {
    state: () => peers.map(({ driver, desyncs }) => ({ tick: driver.tick, status: driver.match.status, desyncs })),
    module: () => loaded(),
    verify: () => verify(save()),
};
