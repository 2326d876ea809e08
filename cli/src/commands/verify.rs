//! `verify`: plays replays again and prints a verdict for each.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{ArgMatches, Args, Command};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Verdict};

use crate::console::{BAD, Console, DOUBTFUL, GOOD};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::{self, Shown};

mod json;

pub(crate) const NAME: &str = "verify";

/// Play replays again and print a verdict for each
#[derive(Args, Debug)]
#[command(after_help = "Exit code: 0 when all match, 1 when any does not, 2 for wrong usage, a path that \
                        cannot be read, or nothing to verify.")]
pub(crate) struct Arguments {
    /// Replays, or folders with files named *.replay at any depth
    #[arg(required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,
    /// Print a line of JSON for each file
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
    limits: &Limits,
    console: &mut Console<'_>,
) -> Result<Exit, CommandError> {
    let mut totals = Totals::default();
    let mut exit = Exit::Success;
    for path in &arguments.paths {
        match files::find(path) {
            Err(error) => {
                console.error(CommandError::Read { path: path.clone(), error });
                exit = Exit::Trouble;
            }
            Ok(files) if files.is_empty() => {
                let extension = files::EXTENSION;
                console.error(format_args!("{}: nothing to verify, no *.{extension} here", Shown(path)));
                exit = Exit::Trouble;
            }
            Ok(files) => {
                for file in files {
                    exit = exit.max(verify_file::<G>(&file, arguments, limits, &mut totals, console)?);
                }
            }
        }
    }
    if arguments.json {
        console.note(&totals);
    } else if totals.files > 0 {
        console.line(&totals)?;
    }
    Ok(exit)
}

fn verify_file<G: Game>(
    file: &Path,
    arguments: &Arguments,
    limits: &Limits,
    totals: &mut Totals,
    console: &mut Console<'_>,
) -> Result<Exit, CommandError> {
    let bytes = match files::read(file, limits.file_bytes) {
        Ok(bytes) => bytes,
        Err(error) => {
            console.error(CommandError::Read { path: file.to_path_buf(), error });
            return Ok(Exit::Trouble);
        }
    };
    let (verdict, elapsed) = timed(|| lockstep2d::replay::verify::<G>(&bytes, limits));
    totals.add(&verdict, elapsed);
    if arguments.json {
        console.line(json::line(file, &verdict))?;
    } else {
        console.line(Line { file, verdict: &verdict })?;
    }
    Ok(if verdict.is_match() { Exit::Success } else { Exit::NoMatch })
}

/// How long something took. The time is shown and never reaches a simulation.
#[expect(clippy::disallowed_types, reason = "the time is shown to the user and never reaches a simulation")]
fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let start = std::time::Instant::now();
    let result = work();
    (result, start.elapsed())
}

/// A file and its verdict, for people.
struct Line<'a> {
    file: &'a Path,
    verdict: &'a Verdict,
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let style = match self.verdict {
            Verdict::Match { .. } => GOOD,
            Verdict::Incomplete { .. } | Verdict::Unverifiable { .. } => DOUBTFUL,
            _ => BAD,
        };
        let text = self.verdict.to_string();
        let (word, rest) = text.split_once(':').unwrap_or((&text, ""));
        write!(f, "{}: {style}{word}{style:#}:{rest}", Shown(self.file))
    }
}

/// What all files come to.
#[derive(Debug, Default)]
struct Totals {
    files: u64,
    matches: u64,
    ticks: u64,
    elapsed: Duration,
}

impl Totals {
    fn add(&mut self, verdict: &Verdict, elapsed: Duration) {
        self.files += 1;
        self.matches += u64::from(verdict.is_match());
        self.ticks += verdict.ticks();
        self.elapsed += elapsed;
    }

    fn ticks_per_second(&self) -> u128 {
        u128::from(self.ticks) * 1_000_000_000 / self.elapsed.as_nanos().max(1)
    }
}

impl fmt::Display for Totals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Totals { files, matches, ticks, elapsed } = self;
        let rate = self.ticks_per_second();
        write!(f, "{matches} of {files} files match; {ticks} ticks in {elapsed:.1?}, {rate} ticks per second")
    }
}
