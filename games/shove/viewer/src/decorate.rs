//! Draws seat colours, scores, the recharge of dashes, and the edge of the platform.

use std::f32::consts::TAU;

use lockstep2d::body::{Body, Geometry};
use lockstep2d::lockstep::Game;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::World;
use lockstep2d_render::{CELL_HEIGHT, Camera, Colour, DrawList, width_of};
use lockstep2d_shove::{Phase, Player, START_RADIUS, Shove};

/// Colours of the seats, distinguishable with colour blindness.
pub const SEAT_COLOURS: [Colour; 4] =
    [Colour::hex(0xe6_9f00), Colour::hex(0x56_b4e9), Colour::hex(0x00_9e73), Colour::hex(0xcc_79a7)];

/// Neutral grey, visible on light and dark backgrounds.
const NEUTRAL: Colour = Colour::hex(0x8a_8f98);
/// Background of the scores. It is dark because the scores have bright colours.
const PLATE: Colour = Colour::hex(0x14_181d);
/// Colour of the headline.
const TITLE: Colour = Colour::hex(0xe4_e7eb);
/// Number of segments of a circle.
const CORNERS: u16 = 48;
/// Recharge time of a dash, in ticks.
const RECHARGE: f32 = 75.0;

/// Draws the edge of the platform, the players with the recharge of their dashes, and the scores.
pub fn decorate(game: &Shove, list: &mut DrawList, camera: &Camera) {
    draw_platform(game, list, camera);
    for (seat, player) in game.players_in_order().enumerate() {
        draw_player(game.world(), seat, &player, list, camera);
    }
    draw_scores(game, list, camera);
}

/// Text with the round and its phase.
pub(crate) fn headline(game: &Shove) -> String {
    let seconds = u32::from(game.ticks_left()).div_ceil(game.tick_rate());
    let present = game.players_in_order().filter(|player| player.present).count();
    let phase = match game.phase() {
        Phase::Over => return "match over".into(),
        _ if present == 0 => return "no players".into(),
        Phase::Ready => format!("ready in {seconds}"),
        Phase::Fight => format!("{seconds} s left"),
        Phase::Pause => "next round soon".into(),
    };
    if game.is_practice() { "practice".into() } else { format!("round {} · {phase}", game.round()) }
}

/// Draws the original edge of the platform and the current one.
fn draw_platform(game: &Shove, list: &mut DrawList, camera: &Camera) {
    let ring = |radius| arc(camera, Vec2::ZERO, camera.length(radius), 1.0);
    list.line(ring(START_RADIUS), NEUTRAL.with_opacity(90), 1.0);
    let is_crumbling = game.radius() < START_RADIUS;
    let edge = if is_crumbling { Colour::hex(0xd5_5e00) } else { NEUTRAL };
    list.line(ring(game.radius()), edge, 2.5);
}

fn draw_player(world: &World, seat: usize, player: &Player, list: &mut DrawList, camera: &Camera) {
    let Some(body) = player.body.and_then(|id| world.body(id)) else { return };
    let colour = SEAT_COLOURS[seat % SEAT_COLOURS.len()];
    let radius = camera.length(radius_of(world, body));
    let disc = arc(camera, player.position, radius, 1.0);
    list.polygon(disc.skip(1), colour, Colour::hex(0x00_0000).with_opacity(160), 1.5);
    // The arc is a full circle when the dash is ready.
    let charge = 1.0 - (player.recharge as f32 / RECHARGE).min(1.0);
    if charge > 0.0 {
        let width = if player.recharge == 0 { 3.0 } else { 1.5 };
        list.line(arc(camera, player.position, radius + 5.0, charge), colour, width);
    }
    let number = (seat + 1).to_string();
    let [x, y] = camera.place(player.position);
    let scale = (radius / CELL_HEIGHT).clamp(0.5, 2.0);
    let corner = [x - width_of(&number, scale) / 2.0, y - scale * CELL_HEIGHT / 2.0];
    list.text(corner, scale, Colour::hex(0x00_0000), number);
}

fn radius_of(world: &World, body: &Body) -> Fx {
    let shape = body.shapes().first().and_then(|shape| world.shape(*shape));
    match shape.map(|shape| shape.geometry()) {
        Some(Geometry::Circle { radius }) => *radius,
        _ => Fx::ONE / 2,
    }
}

/// Draws the scores above the platform, or at the upper edge of the window if there is no room.
fn draw_scores(game: &Shove, list: &mut DrawList, camera: &Camera) {
    let [middle, top] = camera.place(Vec2::new(Fx::ZERO, START_RADIUS));
    let top = (top - 3.0 * CELL_HEIGHT).max(2.0 * CELL_HEIGHT);
    let title = headline(game);
    let scores: Vec<_> = game.players_in_order().enumerate().map(score).collect();
    let gap = width_of("   ", 1.0);
    let row = scores.iter().map(|(_, text)| width_of(text, 1.0) + gap).sum::<f32>() - gap;
    let width = row.max(width_of(&title, 1.0)) + gap;
    let plate = [width, 2.5 * CELL_HEIGHT];
    list.rectangle([middle - width / 2.0, top - CELL_HEIGHT / 4.0], plate, PLATE.with_opacity(220));
    list.text([middle - width_of(&title, 1.0) / 2.0, top], 1.0, TITLE, title);
    let mut x = middle - row / 2.0;
    for (colour, text) in scores {
        let advance = width_of(&text, 1.0) + gap;
        list.text([x, top + CELL_HEIGHT], 1.0, colour, text);
        x += advance;
    }
}

/// Colour and text of a seat. The text is the seat's number and its points, for example `1: 7`. The points are in
/// brackets if the player has fallen. An empty seat has a hyphen instead of points.
fn score((seat, player): (usize, Player)) -> (Colour, String) {
    let points = match player {
        Player { present: false, .. } => "-".into(),
        Player { body: None, score, .. } => format!("({score})"),
        Player { score, .. } => score.to_string(),
    };
    (SEAT_COLOURS[seat % SEAT_COLOURS.len()], format!("{}: {points}", seat + 1))
}

/// Points of an arc, clockwise from the top of the circle. `radius` is in pixels, and `part` is the fraction of the
/// full circle.
fn arc(camera: &Camera, centre: Vec2<Fx>, radius: f32, part: f32) -> impl Iterator<Item = [f32; 2]> {
    let [x, y] = camera.place(centre);
    (0..=CORNERS).map(move |corner| {
        let (sin, cos) = (TAU * part * f32::from(corner) / f32::from(CORNERS)).sin_cos();
        [x + radius * sin, y - radius * cos]
    })
}
