//! The viewer of a small game: a car on a hill, shells, a bridge and goals. The rules are in `game.rs`.
//!
//! `cargo run --release -p lockstep2d-viewer --example hill`

mod game;

use game::{Drive, Hill};
use lockstep2d_viewer::{Colour, Controls, Key, Viewer};

fn main() -> std::process::ExitCode {
    let keys = Controls::new()
        .key(Key::Right, |drive: &mut Drive| drive.gas += 1)
        .key(Key::Left, |drive| drive.gas -= 1)
        .key(Key::Up, |drive| drive.fire = true);
    Viewer::<Hill>::new()
        .scene("hill", "drive to the right with the arrows, fire with the upper one", |seed| seed)
        .keys(keys)
        .status(|game| format!("goals {}, planks {}", game.goals, game.planks_left()))
        .draw(|game, canvas| {
            canvas.bodies(game.world(), |id| match game.name_of(id).as_str() {
                "car" | "wheel" => Some(Colour::hex(0xd55e00)),
                "shell" => Some(Colour::hex(0x000000)),
                _ => None,
            });
            canvas.headline(Colour::hex(0xffffff), format!("goals: {}", game.goals));
        })
        .run()
}
