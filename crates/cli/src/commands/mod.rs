//! The commands of a tool, except `view`. Each is a module: `Arguments` declares the arguments, and `run` executes the
//! command. [`table`] lists them.

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
use crate::panics;

/// A command: its clap definition, and the function that executes it.
pub(crate) struct Row<G: Game> {
    pub(crate) command: Command,
    pub(crate) run: fn(&ArgMatches, &mut Context<'_, G>) -> CommandResult,
}

/// Creates a [`Row`] for each `"name" => module`. If `(argument)` follows the module, a panic of the game becomes an
/// error that names the file in this argument, unless the module says that it plays other files.
macro_rules! rows {
    ($($name:literal => $module:ident $(($file:ident))?),+ $(,)?) => {
        vec![$(Row {
            command: $module::Arguments::augment_args(Command::new($name)),
            run: |matches, context| {
                let arguments: $module::Arguments = arguments(matches);
                let mut run = || $module::run(&arguments, context);
                $(let mut run = || panics::guard(&arguments.$file, &mut run);)?
                run()
            },
        }),+]
    };
}

/// The commands, in the order of the help.
pub(crate) fn table<G: Game>(has_scenes: bool) -> Vec<Row<G>> {
    let mut table = rows![
        "verify" => verify,
        "diff" => diff(a),
        "bisect" => bisect(a),
        "trace" => trace(file),
        "stress-saves" => stress_saves(file),
        "inspect" => inspect(file),
        "seek" => seek(file),
        "fork" => fork(file),
        "trim" => trim(file),
        "stats" => stats(file),
        "export" => export(file),
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
