//! `verify`: plays replays again and prints a verdict for each file.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use clap::{Args, Command};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;

use crate::context::{CommandResult, Context};
use crate::error::CommandError;

mod cache;
mod display;
mod interrupt;
mod judge;
mod judge_api;
mod pool;
mod progress;
mod report;
mod shard;
mod signers;
mod tasks;
mod totals;
mod verifier;
mod watch;

use cache::Cache;
use display::Display;
use judge::Shared;
pub use judge_api::{Judge, Judged};
use pool::Order;
use shard::Shard;
use signers::Signers;
use tasks::Tasks;
use verifier::Verifier;

/// Play replays again and print a verdict for each file
#[derive(Args, Debug)]
#[command(after_help = "Exit code: 0 when all match, 1 when any does not, 2 for wrong usage, a path that \
                        cannot be read, or nothing to verify, 3 when all match but a signature that --keys requires is \
                        missing or not valid. See docs/VERIFYING.md.")]
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
    /// Print each result as soon as it is known, in any order
    #[arg(long)]
    unordered: bool,
    /// Stop a file after this many seconds, without a verdict; checked between ticks
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    max_seconds: Option<u64>,
    #[command(flatten)]
    signers: SignerArguments,
    #[command(flatten)]
    limits: LimitArguments,
}

/// Required signatures.
#[derive(Args, Debug)]
#[command(next_help_heading = "Signatures")]
struct SignerArguments {
    /// Require a signature of each file by one of the public keys in this file, lines of `KEY NAME`
    #[arg(long, value_name = "FILE")]
    keys: Option<PathBuf>,
    /// Require signatures by this many different names
    #[arg(long, value_name = "N", default_value_t = 1, requires = "keys")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..))]
    require: u16,
}

/// Arguments of `verify` that override the limits of one file.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Limits of one file")]
pub struct LimitArguments {
    /// Maximum size of the file in bytes
    #[arg(long, value_name = "N")]
    max_bytes: Option<u64>,
    /// Maximum number of ticks
    #[arg(long, value_name = "N")]
    max_ticks: Option<u64>,
    /// Maximum number of bodies in its world, at the start and after every tick
    #[arg(long, value_name = "N")]
    max_bodies: Option<u64>,
    /// Maximum work units of one tick, as the game and its world count them
    #[arg(long, value_name = "N")]
    max_tick_work: Option<u64>,
    /// Maximum work units of the setup and all ticks together
    #[arg(long, value_name = "N")]
    max_work: Option<u64>,
}

impl LimitArguments {
    /// Returns `limits`, overridden by the arguments.
    ///
    /// ```
    /// use lockstep2d::replay::Limits;
    /// use lockstep2d_cli::{LimitArguments, clap::{self, Parser}};
    /// /// The arguments of a custom program that verifies replays.
    /// #[derive(Parser)]
    /// struct Arguments {
    ///     #[command(flatten)]
    ///     limits: LimitArguments,
    /// }
    /// let arguments = Arguments::parse_from(["worker", "--max-ticks", "36000"]);
    /// let limits = arguments.limits.over(&Limits::default());
    /// assert_eq!((limits.ticks, limits.bodies), (36000, Limits::default().bodies));
    /// ```
    #[must_use]
    pub fn over(&self, limits: &Limits) -> Limits {
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

/// Adds `limits` to the help of `command`, as the default values of the arguments of [`LimitArguments`]. Panics if
/// `command` lacks one of these arguments.
pub fn with_defaults(command: Command, limits: &Limits) -> Command {
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
    let SignerArguments { keys, require } = &arguments.signers;
    let signers = keys.as_ref().map(|keys| Signers::read(keys, usize::from(*require))).transpose()?;
    let time_max = arguments.max_seconds.map(Duration::from_secs);
    let verifier =
        Verifier { judge: judge::judge::<G>, cache, signers, limits, time_max, shared: Shared::default() };
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
