import { Match, MatchDriver, Recorder, Replay, init, loaded, semantics } from "lockstep2d";
import { Game, RULES } from "./game.js";

const element = (id) => document.getElementById(id);
const KEYS = [{ KeyA: 1, KeyD: 2, KeyW: 4 }, { ArrowLeft: 1, ArrowRight: 2, ArrowUp: 4 }];
const pressed = new Set();
addEventListener("keydown", ({ code }) => pressed.add(code));
addEventListener("keyup", ({ code }) => pressed.delete(code));
const pad = (seat) => Object.entries(KEYS[seat]).reduce((bits, [code, bit]) => bits | (pressed.has(code) ? bit : 0), 0);

// A network in memory. Packets may be lost, and arrive late.
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

/** The game with a recorder of its final inputs. */
class Peer {
    constructor(seat, name) {
        this.seat = seat;
        this.name = name;
        this.game = new Game();
        this.desyncs = 0;
        const offer = new TextEncoder().encode(`${RULES}, semantics ${semantics()}`);
        const contact = seat === 0 ? undefined : Uint8Array.of(0);
        const match = new Match({ seats: 2, tickRate: 60, guess: 8, delayMin: 1, offer, contact });
        this.driver = new MatchDriver(match, this.game, (to, packet) => network.send(seat, to[0], packet));
    }

    update() {
        this.driver.match.status === "playing" && this.driver.match.setGuess(element("rollback").checked ? 8 : 0);
        const events = this.driver.update(performance.now(), () => Uint8Array.of(pad(this.seat)));
        this.desyncs += events.filter(({ kind }) => kind === "desync").length;
    }

    draw() {
        const canvas = element(this.name);
        const context = canvas.getContext("2d");
        context.setTransform(1, 0, 0, 1, 0, 0);
        context.clearRect(0, 0, canvas.width, canvas.height);
        context.setTransform(24, 0, 0, -24, canvas.width / 2, canvas.height - 60);
        const poses = this.game.world.poses();
        for (let at = 0; at < poses.length; at += 5) {
            this.body(context, poses.subarray(at, at + 5));
        }
        const { tick, match } = this.driver;
        const final = match.status === "connecting" ? 0 : match.ticks().final;
        element(`${this.name}-text`).textContent =
            `${match.status}, tick ${tick}, final ${final}\n${this.game.hash()}${this.desyncs ? "\nthe states differ" : ""}`;
    }

    body(context, [id, x, y, angle]) {
        context.save();
        context.translate(x, y);
        context.rotate(angle);
        const player = this.game.players.indexOf(id);
        context.fillStyle = player === 0 ? "#e9a13b" : player === 1 ? "#4da3e8" : id === 0 ? "#4a5563" : "#9aa7b5";
        context.beginPath();
        if (player >= 0) {
            context.arc(0, 0, 0.6, 0, 2 * Math.PI);
        } else {
            const [width, height] = id === 0 ? [16, 2] : [1, 1];
            context.rect(-width / 2, -height / 2, width, height);
        }
        context.fill();
        context.restore();
    }
}

/** Records the final inputs by playing them on a game of its own. */
class Tape {
    game = new Game();
    tick = 0;
    parts = [];

    constructor() {
        this.recorder = new Recorder({ rules: RULES, players: 2, inputBytes: 1, start: this.game.hash() });
    }

    follow(match) {
        const { confirmed } = match.ticks();
        for (; this.tick < confirmed; this.tick++) {
            const inputs = match.finalInputs(this.tick);
            if (inputs === undefined) {
                return;
            }
            const due = this.recorder.record(inputs);
            this.game.step(inputs);
            if (due) {
                this.recorder.checkpoint(this.game.hash());
            }
        }
    }

    finish() {
        return this.recorder.finish(this.game.hash());
    }
}

function verify(bytes) {
    try {
        const replay = new Replay(bytes);
        const game = new Game();
        replay.check(game.hash());
        for (let inputs = replay.next(); inputs !== undefined; inputs = replay.next()) {
            game.step(inputs);
            replay.check(game.hash());
        }
        return replay.verdict(game.hash()).text;
    } catch (error) {
        return error.message;
    }
}

await init();
const peers = [new Peer(0, "left"), new Peer(1, "right")];
network.peers = peers;
let tape = new Tape();
setInterval(() => {
    peers.forEach((peer) => peer.update());
    if (peers[0].driver.match.status !== "connecting") {
        tape.follow(peers[0].driver.match);
    }
}, 4);
const frame = () => {
    peers.forEach((peer) => peer.draw());
    requestAnimationFrame(frame);
};
requestAnimationFrame(frame);

function save() {
    const bytes = tape.finish();
    tape = new Tape();
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
