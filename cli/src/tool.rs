//! [`Tool`]: the commands that a game has, and which of them was asked for.

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::{ArgMatches, Command};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;

use crate::commands::{diff, export, heavy, record, scenes, verify};
use crate::console::Console;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::scenes::Catalogue;

/// The command-line tools of a game.
///
/// ```text
/// Tool::<MyGame>::new().with_scenes(MyScenes).with_svg(draw_my_game).run()
/// ```
pub struct Tool<G: Game> {
    pub(crate) limits: Limits,
    pub(crate) catalogue: Option<Box<dyn Catalogue<G>>>,
    pub(crate) svg: Option<fn(&G) -> String>,
    /// Commands of the game's own.
    own: Vec<(Command, OwnCommand)>,
}

/// Does what a command of a game's own is asked to.
type OwnCommand = fn(&ArgMatches) -> Exit;

impl<G: Game> Default for Tool<G> {
    fn default() -> Self {
        Self::new()
    }
}

impl<G: Game> Tool<G> {
    /// The tools that every game has: `verify`, `diff` and `heavy`.
    #[must_use]
    pub fn new() -> Self {
        Tool { limits: Limits::default(), catalogue: None, svg: None, own: Vec::new() }
    }

    /// Sets how much a replay may cost.
    #[must_use]
    pub fn with_limits(self, limits: Limits) -> Self {
        Tool { limits, ..self }
    }

    /// Adds `scenes` and `record`.
    #[must_use]
    pub fn with_scenes(self, catalogue: impl Catalogue<G> + 'static) -> Self {
        Tool { catalogue: Some(Box::new(catalogue)), ..self }
    }

    /// Adds `export`; `svg` draws a game as one SVG document.
    #[must_use]
    pub fn with_svg(self, svg: fn(&G) -> String) -> Self {
        Tool { svg: Some(svg), ..self }
    }

    /// Adds a command of the game's own; `run` does what its arguments say, and prints for itself.
    #[must_use]
    pub fn with_command(mut self, command: Command, run: fn(&ArgMatches) -> Exit) -> Self {
        self.own.push((command, run));
        self
    }

    /// Does what the arguments of this process say, with colours where a terminal shows them.
    #[must_use]
    pub fn run(&self) -> ExitCode {
        let (mut out, mut err) = (anstream::stdout().lock(), anstream::stderr().lock());
        self.run_with(std::env::args_os(), &mut out, &mut err).into()
    }

    /// Does what `arguments` say, the first of which is the program's name. Results go to `out`, messages to
    /// `err`, both with ANSI colours.
    pub fn run_with<A>(
        &self,
        arguments: impl IntoIterator<Item = A>,
        out: &mut dyn Write,
        err: &mut dyn Write,
    ) -> Exit
    where
        A: Into<OsString> + Clone,
    {
        let mut console = Console { out, err };
        let matches = match self.command().try_get_matches_from(arguments) {
            Ok(matches) => matches,
            Err(usage) => return explain(&usage, &mut console),
        };
        match self.dispatch(&matches, &mut console) {
            Ok(exit) => exit,
            Err(error) => {
                if !error.is_reader_gone() {
                    console.error(&error);
                }
                error.exit()
            }
        }
    }

    fn command(&self) -> Command {
        let rules = G::RULES;
        let engine = lockstep2d::SEMANTICS;
        let mut command = Command::new(rules.name)
            .about(format!("Tools for the replays of {}", rules.name))
            .version(format!("rules version {}, engine semantics {engine}", rules.version))
            .subcommand_required(true)
            .arg_required_else_help(true)
            .subcommand(verify::command())
            .subcommand(diff::command())
            .subcommand(heavy::command());
        if self.catalogue.is_some() {
            command = command.subcommand(scenes::command()).subcommand(record::command());
        }
        if self.svg.is_some() {
            command = command.subcommand(export::command());
        }
        command.subcommands(self.own.iter().map(|(own, _)| own.clone()))
    }

    fn dispatch(&self, matches: &ArgMatches, console: &mut Console<'_>) -> Result<Exit, CommandError> {
        match (matches.subcommand(), &self.catalogue, self.svg) {
            (Some((verify::NAME, matches)), _, _) => {
                verify::run::<G>(&verify::arguments(matches), &self.limits, console)
            }
            (Some((diff::NAME, matches)), _, _) => {
                diff::run::<G>(&diff::arguments(matches), &self.limits, console)
            }
            (Some((heavy::NAME, matches)), _, _) => {
                heavy::run::<G>(&heavy::arguments(matches), &self.limits, console)
            }
            (Some((scenes::NAME, _)), Some(catalogue), _) => scenes::run(catalogue.as_ref(), console),
            (Some((record::NAME, matches)), Some(catalogue), _) => {
                record::run(&record::arguments(matches), catalogue.as_ref(), console)
            }
            (Some((export::NAME, matches)), _, Some(svg)) => {
                export::run(&export::arguments(matches), svg, &self.limits, console)
            }
            (Some((name, matches)), _, _) => {
                let own = self.own.iter().find(|(own, _)| own.get_name() == name);
                // clap has refused every other command.
                Ok(own.map_or(Exit::Trouble, |(_, run)| run(matches)))
            }
            (None, _, _) => Ok(Exit::Trouble),
        }
    }
}

/// Shows the help that was asked for, or says what is wrong with the arguments.
fn explain(usage: &clap::Error, console: &mut Console<'_>) -> Exit {
    let text = usage.render();
    if usage.use_stderr() {
        console.note(text.ansi().to_string().trim_end());
        Exit::Trouble
    } else {
        let written = write!(console.out, "{}", text.ansi());
        if written.is_ok() { Exit::Success } else { Exit::Trouble }
    }
}
