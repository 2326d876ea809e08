//! [`Observed`]: a game that keeps a log of its steps.

use std::sync::{Mutex, MutexGuard, PoisonError};

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError, StartError};
use lockstep2d::world::World;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::step_log::{Stamp, StepLog};

/// A game, and a log of its steps. Rules, inputs, saves and hashes are those of `G`, so peers without Bevy can join its
/// matches and verify its replays.
pub struct Observed<G> {
    game: G,
    log: Mutex<StepLog>,
}

/// A save of an [`Observed`] game. Its encoding is that of the save of `G`.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent, bound = "S: Serialize + DeserializeOwned")]
pub struct ObservedSave<S> {
    save: S,
    #[serde(skip)]
    stamp: Option<Stamp>,
}

impl<G: Game> Observed<G> {
    fn from_start(game: G) -> Self {
        let log = Mutex::new(StepLog::new(game.world()));
        Observed { game, log }
    }

    /// The game.
    pub const fn game(&self) -> &G {
        &self.game
    }

    pub(crate) fn log(&self) -> MutexGuard<'_, StepLog> {
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn log_mut(&mut self) -> (&G, &mut StepLog) {
        (&self.game, self.log.get_mut().unwrap_or_else(PoisonError::into_inner))
    }
}

impl<G: Game> Game for Observed<G> {
    type Setup = G::Setup;
    type Input = G::Input;
    type Save = ObservedSave<G::Save>;

    const RULES: RulesId = G::RULES;

    fn new(setup: &G::Setup) -> Result<Self, SetupError> {
        G::new(setup).map(Self::from_start)
    }

    fn new_within(setup: &G::Setup, work_max: u64) -> Result<(Self, u64), StartError> {
        let (game, work) = G::new_within(setup, work_max)?;
        Ok((Self::from_start(game), work))
    }

    fn players(&self) -> u32 {
        self.game.players()
    }

    fn tick_rate(&self) -> u32 {
        self.game.tick_rate()
    }

    fn step(&mut self, inputs: &[G::Input]) {
        let (game, log) = self.log_mut();
        log.before_step(game.world());
        self.game.step(inputs);
        let (game, log) = self.log_mut();
        log.after_step(game.world());
    }

    fn state_hash(&self) -> StateHash {
        self.game.state_hash()
    }

    fn save(&self) -> Self::Save {
        ObservedSave { save: self.game.save(), stamp: Some(self.log().stamp()) }
    }

    fn load(&mut self, save: &Self::Save) {
        let left = self.log().leave(self.game.world());
        self.game.load(&save.save);
        let (game, log) = self.log_mut();
        log.loaded(save.stamp, game.world(), left);
    }

    fn work(&self, inputs: &[G::Input]) -> u64 {
        self.game.work(inputs)
    }

    fn absent() -> G::Input {
        G::absent()
    }

    fn world(&self) -> Option<&World> {
        self.game.world()
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        self.game.world_mut()
    }

    fn claims(&self) -> Vec<(String, i64)> {
        self.game.claims()
    }
}
