//! [`LocalDriver`]: all players are at this machine.

use core::time::Duration;

use lockstep2d::lockstep::Game;
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Recording};
use lockstep2d::world::FixedTimestep;

use super::{fraction_of, nanoseconds};
use crate::error::LockstepError;
use crate::game::LockstepGame;
use crate::inputs::Inputs;
use crate::observed::Observed;

/// Plays and records ticks at the rate of the game. If more than [`FixedTimestep::DEFAULT_TICKS_MAX`] ticks are due in
/// a frame, the rest are dropped.
pub(crate) struct LocalDriver<G: LockstepGame> {
    recording: Recording<Observed<G>>,
    timestep: FixedTimestep,
}

impl<G: LockstepGame> LocalDriver<G> {
    pub(crate) fn new(setup: &G::Setup) -> Result<Self, LockstepError> {
        let recording = Recording::<Observed<G>>::start(setup, CHECKPOINT_INTERVAL)?;
        let timestep = FixedTimestep::new(recording.game().tick_rate());
        Ok(LocalDriver { recording, timestep })
    }

    pub(crate) fn run(&mut self, delta: Duration, inputs: &mut Inputs<G>) -> Result<(), LockstepError> {
        for _ in 0..self.timestep.advance(nanoseconds(delta)) {
            self.step(inputs)?;
        }
        Ok(())
    }

    pub(crate) fn step(&mut self, inputs: &mut Inputs<G>) -> Result<(), LockstepError> {
        let players = self.recording.game().players() as usize;
        self.recording.step(&inputs.next(players))?;
        inputs.used();
        Ok(())
    }

    pub(crate) fn game(&self) -> &Observed<G> {
        self.recording.game()
    }

    pub(crate) fn tick(&self) -> u64 {
        self.recording.ticks()
    }

    pub(crate) fn fraction(&self) -> f32 {
        fraction_of(&self.timestep)
    }

    pub(crate) fn take_replay(&mut self) -> Vec<u8> {
        self.recording.take_bytes()
    }

    pub(crate) fn finish(self) -> Result<Vec<u8>, LockstepError> {
        Ok(self.recording.finish()?)
    }
}
