//! Decides which ticks the threads of a team share, according to the times of earlier ticks.
//!
//! The threads wait for each other about a hundred times in a tick. If other programs use the processors, a wait may
//! last a time slice of the operating system, and a tick takes up to thirty times as long as with one thread. Small
//! worlds may be slower with several threads even on idle processors. Times never influence a result, because no result
//! depends on the number of threads.

#[cfg(test)]
mod tests;

use core::time::Duration;

/// Smallest number of ticks between two trials. In a trial, a tick runs in the mode that was slower so far.
const TRIAL_MIN: u32 = 16;

/// Largest number of ticks between two trials: 17 s at 60 Hz.
const TRIAL_MAX: u32 = 1024;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Alone,
    Team,
}

/// Compares the times of ticks in both modes. Most ticks use the faster mode, and a few trial ticks use the other mode.
/// Trials become rare while the other mode stays slower, because a slow trial delays the game.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    /// Time of a tick in nanoseconds per 1024 active bodies, by mode: a running mean for the faster mode, and the time
    /// of the last trial for the other mode. `None` before the first tick in the mode.
    costs: [Option<u64>; 2],
    faster: Mode,
    until_trial: u32,
    /// Number of ticks between the last trial and the next one.
    interval: u32,
}

impl Pace {
    pub(super) fn new() -> Self {
        Pace { costs: [None; 2], faster: Mode::Team, until_trial: TRIAL_MIN, interval: TRIAL_MIN }
    }

    pub(super) fn mode(&self) -> Mode {
        if self.until_trial == 0 { self.faster.other() } else { self.faster }
    }

    /// Records the time of a tick with `bodies` active bodies.
    pub(super) fn record(&mut self, mode: Mode, time: Duration, bodies: usize) {
        let cost = time.as_nanos() * 1024 / (bodies as u128).max(1);
        let cost = u64::try_from(cost).unwrap_or(u64::MAX);
        let is_trial = mode != self.faster;
        let known = &mut self.costs[mode as usize];
        *known = Some(match *known {
            Some(mean) if !is_trial => mean - mean / 4 + cost / 4,
            _ => cost,
        });
        self.until_trial = self.until_trial.saturating_sub(1);
        if self.other_is_faster() {
            self.faster = self.faster.other();
            self.interval = TRIAL_MIN;
        } else if is_trial {
            self.interval = (self.interval * 2).min(TRIAL_MAX);
        } else {
            return;
        }
        self.until_trial = self.interval;
    }

    /// Whether the other mode takes less than seven eighths of the time of the current one.
    fn other_is_faster(&self) -> bool {
        let [this, other] = [self.faster, self.faster.other()].map(|mode| self.costs[mode as usize]);
        this.zip(other).is_some_and(|(this, other)| other < this - this / 8)
    }
}

impl Mode {
    fn other(self) -> Self {
        match self {
            Mode::Alone => Mode::Team,
            Mode::Team => Mode::Alone,
        }
    }
}
