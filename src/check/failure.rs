//! [`Failure`]: what is wrong, with a replay that shows it.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt;

use super::finding::Finding;
use crate::lockstep::InputError;
use crate::replay::{RecordError, Verdict};

/// What is wrong with a game, with a replay that shows it.
#[derive(Clone, PartialEq, Eq)]
pub struct Failure {
    /// What is wrong in the log as it was given.
    pub finding: Finding,
    /// The same of the replay.
    pub minimised: Finding,
    /// A replay file with as few ticks and inputs as could be found; [`check_replay`](super::check_replay) shows the
    /// failure again. If a run does not repeat itself, its checkpoints may differ from those of the next run.
    pub replay: Vec<u8>,
    /// How many ticks it has.
    pub ticks: u64,
    /// How often it has failed in the same way, and out of how many times. A game that draws on a random iteration order
    /// does not always fail.
    pub failed: (u32, u32),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Failure { finding, minimised, ticks, failed: (failed, of), .. } = self;
        write!(f, "{finding}\na replay of {ticks} ticks fails in this way {failed} times out of {of}")?;
        if minimised != finding { write!(f, ":\n{minimised}") } else { Ok(()) }
    }
}

/// As [`Display`](fmt::Display): what a test shows that unwraps.
impl fmt::Debug for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// Why a log of inputs has not passed.
#[derive(Clone, PartialEq, Eq)]
pub enum CheckError {
    /// No replay can hold this setup and these inputs, or no game starts from it.
    Record(RecordError),
    /// The file is no replay of this game, or costs too much.
    Replay(Verdict),
    /// Something is wrong with the game.
    Failed(Box<Failure>),
}

impl CheckError {
    /// What is wrong with the game, if something is.
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

/// As [`Display`](fmt::Display): what a test shows that unwraps.
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
