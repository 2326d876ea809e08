//! `scenes`: lists what can be recorded.

use clap::Args;
use lockstep2d::lockstep::Game;

use crate::console::Console;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::scenes::Catalogue;

/// List the scenes that can be recorded
#[derive(Args, Debug)]
pub(crate) struct Arguments {}

pub(crate) fn run<G: Game>(
    catalogue: &dyn Catalogue<G>,
    console: &mut Console<'_>,
) -> Result<Exit, CommandError> {
    let scenes = catalogue.scenes();
    let width = scenes.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
    for scene in scenes {
        console.line(format_args!("{:width$}  {} ({} ticks)", scene.name, scene.about, scene.ticks))?;
    }
    Ok(Exit::Success)
}
