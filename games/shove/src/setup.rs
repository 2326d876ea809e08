//! [`Setup`]: parameters of a match.

use std::fmt;

use lockstep2d::lockstep::SetupError;
use serde::{Deserialize, Serialize};

/// Parameters of a match.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setup {
    /// Number of seats, 2 to 4.
    pub seats: u8,
    /// Number of rounds, 1 to 99. Practice does not count.
    pub rounds: u8,
    /// Random seed for the placement of players and crates.
    pub seed: u64,
}

impl Default for Setup {
    /// Four seats, 99 rounds, seed 0.
    fn default() -> Self {
        Setup { seats: 4, rounds: 99, seed: 0 }
    }
}

/// Reason why a match cannot start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnplayableSetup {
    /// The number of seats is not in 2 to 4.
    Seats {
        /// Requested number of seats.
        seats: u8,
    },
    /// The number of rounds is not in 1 to 99.
    Rounds {
        /// Requested number of rounds.
        rounds: u8,
    },
}

impl Setup {
    /// Checks that all parameters are in range.
    ///
    /// # Errors
    /// [`UnplayableSetup`] with the value that is out of range.
    pub fn check(&self) -> Result<(), UnplayableSetup> {
        let Setup { seats, rounds, seed: _ } = *self;
        if !(2..=4).contains(&seats) {
            return Err(UnplayableSetup::Seats { seats });
        }
        if !(1..=99).contains(&rounds) {
            return Err(UnplayableSetup::Rounds { rounds });
        }
        Ok(())
    }
}

impl fmt::Display for UnplayableSetup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            UnplayableSetup::Seats { seats } => write!(f, "a match has 2 to 4 seats, not {seats}"),
            UnplayableSetup::Rounds { rounds } => write!(f, "a match has 1 to 99 rounds, not {rounds}"),
        }
    }
}

impl std::error::Error for UnplayableSetup {}

impl From<UnplayableSetup> for SetupError {
    fn from(error: UnplayableSetup) -> Self {
        SetupError { why: error.to_string() }
    }
}
