//! `stress-saves`: plays a replay, and saves and restores the game at every tick.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::check::{
    CheckError, CheckOptions, Checked, Failure, Finding, Guess, Phases, Variant, check_replay,
};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, TickInputs};
use serde_json::{Value as Json, json};

use super::diff;
use crate::console::{BAD, GOOD};
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::Shown;
use crate::output_file::{OutputFile, Overwrite};

/// Play a replay, and at every tick save the game to bytes, restore it into a new game, and compare
///
/// The new game plays on beside the first one: after every phase of the physics step and after every tick both must
/// have the same state. Checkpoints of the replay are not checked; `verify` does that.
#[derive(Args, Debug)]
#[command(
    after_help = "Exit code: 0 when nothing differs, 1 when something does or the replay cannot be played, 2 for \
                        wrong usage, a tick after the end, or a path that cannot be read or written."
)]
pub(crate) struct Arguments {
    /// The replay
    pub(super) file: PathBuf,
    /// The first tick to compare; earlier ticks are only played
    #[arg(long, default_value_t = 0, value_name = "TICK")]
    from: u64,
    /// The last tick to play [default: the end]
    #[arg(long, value_name = "TICK")]
    to: Option<u64>,
    /// Also roll back by 1 to 8 ticks, with right and wrong input predictions
    #[arg(long)]
    rollback: bool,
    /// Also play all other variants that must give the same states: without caches, with other broad phases and so on
    #[arg(long)]
    all: bool,
    /// On failure, write the shortest failing replay that could be found
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let path = || arguments.file.clone();
    if let Some(to) = arguments.to.filter(|to| arguments.from > *to) {
        return Err(CommandError::Reversed { from: arguments.from, to });
    }
    let (bytes, limits) = (context.load(&arguments.file)?, context.limits());
    let create = |path: &PathBuf| OutputFile::create(path, arguments.overwrite, &[&arguments.file]);
    let output = arguments.output.as_ref().map(create).transpose()?;
    let result = match check_replay::<G>(&bytes, &options(arguments, limits)) {
        Ok(checked) if checked.ticks < arguments.from.max(arguments.to.unwrap_or(0)) => {
            let tick = arguments.from.max(arguments.to.unwrap_or(0));
            return Err(CommandError::NoSuchTick { path: path(), tick, ticks: ticks(&bytes, limits) });
        }
        Ok(checked) => Ok(checked),
        Err(CheckError::Failed(failure)) => Err(failure),
        Err(CheckError::Replay(verdict)) => return Err(CommandError::Replay { path: path(), verdict }),
        Err(CheckError::Record(error)) => return Err(CommandError::Record(error)),
    };
    if let (Err(failure), Some(mut output)) = (&result, output) {
        output.append(&failure.replay)?;
        output.publish(&mut context.console)?;
    }
    let outcome = Outcome { arguments, result: result.as_ref().map_err(AsRef::as_ref) };
    if arguments.json {
        context.console.json(&outcome.document())?;
    } else {
        context.console.line(&outcome)?;
    }
    Ok(if result.is_ok() { Exit::Success } else { Exit::NoMatch })
}

fn options(arguments: &Arguments, limits: &Limits) -> CheckOptions {
    let mut options = CheckOptions::default();
    if !arguments.all {
        // `Variant::Again` only plays the inputs again. If it differs, the game is not deterministic; if only
        // `Variant::Reloaded` differs, the save lacks a part of the state.
        options.variants = vec![Variant::Again, Variant::Reloaded];
        options.variants.extend(arguments.rollback.then_some(Variant::RolledBack));
    }
    CheckOptions {
        phases: Phases::Compared,
        from: arguments.from,
        to: arguments.to.unwrap_or(u64::MAX),
        budget: if arguments.output.is_some() { options.budget } else { 0 },
        limits: limits.clone(),
        ..options
    }
}

/// Number of ticks of a replay before the first tick whose inputs cannot be read.
fn ticks(file: &[u8], limits: &Limits) -> u64 {
    let Ok(mut inputs) = TickInputs::open(file, limits) else {
        return 0;
    };
    let mut ticks = 0;
    while let Ok(Some(_)) = inputs.next_tick() {
        ticks += 1;
    }
    ticks
}

struct Outcome<'a> {
    arguments: &'a Arguments,
    result: Result<&'a Checked, &'a Failure>,
}

impl fmt::Display for Outcome<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Arguments { file, from, output, .. } = self.arguments;
        match self.result {
            Ok(Checked { ticks, hash, variants, .. }) => {
                let variants: Vec<String> = variants.iter().map(Variant::to_string).collect();
                write!(f, "{}: {GOOD}holds{GOOD:#}: ticks {from} to {ticks}, ", Shown(file))?;
                write!(f, "hash {hash}; {}", variants.join(", "))
            }
            Err(failure) => {
                write!(f, "{}: {BAD}fails{BAD:#}: {}", Shown(file), Lines(&failure.finding))?;
                let Some(output) = output else {
                    return Ok(());
                };
                let (failed, of) = failure.failed;
                let ticks = failure.ticks;
                write!(f, "\n{}: {ticks} ticks that fail {failed} times out of {of}: ", Shown(output))?;
                write!(f, "{}", Lines(&failure.minimised))
            }
        }
    }
}

/// A finding. Each line is escaped, because the texts may come from an untrusted file.
struct Lines<'a>(&'a Finding);

impl fmt::Display for Lines<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, line) in self.0.to_string().lines().enumerate() {
            write!(f, "{}{}", if at > 0 { "\n" } else { "" }, Shown(Path::new(line)))?;
        }
        Ok(())
    }
}

impl Outcome<'_> {
    fn document(&self) -> Json {
        let Arguments { file, from, output, .. } = self.arguments;
        let file = file.display().to_string();
        match self.result {
            Ok(Checked { ticks, hash, variants, simulated }) => {
                let variants: Vec<String> = variants.iter().map(Variant::to_string).collect();
                json!({
                    "file": file, "holds": true, "from": from, "ticks": ticks, "hash": hash.to_string(), "variants": variants,
                    "simulated": simulated, "failure": null, "minimised": null,
                })
            }
            Err(failure) => {
                let minimised = output.as_ref().map(|output| {
                    let (failed, of) = failure.failed;
                    json!({
                        "file": output.display().to_string(), "ticks": failure.ticks, "failed": failed, "of": of,
                        "failure": described(&failure.minimised),
                    })
                });
                json!({
                    "file": file, "holds": false, "from": from, "failure": described(&failure.finding),
                    "minimised": minimised,
                })
            }
        }
    }
}

fn described(finding: &Finding) -> Json {
    let rollback = finding.rollback.map(|(ticks, guess)| {
        let guess = match guess {
            Guess::Right => "right",
            Guess::Default => "default",
            Guess::Held => "held",
        };
        json!({"ticks": ticks, "guess": guess})
    });
    json!({
        "variant": finding.variant.to_string(),
        "fault": finding.fault.to_string(),
        "tick": finding.tick,
        "phase": finding.phase.map(|phase| format!("{phase:?}")),
        "rollback": rollback,
        "fields": diff::json::fields(&finding.differences),
        "usually": finding.hint(),
    })
}
