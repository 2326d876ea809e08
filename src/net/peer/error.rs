//! [`NetError`]: reasons why a peer cannot continue.

use alloc::string::String;
use core::fmt;

use ggrs::GgrsError;

use crate::net::error::DriverError;
use crate::net::handshake::HandshakeMismatch;
use crate::replay::RecordError;

/// Reason why a peer cannot continue.
#[derive(Clone, Debug, PartialEq)]
pub enum NetError {
    /// The setup cannot start a game, or the replay cannot be written.
    Record(RecordError),
    /// The game cannot execute a request of the session.
    Driver(DriverError),
    /// GGRS returned an error.
    Ggrs(GgrsError),
    /// The handshake parameters of the other peers differ.
    HandshakeParameters(HandshakeMismatch),
    /// There is no free seat.
    Full,
    /// The state after catching up differs from that of the other peers.
    Diverged {
        /// Number of ticks played.
        tick: u64,
    },
    /// The received state is not a state of this game.
    State {
        /// Reason.
        why: String,
    },
    /// The contacted peer refused.
    Refused {
        /// Reason.
        why: String,
    },
    /// No peer answered.
    NoAnswer,
    /// The other peers have disconnected this peer, because it was silent for too long. It may join again.
    Dropped,
}

impl fmt::Display for NetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NetError::Record(error) => error.fmt(f),
            NetError::Driver(error) => error.fmt(f),
            NetError::Ggrs(error) => error.fmt(f),
            NetError::HandshakeParameters(mismatch) => mismatch.fmt(f),
            NetError::Full => write!(f, "all seats are taken"),
            NetError::Diverged { tick } => {
                write!(f, "the state after tick {tick} differs from that of the other peers")
            }
            NetError::State { why } => write!(f, "the received state cannot be used: {why}"),
            NetError::Refused { why } => write!(f, "refused: {why}"),
            NetError::NoAnswer => write!(f, "no answer"),
            NetError::Dropped => {
                write!(f, "the other peers have continued without this one, which was silent for too long")
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
