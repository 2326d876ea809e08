//! [`Options`]: how a peer takes part.

use core::fmt;
use core::time::Duration;

use serde::{Deserialize, Serialize};

use crate::replay::CHECKPOINT_INTERVAL;

/// How peers stay together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// A tick is played when everyone's input for it is there. Nothing is ever taken back, and a late packet is felt by
    /// all. For games whose step is dear or that do not mind some delay.
    Lockstep,
    /// Missing inputs are guessed, and ticks that were played with a wrong guess are played again.
    Rollback {
        /// How many ticks may be guessed, 1 to 32.
        window: u8,
    },
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Mode::Lockstep => write!(f, "lockstep"),
            Mode::Rollback { window } => write!(f, "rollback by up to {window} ticks"),
        }
    }
}

/// How a peer takes part. The mode has to be the same for all.
///
/// The defaults suit games at 60 ticks a second between peers on one continent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// How peers stay together.
    pub mode: Mode,
    /// After how many ticks a local input takes effect, at most [`INPUT_DELAY_MAX`]. It hides as many ticks of latency.
    pub input_delay: u8,
    /// After how long a silent peer counts as gone.
    pub timeout: Duration,
    /// How many ticks apart states are compared, at least 1.
    pub check_interval: u32,
    /// Ticks per block of the replay.
    pub checkpoint_interval: u32,
    /// How many players the first tick waits for, the host among them.
    pub start_with: u32,
    /// How many ticks a peer that joins later plays at most in one update, to catch up.
    pub catch_up: u32,
}

/// Longest input delay, in ticks.
pub const INPUT_DELAY_MAX: u8 = 15;
/// Widest prediction window, in ticks.
pub(super) const WINDOW_MAX: u8 = 32;

impl Options {
    /// Rollback by up to 8 ticks, with inputs delayed by 2.
    #[must_use]
    pub const fn rollback() -> Self {
        Options { mode: Mode::Rollback { window: 8 }, input_delay: 2, ..Self::lockstep() }
    }

    /// Lockstep, with inputs delayed by 4 ticks.
    #[must_use]
    pub const fn lockstep() -> Self {
        Options {
            mode: Mode::Lockstep,
            input_delay: 4,
            timeout: Duration::from_secs(2),
            check_interval: 10,
            checkpoint_interval: CHECKPOINT_INTERVAL,
            start_with: 2,
            catch_up: 10,
        }
    }

    /// Waits for some number of players before the first tick.
    #[must_use]
    pub const fn start_with(self, players: u32) -> Self {
        Options { start_with: players, ..self }
    }

    /// How many ticks may be guessed.
    pub(super) fn window(&self) -> u8 {
        match self.mode {
            Mode::Lockstep => 0,
            Mode::Rollback { window } => window.clamp(1, WINDOW_MAX),
        }
    }

    pub(super) fn delay(&self) -> u8 {
        self.input_delay.min(INPUT_DELAY_MAX)
    }

    /// How many ticks a peer can be ahead of what another one knows: that many of its last ticks are not final before
    /// it has heard more.
    pub(super) fn doubt(&self) -> u64 {
        u64::from(self.window()) + u64::from(INPUT_DELAY_MAX) + 2
    }

    /// How many states have to be remembered: one that is final, and all those since.
    pub(super) fn memory(&self) -> u32 {
        2 * (u32::from(self.window()) + u32::from(INPUT_DELAY_MAX) + 2)
    }
}
