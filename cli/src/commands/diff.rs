//! `diff`: says in what two reports, replays or snapshots differ first, and who departed.

use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::lockstep::Game;
use lockstep2d::report::{Comparison, Evidence, compare};

use crate::console::Console;
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;

pub(super) mod json;
mod text;

/// Say in what two reports, replays or snapshots differ first, and who departed
#[derive(Args, Debug)]
#[command(
    after_help = "The inputs of the replays are played again: who has other states than these lead to, has \
                        departed. Tick t is the state after t ticks.\n\nExit code: 0 when nothing differs, 1 when \
                        something does, 2 for wrong usage, or files that cannot be read or compared."
)]
pub(crate) struct Arguments {
    /// A report of a divergence, a replay, or a snapshot of a world
    a: PathBuf,
    /// What to compare it with
    b: PathBuf,
    #[command(flatten)]
    printed: Printed,
}

/// How to print a comparison.
#[derive(Args, Debug)]
pub(super) struct Printed {
    /// Print one JSON document, with all that differs
    #[arg(long)]
    json: bool,
    /// How many of the bodies and other things that differ to show
    #[arg(long, default_value_t = 10, value_name = "N")]
    things: usize,
}

impl Printed {
    /// Prints what two files, A first, differ in.
    pub(super) fn print(
        &self,
        found: &Comparison,
        sides: [&Path; 2],
        console: &mut Console<'_>,
    ) -> CommandResult {
        if self.json {
            console.line(json::document(sides, found))?;
        } else {
            console.line(text::Text { found, sides, things: self.things })?;
        }
        Ok(if found.is_equal() { Exit::Success } else { Exit::NoMatch })
    }
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let (a, b) = (read(&arguments.a, context)?, read(&arguments.b, context)?);
    let found = compare::<G>(&a, &b, context.limits()).map_err(CommandError::Compare)?;
    arguments.printed.print(&found, [&arguments.a, &arguments.b], &mut context.console)
}

/// Reads a file that can be compared with another one.
pub(super) fn read<G: Game>(path: &Path, context: &Context<'_, G>) -> Result<Evidence, CommandError> {
    let bytes = context.load(path)?;
    Evidence::read(bytes, context.limits())
        .map_err(|error| CommandError::Evidence { path: path.to_path_buf(), error })
}
