//! `bisect`: finds the tick, stage, body and field in which two runs first differ.

use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::lockstep::Game;
use lockstep2d::report::bisect;

use super::diff;
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::panics;

/// Find the tick, stage, body and field in which two runs first differ
#[derive(Args, Debug)]
#[command(
    after_help = "Without B, A is compared with a run of this program on the same inputs. A replay has a hash \
                        only at each checkpoint, so `bisect` finds only between which checkpoints the runs diverge. \
                        A trace of these ticks, written with `trace` by the program that wrote the replay, gives the \
                        tick, phase, body and field. With B, replays may have different inputs or setups: both are \
                        played until their states differ. Tick t is the state after t ticks.\n\nExit code: 0 when \
                        nothing differs, 1 when something does, 2 for wrong usage, or files that cannot be read or \
                        compared."
)]
pub(crate) struct Arguments {
    /// A replay, a trace or a report of a divergence
    pub(super) a: PathBuf,
    /// A file to compare it with [default: a run of this program]
    b: Option<PathBuf>,
    #[command(flatten)]
    printed: diff::Printed,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let a = diff::read(&arguments.a, context)?;
    let b = arguments.b.as_ref().map(|b| diff::read(b, context)).transpose()?;
    if let Some(b) = &arguments.b {
        panics::playing(&[&arguments.a, b]);
    }
    let found = bisect::<G>(&a, b.as_ref(), context.limits()).map_err(CommandError::Compare)?;
    let other = arguments.b.as_deref().unwrap_or(Path::new("this program"));
    arguments.printed.print(&found, [&arguments.a, other], &mut context.console)
}
