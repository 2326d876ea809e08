//! The command `view`: the viewer of the game, which parses its own arguments.

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use lockstep2d::lockstep::Game;
use lockstep2d_viewer::Viewer;

use crate::exit::Exit;

const ARGUMENTS: &str = "arguments";

pub(crate) fn command() -> Command {
    let arguments = Arg::new(ARGUMENTS)
        .help("Files and options of the viewer: see view --help")
        .action(ArgAction::Append)
        .num_args(0..)
        .allow_hyphen_values(true)
        .trailing_var_arg(true)
        .value_parser(value_parser!(OsString));
    Command::new("view")
        .about("Shows a replay, a snapshot or a divergence report in a window")
        .disable_help_flag(true)
        .arg(arguments)
}

/// Runs the viewer. An error of the viewer is [`Exit::Trouble`].
pub(crate) fn run<G: Game + 'static>(viewer: Viewer<G>, matches: &ArgMatches) -> Exit {
    let arguments = matches.get_many::<OsString>(ARGUMENTS).into_iter().flatten().cloned();
    let name = [OsString::from("view")];
    let exit = viewer.name("view").run_with(name.into_iter().chain(arguments));
    if exit == ExitCode::SUCCESS { Exit::Success } else { Exit::Trouble }
}
