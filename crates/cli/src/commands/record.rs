//! `record`: plays a scene and writes its replay.

use std::path::PathBuf;

use clap::Args;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Recording};

use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::Shown;
use crate::output_file::{OutputFile, Overwrite};
use crate::scenes::Scene;

/// Play a scene and write its replay
#[derive(Args, Debug)]
#[command(
    after_help = "Exit code: 0 when it was written, 2 for wrong usage, or a file that cannot be written."
)]
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
    #[command(flatten)]
    overwrite: Overwrite,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let catalogue = context.catalogue();
    let Some(scene) = catalogue.open(&arguments.scene, arguments.seed) else {
        let known = catalogue.scenes().into_iter().map(|scene| scene.name).collect();
        return Err(CommandError::UnknownScene { name: arguments.scene.clone(), known });
    };
    let ticks = arguments.ticks.unwrap_or(scene.ticks);
    let recording = Recording::<G>::start(&scene.setup, CHECKPOINT_INTERVAL)?;
    let mut output = OutputFile::create(&arguments.output, arguments.overwrite, &[])?;
    let hash = write(recording, scene, ticks, &mut output)?;
    output.publish(&mut context.console)?;
    let file = Shown(&arguments.output);
    context.console.line(format_args!("{file}: recorded {ticks} ticks, final hash {hash}"))?;
    Ok(Exit::Success)
}

/// Appends to the file while the game runs. If the process is killed, the temporary file is a valid incomplete replay.
fn write<G: Game>(
    mut recording: Recording<G>,
    mut scene: Scene<G>,
    ticks: u64,
    output: &mut OutputFile,
) -> Result<StateHash, CommandError> {
    for tick in 0..ticks {
        let inputs = (scene.script)(tick, recording.game());
        recording.step(&inputs)?;
        output.append(&recording.take_bytes())?;
    }
    let hash = recording.game().state_hash();
    output.append(&recording.finish()?)?;
    Ok(hash)
}
