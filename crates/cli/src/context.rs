//! [`Context`]: the tool and the console, which every command receives besides its arguments.

use std::path::Path;

use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;

use crate::console::Console;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files;
use crate::scenes::Catalogue;
use crate::tool::Tool;

/// Exit status of a command, or the error that stopped it.
pub(crate) type CommandResult = Result<Exit, CommandError>;

/// Context of every command, besides its arguments: the tool of the game, and the console to write to.
pub(crate) struct Context<'a, G: Game> {
    pub(crate) tool: &'a Tool<G>,
    pub(crate) console: Console<'a>,
}

impl<'a, G: Game> Context<'a, G> {
    /// The limits for replays.
    pub(crate) fn limits(&self) -> &'a Limits {
        &self.tool.limits
    }

    /// Reads a file that the command requires, with the size limit for replays: see [`files::read`].
    ///
    /// # Errors
    /// [`CommandError::Read`] when the file cannot be read.
    pub(crate) fn load(&self, path: &Path) -> Result<Vec<u8>, CommandError> {
        files::read(path, self.limits().file_bytes).map_err(CommandError::read(path))
    }

    /// The scenes of the game.
    ///
    /// # Panics
    /// If the game has no scenes. Only commands that the table omits for such games may call this.
    pub(crate) fn catalogue(&self) -> &'a dyn Catalogue<G> {
        self.tool.catalogue.as_deref().expect("the command is listed only where there are scenes")
    }
}
