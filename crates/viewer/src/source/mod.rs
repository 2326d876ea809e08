//! [`Source`]: the interface of everything that the viewer can show.

mod open;
mod replay;
mod snapshot;

pub use open::OpenError;
pub use replay::Replay;
pub use snapshot::Snapshot;

use std::fmt;
use std::time::Duration;

use lockstep2d::hash::StateHash;
use lockstep2d::replay::Verdict;
use lockstep2d::world::World;
use lockstep2d_render::{Camera, DrawList};

use crate::event::{Event, Key};
use crate::live::Playground;

/// A sequence of worlds, one per tick: a replay, a snapshot or a live game. *Tick t* is the state after *t* ticks.
///
/// ```
/// use lockstep2d::{hash::StateHash, world::World};
/// use lockstep2d_viewer::{App, Source, SourceError};
///
/// /// A world that stands still.
/// struct Still(World);
///
/// impl Source for Still {
///     fn name(&self) -> &str { "still" }
///     fn world(&mut self) -> &World { &self.0 }
///     fn hash(&self) -> StateHash { self.0.state_hash() }
///     fn tick(&self) -> u64 { 0 }
///     fn ticks(&self) -> Option<u64> { Some(0) }
///     fn tick_rate(&self) -> u32 { 60 }
///     fn seek(&mut self, tick: u64) -> Result<(), SourceError> {
///         if tick == 0 { Ok(()) } else { Err(SourceError(format!("there is no tick {tick}"))) }
///     }
/// }
///
/// let mut app = App::default();
/// app.show(Box::new(Still(World::default())));
/// assert_eq!(app.report().name, "still");
/// ```
pub trait Source {
    /// Name of the file or the scene, for display.
    fn name(&self) -> &str;

    /// World at the current tick.
    fn world(&mut self) -> &World;

    /// Hash of the whole state at the current tick.
    fn hash(&self) -> StateHash;

    /// The current tick.
    fn tick(&self) -> u64;

    /// The first tick of the source.
    fn first(&self) -> u64 {
        0
    }

    /// The last tick of the source; `None` if the source has no end.
    fn ticks(&self) -> Option<u64>;

    /// Last tick on the timeline. For a source without an end, this is the last tick played so far.
    fn recorded(&self) -> u64 {
        self.ticks().unwrap_or_else(|| self.tick())
    }

    /// Ticks per second.
    fn tick_rate(&self) -> u32;

    /// Seeks to a tick.
    ///
    /// # Errors
    /// [`SourceError`] if the tick cannot be reached.
    fn seek(&mut self, tick: u64) -> Result<(), SourceError>;

    /// Status line, such as the verdict of a replay or the scores of a match; may be empty.
    fn status(&self) -> String {
        String::new()
    }

    /// Verdict of a replay, which determines the colour of the status line. `None` until the replay has been verified,
    /// and for other sources.
    fn verdict(&self) -> Option<&Verdict> {
        None
    }

    /// Interface for user actions, if the source is a live sandbox.
    fn playground(&mut self) -> Option<&mut dyn Playground> {
        None
    }

    /// Handles an input event before the viewer does. Returns `true` if the source consumed it.
    fn handle(&mut self, _event: &Event) -> bool {
        false
    }

    /// Keys that [`Source::handle`] consumes.
    fn keys(&self) -> Vec<Key> {
        Vec::new()
    }

    /// Advances a source that has its own clock, such as a network match, and returns `true`. The viewer can neither
    /// play nor pause such a source. Other sources return `false`.
    ///
    /// # Errors
    /// [`SourceError`] if the source cannot continue.
    fn advance(&mut self, _time: Duration) -> Result<bool, SourceError> {
        Ok(false)
    }

    /// Draws the game's own graphics over the world.
    fn decorate(&mut self, _list: &mut DrawList, _camera: &Camera) {}

    /// Returns a replay of the ticks recorded so far; `None` if the source is not recorded.
    ///
    /// # Errors
    /// [`SourceError`] if no replay can be made.
    fn save_replay(&mut self) -> Option<Result<Vec<u8>, SourceError>> {
        None
    }

    /// Closes the source before it is replaced or the program ends. For example, a network match is left here. Closing
    /// should take at most a second.
    fn close(&mut self) {}

    /// Names and values of the fields of the game's own state, without those of the world.
    fn state(&self) -> Vec<(String, String)> {
        Vec::new()
    }

    /// Does some background work, such as verifying a replay. Returns `true` while work remains.
    fn think(&mut self) -> bool {
        false
    }
}

/// Error of a source, as a message for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceError(
    /// The message.
    pub String,
);

impl SourceError {
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
