//! `seek`: goes to a tick of a replay, and back from there, with keyframes.

use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, value_parser};
use lockstep2d::codec;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{KEYFRAMES_BYTES_MAX, SeekError, Timeline, TimelineOptions};
use serde::Serialize;

use crate::console::Console;
use crate::context::{CommandResult, Context};
use crate::counts::Counts;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::{self, Shown};
use crate::output_file::{self, OutputFile, Overwrite};

/// Go to a tick of a replay and describe its state
#[derive(Args, Debug)]
#[command(
    after_help = "Tick t is the state after t ticks; 0 is the start.\n\nThe keyframe file is written by the first run \
                        that reaches a keyframe; later runs use it and add to it. Seeking then simulates at most the ticks between two \
                        keyframes. Every keyframe must have the state hash that the replay states for its tick. This \
                        does not verify the replay: only `verify` checks that the inputs lead to these states.\n\nExit \
                        code: 0 when the tick was reached, 1 when the replay cannot be played up to the tick, 2 for \
                        wrong usage, a tick after the end, a file that cannot be read or written, or keyframes of \
                        another replay."
)]
pub(crate) struct Arguments {
    /// The replay
    pub(super) file: PathBuf,
    /// The tick to go to; 0 is the start
    #[arg(long, value_name = "N")]
    tick: u64,
    /// Number of single steps back from there
    #[arg(long, value_name = "K", default_value_t = 0)]
    back: u64,
    /// The file of keyframes (saved states) of the replay: used if it exists, and written, also without --force, when
    /// this run reaches new keyframes
    #[arg(long, value_name = "FILE")]
    keyframes: Option<PathBuf>,
    /// Number of ticks between keyframes; a file of keyframes that exists keeps its own
    #[arg(long, value_name = "TICKS", default_value_t = TimelineOptions::default().interval,
          value_parser = value_parser!(u32).range(1..))]
    interval: u32,
    /// Write the game's save to this file, in its canonical encoding
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let bytes = context.load(&arguments.file)?;
    let keyframes = arguments.keyframes.as_deref().map(read_keyframes).transpose()?.flatten();
    // If there is a keyframe file, the interval 1 is only a placeholder: `use_keyframes` replaces it by the interval of
    // the file.
    let interval = if keyframes.is_some() { 1 } else { arguments.interval };
    let options = TimelineOptions { interval, ..TimelineOptions::default() };
    let mut timeline = Timeline::<G>::open(&bytes, &options, context.limits())
        .map_err(CommandError::replay(&arguments.file))?;
    if let Some((path, keyframes)) = keyframes {
        let failed = |error| CommandError::Keyframes { path: path.to_path_buf(), error };
        timeline.use_keyframes(&keyframes).map_err(failed)?;
    }
    let create = |path: &PathBuf| OutputFile::create(path, arguments.overwrite, &[&arguments.file]);
    let output = arguments.output.as_ref().map(create).transpose()?;
    let known = timeline.keyframes().count();
    let result = go(&mut timeline, arguments);
    if let Some(path) = arguments.keyframes.as_ref().filter(|_| timeline.keyframes().count() != known) {
        output_file::save(
            path,
            &timeline.keyframes_to_bytes(),
            Overwrite::ALWAYS,
            &[&arguments.file],
            &mut context.console,
        )?;
    }
    let (there, back) = result?;

    if let Some(mut output) = output {
        output.append(&codec::encode(&timeline.game().save()))?;
        output.publish(&mut context.console)?;
    }
    let found = SeekResult {
        file: arguments.file.display().to_string(),
        tick: timeline.tick(),
        ticks: timeline.ticks(),
        hash: timeline.game().state_hash().to_string(),
        counts: timeline.world().map(Counts::of),
        simulated: there,
        simulated_back: back,
        keyframe_interval: timeline.interval(),
    };
    if arguments.json {
        context.console.json(&found)?;
    } else {
        found.print(arguments, &mut context.console)?;
    }
    Ok(Exit::Success)
}

/// Seeks, then steps back. Returns the numbers of ticks simulated by the seek and by the steps back.
fn go<G: Game>(timeline: &mut Timeline<'_, G>, arguments: &Arguments) -> Result<(u64, u64), CommandError> {
    let path = || arguments.file.clone();
    let explain = |error| match error {
        SeekError::NoSuchTick { tick, ticks } => CommandError::NoSuchTick { path: path(), tick, ticks },
        SeekError::Replay(verdict) => CommandError::Replay { path: path(), verdict },
        SeekError::Forgetful { .. } => CommandError::Keyframe { path: path(), error },
        SeekError::Keyframe { .. } => {
            CommandError::Keyframe { path: arguments.keyframes.clone().unwrap_or_else(path), error }
        }
    };
    timeline.seek(arguments.tick).map_err(explain)?;
    let there = timeline.simulated();
    for _ in 0..arguments.back.min(arguments.tick) {
        timeline.step_back().map_err(explain)?;
    }
    Ok((there, timeline.simulated() - there))
}

/// Reads a file of keyframes, if it exists.
fn read_keyframes(path: &Path) -> Result<Option<(&Path, Vec<u8>)>, CommandError> {
    // 1 MiB more than the keyframes is enough for the headers of the file and of each keyframe.
    match files::read(path, (KEYFRAMES_BYTES_MAX + (1 << 20)) as u64) {
        Ok(bytes) => Ok(Some((path, bytes))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(CommandError::read(path)(error)),
    }
}

#[derive(Serialize)]
struct SeekResult {
    file: String,
    tick: u64,
    ticks: u64,
    hash: String,
    counts: Option<Counts>,
    simulated: u64,
    simulated_back: u64,
    keyframe_interval: u64,
}

impl SeekResult {
    fn print(&self, arguments: &Arguments, console: &mut Console<'_>) -> Result<(), CommandError> {
        let SeekResult { tick, ticks, hash, simulated, simulated_back, .. } = self;
        console.line(format_args!("{}: tick {tick} of {ticks}", Shown(&arguments.file)))?;
        console.line(format_args!("state {hash}"))?;
        if let Some(counts) = &self.counts {
            console.line(counts)?;
        }
        if arguments.back == 0 {
            console.line(format_args!("simulated {simulated} ticks"))?;
        } else {
            let back = arguments.back.min(arguments.tick);
            console
                .line(format_args!("simulated {simulated} ticks, and {simulated_back} for {back} back"))?;
        }
        match &arguments.output {
            Some(path) => console.line(format_args!("save written to {}", Shown(path))),
            None => Ok(()),
        }
    }
}
