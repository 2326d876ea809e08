//! [`DriverError`]: what cannot be done for a session.

use core::fmt;

use crate::replay::RecordError;

/// Something that a session should not have asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriverError {
    /// A state that is no longer, or not yet, remembered.
    NoState {
        /// How many ticks lead to it.
        tick: u64,
    },
    /// Inputs for another number of players than were seated.
    Players {
        /// How many players have seats.
        seated: u64,
        /// How many inputs came.
        inputs: u64,
    },
    /// The replay refuses what was played.
    Record(RecordError),
}

impl fmt::Display for DriverError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DriverError::NoState { tick } => write!(f, "the state after {tick} ticks is not remembered"),
            DriverError::Players { seated, inputs } => {
                write!(f, "{inputs} inputs for {seated} seated players")
            }
            DriverError::Record(error) => write!(f, "the replay cannot go on: {error}"),
        }
    }
}

impl core::error::Error for DriverError {}
