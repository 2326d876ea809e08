//! `fork`: writes a replay with the beginning of another replay and a different end.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;
use serde::Serialize;

use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::Shown;
use crate::output_file::{OutputFile, Overwrite};
use crate::panics;
use crate::rewriting::{Copy, CopyError};

/// Write a replay with the beginning of another one and a different end
#[derive(Args, Debug)]
#[command(
    after_help = "The new replay has the first N ticks of the old one, then one tick for each line of --then, then \
                        --idle ticks without input. A line is a JSON array with one input for each player; empty lines \
                        are skipped. The new replay is verified before it is written.\n\nExit code: 0 when it was \
                        written, 1 when the old replay cannot be played up to tick N or the new one would not match, 2 \
                        for wrong usage, a tick after the end, or files that cannot be read or written."
)]
pub(crate) struct Arguments {
    /// The replay
    pub(super) file: PathBuf,
    /// Number of ticks to keep
    #[arg(long, value_name = "N")]
    tick: u64,
    /// The inputs that follow, one line of JSON for each tick; - is the standard input
    #[arg(long, value_name = "FILE")]
    then: Option<PathBuf>,
    /// Number of ticks without input to add
    #[arg(long, value_name = "K", default_value_t = 0)]
    idle: u64,
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
    let inputs = [Some(&arguments.file), arguments.then.as_ref()];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().map(PathBuf::as_path).collect();
    let mut output = OutputFile::create(&arguments.output, arguments.overwrite, &inputs)?;
    let of_file = |error: CopyError| error.of_file(&arguments.file);
    let mut copy = Copy::<G>::new(&bytes, arguments.tick, limits).map_err(of_file)?;
    let kept = copy.ticks();
    if kept < arguments.tick {
        let path = arguments.file.clone();
        return Err(CommandError::NoSuchTick { path, tick: arguments.tick, ticks: kept });
    }
    if let Some(path) = &arguments.then {
        play_lines(&mut copy, path, arguments, limits)?;
    }
    panics::playing(&[&arguments.output]);
    let idle = vec![G::Input::default(); usize::try_from(copy.players()).unwrap_or(0)];
    // Records at most one tick beyond the limit, because one tick is enough to make the verification fail.
    let idle_ticks = arguments.idle.min(limits.ticks.saturating_sub(copy.ticks()).saturating_add(1));
    for _ in 0..idle_ticks {
        copy.step(&idle, limits).map_err(|error| error.of_file(&arguments.output))?;
    }
    let ticks = copy.ticks();
    let (replay, hash) = copy.finish(&arguments.output, limits)?;
    output.append(&replay)?;
    output.publish(&mut context.console)?;

    let added = ticks - kept;
    if arguments.json {
        let file = arguments.output.display().to_string();
        let line = Line { file, ticks, kept, added, hash: hash.to_string() };
        context.console.json(&line)?;
    } else {
        let (old, new) = (Shown(&arguments.file), Shown(&arguments.output));
        context
            .console
            .line(format_args!("{new}: {kept} ticks of {old} and {added} more, final hash {hash}"))?;
    }
    Ok(Exit::Success)
}

#[derive(Serialize)]
struct Line {
    file: String,
    ticks: u64,
    kept: u64,
    added: u64,
    hash: String,
}

fn play_lines<G: Game>(
    copy: &mut Copy<G>,
    path: &Path,
    arguments: &Arguments,
    limits: &Limits,
) -> Result<(), CommandError> {
    panics::playing(&[path]);
    let read_error = CommandError::read(path);
    let source: Box<dyn Read> = if path == Path::new("-") {
        Box::new(io::stdin().lock())
    } else {
        Box::new(File::open(path).map_err(&read_error)?)
    };
    // The size limit of the lines is larger than that of a replay, because inputs take more bytes in JSON.
    let lines = BufReader::new(source.take(limits.file_bytes.saturating_mul(16))).lines();
    for (number, line) in (1..).zip(lines) {
        let line = line.map_err(&read_error)?;
        if line.trim().is_empty() {
            continue;
        }
        let explain = |why| CommandError::Inputs { path: path.to_path_buf(), line: number, why };
        let inputs: Vec<G::Input> =
            serde_json::from_str(&line).map_err(|error| explain(error.to_string()))?;
        copy.step(&inputs, limits).map_err(|error| match error {
            CopyError::Record(error) => explain(error.to_string()),
            error => error.of_file(&arguments.output),
        })?;
    }
    Ok(())
}
