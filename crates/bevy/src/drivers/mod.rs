//! The drivers, which play the ticks of a game.

mod local;
mod network;
mod replay;
mod sync_test;

use core::time::Duration;

pub(crate) use local::LocalDriver;
pub use network::AnyTransport;
pub(crate) use network::MatchDriver;
pub(crate) use replay::ReplayDriver;
pub(crate) use sync_test::SyncTestDriver;

use crate::error::LockstepError;
use crate::game::LockstepGame;
use crate::inputs::Inputs;
use crate::observed::Observed;

/// Times of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameTime {
    /// Game time since the last frame. Game time can be paused and scaled.
    pub(crate) delta: Duration,
    /// Real time since the last frame.
    pub(crate) real_delta: Duration,
    /// Real time since the start of the program.
    pub(crate) real_elapsed: Duration,
}

pub(crate) enum Driver<G: LockstepGame> {
    Local(Box<LocalDriver<G>>),
    SyncTest(Box<SyncTestDriver<G>>),
    Replay(Box<ReplayDriver<G>>),
    Match(Box<MatchDriver<G>>),
}

impl<G: LockstepGame> Driver<G> {
    pub(crate) fn run(
        &mut self,
        time: FrameTime,
        is_paused: bool,
        inputs: &mut Inputs<G>,
    ) -> Result<(), LockstepError> {
        match self {
            Driver::Local(local) if !is_paused => local.run(time.delta, inputs),
            Driver::SyncTest(test) if !is_paused => test.run(time.delta, inputs),
            Driver::Replay(replay) if !is_paused => replay.run(time.delta),
            Driver::Local(_) | Driver::SyncTest(_) | Driver::Replay(_) => Ok(()),
            // A paused match still has to receive packets.
            Driver::Match(network) => network.run(time, is_paused, inputs),
        }
    }

    pub(crate) fn game(&self) -> &Observed<G> {
        match self {
            Driver::Local(local) => local.game(),
            Driver::SyncTest(test) => test.game(),
            Driver::Replay(replay) => replay.game(),
            Driver::Match(network) => network.peer().game(),
        }
    }

    pub(crate) fn tick(&self) -> u64 {
        match self {
            Driver::Local(local) => local.tick(),
            Driver::SyncTest(test) => test.tick(),
            Driver::Replay(replay) => replay.tick(),
            Driver::Match(network) => network.peer().tick(),
        }
    }

    /// Number of confirmed ticks, which no rollback can change.
    pub(crate) fn confirmed(&self) -> u64 {
        match self {
            Driver::Local(local) => local.tick(),
            Driver::SyncTest(test) => test.confirmed(),
            Driver::Replay(replay) => replay.tick(),
            Driver::Match(network) => network.peer().confirmed(),
        }
    }

    /// Time since the last tick as a fraction of a tick, 0 to 1.
    pub(crate) fn fraction(&self) -> f32 {
        match self {
            Driver::Local(local) => local.fraction(),
            Driver::SyncTest(test) => test.fraction(),
            Driver::Replay(replay) => replay.fraction(),
            Driver::Match(network) => network.fraction(),
        }
    }
}

fn fraction_of(timestep: &lockstep2d::world::FixedTimestep) -> f32 {
    timestep.interpolation_billionths() as f32 * 1e-9
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
