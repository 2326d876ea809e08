// Draws a world on a canvas.
const COLOURS = ["#e9a13b", "#4da3e8", "#6fbf73", "#c77dd6"];

function body(context, game, [id, x, y, angle]) {
    context.save();
    context.translate(x, y);
    context.rotate(angle);
    const player = game.players.indexOf(id);
    context.fillStyle = COLOURS[player] ?? (id === 0 ? "#4a5563" : "#9aa7b5");
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

/** `scale` is in pixels per metre. */
export function draw(canvas, game, scale) {
    const context = canvas.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.setTransform(scale, 0, 0, -scale, canvas.width / 2, canvas.height - 60);
    const poses = game.world.poses();
    for (let at = 0; at < poses.length; at += 5) {
        body(context, game, poses.subarray(at, at + 5));
    }
}
