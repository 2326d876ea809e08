//! [`LockstepError`]: reasons why a driver cannot continue.

use core::fmt;

use bevy::prelude::Message;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{InputError, SetupError};
use lockstep2d::peer::PeerError;
use lockstep2d::replay::{RecordError, SeekError, Verdict};

/// Reason why a driver cannot start or continue.
#[derive(Clone, Debug)]
pub enum LockstepError {
    /// The game of a sync test refuses its setup.
    Setup(SetupError),
    /// Inputs of a sync test cannot be encoded.
    Inputs(InputError),
    /// A local game cannot start from its setup, or cannot be recorded.
    Record(RecordError),
    /// A match cannot start or continue, or its replay or report cannot be made.
    Match(PeerError),
    /// No tick of the replay can be played.
    Replay(Box<Verdict>),
    /// The replay cannot be played to the requested tick.
    Seek(SeekError),
    /// A sync test found a state that depends on more than the inputs: a save lacks a part of the state, or a step
    /// reads data outside of the state and the inputs.
    SyncTest {
        /// Number of ticks after which the states differ.
        tick: u64,
        /// Hash when the tick was played first.
        first: StateHash,
        /// Hash when the tick was played again.
        again: StateHash,
    },
    /// The driver does not support this operation: only replays can seek, for example.
    Unsupported(&'static str),
}

impl fmt::Display for LockstepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LockstepError::Setup(error) => error.fmt(f),
            LockstepError::Inputs(error) => error.fmt(f),
            LockstepError::Record(error) => error.fmt(f),
            LockstepError::Match(error) => error.fmt(f),
            LockstepError::Replay(verdict) => write!(f, "the replay cannot be played: {verdict}"),
            LockstepError::Seek(error) => write!(f, "the replay cannot be played: {error}"),
            LockstepError::SyncTest { tick, first, again } => {
                write!(f, "the state hash after {tick} ticks was {first}, and is {again} after a rollback")
            }
            LockstepError::Unsupported(what) => write!(f, "the driver cannot {what}"),
        }
    }
}

impl core::error::Error for LockstepError {}

impl From<RecordError> for LockstepError {
    fn from(error: RecordError) -> Self {
        LockstepError::Record(error)
    }
}

impl From<PeerError> for LockstepError {
    fn from(error: PeerError) -> Self {
        LockstepError::Match(error)
    }
}

impl From<SeekError> for LockstepError {
    fn from(error: SeekError) -> Self {
        LockstepError::Seek(error)
    }
}

impl From<InputError> for LockstepError {
    fn from(error: InputError) -> Self {
        LockstepError::Inputs(error)
    }
}

impl From<SetupError> for LockstepError {
    fn from(error: SetupError) -> Self {
        LockstepError::Setup(error)
    }
}

/// Sent when the driver has stopped. A replay can continue after a [`Lockstep::seek`](crate::Lockstep::seek), and a
/// peer after [`Peer::ask`](lockstep2d::peer::Peer::ask).
#[derive(Message, Clone, Debug)]
pub struct LockstepFailed(
    /// Reason.
    pub LockstepError,
);
