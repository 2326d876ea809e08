//! [`Context`]: what every command is given besides its arguments.

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
    /// Limits of what a replay may cost.
    pub(crate) fn limits(&self) -> &'a Limits {
        &self.tool.limits
    }

    /// Reads a file that the command cannot do without, as far as the limits allow: see [`files::read`].
    ///
    /// # Errors
    /// [`CommandError::Read`] when it cannot be read.
    pub(crate) fn load(&self, path: &Path) -> Result<Vec<u8>, CommandError> {
        files::read(path, self.limits().file_bytes).map_err(CommandError::read(path))
    }

    /// The scenes of the game.
    ///
    /// # Panics
    /// In a command that the table lists for games without scenes, too.
    pub(crate) fn catalogue(&self) -> &'a dyn Catalogue<G> {
        self.tool.catalogue.as_deref().expect("the command is listed only where there are scenes")
    }
}
