//! `trim`: makes a complete replay of the intact part of another replay.

use std::path::PathBuf;

use clap::Args;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Part, ReadError, Reader, Verdict};
use serde::Serialize;

use crate::console::DOUBTFUL;
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::{OneLine, Shown};
use crate::output_file::{OutputFile, Overwrite};
use crate::rewriting::{Copy, CopyError};

/// Make a complete replay of the intact part of a cut or damaged one
#[derive(Args, Debug)]
#[command(
    after_help = "Blocks are kept up to the first that is damaged or whose inputs do not lead to its checkpoint. The \
                        start cannot be trimmed. The new replay is verified before it is written.\n\nExit code: 0 when \
                        it was written, 1 when there is nothing to keep, 2 for wrong usage, or files that cannot be \
                        read or written."
)]
pub(crate) struct Arguments {
    /// The replay
    pub(super) file: PathBuf,
    /// Maximum number of ticks to keep
    #[arg(long, value_name = "N")]
    ticks: Option<u64>,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let (bytes, limits) = (context.load(&arguments.file)?, context.limits());
    let mut output = OutputFile::create(&arguments.output, arguments.overwrite, &[&arguments.file])?;
    let Whole { part, interval, damage } =
        whole_part(&bytes, limits).map_err(CommandError::replay(&arguments.file))?;
    let most = arguments.ticks.unwrap_or(u64::MAX);
    // Plays up to the end of the block of the last requested tick, because ticks are kept only if the checkpoint of
    // their block agrees.
    let checked = most.checked_next_multiple_of(interval).unwrap_or(u64::MAX);
    let of_file = |error: CopyError| error.of_file(&arguments.file);
    let again = |ticks| Copy::<G>::new(part, ticks, limits).map_err(of_file);
    let (copy, damage) = match Copy::<G>::new(part, checked, limits) {
        Err(CopyError::Replay { ticks, verdict }) if ticks > 0 => (again(ticks.min(most))?, Some(verdict)),
        Ok(copy) if copy.ticks() > most => (again(most)?, damage),
        copy => (copy.map_err(of_file)?, damage),
    };
    let ticks = copy.ticks();
    let (replay, hash) = copy.finish(&arguments.output, limits)?;
    output.append(&replay)?;
    output.publish(&mut context.console)?;

    // Damage after the last requested tick is not reported.
    let damage = damage.filter(|_| ticks < most);
    if arguments.json {
        let file = arguments.output.display().to_string();
        let line =
            Line { file, ticks, hash: hash.to_string(), left_out: damage.map(|verdict| verdict.to_string()) };
        context.console.json(&line)?;
    } else {
        let (old, new) = (Shown(&arguments.file), Shown(&arguments.output));
        context.console.line(format_args!("{new}: {ticks} ticks of {old}, final hash {hash}"))?;
        if let Some(verdict) = damage {
            let verdict = verdict.to_string();
            context
                .console
                .note(format_args!("{DOUBTFUL}left out:{DOUBTFUL:#} {old}: {}", OneLine(&verdict)));
        }
    }
    Ok(Exit::Success)
}

#[derive(Serialize)]
struct Line {
    file: String,
    ticks: u64,
    hash: String,
    left_out: Option<String>,
}

struct Whole<'a> {
    /// The header and the intact blocks.
    part: &'a [u8],
    /// Number of ticks in a block.
    interval: u64,
    /// Error of the part after the intact blocks, if that part is damaged.
    damage: Option<Verdict>,
}

fn whole_part<'a>(bytes: &'a [u8], limits: &Limits) -> Result<Whole<'a>, ReadError> {
    let mut reader = Reader::open(bytes, limits)?;
    let mut end = reader.offset();
    let damage = loop {
        match reader.next_part() {
            Ok(Some(Part::Inputs(_))) => end = reader.offset(),
            Ok(_) => break None,
            Err(error) => break Some(error.into()),
        }
    };
    let end = usize::try_from(end).unwrap_or(bytes.len());
    Ok(Whole { part: &bytes[..end], interval: reader.header().checkpoint_interval.into(), damage })
}
