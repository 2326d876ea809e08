//! [`Player`]: which tick is shown when.

use std::time::Duration;

use lockstep2d::world::World;

use crate::source::{Source, SourceError};

/// Slowest and fastest, as powers of two.
const SPEEDS: std::ops::RangeInclusive<i32> = -5..=5;

/// What is played at a time, in bodies and pairs: about ten milliseconds.
const SLICE: u64 = 60_000;

/// Plays a source, or goes to a tick.
#[derive(Debug)]
pub(super) struct Player {
    pub(super) playing: bool,
    /// Twice as fast for each.
    speed: i32,
    /// Ticks that are due; a part of one waits for the next frame.
    due: f64,
    /// Where to go to, in several frames if it is far.
    goal: Option<u64>,
}

impl Default for Player {
    fn default() -> Self {
        Player { playing: true, speed: 0, due: 0.0, goal: None }
    }
}

impl Player {
    /// Plays or stops; from another tick if one is named.
    pub(super) fn toggle(&mut self, from: Option<u64>) {
        self.playing = !self.playing;
        self.goal = from;
    }

    pub(super) fn faster(&mut self, by: i32) {
        self.speed = (self.speed + by).clamp(*SPEEDS.start(), *SPEEDS.end());
    }

    /// As a person reads it.
    pub(super) fn speed(&self) -> String {
        match self.speed {
            speed @ 0.. => format!("{}x", 1 << speed),
            speed => format!("1/{}x", 1 << -speed),
        }
    }

    /// Goes to a tick and stays there.
    pub(super) fn go_to(&mut self, tick: u64) {
        (self.playing, self.goal) = (false, Some(tick));
    }

    /// Goes some ticks further or back and stays there.
    pub(super) fn go_by(&mut self, ticks: i64, source: &dyn Source) {
        let from = self.goal.unwrap_or(source.tick());
        let end = source.ticks().unwrap_or(u64::MAX);
        self.go_to(from.saturating_add_signed(ticks).clamp(source.first(), end));
    }

    /// Where it is on the way to.
    pub(super) fn goal(&self) -> Option<u64> {
        self.goal
    }

    /// Plays what is due. After an error it stands still.
    pub(super) fn advance(&mut self, time: Duration, source: &mut dyn Source) -> Result<(), SourceError> {
        let result = self.try_advance(time, source);
        if result.is_err() {
            (self.playing, self.goal) = (false, None);
        }
        result
    }

    fn try_advance(&mut self, time: Duration, source: &mut dyn Source) -> Result<(), SourceError> {
        if source.advance(time)? {
            return Ok(());
        }
        let slice = slice_of(source.world());
        if let Some(goal) = self.goal {
            source.seek(goal.min(source.tick().saturating_add(slice)))?;
            self.goal = (source.tick() != goal).then_some(goal);
        } else if self.playing {
            self.due += time.as_secs_f64() * f64::from(source.tick_rate()) * f64::from(self.speed).exp2();
            let due = (self.due as u64).min(slice);
            // What does not fit into a frame is not caught up on: it only becomes slower.
            self.due = self.due.fract();
            let end = source.ticks().unwrap_or(u64::MAX);
            source.seek(source.tick().saturating_add(due).min(end))?;
            self.playing = source.tick() < end;
        }
        Ok(())
    }
}

/// How many ticks of a world are played in a frame at most, at least one.
pub(super) fn slice_of(world: &World) -> u64 {
    SLICE / (100 + world.body_count() as u64 + 2 * world.pair_count() as u64).min(SLICE)
}
