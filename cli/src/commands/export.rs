//! `export`: plays a replay and writes what is there in another format.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use clap::{ArgMatches, Args, Command};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Playback, Verdict};

use crate::console::Console;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files;

mod json;

pub(crate) const NAME: &str = "export";

/// Play a replay and write what is there as a picture or as JSON
#[derive(Args, Debug)]
#[command(
    after_help = "Tick t is the state after t ticks; 0 is the start. A line of JSON has the tick, the state hash \
                        and the game's save in its form for people; a fixed-point number is its bits, and beside them a \
                        decimal.\n\nExit code: 0 when it was written, 1 when the replay cannot be played as far, 2 for \
                        wrong usage, or files that cannot be read or written."
)]
pub(crate) struct Arguments {
    /// The replay
    file: PathBuf,
    #[command(flatten)]
    format: Format,
    /// After how many ticks
    #[arg(long, required_unless_present = "json")]
    tick: Option<u64>,
    /// The first tick, instead of the start
    #[arg(long, value_name = "TICK", conflicts_with_all = ["tick", "svg"])]
    from: Option<u64>,
    /// The last tick, instead of the end
    #[arg(long, value_name = "TICK", conflicts_with_all = ["tick", "svg"])]
    to: Option<u64>,
    /// The file to write, instead of the standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// In which format.
#[derive(Args, Debug)]
#[group(required = true, multiple = false)]
struct Format {
    /// A picture of one tick as an SVG document, if the game draws any
    #[arg(long)]
    svg: bool,
    /// The states of one or more ticks as JSON, a line for each
    #[arg(long)]
    json: bool,
}

pub(crate) fn command() -> Command {
    Arguments::augment_args(Command::new(NAME))
}

pub(crate) fn arguments(matches: &ArgMatches) -> Arguments {
    super::from_matches(matches)
}

pub(crate) fn run<G: Game>(
    arguments: &Arguments,
    svg: Option<fn(&G) -> String>,
    limits: &Limits,
    console: &mut Console<'_>,
) -> Result<Exit, CommandError> {
    let bytes = files::load(&arguments.file, limits.file_bytes)?;
    let mut replay = Replay::<G>::open(&bytes, arguments, limits)?;
    let first = arguments.tick.or(arguments.from).unwrap_or(0);
    let last = arguments.tick.or(arguments.to).unwrap_or(replay.playback.ticks());
    replay.check(first)?;
    replay.check(last)?;
    if arguments.format.json {
        return with_output(arguments, console, |output| json::write(replay, first..=last, output));
    }
    let svg = svg.ok_or(CommandError::NoPictures)?;
    replay.play_to(first)?;
    let document = svg(replay.playback.game());
    with_output(arguments, console, |output| output.line(document.trim_end()))
}

/// Where lines go, and what a failure to write them is.
struct Output<'a> {
    to: &'a mut dyn Write,
    path: Option<&'a PathBuf>,
}

impl Output<'_> {
    fn line(&mut self, line: &str) -> Result<(), CommandError> {
        writeln!(self.to, "{line}").map_err(|error| self.explain(error))
    }

    fn explain(&self, error: std::io::Error) -> CommandError {
        match self.path {
            Some(path) => CommandError::Write { path: path.clone(), error },
            None => CommandError::Output(error),
        }
    }
}

fn with_output(
    arguments: &Arguments,
    console: &mut Console<'_>,
    write: impl FnOnce(&mut Output<'_>) -> Result<(), CommandError>,
) -> Result<Exit, CommandError> {
    let Some(path) = &arguments.output else {
        write(&mut Output { to: console.out, path: None })?;
        return Ok(Exit::Success);
    };
    let file = File::create(path).map_err(|error| CommandError::Write { path: path.clone(), error })?;
    let mut buffer = BufWriter::new(file);
    let mut output = Output { to: &mut buffer, path: Some(path) };
    write(&mut output)?;
    output.to.flush().map_err(|error| output.explain(error))?;
    Ok(Exit::Success)
}

/// A replay that is played up to the ticks that are asked for.
struct Replay<'a, G: Game> {
    playback: Playback<'a, G>,
    path: &'a PathBuf,
}

impl<'a, G: Game> Replay<'a, G> {
    fn open(bytes: &'a [u8], arguments: &'a Arguments, limits: &Limits) -> Result<Self, CommandError> {
        let path = &arguments.file;
        let refused = |verdict| CommandError::Replay { path: path.clone(), verdict };
        Ok(Replay { playback: Playback::open(bytes, limits).map_err(refused)?, path })
    }

    /// Refuses a tick that is not there.
    fn check(&self, tick: u64) -> Result<(), CommandError> {
        let ticks = self.playback.ticks();
        let path = || self.path.clone();
        if tick > ticks { Err(CommandError::NoSuchTick { path: path(), tick, ticks }) } else { Ok(()) }
    }

    /// Plays on until after `tick` ticks.
    fn play_to(&mut self, tick: u64) -> Result<(), CommandError> {
        let refused = |verdict: Verdict| CommandError::Replay { path: self.path.clone(), verdict };
        while self.playback.tick() < tick {
            self.playback.step().map_err(refused)?;
        }
        Ok(())
    }
}
