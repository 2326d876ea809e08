//! `diff`: prints the first difference between two reports, replays or snapshots, and which side diverged.

use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::lockstep::Game;
use lockstep2d::report::{Comparison, Evidence, compare};

use crate::console::Console;
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::panics;

pub(super) mod json;
mod text;

/// Print the first difference between two reports, replays or snapshots, and which side diverged
#[derive(Args, Debug)]
#[command(
    after_help = "The inputs of the replays are played again: a side whose states differ from the result has \
                        diverged. Tick t is the state after t ticks.\n\nExit code: 0 when nothing differs, 1 when \
                        something does, 2 for wrong usage, or files that cannot be read or compared."
)]
pub(crate) struct Arguments {
    /// A report of a divergence, a replay, or a snapshot of a world
    pub(super) a: PathBuf,
    /// The file to compare it with
    b: PathBuf,
    #[command(flatten)]
    printed: Printed,
}

/// Options for printing a comparison.
#[derive(Args, Debug)]
pub(super) struct Printed {
    /// Print all differences as one JSON document
    #[arg(long)]
    json: bool,
    /// Maximum number of bodies, joints and other parts of the state to show, and of fields of a setup or an input
    #[arg(long, default_value_t = 10, value_name = "N")]
    subjects: usize,
}

impl Printed {
    pub(super) fn print(
        &self,
        found: &Comparison,
        sides: [&Path; 2],
        console: &mut Console<'_>,
    ) -> CommandResult {
        if self.json {
            console.json(&json::document(sides, found))?;
        } else {
            console.line(text::Text { found, sides, subjects: self.subjects })?;
        }
        Ok(if found.is_equal() { Exit::Success } else { Exit::NoMatch })
    }
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let (a, b) = (read(&arguments.a, context)?, read(&arguments.b, context)?);
    panics::playing(&[&arguments.a, &arguments.b]);
    let found = compare::<G>(&a, &b, context.limits()).map_err(CommandError::Compare)?;
    arguments.printed.print(&found, [&arguments.a, &arguments.b], &mut context.console)
}

pub(super) fn read<G: Game>(path: &Path, context: &Context<'_, G>) -> Result<Evidence, CommandError> {
    let bytes = context.load(path)?;
    Evidence::read(bytes, context.limits())
        .map_err(|error| CommandError::Evidence { path: path.to_path_buf(), error })
}
