//! [`Setup`]: what a match starts from.

use std::fmt;

use lockstep2d::lockstep::SetupError;
use serde::{Deserialize, Serialize};

/// How a match begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setup {
    /// Players, 2 to 4.
    pub seats: u8,
    /// Rounds that have a winner or run out of time, 1 to 99; then the match is over.
    pub rounds: u8,
    /// What the placing of players and crates is drawn from.
    pub seed: u64,
}

impl Default for Setup {
    /// Four players and 99 rounds.
    fn default() -> Self {
        Setup { seats: 4, rounds: 99, seed: 0 }
    }
}

/// Why a match cannot start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnplayableSetup {
    /// There are 2 to 4 seats.
    Seats {
        /// How many were asked for.
        seats: u8,
    },
    /// There are 1 to 99 rounds.
    Rounds {
        /// How many were asked for.
        rounds: u8,
    },
}

impl Setup {
    /// Checks that a match can start from it.
    ///
    /// # Errors
    /// [`UnplayableSetup`], with what is out of range.
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
            UnplayableSetup::Seats { seats } => write!(f, "two to four can play, not {seats}"),
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
