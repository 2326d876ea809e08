//! The commands, one file each: `Arguments` describes what one takes, `run` does it.

pub(crate) mod bisect;
pub(crate) mod diff;
pub(crate) mod export;
pub(crate) mod fork;
pub(crate) mod heavy;
pub(crate) mod inspect;
pub(crate) mod record;
pub(crate) mod scenes;
pub(crate) mod seek;
pub(crate) mod stats;
pub(crate) mod trace;
pub(crate) mod trim;
pub(crate) mod verify;

use clap::Subcommand;
use lockstep2d::lockstep::Game;

use crate::console::Console;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::scenes::Catalogue;
use crate::tool::Tool;

/// What every game's tool can do, in the order in which to list it.
#[derive(Debug, Subcommand)]
pub(crate) enum Common {
    Verify(verify::Arguments),
    Diff(diff::Arguments),
    Bisect(bisect::Arguments),
    Trace(trace::Arguments),
    Heavy(heavy::Arguments),
    Inspect(inspect::Arguments),
    Seek(seek::Arguments),
    Fork(fork::Arguments),
    Trim(trim::Arguments),
    Stats(stats::Arguments),
    Export(export::Arguments),
}

impl Common {
    pub(crate) fn run<G: Game>(
        &self,
        tool: &Tool<G>,
        console: &mut Console<'_>,
    ) -> Result<Exit, CommandError> {
        let limits = &tool.limits;
        match self {
            Common::Verify(arguments) => verify::run::<G>(arguments, limits, console),
            Common::Diff(arguments) => diff::run::<G>(arguments, limits, console),
            Common::Bisect(arguments) => bisect::run::<G>(arguments, limits, console),
            Common::Trace(arguments) => trace::run::<G>(arguments, limits, console),
            Common::Heavy(arguments) => heavy::run::<G>(arguments, limits, console),
            Common::Inspect(arguments) => inspect::run::<G>(arguments, limits, console),
            Common::Seek(arguments) => seek::run::<G>(arguments, limits, console),
            Common::Fork(arguments) => fork::run::<G>(arguments, limits, console),
            Common::Trim(arguments) => trim::run::<G>(arguments, limits, console),
            Common::Stats(arguments) => stats::run::<G>(arguments, limits, console),
            Common::Export(arguments) => export::run::<G>(arguments, tool.view, limits, console),
        }
    }
}

/// What the tool of a game with scenes can do besides.
#[derive(Debug, Subcommand)]
pub(crate) enum OfScenes {
    Scenes(scenes::Arguments),
    Record(record::Arguments),
}

impl OfScenes {
    pub(crate) fn run<G: Game>(
        &self,
        catalogue: &dyn Catalogue<G>,
        console: &mut Console<'_>,
    ) -> Result<Exit, CommandError> {
        match self {
            OfScenes::Scenes(scenes::Arguments {}) => scenes::run(catalogue, console),
            OfScenes::Record(arguments) => record::run(arguments, catalogue, console),
        }
    }
}
