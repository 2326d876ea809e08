use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use serde::{Serialize, de::DeserializeOwned};

use crate::hash::StateHash;
use crate::world::World;

/// Identifies the rules of a replay. Increment `version` with each change of the rules that may change the states of
/// existing replays.
///
/// ```
/// use lockstep2d::lockstep::RulesId;
/// /// Version 2: a goal counts double in the last minute.
/// const RULES: RulesId = RulesId { name: "pucks", version: 2 };
/// // Replays of version 1 are refused instead of ending in another score.
/// assert_ne!(RULES, RulesId { version: 1, ..RULES });
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RulesId {
    /// A short name of 1 to 64 bytes.
    pub name: &'static str,
    /// The version of the rules.
    pub version: u32,
}

/// Reason why a game does not start.
///
/// ```
/// use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup, StartError};
/// # use lockstep2d::{body::BodyDef, world::Command};
/// let spawn = Command::Spawn { body: BodyDef::dynamic(), shapes: vec![] };
/// let setup = SandboxSetup { commands: vec![spawn; 1000], ..SandboxSetup::default() };
/// // A server that starts the level of an unknown user sets a limit.
/// assert!(matches!(Sandbox::new_within(&setup, 10), Err(StartError::TooMuchWork { max: 10, .. })));
/// assert!(Sandbox::new_within(&setup, 1_000_000_000).is_ok());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StartError {
    /// The setup is not playable.
    Refused(SetupError),
    /// The setup takes more work than the budget.
    TooMuchWork {
        /// Work units of the setup, or a lower bound of them.
        work: u64,
        /// The budget in work units.
        max: u64,
    },
}

impl fmt::Display for StartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StartError::Refused(error) => error.fmt(f),
            StartError::TooMuchWork { work, max } => {
                write!(f, "the setup takes {work} work units, at most {max} are allowed")
            }
        }
    }
}

impl core::error::Error for StartError {}

/// Error: a setup cannot start a game.
///
/// ```
/// use lockstep2d::lockstep::SetupError;
/// /// Checks the number of players, two to four, in a setup from an untrusted file.
/// fn checked(players: u32) -> Result<u32, SetupError> {
///     let is_valid = (2..=4).contains(&players);
///     is_valid.then_some(players).ok_or_else(|| SetupError { why: format!("{players} players") })
/// }
/// assert_eq!(checked(9).map_err(|error| error.why), Err("9 players".into()));
/// assert_eq!(checked(4), Ok(4));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetupError {
    /// Reason of the refusal.
    pub why: String,
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the setup cannot start a game: {}", self.why)
    }
}

impl core::error::Error for SetupError {}

/// A deterministic game: equal setups and inputs give equal state hashes after every tick.
///
/// Recording, verification, rollback and the tools are generic over this trait.
///
/// ```
/// # use lockstep2d::{body::*, fx, hash::StateHash, math::*, world::*};
/// use lockstep2d::lockstep::{Game, RulesId, SetupError};
///
/// /// One player lifts a ball.
/// struct Lift {
///     world: World,
///     ball: BodyId,
/// }
///
/// impl Game for Lift {
///     type Setup = ();
///     type Input = bool;
///     type Save = Snapshot;
///     const RULES: RulesId = RulesId { name: "lift", version: 1 };
///
///     fn new(_: &()) -> Result<Self, SetupError> {
///         let build = || {
///             let mut world = World::default();
///             let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?);
///             let ball = world.spawn(&BodyDef::dynamic(), &[ball])?;
///             Ok(Lift { world, ball })
///         };
///         build().map_err(|error: WorldError| SetupError { why: error.to_string() })
///     }
///     fn players(&self) -> u32 { 1 }
///     fn tick_rate(&self) -> u32 { 60 }
///     fn step(&mut self, inputs: &[bool]) {
///         if inputs.first() == Some(&true) {
///             let _ = self.world.apply_force_to_centre(self.ball, Vec2::new(fx!(0), fx!(20)));
///         }
///         self.world.step();
///     }
///     fn state_hash(&self) -> StateHash { self.world.state_hash() }
///     fn save(&self) -> Snapshot { self.world.save() }
///     fn load(&mut self, save: &Snapshot) { self.world.restore(save); }
///     fn work(&self, _: &[bool]) -> u64 { self.world.work(0, 0) }
///     fn world(&self) -> Option<&World> { Some(&self.world) }
///     fn world_mut(&mut self) -> Option<&mut World> { Some(&mut self.world) }
/// }
///
/// // With this implementation, the game can be recorded, verified, played in matches, and checked for determinism.
/// use lockstep2d::check::{CheckOptions, check, random_inputs};
/// let inputs = random_inputs::<Lift>(1, 30, &mut Rng::new(1));
/// check::<Lift>(&(), &inputs, &CheckOptions::default())?;
/// # Ok::<(), lockstep2d::check::CheckError>(())
/// ```
pub trait Game: Sized {
    /// Everything that the first tick depends on: level, seed, options.
    type Setup: Serialize + DeserializeOwned;
    /// Input of one player for one tick. `Default` is "nothing pressed".
    type Input: Clone + Default + PartialEq + Serialize + DeserializeOwned;
    /// Complete copy of the state. Saves are sent to late joiners and compared between machines. Reports show the field
    /// names of the save's human-readable serialization.
    type Save: Clone + Serialize + DeserializeOwned;

    /// The name and version of the rules.
    const RULES: RulesId;

    /// Creates the game before its first tick.
    ///
    /// # Errors
    /// [`SetupError`] if the setup is not playable. A setup may come from an untrusted file.
    fn new(setup: &Self::Setup) -> Result<Self, SetupError>;

    /// Creates the game within a budget of `work_max` work units, and returns the units used. The default calls
    /// [`Game::new`] and counts nothing. Override it if an untrusted setup can be expensive.
    ///
    /// # Errors
    /// [`StartError`] if the setup is not playable or takes more work.
    fn new_within(setup: &Self::Setup, work_max: u64) -> Result<(Self, u64), StartError> {
        let _ = work_max;
        Self::new(setup).map(|game| (game, 0)).map_err(StartError::Refused)
    }

    /// Number of players, constant and at most 64.
    fn players(&self) -> u32;

    /// Ticks per second, constant. A game that steps its world once per tick returns the world's
    /// [`Config::tick_rate`](crate::world::Config::tick_rate). [`check`](crate::check) does not detect a wrong rate.
    fn tick_rate(&self) -> u32;

    /// Advances one tick, with one input for each player, in player order.
    ///
    /// Inputs may come from an untrusted file: ignore impossible ones, without panic.
    fn step(&mut self, inputs: &[Self::Input]);

    /// Hash of all state that influences future ticks.
    fn state_hash(&self) -> StateHash;

    /// Copies the state.
    fn save(&self) -> Self::Save;

    /// Restores a saved state.
    fn load(&mut self, save: &Self::Save);

    /// An upper bound of the work units of the next tick, without the work that the world counts during the step. A
    /// verifier uses the bound to limit the computing time of an untrusted file. For a world, use [`World::work`].
    fn work(&self, inputs: &[Self::Input]) -> u64;

    /// Input of a seat without a player: before a player has joined, and after the player has left. To distinguish
    /// absence from idleness, return an input that no player can send. Replays record it like any other input.
    #[must_use]
    fn absent() -> Self::Input {
        Self::Input::default()
    }

    /// The physics world, if there is one, for drawing and other readers. Implement [`Game::world_mut`] as well.
    fn world(&self) -> Option<&World> {
        None
    }

    /// The physics world, for tools that count work, compare phases, or change settings that must not affect the
    /// result. Without it, [`check`](crate::check) leaves out such settings, and a verifier bounds the work by
    /// [`Game::work`] alone.
    fn world_mut(&mut self) -> Option<&mut World> {
        None
    }

    /// Results at the end of a replay, such as a score: at most 256 values with different names of 1 to 64 bytes. A
    /// verifier compares the values in the replay with its own.
    fn claims(&self) -> Vec<(String, i64)> {
        Vec::new()
    }
}

/// The world of a game, for reading.
pub(crate) fn world_of<G: Game>(game: &mut G) -> Option<&World> {
    // Some games implement `world_mut` alone.
    if game.world().is_some() { game.world() } else { game.world_mut().map(|world| &*world) }
}
