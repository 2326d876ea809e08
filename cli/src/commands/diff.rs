//! `diff`: says in what two reports, replays or snapshots differ first, and who departed.

use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;
use lockstep2d::report::{Evidence, compare};

use crate::console::Console;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files;

pub(super) mod json;
pub(super) mod text;

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
    let (a, b) = (read(&arguments.a, limits)?, read(&arguments.b, limits)?);
    let found = compare::<G>(&a, &b, limits).map_err(CommandError::Compare)?;
    if arguments.json {
        console.line(json::document(&arguments.a, &arguments.b, &found))?;
    } else {
        let sides = [arguments.a.as_path(), arguments.b.as_path()];
        console.line(text::Text { found: &found, sides, things: arguments.things })?;
    }
    Ok(if found.is_equal() { Exit::Success } else { Exit::NoMatch })
}

pub(super) fn read(path: &Path, limits: &Limits) -> Result<Evidence, CommandError> {
    let bytes = files::load(path, limits.file_bytes)?;
    Evidence::read(bytes, limits).map_err(|error| CommandError::Evidence { path: path.to_path_buf(), error })
}
