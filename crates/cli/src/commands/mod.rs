//! The commands that a tool has without the viewer, one module each. In each module, `Arguments` declares the arguments
//! of the command and `run` executes it. [`table`] has a row for each command.

mod bisect;
mod diff;
mod export;
mod fork;
mod inspect;
mod keygen;
mod record;
mod scenes;
mod seek;
pub(crate) mod sign;
mod stats;
mod stress_saves;
mod trace;
mod trim;
pub(crate) mod verify;

use clap::{ArgMatches, Args, Command};
use lockstep2d::lockstep::Game;

use crate::context::{CommandResult, Context};

/// A command: its clap definition (name, help and arguments), and the function that executes it.
pub(crate) struct Row<G: Game> {
    pub(crate) command: Command,
    pub(crate) run: fn(&ArgMatches, &mut Context<'_, G>) -> CommandResult,
}

/// The rows of commands, each given as its name and its module.
macro_rules! rows {
    ($($name:literal => $module:ident),+ $(,)?) => {
        vec![$(Row {
            command: $module::Arguments::augment_args(Command::new($name)),
            run: |matches, context| $module::run(&arguments(matches), context),
        }),+]
    };
}

/// The commands of this module, in the order in which the help lists them.
pub(crate) fn table<G: Game>(has_scenes: bool) -> Vec<Row<G>> {
    let mut table = rows![
        "verify" => verify,
        "diff" => diff,
        "bisect" => bisect,
        "trace" => trace,
        "stress-saves" => stress_saves,
        "inspect" => inspect,
        "seek" => seek,
        "fork" => fork,
        "trim" => trim,
        "stats" => stats,
        "export" => export,
        "keygen" => keygen,
        "sign" => sign,
    ];
    if has_scenes {
        table.extend(rows![
            "scenes" => scenes,
            "record" => record,
        ]);
    }
    table
}

fn arguments<A: Args>(matches: &ArgMatches) -> A {
    A::from_arg_matches(matches).expect("clap matched what this type describes")
}
