//! [`ReplayDriver`]: plays a replay, and seeks in it.

use core::time::Duration;

use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Step, Timeline, TimelineOptions};
use lockstep2d::world::FixedTimestep;
use ouroboros::self_referencing;

use super::{fraction_of, nanoseconds};
use crate::error::LockstepError;
use crate::game::LockstepGame;
use crate::observed::Observed;

/// A replay and the timeline that borrows it.
#[self_referencing]
struct Film<G: LockstepGame> {
    file: Vec<u8>,
    #[borrows(file)]
    #[not_covariant]
    timeline: Timeline<'this, Observed<G>>,
}

pub(crate) struct ReplayDriver<G: LockstepGame> {
    film: Film<G>,
    timestep: FixedTimestep,
    ticks: u64,
}

impl<G: LockstepGame> ReplayDriver<G> {
    pub(crate) fn new(file: Vec<u8>, limits: &Limits) -> Result<Self, LockstepError> {
        let film: Film<G> =
            FilmTryBuilder { file, timeline_builder: |file| open_timeline(file, limits) }.try_build()?;
        let (rate, ticks) = film.with_timeline(|timeline| (timeline.game().tick_rate(), timeline.ticks()));
        Ok(ReplayDriver { film, timestep: FixedTimestep::new(rate), ticks })
    }

    pub(crate) fn run(&mut self, delta: Duration) -> Result<(), LockstepError> {
        for _ in 0..self.timestep.advance(nanoseconds(delta)) {
            if !self.step()? {
                break;
            }
        }
        Ok(())
    }

    /// Returns `false` if the replay has ended.
    pub(crate) fn step(&mut self) -> Result<bool, LockstepError> {
        self.film.with_timeline_mut(|timeline| {
            let (before, mark) = (timeline.tick(), timeline.game().log().mark());
            let step = timeline.step();
            // If a tick exceeds a limit, the timeline loads an earlier state and plays up to `before` again. The log
            // then returns to `mark`.
            if step.is_err() && timeline.tick() == before {
                let game = timeline.game();
                game.log().return_to(mark, game.world());
            }
            Ok(matches!(step?, Step::Ticked))
        })
    }

    pub(crate) fn seek(&mut self, tick: u64) -> Result<(), LockstepError> {
        self.film.with_timeline_mut(|timeline| {
            let left = timeline.game().log().leave(timeline.game().world());
            timeline.game().log().suspend();
            // After an error, the game may be at another tick than the requested one, so the log takes the tick of the
            // timeline.
            let sought = timeline.seek(tick);
            let game = timeline.game();
            game.log().relocate(timeline.tick(), game.world(), left);
            Ok(sought?)
        })
    }

    pub(crate) fn game(&self) -> &Observed<G> {
        self.film.with_timeline(|timeline| timeline.game())
    }

    pub(crate) fn tick(&self) -> u64 {
        self.film.with_timeline(|timeline| timeline.tick())
    }

    pub(crate) fn ticks(&self) -> u64 {
        self.ticks
    }

    pub(crate) fn fraction(&self) -> f32 {
        // At the end of the replay, there is no next tick to interpolate to.
        if self.tick() == self.ticks { 1.0 } else { fraction_of(&self.timestep) }
    }
}

fn open_timeline<'a, G: LockstepGame>(
    file: &'a [u8],
    limits: &Limits,
) -> Result<Timeline<'a, Observed<G>>, LockstepError> {
    Timeline::open(file, &TimelineOptions::default(), limits)
        .map_err(|verdict| LockstepError::Replay(Box::new(verdict)))
}
