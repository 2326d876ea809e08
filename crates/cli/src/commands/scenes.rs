//! `scenes`: lists the scenes that can be recorded.

use clap::Args;
use lockstep2d::lockstep::Game;

use crate::context::{CommandResult, Context};
use crate::exit::Exit;

/// List the scenes that can be recorded
#[derive(Args, Debug)]
pub(crate) struct Arguments {}

pub(crate) fn run<G: Game>(Arguments {}: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let scenes = context.catalogue().scenes();
    let width = scenes.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
    for scene in scenes {
        context
            .console
            .line(format_args!("{:width$}  {} ({} ticks)", scene.name, scene.about, scene.ticks))?;
    }
    Ok(Exit::Success)
}
