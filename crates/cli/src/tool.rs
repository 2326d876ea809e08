//! [`Tool`]: the commands of a game, and their dispatch.

use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;

use clap::{ArgMatches, Command};
use lockstep2d::draw::View;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;

use crate::commands::{Row, table, verify};
use crate::console::Console;
use crate::context::{CommandResult, Context};
use crate::exit::Exit;
use crate::scenes::Catalogue;
#[cfg(feature = "view")]
use crate::view;

/// The command-line tools of a game.
///
/// ```
/// use lockstep2d::lockstep::Sandbox;
/// use lockstep2d_cli::{Exit, Tool, clap::Command};
/// // Adds a command to those that every game has.
/// let credits = Command::new("credits").about("Names everybody");
/// let tool = Tool::<Sandbox>::new().with_command(credits, |_| {
///     println!("thanks to everybody");
///     Exit::Success
/// });
/// // `tool.run()` takes the arguments of the process.
/// let (mut out, mut err) = (vec![], vec![]);
/// assert_eq!(tool.run_with(["game", "credits"], &mut out, &mut err), Exit::Success);
/// tool.run_with(["game", "--help"], &mut out, &mut err);
/// let help = String::from_utf8_lossy(&out);
/// assert!(["credits", "verify", "bisect"].iter().all(|command| help.contains(command)), "{help}");
/// ```
pub struct Tool<G: Game> {
    pub(crate) limits: Limits,
    pub(crate) catalogue: Option<Box<dyn Catalogue<G>>>,
    pub(crate) view: Option<fn(&G) -> View>,
    /// Commands added by [`Tool::with_command`] and `Tool::with_viewer`.
    own: Vec<(Command, OwnCommand)>,
}

type OwnCommand = Box<dyn Fn(&ArgMatches) -> Exit>;

impl<G: Game> Default for Tool<G> {
    fn default() -> Self {
        Self::new()
    }
}

impl<G: Game> Tool<G> {
    /// Creates the tools with the commands that every game has: `verify`, `diff`, `bisect`, `trace`, `stress-saves`,
    /// `inspect`, `seek`, `fork`, `trim`, `stats`, `export`, `keygen` and `sign`.
    #[must_use]
    pub fn new() -> Self {
        Tool { limits: Limits::default(), catalogue: None, view: None, own: Vec::new() }
    }

    /// Sets the limits for replays.
    #[must_use]
    pub fn with_limits(self, limits: Limits) -> Self {
        Tool { limits, ..self }
    }

    /// Adds the commands `scenes` and `record`.
    #[must_use]
    pub fn with_scenes(self, catalogue: impl Catalogue<G> + 'static) -> Self {
        Tool { catalogue: Some(Box::new(catalogue)), ..self }
    }

    /// Sets the default view in which `export` shows the game's world ([`Game::world`]), instead of [`View::default`].
    /// Animations use only the aspect ratio of the view's size. Arguments of the command override the window, the
    /// layers and the size of the view.
    #[must_use]
    pub fn with_view(self, view: fn(&G) -> View) -> Self {
        Tool { view: Some(view), ..self }
    }

    /// Adds a command of the game. The command prints its output itself.
    #[must_use]
    pub fn with_command(mut self, command: Command, run: fn(&ArgMatches) -> Exit) -> Self {
        self.own.push((command, Box::new(run)));
        self
    }

    /// Adds the command `view`, which opens the viewer of the game. Its arguments are those of
    /// [`Viewer::run`](lockstep2d_viewer::Viewer::run). `viewer` is called when the command runs. Call
    /// [`Tool::with_limits`] before this function, so that the limits also apply to the viewer.
    ///
    /// ```no_run
    /// use lockstep2d::lockstep::Sandbox;
    /// use lockstep2d_cli::{Tool, lockstep2d_viewer::Viewer};
    /// Tool::<Sandbox>::new().with_viewer(Viewer::new).run();
    /// ```
    #[cfg(feature = "view")]
    #[must_use]
    pub fn with_viewer(mut self, viewer: fn() -> lockstep2d_viewer::Viewer<G>) -> Self
    where
        G: 'static,
    {
        let limits = self.limits.clone();
        let run = move |matches: &ArgMatches| view::run(viewer().limits(limits.clone()), matches);
        self.own.push((view::command(), Box::new(run)));
        self
    }

    /// Runs the command that the arguments of this process select, with colours on terminals.
    #[must_use]
    pub fn run(&self) -> ExitCode {
        // The streams are not locked here: a game that prints or panics on another thread would then wait for the lock
        // forever.
        let (mut out, mut err) = (anstream::stdout(), anstream::stderr());
        let is_terminal = std::io::stderr().is_terminal();
        let console =
            Console { out: &mut out, err: &mut err, is_out_taken: false, is_terminal, owns_process: true };
        self.run_on(std::env::args_os(), console).into()
    }

    /// Runs the command that `arguments` select. The first argument is the program's name. Results go to `out`,
    /// messages to `err`, both with ANSI colours.
    pub fn run_with<A>(
        &self,
        arguments: impl IntoIterator<Item = A>,
        out: &mut dyn Write,
        err: &mut dyn Write,
    ) -> Exit
    where
        A: Into<OsString> + Clone,
    {
        self.run_on(
            arguments,
            Console { out, err, is_out_taken: false, is_terminal: false, owns_process: false },
        )
    }

    fn run_on<'a, A>(&'a self, arguments: impl IntoIterator<Item = A>, mut console: Console<'a>) -> Exit
    where
        A: Into<OsString> + Clone,
    {
        let table = table(self.catalogue.is_some());
        let matches = match self.command(&table).try_get_matches_from(arguments) {
            Ok(matches) => matches,
            Err(usage) => return explain(&usage, &mut console),
        };
        let mut context = Context { tool: self, console };
        match self.dispatch(&matches, &table, &mut context) {
            Ok(exit) => exit,
            Err(error) => {
                if !error.is_reader_gone() {
                    context.console.error(&error);
                }
                error.exit()
            }
        }
    }

    fn command(&self, table: &[Row<G>]) -> Command {
        let rules = G::RULES;
        let (engine, semantics) = (lockstep2d::VERSION, lockstep2d::SEMANTICS);
        Command::new(rules.name)
            .about(format!("Tools for the replays of {}", rules.name))
            .version(format!("rules version {}, engine {engine}, semantics {semantics}", rules.version))
            .subcommand_required(true)
            .arg_required_else_help(true)
            .subcommands(table.iter().map(|row| &row.command))
            .mut_subcommand("verify", |verify| verify::with_defaults(verify, &self.limits))
            .subcommands(self.own.iter().map(|(own, _)| own))
    }

    fn dispatch(
        &self,
        matches: &ArgMatches,
        table: &[Row<G>],
        context: &mut Context<'_, G>,
    ) -> CommandResult {
        let Some((name, of_command)) = matches.subcommand() else { return Ok(Exit::Trouble) };
        if let Some((_, run)) = self.own.iter().find(|(own, _)| own.get_name() == name) {
            return Ok(run(of_command));
        }
        let row = table.iter().find(|row| row.command.get_name() == name);
        (row.expect("clap matched a command of the table").run)(of_command, context)
    }
}

/// Prints the requested help or version, or the error in the arguments.
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
