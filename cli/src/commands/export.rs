//! `export`: plays a replay up to a tick and draws it.

use std::fs;
use std::path::PathBuf;

use clap::{ArgMatches, Args, Command};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Playback, Verdict};

use crate::console::Console;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files;

pub(crate) const NAME: &str = "export";

/// Play a replay up to a tick and draw what is there
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The replay
    file: PathBuf,
    /// After how many ticks; 0 is the start
    #[arg(long)]
    tick: u64,
    /// As an SVG document, the one format so far
    #[arg(long, required = true)]
    svg: bool,
    /// The file to write, instead of the standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(crate) fn command() -> Command {
    Arguments::augment_args(Command::new(NAME))
}

pub(crate) fn arguments(matches: &ArgMatches) -> Arguments {
    super::from_matches(matches)
}

pub(crate) fn run<G: Game>(
    arguments: &Arguments,
    svg: fn(&G) -> String,
    limits: &Limits,
    console: &mut Console<'_>,
) -> Result<Exit, CommandError> {
    let document = svg(&play::<G>(arguments, limits)?);
    match &arguments.output {
        Some(path) => {
            fs::write(path, document).map_err(|error| CommandError::Write { path: path.clone(), error })?;
        }
        None => console.line(document.trim_end())?,
    }
    Ok(Exit::Success)
}

/// The game after the tick that was asked for.
fn play<G: Game>(arguments: &Arguments, limits: &Limits) -> Result<G, CommandError> {
    let path = || arguments.file.clone();
    let bytes = files::read(&arguments.file, limits.file_bytes)
        .map_err(|error| CommandError::Read { path: path(), error })?;
    let refused = |verdict: Verdict| CommandError::Replay { path: path(), verdict };
    let mut playback = Playback::<G>::open(&bytes, limits).map_err(refused)?;
    if arguments.tick > playback.ticks() {
        return Err(CommandError::NoSuchTick { path: path(), tick: arguments.tick, ticks: playback.ticks() });
    }
    while playback.tick() < arguments.tick {
        playback.step().map_err(refused)?;
    }
    Ok(playback.into_game())
}
