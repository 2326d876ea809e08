import { init, loaded, verifyReplay } from "lockstep2d";
import { draw } from "./draw.js";
import { Player } from "./player.js";

const element = (id) => document.getElementById(id);
const KEYS = { KeyA: 1, KeyD: 2, KeyW: 4, ArrowLeft: 1, ArrowRight: 2, ArrowUp: 4 };
const REFUSALS = {
    offer: "the others play another version of the game",
    full: "too many players are joining; reload the page",
    taken: "another player has the same number by chance; reload the page",
};
const pressed = new Set();
addEventListener("keydown", ({ code }) => pressed.add(code));
addEventListener("keyup", ({ code }) => pressed.delete(code));
// A page gets no event for a key that is released while another window has the focus.
addEventListener("blur", () => pressed.clear());
const pad = () => [...pressed].reduce((bits, code) => bits | (KEYS[code] ?? 0), 0);

let player;

async function enter(event) {
    event?.preventDefault();
    element("lobby").hidden = true;
    try {
        player = await Player.enter(element("relay").value, element("code").value, pad);
    } catch (error) {
        element("lobby").hidden = false;
        element("verdict").textContent = error.message;
        return;
    }
    // Browsers may restore the checkbox when a page is reloaded.
    player.direct.enable(element("direct").checked);
    element("match").hidden = false;
    requestAnimationFrame(frame);
}

function frame() {
    const { status, refusal, tick, final, seats, desyncs, direct } = player.state();
    player.guess = element("rollback").checked ? 8 : 0;
    draw(element("canvas"), player.game, 36);
    // A player who has joined late lacks the inputs of the first ticks, and therefore cannot save a replay.
    element("save").disabled = player.recording.broken || player.recording.ticks === 0;
    const others = player.relay.others.length;
    const broken = player.relay.isClosed ? "this player has entered the room again, in another tab" : "no connection to the relay";
    const line = player.isOver ? "this player has left" : player.relay.isOpen ? `${others} others in the room, ${direct} of them by WebRTC` : broken;
    element("text").textContent = `${status}, seat ${seats.join(" ")}, tick ${tick}, final ${final}\n${line}\n${player.game.hash()}` +
        (desyncs ? "\nthe states differ" : "") +
        (refusal ? `\nrefused: ${REFUSALS[refusal]}` : "") +
        (status === "paused" ? "\nwaits for the other player; if the one who opened the match has reloaded the page, leave and open another match" : "");
    player.isOver || requestAnimationFrame(frame);
}

function save() {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([player.recording.finish()]));
    link.download = "push.replay";
    link.click();
    // The recording ends when it is saved, even if the match goes on.
    element("save").textContent = `Save the replay of ${player.recording.ticks} ticks`;
}

const verify = (bytes) => verifyReplay(bytes).text;

await init();
const parameters = new URLSearchParams(location.search);
element("relay").value = parameters.get("relay") ?? element("relay").value;
element("code").value = parameters.get("code") ?? Math.random().toString(36).slice(2, 7).toUpperCase();
element("lobby").addEventListener("submit", enter);
element("save").addEventListener("click", save);
element("leave").addEventListener("click", () => player.leave());
element("direct").addEventListener("change", ({ target }) => player.direct.enable(target.checked));
element("open").addEventListener("change", async ({ target }) => {
    element("verdict").textContent = verify(new Uint8Array(await target.files[0].arrayBuffer()));
});
// For the test of this page.
globalThis.example = {
    enter: () => enter(),
    state: () => player?.state(),
    end: (ticks) => player.match.endAt(ticks),
    hash: () => player.game.hash(),
    module: () => loaded(),
    replay: () => [...player.recording.finish()],
};
