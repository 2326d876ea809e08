//! The game in a window: `cargo run`, or `cargo run -- match.replay`. Two people play at one keyboard, or two processes
//! with `--host 0.0.0.0:7000` and `--join 127.0.0.1:7000`.

// Drawing may use floats.
#![allow(clippy::disallowed_methods, clippy::disallowed_types, clippy::float_arithmetic)]

use lockstep2d::peer::PeerOptions;
use lockstep2d_viewer::{Colour, Controls, Key, Viewer};
use my_game::{Input, MyGame, Setup};

/// Colours of the players.
const COLOURS: [Colour; 2] = [Colour::hex(0xd55e00), Colour::hex(0x0072b2)];

fn main() -> std::process::ExitCode {
    let arrows = Controls::new()
        .key(Key::Right, |input: &mut Input| input.x += 1)
        .key(Key::Left, |input| input.x -= 1)
        .key(Key::Up, |input| input.y += 1)
        .key(Key::Down, |input| input.y -= 1);
    let letters = Controls::new()
        .key('d', |input: &mut Input| input.x += 1)
        .key('a', |input| input.x -= 1)
        .key('w', |input| input.y += 1)
        .key('s', |input| input.y -= 1);
    Viewer::<MyGame>::new()
        .scene("match", "two people at one keyboard", |_seed| Setup::default())
        .keys(letters)
        .keys(arrows)
        .state(|game| game.rules().clone())
        .draw(|game, canvas| {
            let [left, right] = game.rules().goals;
            for (player, colour) in game.bodies().into_iter().zip(COLOURS) {
                canvas.body(game.world(), player, colour);
            }
            canvas.headline(Colour::hex(0xffffff), format!("{left} : {right}"));
        })
        .online(PeerOptions::rollback())
        .run()
}
