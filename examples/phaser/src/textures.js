// Textures and the background, drawn with `Graphics`: the example has no image files. Sizes are in pixels.
export const SCALE = 60; // pixels per metre
export const COLOURS = [0xf2a33a, 0x3f8fe0];

// For each texture: its width, its height, and a function that draws it.
const TEXTURES = {
    post: [84, 240, (g) => {
        g.fillStyle(0x5b6678).fillPoints([{ x: 33, y: 0 }, { x: 51, y: 0 }, { x: 84, y: 210 }, { x: 0, y: 210 }], true);
        g.fillStyle(0x748196).fillPoints([{ x: 33, y: 0 }, { x: 40, y: 0 }, { x: 26, y: 210 }, { x: 0, y: 210 }], true);
    }],
    plank: [540, 24, (g) => {
        g.fillStyle(0x8a5a33).fillRoundedRect(0, 0, 540, 24, 6);
        g.fillStyle(0xb57a45).fillRoundedRect(0, 0, 540, 15, 6);
        g.fillStyle(0x6d4526);
        [90, 180, 360, 450].forEach((x) => g.fillRect(x, 0, 2, 24));
        COLOURS.forEach((colour, seat) => g.fillStyle(colour).fillRoundedRect([0, 500][seat], 0, 40, 24, 6));
        g.fillStyle(0x3b4352).fillCircle(270, 12, 9).fillStyle(0xaab4c4).fillCircle(270, 12, 4);
    }],
    amber: [60, 60, (g) => disc(g, COLOURS[0], 0xffcf85, 0x9a5a10)],
    blue: [60, 60, (g) => disc(g, COLOURS[1], 0x92c6ff, 0x174f8c)],
    crate: [48, 48, (g) => {
        g.fillStyle(0x9c6b3a).fillRect(0, 0, 48, 48).fillStyle(0xc8945a).fillRect(6, 6, 36, 36);
        g.lineStyle(6, 0x9c6b3a).lineBetween(8, 8, 40, 40).lineStyle(2, 0x6d4526).strokeRect(1, 1, 46, 46);
    }],
    box: [36, 36, (g) => {
        g.fillStyle(0xd9c7a3).fillRect(0, 0, 36, 36).fillStyle(0xb8604f).fillRect(14, 0, 8, 36).fillRect(0, 14, 36, 8);
        g.lineStyle(2, 0x8d7a55).strokeRect(1, 1, 34, 34);
    }],
    dot: [16, 16, (g) => g.fillStyle(0xffffff).fillCircle(8, 8, 8)],
    wave: [96, 60, (g) => {
        const top = Array.from({ length: 97 }, (_, x) => ({ x, y: 8 + 5 * Math.sin((x / 96) * 2 * Math.PI) }));
        g.fillStyle(0xffffff).fillPoints([...top, { x: 96, y: 60 }, { x: 0, y: 60 }], true);
    }],
};

function disc(g, colour, light, dark) {
    g.fillStyle(dark).fillCircle(30, 30, 30).fillStyle(colour).fillCircle(30, 30, 27);
    g.fillStyle(light).fillEllipse(30, 20, 40, 24);
    g.fillStyle(dark).fillRect(4, 38, 52, 9).fillRect(25, 38, 10, 14); // the belt
    [20, 40].forEach((x) => g.fillStyle(0xffffff).fillCircle(x, 24, 7).fillStyle(0x1b222c).fillCircle(x, 25, 3.5));
    g.fillStyle(0x1b222c).fillRect(12, 13, 14, 3).fillRect(34, 13, 14, 3);
}

export function makeTextures(scene) {
    for (const [name, [width, height, draw]] of Object.entries(TEXTURES)) {
        if (!scene.textures.exists(name)) {
            const graphics = scene.make.graphics({}, false);
            draw(graphics);
            graphics.generateTexture(name, width, height);
            graphics.destroy();
        }
    }
}

/** Draws the sky, which does not move with the camera. It is larger than the screen, because the camera may shake. */
export function addSky(scene) {
    const { width, height } = scene.scale;
    const sky = scene.add.graphics().setScrollFactor(0);
    sky.fillGradientStyle(0x243b6b, 0x243b6b, 0xf0a98a, 0xf0a98a).fillRect(-20, -20, width + 40, height + 40);
    sky.fillStyle(0xffe2a8, 0.25).fillCircle(700, 330, 110).fillStyle(0xffe9c2).fillCircle(700, 330, 70);
    [[0x6a5a85, 370, 35, 90, 1], [0x4b4a75, 430, 22, 55, 4]].forEach(([colour, middle, size, length, phase]) => {
        const hills = [{ x: -20, y: height + 20 }, { x: width + 20, y: height + 20 }];
        for (let x = width + 20; x >= -20; x -= 10) {
            hills.push({ x, y: middle - size * Math.sin(phase + x / length) });
        }
        sky.fillStyle(colour).fillPoints(hills, true);
    });
}
