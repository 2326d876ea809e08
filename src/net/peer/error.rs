//! [`NetError`]: why a peer cannot go on.

use alloc::string::String;
use core::fmt;

use ggrs::GgrsError;

use crate::net::error::DriverError;
use crate::net::terms::TermsMismatch;
use crate::replay::RecordError;

/// Why a peer cannot go on.
#[derive(Clone, Debug, PartialEq)]
pub enum NetError {
    /// No game starts, or its replay cannot be written.
    Record(RecordError),
    /// The game cannot do what the session asks for.
    Driver(DriverError),
    /// GGRS refuses.
    Ggrs(GgrsError),
    /// The others play something else.
    Terms(TermsMismatch),
    /// There is no free seat.
    Full,
    /// The state that was reached by catching up is not that of the others.
    Diverged {
        /// How many ticks had been played.
        tick: u64,
    },
    /// The state that was sent is not one of this game.
    State {
        /// What is wrong with it.
        why: String,
    },
    /// The peer that was asked has said no.
    Refused {
        /// Why.
        why: String,
    },
    /// Nobody has answered.
    NoAnswer,
    /// The others count this peer as gone: it was silent for too long. It may join again.
    Dropped,
}

impl fmt::Display for NetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NetError::Record(error) => error.fmt(f),
            NetError::Driver(error) => error.fmt(f),
            NetError::Ggrs(error) => error.fmt(f),
            NetError::Terms(mismatch) => mismatch.fmt(f),
            NetError::Full => write!(f, "all seats are taken"),
            NetError::Diverged { tick } => write!(f, "another state than the others' after tick {tick}"),
            NetError::State { why } => write!(f, "the state that was sent cannot be used: {why}"),
            NetError::Refused { why } => write!(f, "refused: {why}"),
            NetError::NoAnswer => write!(f, "no answer"),
            NetError::Dropped => {
                write!(f, "the others have gone on without this peer, which was silent for too long")
            }
        }
    }
}

impl core::error::Error for NetError {}

impl From<RecordError> for NetError {
    fn from(error: RecordError) -> Self {
        NetError::Record(error)
    }
}

impl From<DriverError> for NetError {
    fn from(error: DriverError) -> Self {
        NetError::Driver(error)
    }
}

impl From<GgrsError> for NetError {
    fn from(error: GgrsError) -> Self {
        NetError::Ggrs(error)
    }
}
