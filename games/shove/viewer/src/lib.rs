//! The viewer of Shove: matches of two people at one keyboard, with bots, or over a network. It also shows replays.
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

mod decorate;

use lockstep2d::peer::PeerOptions;
use lockstep2d_shove::{Bot, Pad, Setup, Shove};
use lockstep2d_viewer::{Controls, Key, Viewer};

pub use decorate::{SEAT_COLOURS, decorate};

/// The viewer: two people at the keyboard, and bots on further seats.
#[must_use]
pub fn viewer() -> Viewer<Shove> {
    let seats = |seats| move |seed| Setup { seats, seed, ..Setup::default() };
    Viewer::new()
        .name("shove-viewer")
        .about("Plays shove: two people at one keyboard, or several over a network; and shows its replays")
        .scene("three", "two people and a bot", seats(3))
        .scene("duel", "two people", seats(2))
        .scene("four", "two people and two bots", seats(4))
        .keys(left())
        .keys(right())
        .bot(bot)
        .bot(bot)
        .draw(|game, canvas| {
            let camera = *canvas.camera();
            decorate(game, canvas.list(), &camera);
        })
        .status(decorate::headline)
        .online(PeerOptions::rollback())
}

/// Creates the bot of a seat.
#[must_use]
pub fn bot(seed: u64, seat: usize) -> lockstep2d_viewer::Bot<Shove> {
    let mut bot = Bot::new(seed, u8::try_from(seat).unwrap_or(u8::MAX));
    Box::new(move |game| bot.pad(game))
}

/// Keys of one person: W, A, S and D, and F to dash.
#[must_use]
pub fn left() -> Controls<Pad> {
    let keys = [('w', Pad::UP), ('a', Pad::LEFT), ('s', Pad::DOWN), ('d', Pad::RIGHT), ('f', Pad::DASH)];
    keys.into_iter().fold(Controls::new(), |controls, (key, pad)| button(controls, key, pad))
}

/// Keys of the other person: the arrow keys, and Enter or Control to dash.
#[must_use]
pub fn right() -> Controls<Pad> {
    let keys = [
        (Key::Up, Pad::UP),
        (Key::Left, Pad::LEFT),
        (Key::Down, Pad::DOWN),
        (Key::Right, Pad::RIGHT),
        (Key::Enter, Pad::DASH),
        (Key::Control, Pad::DASH),
    ];
    keys.into_iter().fold(Controls::new(), |controls, (key, pad)| button(controls, key, pad))
}

fn button(controls: Controls<Pad>, key: impl Into<Key>, button: Pad) -> Controls<Pad> {
    controls.key(key, move |pad: &mut Pad| *pad = pad.with(button))
}
