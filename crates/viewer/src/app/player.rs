//! [`Player`]: playback state and speed, and seeking to a tick.

use std::time::Duration;

use lockstep2d::world::World;

use crate::source::{Source, SourceError};

/// Range of the playback speed. A speed is given as an exponent of two.
const SPEEDS: std::ops::RangeInclusive<i32> = -5..=5;

/// Largest cost of the ticks of a frame. [`slice_of`] defines the cost.
const SLICE: u64 = 60_000;

#[derive(Debug)]
pub(super) struct Player {
    pub(super) playing: bool,
    /// Playback speed as an exponent of two.
    speed: i32,
    /// Number of ticks that are due, including the fraction of a tick from earlier frames.
    due: f64,
    /// Tick to seek to. If it is far, seeking takes several frames.
    goal: Option<u64>,
}

impl Default for Player {
    fn default() -> Self {
        Player { playing: true, speed: 0, due: 0.0, goal: None }
    }
}

impl Player {
    /// Toggles between playing and paused. If `from` is given, seeks to it.
    pub(super) fn toggle(&mut self, from: Option<u64>) {
        self.playing = !self.playing;
        self.goal = from;
    }

    pub(super) fn faster(&mut self, by: i32) {
        self.speed = (self.speed + by).clamp(*SPEEDS.start(), *SPEEDS.end());
    }

    /// Speed as text, such as `2x` or `1/4x`.
    pub(super) fn speed(&self) -> String {
        match self.speed {
            speed @ 0.. => format!("{}x", 1 << speed),
            speed => format!("1/{}x", 1 << -speed),
        }
    }

    pub(super) fn go_to(&mut self, tick: u64) {
        (self.playing, self.goal) = (false, Some(tick));
    }

    /// Pauses, and seeks by a number of ticks from the current goal or, without a goal, from the current tick. The
    /// result is clamped to the ticks of the source.
    pub(super) fn go_by(&mut self, ticks: i64, source: &dyn Source) {
        let from = self.goal.unwrap_or(source.tick());
        let end = source.ticks().unwrap_or(u64::MAX);
        self.go_to(from.saturating_add_signed(ticks).clamp(source.first(), end));
    }

    pub(super) fn goal(&self) -> Option<u64> {
        self.goal
    }

    /// Plays the due ticks, or continues to seek. Pauses after an error.
    pub(super) fn advance(&mut self, time: Duration, source: &mut dyn Source) -> Result<(), SourceError> {
        let result = self.try_advance(time, source);
        if result.is_err() {
            (self.playing, self.goal) = (false, None);
        }
        result
    }

    fn try_advance(&mut self, time: Duration, source: &mut dyn Source) -> Result<(), SourceError> {
        if source.advance(time)? {
            // A source with its own clock cannot be paused, and has no speed.
            *self = Player::default();
            return Ok(());
        }
        let slice = slice_of(source.world());
        if let Some(goal) = self.goal {
            source.seek(goal.min(source.tick().saturating_add(slice)))?;
            self.goal = (source.tick() != goal).then_some(goal);
        } else if self.playing {
            self.due += time.as_secs_f64() * f64::from(source.tick_rate()) * f64::from(self.speed).exp2();
            let due = (self.due as u64).min(slice);
            // Due ticks beyond `slice` are dropped, so playback slows down instead of catching up later.
            self.due = self.due.fract();
            let end = source.ticks().unwrap_or(u64::MAX);
            source.seek(source.tick().saturating_add(due).min(end))?;
            self.playing = source.tick() < end;
        }
        Ok(())
    }
}

/// Largest number of ticks to play in a frame, at least 1. A tick costs 100, plus 1 for each body, plus 2 for each
/// pair.
pub(super) fn slice_of(world: &World) -> u64 {
    SLICE / (100 + world.body_count() as u64 + 2 * world.pair_count() as u64).min(SLICE)
}
