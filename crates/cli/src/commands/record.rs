//! `record`: plays a scene and writes its replay.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Recording};

use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::Shown;
use crate::scenes::Scene;

/// Play a scene and write its replay
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The name of the scene, as `scenes` lists it
    scene: String,
    /// Number of ticks [default: depends on the scene]
    #[arg(long)]
    ticks: Option<u64>,
    /// Seed of the scene's random choices
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let catalogue = context.catalogue();
    let Some(scene) = catalogue.open(&arguments.scene, arguments.seed) else {
        let known = catalogue.scenes().into_iter().map(|scene| scene.name).collect();
        return Err(CommandError::UnknownScene { name: arguments.scene.clone(), known });
    };
    let ticks = arguments.ticks.unwrap_or(scene.ticks);
    let hash = write(scene, ticks, &arguments.output)?;
    let file = Shown(&arguments.output);
    context.console.line(format_args!("{file}: recorded {ticks} ticks, final hash {hash}"))?;
    Ok(Exit::Success)
}

/// Appends to the file as the game runs, so that an interrupted run leaves a valid incomplete replay.
fn write<G: Game>(mut scene: Scene<G>, ticks: u64, path: &Path) -> Result<StateHash, CommandError> {
    let write_error = CommandError::write(path);
    let mut recording = Recording::<G>::start(&scene.setup, CHECKPOINT_INTERVAL)?;
    let mut file = File::create(path).map_err(&write_error)?;
    for tick in 0..ticks {
        let inputs = (scene.script)(tick, recording.game());
        recording.step(&inputs)?;
        file.write_all(&recording.take_bytes()).map_err(&write_error)?;
    }
    let hash = recording.game().state_hash();
    file.write_all(&recording.finish()?).map_err(write_error)?;
    Ok(hash)
}
