//! The `shove` command: the replay tools for this game, and network matches.

mod play;
mod scenes;

use std::process::ExitCode;

use lockstep2d::draw::{Frame, Layers, View};
use lockstep2d::math::{Aabb, Vec2};
use lockstep2d_cli::Tool;
use lockstep2d_shove::{START_RADIUS, Shove};

use scenes::Matches;

fn main() -> ExitCode {
    Tool::<Shove>::new()
        .with_scenes(Matches)
        .with_view(view_of_match)
        .with_command(play::command(), play::run)
        .run()
}

/// Picture of the whole platform, with the round and the scores as title.
fn view_of_match(game: &Shove) -> View {
    let corner = Vec2::new(START_RADIUS, START_RADIUS);
    let scores: Vec<_> = game.players_in_order().map(|player| player.score.to_string()).collect();
    let title = format!("round {} · {:?} · {}", game.round(), game.phase(), scores.join(" : "));
    let frame = Frame::Window(Aabb::new(-corner, corner));
    let layers = Layers { outlines: true, joints: true, velocities: true, ..Layers::NONE };
    View { height: 960, frame, title, layers, ..View::default() }
}
