// The scene that shows a session.
import * as Phaser from "phaser";
import { JUMP, KINDS, LEFT, RIGHT, SLAM, WATER } from "./rules.js";
import { COLOURS, SCALE, addSky, makeTextures } from "./textures.js";

const NAMES = ["Amber", "Blue"];
const BITS = [LEFT, RIGHT, JUMP, SLAM];
const KEYS = [["A", "D", "W", "S"], ["LEFT", "RIGHT", "UP", "DOWN"]];

/** The keys of a player. */
class Pad {
    #keys;
    // Bits of the keys that were pressed since the last tick, so that a short press between two ticks is not lost.
    #pressed = 0;

    constructor(keyboard, names) {
        this.#keys = names.map((name) => keyboard.addKey(name));
        this.#keys.forEach((key, index) => key.on("down", () => (this.#pressed |= BITS[index])));
    }

    read() {
        const held = this.#keys.reduce((bits, key, index) => bits | (key.isDown ? BITS[index] : 0), 0);
        const input = held | this.#pressed;
        this.#pressed = 0;
        return input;
    }
}

export class Arena extends Phaser.Scene {
    constructor() {
        super("arena");
    }

    create({ session }) {
        this.session = session;
        this.sprites = new Map();
        makeTextures(this);
        addSky(this);
        this.#water();
        this.#texts();
        this.dust = this.#particles({
            lifespan: 400, speed: { min: 40, max: 180 }, scale: { start: 0.5, end: 0 }, tint: 0xffe8c8,
        });
        this.splash = this.#particles({
            lifespan: 800, speed: { min: 150, max: 420 }, angle: { min: 240, max: 300 }, gravityY: 900,
            scale: { start: 0.7, end: 0.1 }, tint: [0xffffff, 0x9fd8ff, 0x5fb0ec],
        });
        // The origin of the world is at (0, 0) in pixels. The camera has no zoom: SCALE is the only scale.
        this.cameras.main.centerOn(0, -1.4 * SCALE);

        const pads = KEYS.map((names) => new Pad(this.input.keyboard, names));
        // In an online match, only one player is at this keyboard and may use both sets of keys.
        session.readPad = (seat) => (session.relay ? pads[0].read() | pads[1].read() : pads[seat].read());
        session.onTick = (tick) => this.#tick(tick);
        this.input.keyboard.on("keydown-R", () => this.#save());
        this.input.keyboard.on("keydown-ESC", () => {
            session.leave();
            this.scene.start("title");
        });
        this.events.once("shutdown", () => (session.onTick = () => {}));
    }

    /** Called by Phaser for each frame. */
    update() {
        this.#bodies();
        this.waves.forEach((wave, index) => (wave.tilePositionX += index === 0 ? 0.4 : -0.7));
        this.status.setText(this.#status());
    }

    // Poses are floats: x to the right and y up, in metres; angles counter-clockwise. The y axis of Phaser points down,
    // so y and the angle change their signs.
    #bodies() {
        const { world, before } = this.session.game;
        const { alpha } = this.session;
        const poses = world.poses();
        const last = new Map(); // the pose of each body before the last tick
        for (let i = 0; i < before.length; i += 5) {
            last.set(before[i], before.subarray(i + 1, i + 4));
        }
        const alive = new Set();
        for (let i = 0; i < poses.length; i += 5) {
            const [id, x, y, angle] = poses.subarray(i, i + 4);
            let [fromX, fromY, fromAngle] = last.get(id) ?? [x, y, angle];
            if (Math.hypot(x - fromX, y - fromY) > 1) {
                [fromX, fromY, fromAngle] = [x, y, angle]; // a new round has moved the body
            }
            this.#sprite(id)
                .setPosition(Phaser.Math.Linear(fromX, x, alpha) * SCALE, -Phaser.Math.Linear(fromY, y, alpha) * SCALE)
                .setRotation(-(fromAngle + Phaser.Math.Angle.Wrap(angle - fromAngle) * alpha));
            alive.add(id);
        }
        for (const [id, sprite] of this.sprites) {
            if (!alive.has(id)) {
                sprite.destroy();
                this.sprites.delete(id);
            }
        }
    }

    // A sprite belongs to the handle of a body, which stays the same for the life of the body. But after a rollback
    // another body may have this handle, for example a small box instead of a crate, so the texture is set again
    // whenever the kind differs.
    #sprite(id) {
        const kind = KINDS[Number(this.session.game.world.body(id).userData)];
        let sprite = this.sprites.get(id);
        if (sprite === undefined) {
            sprite = this.add.image(0, 0, kind).setDepth(kind === "post" ? 0 : 1);
            this.sprites.set(id, sprite);
        } else if (sprite.texture.key !== kind) {
            sprite.setTexture(kind);
        }
        return sprite;
    }

    // Particles, shakes of the camera and banners cannot be taken back, so they are shown only for confirmed ticks.
    // They are a few ticks later than the bodies, which are drawn with guessed inputs and corrected after a wrong
    // guess.
    #tick({ effects, points }) {
        this.points.forEach((text, seat) => text.setText(points[seat]));
        for (const { kind, at, speed, seat } of effects) {
            const [x, y] = at ? [at.x.toNumber() * SCALE, -at.y.toNumber() * SCALE] : [];
            if (kind === "hit") {
                this.dust.explode(Math.ceil(speed.toNumber()), x, y);
                speed.gt(9) && this.cameras.main.shake(120, 0.004);
            } else if (kind === "splash") {
                this.splash.explode(40, x, -Number(WATER) * SCALE);
            } else {
                this.#announce(`${NAMES[seat]} ${kind === "win" ? "wins the match!" : "scores"}`, COLOURS[seat]);
                this.tweens.add({ targets: this.points[seat], scale: 1.6, duration: 150, yoyo: true });
                this.cameras.main.shake(250, 0.008);
            }
        }
    }

    #announce(text, colour) {
        this.tweens.killTweensOf(this.banner);
        this.banner.setText(text).setTint(colour).setAlpha(1).setScale(0.6);
        this.tweens.add({ targets: this.banner, scale: 1, duration: 250, ease: "Back.out" });
        this.tweens.add({ targets: this.banner, alpha: 0, delay: 1300, duration: 300 });
    }

    #status() {
        const { status, room, relay, error, match } = this.session;
        if (error !== "") {
            return error;
        }
        if (room === undefined) {
            return "A D W S and the arrow keys: roll, jump, slam      R: replay      Esc: title";
        }
        if (!relay.isOpen) {
            return `Room ${room}: no connection to the relay`;
        }
        switch (status) {
            case "playing":
                return `Room ${room}: you are ${NAMES[match.seats[0]]}      R: replay      Esc: leave`;
            case "waiting":
                return `Room ${room}: send the address of this page to the other player`;
            default:
                return `Room ${room}: ${status}`;
        }
    }

    // Saves the replay of the confirmed ticks so far. The recording then ends, even if the match goes on.
    #save() {
        const { recording } = this.session;
        if (recording === undefined) {
            this.#announce("Joined later: no replay", 0xffffff);
            return;
        }
        const link = document.createElement("a");
        link.href = URL.createObjectURL(new Blob([recording.finish()]));
        link.download = "seesaw.replay";
        link.click();
        this.#announce(`Replay of ${recording.ticks} ticks`, 0xffffff);
    }

    #particles(config) {
        return this.add.particles(0, 0, "dot", { ...config, emitting: false }).setDepth(2);
    }

    #water() {
        const top = -Number(WATER) * SCALE;
        this.waves = [[0x2f6fb0, 0.75, -4], [0x1d4f8c, 0.85, 12]].map(([colour, alpha, y]) => {
            const wave = this.add.tileSprite(0, top + y, 1100, 60, "wave").setOrigin(0.5, 0);
            return wave.setTint(colour).setAlpha(alpha).setDepth(3);
        });
    }

    #texts() {
        const { width, height } = this.scale;
        const add = (x, y, size, text = "") => {
            const style = { fontFamily: "system-ui, sans-serif", fontStyle: "bold", fontSize: size, color: "#ffffff" };
            const added = this.add.text(x, y, text, style).setOrigin(0.5).setShadow(0, 2, "#00000080", 4);
            return added.setScrollFactor(0).setDepth(4);
        };
        this.points = COLOURS.map((colour, seat) => add(width / 2 + [-60, 60][seat], 50, 56, "0").setTint(colour));
        add(width / 2, 48, 40, ":");
        this.banner = add(width / 2, 150, 54).setAlpha(0);
        this.status = add(width / 2, height - 18, 15);
    }
}
