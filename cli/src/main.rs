//! The `lockstep2d` command: the tools of the sandbox game.

use std::process::ExitCode;

use lockstep2d::draw::{self, View};
use lockstep2d::lockstep::Sandbox;
use lockstep2d_cli::{SandboxScenes, Tool};

fn main() -> ExitCode {
    Tool::<Sandbox>::new().with_scenes(SandboxScenes).with_svg(draw_world).run()
}

fn draw_world(game: &Sandbox) -> String {
    draw::svg(game.world(), &View::default())
}
