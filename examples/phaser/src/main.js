import * as Phaser from "phaser";
import { init } from "lockstep2d";
import { Arena } from "./arena.js";
import { verify } from "./replay.js";
import { Session } from "./session.js";
import { addSky, makeTextures } from "./textures.js";

const parameters = new URLSearchParams(location.search);
const RELAY = parameters.get("relay") ?? `ws://${location.hostname}:7010`;

/** The first scene: chooses and opens a session. */
class Title extends Phaser.Scene {
    constructor() {
        super("title");
    }

    create() {
        makeTextures(this);
        addSky(this);
        const { width } = this.scale;
        const style = { fontFamily: "system-ui, sans-serif", fontSize: 22, color: "#ffffff", align: "center" };
        const add = (y, text, more) => this.add.text(width / 2, y, text, { ...style, ...more }).setOrigin(0.5);
        add(150, "SEESAW", { fontSize: 84, fontStyle: "bold" }).setShadow(0, 4, "#00000080", 8);
        add(225, "Push the other player into the water. Five points win.");
        this.add.image(width / 2 - 230, 152, "amber").setRotation(-0.3);
        this.add.image(width / 2 + 230, 152, "blue").setRotation(0.3);
        const button = (y, key, text, choose) => {
            add(y, `${key}   ${text}`, { fontStyle: "bold", backgroundColor: "#1b2438c0", padding: { x: 24, y: 12 } })
                .setInteractive({ useHandCursor: true }).on("pointerdown", choose);
            this.input.keyboard.on(`keydown-${{ 1: "ONE", 2: "TWO" }[key]}`, choose);
        };
        button(310, 1, "Two players at this keyboard", () => this.scene.start("arena", { session: Session.local() }));
        button(380, 2, "Online match", () => this.#join(Math.random().toString(36).slice(2, 7).toUpperCase()));
        this.message = add(450, "");
        const room = parameters.get("room");
        if (room !== null && !this.registry.has("entered")) {
            this.registry.set("entered", true);
            this.#join(room);
        }
    }

    async #join(room) {
        if (this.isJoining) {
            return;
        }
        this.isJoining = true;
        this.message.setText(`Room ${room}: connecting to ${RELAY}`);
        try {
            const session = await Session.online(RELAY, room);
            // Adds the room to the address of this page: a player who opens this address joins the match.
            parameters.set("room", room);
            history.replaceState(null, "", `?${parameters}`);
            this.scene.isActive() ? this.scene.start("arena", { session }) : session.leave();
        } catch (error) {
            this.message.setText(error.message);
        }
        this.isJoining = false;
    }
}

await init(); // loads the wasm module
const game = new Phaser.Game({
    type: Phaser.AUTO,
    width: 960,
    height: 540,
    parent: "game",
    scale: { mode: Phaser.Scale.FIT, autoCenter: Phaser.Scale.CENTER_HORIZONTALLY },
    audio: { noAudio: true },
    banner: false,
    // One texture per draw call: if a draw call uses several textures, software renderers, such as that of the test,
    // draw some of its quads wrongly.
    render: { maxTextures: 1 },
    scene: [Title, Arena],
});

document.getElementById("file").addEventListener("change", async ({ target }) => {
    document.getElementById("verdict").textContent = verify(new Uint8Array(await target.files[0].arrayBuffer())).text;
});
// For the test of this page.
globalThis.example = { game, session: () => game.scene.getScene("arena").session, verify };
