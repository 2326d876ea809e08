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

use crate::clock::Clock;
use crate::console::{BAD, Console, DOUBTFUL, GOOD};
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::{self, OneLine, Shown};
use crate::identity::game_digest;

mod cache;
mod interrupt;
mod judge;
mod panics;
mod pool;
mod progress;
mod report;
mod shard;
mod tasks;
mod totals;
mod watch;

use cache::Cache;
use interrupt::Interrupt;
use judge::{Outcome, Shared};
use pool::{Order, Pause, Sink};
use progress::Progress;
use report::{Digests, Report};
use shard::Shard;
use tasks::Tasks;
use totals::Totals;
use watch::Work;

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
    /// Print each result as soon as it is known, in any order: a long file holds up no other
    #[arg(long)]
    unordered: bool,
    /// Stop a file after this many seconds, without a verdict; checked between ticks
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    max_seconds: Option<u64>,
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
    let time_max = arguments.max_seconds.map(Duration::from_secs);
    let verifier = Verifier { judge: judge::judge::<G>, cache, limits, time_max, shared: Shared::default() };
    let jobs = arguments.jobs.map_or_else(processors, usize::from);
    let tasks = Tasks::new(&arguments.paths, arguments.shard);
    let order = if arguments.unordered { Order::Completion } else { Order::Tasks };
    let mut display = Display::new(arguments, &mut context.console, &verifier.shared);
    let work = |task: Result<PathBuf, CommandError>| task.and_then(|path| verifier.verify(path));
    pool::run(jobs, order, tasks, work, &verifier.shared.stop, &mut display)?;
    display.finish()
}

fn processors() -> usize {
    thread::available_parallelism().map_or(1, NonZeroUsize::get)
}

/// Verifies one file, on any thread.
struct Verifier {
    judge: fn(&[u8], &Limits, &Shared, &Work) -> Outcome,
    limits: Limits,
    time_max: Option<Duration>,
    cache: Option<Cache>,
    shared: Shared,
}

/// A file and its outcome.
struct Verified {
    path: PathBuf,
    outcome: Outcome,
    digests: Digests,
    cached: bool,
    /// Why the report could not be cached.
    unkept: Option<io::Error>,
}

impl Verifier {
    fn verify(&self, path: PathBuf) -> Result<Verified, CommandError> {
        let at_work = self.shared.watch.begin(path.clone(), self.time_max);
        let bytes = self.read(&path).map_err(CommandError::read(&path))?;
        let digests = Digests { blake3: blake3::hash(&bytes), game: game_digest(&bytes, &self.limits) };
        let judge = || (self.judge)(&bytes, &self.limits, &self.shared, at_work.work());
        let Some(cache) = &self.cache else {
            return Ok(Verified { path, outcome: judge(), digests, cached: false, unkept: None });
        };
        let key = cache.key(&digests.blake3);
        if let Some(report) = cache.get(&key) {
            return Ok(Verified {
                path,
                outcome: Outcome::Report(report),
                digests,
                cached: true,
                unkept: None,
            });
        }
        let outcome = judge();
        let unkept = match &outcome {
            Outcome::Report(report) if report.is_final() => cache.put(&key, report.clone()).err(),
            _ => None,
        };
        Ok(Verified { path, outcome, digests, cached: false, unkept })
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
    /// Seconds after which files are stopped.
    max_seconds: u64,
    console: &'a mut Console<'c>,
    shared: &'a Shared,
    interrupt: Interrupt,
    progress: Progress,
    clock: Clock,
    totals: Totals,
    exit: Exit,
    is_cache_failing: bool,
}

impl Sink<Result<Verified, CommandError>> for Display<'_, '_> {
    type Error = CommandError;

    fn result(&mut self, result: Result<Verified, CommandError>) -> Result<(), CommandError> {
        match result {
            Err(error) => self.trouble(&error)?,
            Ok(verified) => self.line(&verified)?,
        }
        self.progress.update(&self.totals, self.shared, self.clock.elapsed());
        Ok(())
    }

    /// Names the files that take long, and updates the progress line.
    fn pause(&mut self) -> Result<Pause, CommandError> {
        for work in self.shared.watch.overdue() {
            self.progress.aside(|| self.console.note(work));
        }
        self.progress.update(&self.totals, self.shared, self.clock.elapsed());
        Ok(if self.interrupt.caught().is_some() { Pause::End } else { Pause::Continue })
    }

    /// Names the files at work and the signal, and ends the process without waiting for them.
    fn end(&mut self) {
        let Some((name, signal)) = self.interrupt.caught() else { return };
        self.totals.elapsed = self.clock.elapsed();
        let at_work = self.shared.watch.at_work();
        self.progress.aside(|| {
            for work in &at_work {
                self.console.note(work);
            }
            let count = at_work.len();
            self.console.note(format_args!("{}; stopped by {name} with {count} files at work", self.totals));
        });
        let _ = self.console.out.flush();
        interrupt::end_process(signal);
    }
}

impl<'a, 'c> Display<'a, 'c> {
    fn new(arguments: &Arguments, console: &'a mut Console<'c>, shared: &'a Shared) -> Self {
        Display {
            json: arguments.json,
            max_seconds: arguments.max_seconds.unwrap_or(0),
            progress: Progress::new(console.is_terminal && !arguments.json),
            interrupt: Interrupt::listen(console.owns_process),
            console,
            shared,
            clock: Clock::start(),
            totals: Totals::default(),
            exit: Exit::Success,
            is_cache_failing: false,
        }
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
        let Verified { path, outcome, digests, cached, unkept } = verified;
        let report = match outcome {
            Outcome::Report(report) => report,
            Outcome::OutOfTime { ticks } => return self.out_of_time(path, digests, *ticks),
            Outcome::Stopped => return Ok(()),
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
            true => self.console.line(report.json(path, digests, *cached)),
            false => self.console.line(Line { path, report }),
        })
    }

    /// Prints the line of a file that has used up its time. It counts like a file that cannot be read.
    fn out_of_time(&mut self, path: &Path, digests: &Digests, ticks: u64) -> Result<(), CommandError> {
        self.exit = Exit::Trouble;
        self.totals.add_undecided(ticks);
        let seconds = self.max_seconds;
        self.progress.aside(|| match self.json {
            true => self.console.line(report::out_of_time(path, digests, seconds, ticks)),
            false => self.console.line(format_args!(
                "{}: {DOUBTFUL}out of time{DOUBTFUL:#}: no verdict after {seconds} s and {ticks} ticks",
                Shown(path)
            )),
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
