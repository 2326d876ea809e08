//! [`NetOptions`]: options of a peer.

use core::fmt;
use core::time::Duration;

use serde::{Deserialize, Serialize};

use crate::replay::CHECKPOINT_INTERVAL;

/// Synchronisation mode of the peers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// A tick is played when the inputs of all players have arrived. Nothing is ever rolled back, and a late packet
    /// delays all players. Suitable for games with an expensive step or that tolerate some delay.
    Lockstep,
    /// Missing inputs are predicted, and ticks that were played with a wrong prediction are rolled back and played
    /// again.
    Rollback {
        /// Maximum number of predicted ticks, 1 to 32.
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

/// Options of a peer. The mode has to be the same for all peers.
///
/// The defaults suit games at 60 ticks per second between peers on one continent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NetOptions {
    /// Synchronisation mode.
    pub mode: Mode,
    /// Delay of local inputs in ticks, at most [`INPUT_DELAY_MAX`]. It hides the same number of ticks of latency.
    pub input_delay: u8,
    /// Time without messages after which a peer counts as disconnected.
    pub timeout: Duration,
    /// Interval in ticks at which states are compared, at least 1.
    pub check_interval: u32,
    /// Number of ticks per block of the replay.
    pub checkpoint_interval: u32,
    /// Number of players to wait for before the first tick, including the host.
    pub start_with: u32,
    /// Maximum number of ticks that a late joiner plays in one update, to catch up.
    pub catch_up: u32,
}

/// Maximum input delay, in ticks.
pub const INPUT_DELAY_MAX: u8 = 15;
/// Maximum prediction window, in ticks.
pub(super) const WINDOW_MAX: u8 = 32;

impl NetOptions {
    /// Rollback by up to 8 ticks, with an input delay of 2.
    #[must_use]
    pub const fn rollback() -> Self {
        NetOptions { mode: Mode::Rollback { window: 8 }, input_delay: 2, ..Self::lockstep() }
    }

    /// Lockstep, with an input delay of 4 ticks.
    #[must_use]
    pub const fn lockstep() -> Self {
        NetOptions {
            mode: Mode::Lockstep,
            input_delay: 4,
            timeout: Duration::from_secs(2),
            check_interval: 10,
            checkpoint_interval: CHECKPOINT_INTERVAL,
            start_with: 2,
            catch_up: 10,
        }
    }

    /// Sets the number of players to wait for before the first tick.
    #[must_use]
    pub const fn start_with(self, players: u32) -> Self {
        NetOptions { start_with: players, ..self }
    }

    /// Maximum number of predicted ticks.
    pub(super) fn window(&self) -> u8 {
        match self.mode {
            Mode::Lockstep => 0,
            Mode::Rollback { window } => window.clamp(1, WINDOW_MAX),
        }
    }

    pub(super) fn delay(&self) -> u8 {
        self.input_delay.min(INPUT_DELAY_MAX)
    }

    /// Maximum number of ticks that a peer can be ahead of what another one has confirmed. This many of its last ticks
    /// are not final.
    pub(super) fn doubt(&self) -> u64 {
        u64::from(self.window()) + u64::from(INPUT_DELAY_MAX) + 2
    }

    /// Number of states to keep: a final one, and all later ones.
    pub(super) fn memory(&self) -> u32 {
        2 * (u32::from(self.window()) + u32::from(INPUT_DELAY_MAX) + 2)
    }
}
