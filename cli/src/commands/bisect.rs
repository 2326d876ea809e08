//! `bisect`: finds the tick, its stage, the body and the field in which a course leaves another.

use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;
use lockstep2d::report::bisect;

use super::diff::{self, json, text};
use crate::console::Console;
use crate::error::CommandError;
use crate::exit::Exit;

/// Find the tick, its stage, the body and the field in which a course leaves another
#[derive(Args, Debug)]
#[command(
    after_help = "Without B, the other course is that of this program with the same inputs. A replay has one hash a \
                        second, so it tells the second; a trace of that second, written by the program that wrote \
                        the replay (see the command trace), tells the rest. With B, replays may have other inputs or \
                        setups: both are played until their states differ. Tick t is the state after t ticks.\n\n\
                        Exit code: 0 when nothing differs, 1 when something does, 2 for wrong usage, or files that \
                        cannot be read or compared."
)]
pub(crate) struct Arguments {
    /// A replay, a trace or a report of a divergence
    a: PathBuf,
    /// What to compare it with, instead of this program
    b: Option<PathBuf>,
    /// Print one JSON document, with all that differs
    #[arg(long)]
    json: bool,
    /// How many of the bodies and other things that differ to show
    #[arg(long, default_value_t = 10, value_name = "N")]
    things: usize,
}

pub(crate) fn run<G: Game>(
    arguments: &Arguments,
    limits: &Limits,
    console: &mut Console<'_>,
) -> Result<Exit, CommandError> {
    let a = diff::read(&arguments.a, limits)?;
    let b = arguments.b.as_ref().map(|b| diff::read(b, limits)).transpose()?;
    let found = bisect::<G>(&a, b.as_ref(), limits).map_err(CommandError::Compare)?;
    let other = arguments.b.as_deref().unwrap_or(Path::new("this program"));
    if arguments.json {
        console.line(json::document(&arguments.a, other, &found))?;
    } else {
        console.line(text::Text { found: &found, sides: [&arguments.a, other], things: arguments.things })?;
    }
    Ok(if found.is_equal() { Exit::Success } else { Exit::NoMatch })
}
