//! `trace`: plays a replay and writes the states and phases of some of its ticks, for `bisect`.

use std::path::PathBuf;

use clap::Args;
use lockstep2d::lockstep::Game;
use lockstep2d::report::Trace;

use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::Shown;
use crate::output_file::{OutputFile, Overwrite};

/// Play a replay and write the states and phases of some ticks, for bisect
#[derive(Args, Debug)]
#[command(
    after_help = "This program plays the inputs again; checkpoints of the file are not checked. A program of another \
                        platform can `bisect` the trace to find the tick, phase, body and field in which the two \
                        programs first differ.\n\nExit code: 0 when it was written, 1 when the replay cannot be \
                        played up to the tick, 2 for wrong usage, a tick after the end, or files that cannot be read \
                        or written."
)]
pub(crate) struct Arguments {
    /// The replay
    pub(super) file: PathBuf,
    /// The last tick to trace [default: the end]
    #[arg(long, value_name = "TICK")]
    to: Option<u64>,
    /// Number of ticks to trace
    #[arg(long, default_value_t = 120)]
    ticks: u32,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let Arguments { file, to, ticks, output, overwrite } = arguments;
    let bytes = context.load(file)?;
    let mut written = OutputFile::create(output, *overwrite, &[file])?;
    let traced = Trace::<G>::of_replay(&bytes, context.limits(), to.unwrap_or(u64::MAX), *ticks);
    let report = traced.map_err(|error| CommandError::Trace { path: file.clone(), error })?;
    if let Some(tick) = to.filter(|tick| *tick > report.tick()) {
        return Err(CommandError::NoSuchTick { path: file.clone(), tick, ticks: report.tick() });
    }
    written.append(&report.to_bytes())?;
    written.publish(&mut context.console)?;
    let (known, left_out) = (report.history().len(), report.saves_left_out());
    let first = report.history().first().map_or(0, |(tick, _)| *tick);
    context.console.line(format_args!(
        "{}: ticks {first} to {}, {} of {known} states",
        Shown(output),
        report.tick(),
        known - left_out
    ))?;
    Ok(Exit::Success)
}
