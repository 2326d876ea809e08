//! [`Source`]: what can be shown.

mod open;
mod replay;
mod snapshot;

pub use open::{OpenError, open};
pub use replay::Replay;
pub use snapshot::Snapshot;

use std::fmt;
use std::time::Duration;

use lockstep2d::hash::StateHash;
use lockstep2d::world::World;
use lockstep2d_picture::{Camera, DrawList};

use crate::event::Event;
use crate::live::Playground;

/// Something with a world at every tick: a replay, a snapshot, a live game.
///
/// *Tick t* is the state after *t* ticks.
pub trait Source {
    /// What to call it: the name of a file or a scene.
    fn name(&self) -> &str;

    /// The world as of now.
    fn world(&mut self) -> &World;

    /// The hash of the whole state as of now.
    fn hash(&self) -> StateHash;

    /// Where it is.
    fn tick(&self) -> u64;

    /// The first tick that one can go to.
    fn first(&self) -> u64 {
        0
    }

    /// The last tick that one can go to; `None` if it goes on for ever.
    fn ticks(&self) -> Option<u64>;

    /// How many ticks there are so far: what a timeline shows. Of what goes on for ever, those that have been played.
    fn recorded(&self) -> u64 {
        self.ticks().unwrap_or_else(|| self.tick())
    }

    /// Ticks per second.
    fn tick_rate(&self) -> u32;

    /// Goes to a tick.
    ///
    /// # Errors
    /// [`SourceError`] where there is no such tick; then it is at the last one that it could reach.
    fn seek(&mut self, tick: u64) -> Result<(), SourceError>;

    /// What there is to say about it: whether it verifies, scores.
    fn status(&self) -> String {
        String::new()
    }

    /// What one can do in it with a pointer, if it is a live sandbox.
    fn playground(&mut self) -> Option<&mut dyn Playground> {
        None
    }

    /// Takes notice of what a person does, before anybody else does. `true` if it was meant for nobody else: for the keys
    /// of a game's players.
    fn handle(&mut self, _event: &Event) -> bool {
        false
    }

    /// Lets time pass for what goes by its own clock, such as a match over a network. `true` if it does: then nobody
    /// but itself makes it go on, and one cannot pause it.
    ///
    /// # Errors
    /// [`SourceError`] when it cannot go on.
    fn advance(&mut self, _time: Duration) -> Result<bool, SourceError> {
        Ok(false)
    }

    /// Draws on top of the world what belongs to the game: scores, colours of players.
    fn decorate(&mut self, _list: &mut DrawList, _camera: &Camera) {}

    /// A replay file of everything so far, if it is something that is recorded.
    ///
    /// # Errors
    /// [`SourceError`] when there is none to be had.
    fn save_replay(&mut self) -> Option<Result<Vec<u8>, SourceError>> {
        None
    }

    /// Uses a little time to find out more about itself, such as whether a replay verifies. `true` while there is more.
    fn think(&mut self) -> bool {
        false
    }
}

/// Why a tick cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceError(
    /// For people.
    pub String,
);

impl SourceError {
    /// The same as another error says.
    pub(crate) fn of(error: impl fmt::Display) -> Self {
        SourceError(error.to_string())
    }
}

impl fmt::Display for SourceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for SourceError {}
