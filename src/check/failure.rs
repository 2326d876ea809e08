//! [`Failure`]: a fault of a game, with a replay that reproduces it.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt;

use super::finding::Finding;
use crate::lockstep::InputError;
use crate::replay::{RecordError, Verdict};

/// A fault of a game, with a replay that reproduces it.
#[derive(Clone, PartialEq, Eq)]
pub struct Failure {
    /// The finding in the log as it was given.
    pub finding: Finding,
    /// The finding in the minimised replay.
    pub minimised: Finding,
    /// A replay file with as few ticks and inputs as could be found; [`check_replay`](super::check_replay) reproduces
    /// the failure. If the game is not deterministic between runs, its checkpoints may differ from those of the next
    /// run.
    pub replay: Vec<u8>,
    /// Number of ticks in the replay.
    pub ticks: u64,
    /// Number of runs of the replay that failed in the same way, and number of runs. A game that depends on a random
    /// iteration order does not always fail.
    pub failed: (u32, u32),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Failure { finding, minimised, ticks, failed: (failed, of), .. } = self;
        write!(f, "{finding}\na replay of {ticks} ticks fails in this way {failed} times out of {of}")?;
        if minimised != finding { write!(f, ":\n{minimised}") } else { Ok(()) }
    }
}

/// Same as [`Display`](fmt::Display), for the output of a test that unwraps.
impl fmt::Debug for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// Reason why a log of inputs did not pass.
#[derive(Clone, PartialEq, Eq)]
pub enum CheckError {
    /// The setup cannot start a game, or a replay cannot represent this setup and these inputs.
    Record(RecordError),
    /// The file is not a replay of this game, or exceeds a limit.
    Replay(Verdict),
    /// The game has a fault.
    Failed(Box<Failure>),
}

impl CheckError {
    /// The fault of the game, if there is one.
    #[must_use]
    pub fn failure(&self) -> Option<&Failure> {
        match self {
            CheckError::Failed(failure) => Some(failure),
            CheckError::Record(_) | CheckError::Replay(_) => None,
        }
    }
}

impl fmt::Display for CheckError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CheckError::Record(error) => write!(f, "nothing to check: {error}"),
            CheckError::Replay(verdict) => write!(f, "nothing to check: {verdict}"),
            CheckError::Failed(failure) => write!(f, "{failure}"),
        }
    }
}

/// Same as [`Display`](fmt::Display), for the output of a test that unwraps.
impl fmt::Debug for CheckError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl core::error::Error for CheckError {}

impl From<RecordError> for CheckError {
    fn from(error: RecordError) -> Self {
        CheckError::Record(error)
    }
}

impl From<InputError> for CheckError {
    fn from(error: InputError) -> Self {
        CheckError::Record(RecordError::Inputs(error))
    }
}

impl From<Verdict> for CheckError {
    fn from(verdict: Verdict) -> Self {
        CheckError::Replay(verdict)
    }
}
