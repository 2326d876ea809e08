//! [`DriverError`]: reasons why a session's request cannot be executed.

use core::fmt;

use crate::replay::RecordError;

/// A request that a session should not have made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriverError {
    /// The state is not kept any more, or does not exist yet.
    NoState {
        /// Number of ticks before the state.
        tick: u64,
    },
    /// The number of inputs is not the number of seated players.
    Players {
        /// Number of seated players.
        seated: u64,
        /// Number of inputs received.
        inputs: u64,
    },
    /// The inputs cannot be recorded in the replay.
    Record(RecordError),
}

impl fmt::Display for DriverError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DriverError::NoState { tick } => write!(f, "the state after {tick} ticks is not kept"),
            DriverError::Players { seated, inputs } => {
                write!(f, "{inputs} inputs for {seated} seated players")
            }
            DriverError::Record(error) => write!(f, "the replay cannot be continued: {error}"),
        }
    }
}

impl core::error::Error for DriverError {}
