//! [`Game`]: rules that advance in ticks from encoded inputs.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use serde::{Serialize, de::DeserializeOwned};

use crate::hash::StateHash;
use crate::world::World;

/// Which rules a replay was made with. Bump `version` whenever the same inputs give another state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RulesId {
    /// A short name, at most 64 bytes.
    pub name: &'static str,
    /// The version of the rules.
    pub version: u32,
}

/// A setup from which no game can start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetupError {
    /// What is wrong with it.
    pub why: String,
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the setup cannot start a game: {}", self.why)
    }
}

impl core::error::Error for SetupError {}

/// A deterministic game: the same setup and the same inputs give the same state hash after every tick.
///
/// Recording, verification, rollback and the command-line tools are generic over this trait.
pub trait Game: Sized {
    /// Everything that the first tick depends on: level, seed, options.
    type Setup: Serialize + DeserializeOwned;
    /// What one player contributes to one tick. `Default` is "nothing pressed".
    type Input: Clone + Default + PartialEq + Serialize + DeserializeOwned;
    /// A copy of the state that [`Game::load`] returns to: all of it, so that it can be sent to someone who was not
    /// there, and compared with another machine's. In a format for people its names are those of a report.
    type Save: Clone + Serialize + DeserializeOwned;

    /// The name and version of the rules.
    const RULES: RulesId;

    /// The game before its first tick.
    ///
    /// # Errors
    /// [`SetupError`] when the setup, which may come from a stranger's file, is not playable.
    fn new(setup: &Self::Setup) -> Result<Self, SetupError>;

    /// Number of players; constant over a game, at most 64.
    fn players(&self) -> u32;

    /// Ticks per second; constant over a game.
    fn tick_rate(&self) -> u32;

    /// Advances one tick. `inputs` has one entry for each player, in player order.
    ///
    /// Inputs may come from a stranger's file: an impossible one must be ignored, not panic.
    fn step(&mut self, inputs: &[Self::Input]);

    /// The hash of everything that influences the future.
    fn state_hash(&self) -> StateHash;

    /// A copy of the state.
    fn save(&self) -> Self::Save;

    /// Returns to a saved state.
    fn load(&mut self, save: &Self::Save);

    /// An upper bound of the cost of the next tick in work units, so that a verifier can limit what a stranger's
    /// file makes it compute. The sandbox counts bodies, contacts and joints, times sub-steps.
    fn work(&self, inputs: &[Self::Input]) -> u64;

    /// What a seat contributes in every tick in which nobody sits on it: before its player has come, and after they
    /// have left. "Nothing pressed", unless the game wants to know: then an input that no player can send.
    ///
    /// It is an input like any other. It stands in the replay, and so everybody agrees on when a player left.
    #[must_use]
    fn absent() -> Self::Input {
        Self::Input::default()
    }

    /// The physics world, if there is one, for tools that look into it. They change it only in games of their own.
    fn world_mut(&mut self) -> Option<&mut World> {
        None
    }

    /// What the game reports of itself at the end of a replay, such as a score or a time: at most 256 values with
    /// different names of 1 to 64 bytes.
    ///
    /// A replay states them where they are read without playing it; a verifier compares them with its own.
    fn claims(&self) -> Vec<(String, i64)> {
        Vec::new()
    }
}
