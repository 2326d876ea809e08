//! [`SyncTestDriver`]: a local game that rolls back after each tick from tick `depth` on.

use core::time::Duration;
use std::collections::VecDeque;

use lockstep2d::lockstep::{EncodedInputs, Game, History};
use lockstep2d::world::FixedTimestep;

use super::{fraction_of, nanoseconds};
use crate::error::LockstepError;
use crate::game::LockstepGame;
use crate::inputs::Inputs;
use crate::observed::Observed;

/// From tick `depth` on, each tick is followed by a rollback: the driver loads the state of `depth` ticks ago, plays
/// these ticks again, and compares the states.
pub(crate) struct SyncTestDriver<G: LockstepGame> {
    game: Observed<G>,
    timestep: FixedTimestep,
    tick: u64,
    depth: u32,
    history: History<Observed<G>>,
    /// Inputs of the last `depth` ticks.
    inputs: VecDeque<EncodedInputs<G::Input>>,
}

impl<G: LockstepGame> SyncTestDriver<G> {
    pub(crate) fn new(setup: &G::Setup, depth: u32) -> Result<Self, LockstepError> {
        let game = Observed::<G>::new(setup)?;
        let timestep = FixedTimestep::new(game.tick_rate());
        let mut history = History::of_ticks(depth.saturating_add(2));
        history.push(0, game.save(), game.state_hash());
        Ok(SyncTestDriver { game, timestep, tick: 0, depth, history, inputs: VecDeque::new() })
    }

    pub(crate) fn run(&mut self, delta: Duration, inputs: &mut Inputs<G>) -> Result<(), LockstepError> {
        for _ in 0..self.timestep.advance(nanoseconds(delta)) {
            self.step(inputs)?;
        }
        Ok(())
    }

    pub(crate) fn step(&mut self, inputs: &mut Inputs<G>) -> Result<(), LockstepError> {
        let players = self.game.players();
        let encoded = EncodedInputs::new(&inputs.next(players as usize), players)?;
        inputs.used();
        self.game.step(encoded.inputs());
        self.tick += 1;
        self.history.push(self.tick, self.game.save(), self.game.state_hash());
        self.inputs.push_back(encoded);
        self.replay()
    }

    /// Loads the state of `depth` ticks ago, and plays to the newest tick again.
    fn replay(&mut self) -> Result<(), LockstepError> {
        let count = self.inputs.len();
        if count < self.depth as usize {
            return Ok(());
        }
        let first = self.tick - count as u64;
        if let Some(past) = self.history.get(first) {
            self.game.load(&past.save);
        }
        for (tick, inputs) in (first + 1..).zip(&self.inputs) {
            self.game.step(inputs.inputs());
            let again = self.game.state_hash();
            if let Some(past) = self.history.get(tick).filter(|past| past.hash != again) {
                return Err(LockstepError::SyncTest { tick, first: past.hash, again });
            }
        }
        self.inputs.pop_front();
        Ok(())
    }

    pub(crate) fn game(&self) -> &Observed<G> {
        &self.game
    }

    pub(crate) fn tick(&self) -> u64 {
        self.tick
    }

    pub(crate) fn confirmed(&self) -> u64 {
        self.tick - self.inputs.len() as u64
    }

    pub(crate) fn fraction(&self) -> f32 {
        fraction_of(&self.timestep)
    }
}
