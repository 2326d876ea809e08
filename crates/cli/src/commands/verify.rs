//! `verify`: plays replays again and prints a verdict for each file.

use std::fmt;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use clap::{Args, Command};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;

use crate::console::{BAD, Console, DOUBTFUL, GOOD};
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::{self, OneLine, Shown};

mod cache;
mod judge;
mod panics;
mod pool;
mod progress;
mod report;
mod shard;
mod tasks;
mod totals;

use cache::Cache;
use judge::Shared;
use progress::Progress;
use report::Report;
use shard::Shard;
use tasks::Tasks;
use totals::Totals;

/// Play replays again and print a verdict for each file
#[derive(Args, Debug)]
#[command(after_help = "Exit code: 0 when all match, 1 when any does not, 2 for wrong usage, a path that \
                        cannot be read, or nothing to verify. See docs/VERIFYING.md.")]
pub(crate) struct Arguments {
    /// Replays, folders that contain *.replay files at any depth, or - for a replay from standard input
    #[arg(required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,
    /// Print a line of JSON for each file
    #[arg(long)]
    json: bool,
    /// Number of files to verify in parallel [default: number of processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Verify only the I-th of N parts of the files, counted from 1
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE, hide_default_value = true)]
    shard: Shard,
    /// Cache verdicts in this folder, and do not play files again whose verdict is cached
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    #[command(flatten)]
    limits: LimitArguments,
}

/// Limits of one file that override the limits of the tool.
#[derive(Args, Debug)]
#[command(next_help_heading = "Limits of one file")]
struct LimitArguments {
    /// Most bytes of the file
    #[arg(long, value_name = "N")]
    max_bytes: Option<u64>,
    /// Most ticks
    #[arg(long, value_name = "N")]
    max_ticks: Option<u64>,
    /// Most bodies in its world at a time
    #[arg(long, value_name = "N")]
    max_bodies: Option<u64>,
    /// Most work units of one tick, as the game counts them
    #[arg(long, value_name = "N")]
    max_tick_work: Option<u64>,
    /// Most work units of all ticks together
    #[arg(long, value_name = "N")]
    max_work: Option<u64>,
}

impl LimitArguments {
    fn over(&self, limits: &Limits) -> Limits {
        Limits {
            file_bytes: self.max_bytes.unwrap_or(limits.file_bytes),
            ticks: self.max_ticks.unwrap_or(limits.ticks),
            bodies: self.max_bodies.unwrap_or(limits.bodies),
            tick_work: self.max_tick_work.unwrap_or(limits.tick_work),
            total_work: self.max_work.unwrap_or(limits.total_work),
            ..limits.clone()
        }
    }
}

/// Adds the limits of the tool to the help of the arguments that override them.
pub(crate) fn with_defaults(command: Command, limits: &Limits) -> Command {
    let defaults = [
        ("max_bytes", limits.file_bytes),
        ("max_ticks", limits.ticks),
        ("max_bodies", limits.bodies),
        ("max_tick_work", limits.tick_work),
        ("max_work", limits.total_work),
    ];
    defaults.into_iter().fold(command, |command, (argument, most)| {
        command.mut_arg(argument, |argument| {
            let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
            argument.help(format!("{help} [default: {most}]"))
        })
    })
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let limits = arguments.limits.over(context.limits());
    let open = |folder: &PathBuf| Cache::open(folder, G::RULES, &limits).map_err(CommandError::write(folder));
    let cache = arguments.cache.as_ref().map(open).transpose()?;
    let verifier = Verifier { judge: judge::judge::<G>, cache, limits, shared: Shared::default() };
    let jobs = arguments.jobs.map_or_else(processors, usize::from);
    let tasks = Tasks::new(&arguments.paths, arguments.shard);
    let mut display = Display::new(arguments.json, &mut context.console, &verifier.shared);
    pool::in_order(
        jobs,
        tasks,
        |task| task.and_then(|path| verifier.verify(path)),
        &verifier.shared.stop,
        |result| display.show(result),
    )?;
    display.finish()
}

fn processors() -> usize {
    thread::available_parallelism().map_or(1, NonZeroUsize::get)
}

/// Verifies one file, on any thread.
struct Verifier {
    judge: fn(&[u8], &Limits, &Shared) -> Option<Report>,
    limits: Limits,
    cache: Option<Cache>,
    shared: Shared,
}

/// A file and its report.
struct Verified {
    path: PathBuf,
    /// `None` if verification was stopped.
    report: Option<Report>,
    cached: bool,
    /// Why the report could not be cached.
    unkept: Option<io::Error>,
}

impl Verifier {
    fn verify(&self, path: PathBuf) -> Result<Verified, CommandError> {
        let bytes = self.read(&path).map_err(CommandError::read(&path))?;
        let Some(cache) = &self.cache else {
            let report = (self.judge)(&bytes, &self.limits, &self.shared);
            return Ok(Verified { path, report, cached: false, unkept: None });
        };
        let key = cache.key(&bytes);
        if let Some(report) = cache.get(&key) {
            return Ok(Verified { path, report: Some(report), cached: true, unkept: None });
        }
        let report = (self.judge)(&bytes, &self.limits, &self.shared);
        let to_keep = report.clone().filter(Report::is_final);
        let unkept = to_keep.and_then(|report| cache.put(&key, report).err());
        Ok(Verified { path, report, cached: false, unkept })
    }

    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        if path.as_os_str() == tasks::INPUT {
            files::read_from(io::stdin().lock(), 0, self.limits.file_bytes)
        } else {
            files::read(path, self.limits.file_bytes)
        }
    }
}

/// Prints the results line by line, and the summary.
struct Display<'a, 'c> {
    json: bool,
    console: &'a mut Console<'c>,
    shared: &'a Shared,
    progress: Progress,
    clock: Clock,
    totals: Totals,
    exit: Exit,
    is_cache_failing: bool,
}

impl<'a, 'c> Display<'a, 'c> {
    fn new(json: bool, console: &'a mut Console<'c>, shared: &'a Shared) -> Self {
        Display {
            json,
            progress: Progress::new(console.is_terminal && !json),
            console,
            shared,
            clock: Clock::start(),
            totals: Totals::default(),
            exit: Exit::Success,
            is_cache_failing: false,
        }
    }

    /// Prints a result, or without one only updates the progress line.
    fn show(&mut self, result: Option<Result<Verified, CommandError>>) -> Result<(), CommandError> {
        match result {
            None => {}
            Some(Err(error)) => self.trouble(&error)?,
            Some(Ok(verified)) => self.line(&verified)?,
        }
        self.progress.update(&self.totals, self.shared, self.clock.elapsed());
        Ok(())
    }

    /// Prints an error. With `--json`, a file that cannot be read also gets a line among the results.
    fn trouble(&mut self, error: &CommandError) -> Result<(), CommandError> {
        self.exit = Exit::Trouble;
        if let (true, CommandError::Read { path, error }) = (self.json, error) {
            self.progress.aside(|| self.console.line(report::unread(path, error)))?;
        }
        self.progress.aside(|| self.console.error(error));
        Ok(())
    }

    fn line(&mut self, verified: &Verified) -> Result<(), CommandError> {
        let Verified { path, report: Some(report), cached, unkept } = verified else {
            return Ok(());
        };
        self.totals.add(report, *cached);
        if !report.is_match() {
            self.exit = self.exit.max(Exit::NoMatch);
        }
        if let Some(error) = unkept.as_ref().filter(|_| !self.is_cache_failing) {
            // Warn only once: the cause is the same for all files.
            self.is_cache_failing = true;
            let warning = format!("verdicts cannot be cached: {error}");
            self.progress.aside(|| self.console.warning(warning));
        }
        self.progress.aside(|| match self.json {
            true => self.console.line(report.json(path, *cached)),
            false => self.console.line(Line { path, report }),
        })
    }

    fn finish(mut self) -> CommandResult {
        self.progress.finish();
        self.totals.elapsed = self.clock.elapsed();
        if self.json {
            self.console.note(&self.totals);
        } else if self.totals.files > 0 {
            self.console.line(&self.totals)?;
        }
        Ok(self.exit)
    }
}

/// Measures the elapsed time. The time is shown and never reaches a simulation.
#[expect(clippy::disallowed_types, reason = "the time is shown to the user and never reaches a simulation")]
struct Clock(std::time::Instant);

#[expect(clippy::disallowed_types, reason = "the time is shown to the user and never reaches a simulation")]
impl Clock {
    fn start() -> Self {
        Clock(std::time::Instant::now())
    }

    fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }
}

/// A file and its verdict as readable text.
struct Line<'a> {
    path: &'a Path,
    report: &'a Report,
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let style = match self.report {
            report if report.is_match() => GOOD,
            report if report.is_doubtful() => DOUBTFUL,
            _ => BAD,
        };
        let text = &self.report.text;
        let (word, rest) = text.split_once(':').unwrap_or((text, ""));
        write!(f, "{}: {style}{word}{style:#}:{}", Shown(self.path), OneLine(rest))
    }
}
