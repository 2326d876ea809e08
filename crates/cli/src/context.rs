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

pub(crate) type CommandResult = Result<Exit, CommandError>;

pub(crate) struct Context<'a, G: Game> {
    pub(crate) tool: &'a Tool<G>,
    pub(crate) console: Console<'a>,
}

impl<'a, G: Game> Context<'a, G> {
    pub(crate) fn limits(&self) -> &'a Limits {
        &self.tool.limits
    }

    /// Reads a file with the size limit for replays: see [`files::read`].
    pub(crate) fn load(&self, path: &Path) -> Result<Vec<u8>, CommandError> {
        files::read(path, self.limits().file_bytes).map_err(CommandError::read(path))
    }

    /// The scenes of the game. Panics if there are none, but the tool then has no command that calls this function.
    pub(crate) fn catalogue(&self) -> &'a dyn Catalogue<G> {
        self.tool.catalogue.as_deref().expect("the command is listed only where there are scenes")
    }
}
