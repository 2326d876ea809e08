//! [`Verdict`]: what a verifier says of a file.

use alloc::string::String;
use core::fmt;

use super::flaw::Flaw;
use super::limits::Limit;
use super::reader::ReadError;
use crate::hash::StateHash;

/// What a verifier says of a file. Only `Match` is good.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The setup and the inputs lead to every checkpoint, the end state and the claims of the file.
    Match {
        /// Ticks of the game.
        ticks: u64,
        /// The hash of its last state.
        hash: StateHash,
    },
    /// All checkpoints agree, but the trailer says something else about the end.
    ClaimMismatch {
        /// Ticks of the game.
        ticks: u64,
        /// The hash of its last state, as played again.
        hash: StateHash,
        /// The first thing that is not so.
        difference: ClaimDifference,
    },
    /// Played again, the game takes another course; it leaves the recorded one after `last_equal`.
    Diverged {
        /// The tick of the last checkpoint that agrees; `None` if not even the start does.
        last_equal: Option<u64>,
        /// The tick of the first checkpoint that does not.
        first_different: u64,
    },
    /// The file ends before its trailer. What is there agrees.
    Incomplete {
        /// Ticks that could be played again: those of the blocks that are whole.
        ticks: u64,
        /// The hash of the state after them.
        hash: StateHash,
    },
    /// No recorder writes such bytes.
    Malformed {
        /// Where in the file.
        offset: u64,
        /// What is wrong there.
        flaw: Flaw,
    },
    /// The file is larger, or computes more, than the verifier allows.
    LimitExceeded {
        /// In what.
        limit: Limit,
        /// What the file has, or at least has.
        value: u64,
        /// What is allowed.
        max: u64,
    },
    /// The file may be good, but this program cannot tell.
    Unverifiable {
        /// What it lacks.
        why: Mismatch,
    },
}

/// Something that a trailer says and the game does not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ClaimDifference {
    /// The hash of the last state.
    FinalHash {
        /// As the trailer has it.
        claimed: StateHash,
        /// As the game has it.
        actual: StateHash,
    },
    /// A value that the game reports of itself.
    Value {
        /// Its name.
        name: String,
        /// As the trailer has it.
        claimed: Option<i64>,
        /// As the game has it.
        actual: Option<i64>,
    },
}

/// What a file was made with and this program is not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mismatch {
    /// Another version of the file format.
    Format {
        /// That of the file.
        file: u32,
        /// That of this program.
        here: u32,
    },
    /// Other semantics of the engine.
    Semantics {
        /// Those of the file.
        file: u32,
        /// Those of this program.
        here: u32,
    },
    /// Another game, or another version of its rules.
    Rules {
        /// Name and version in the file.
        file: (String, u32),
        /// Name and version of this program.
        here: (String, u32),
    },
}

impl Verdict {
    /// Whether this is [`Verdict::Match`].
    #[must_use]
    pub fn is_match(&self) -> bool {
        matches!(self, Verdict::Match { .. })
    }

    /// The verdict in one word, as tools print it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Verdict::Match { .. } => "match",
            Verdict::ClaimMismatch { .. } => "claim_mismatch",
            Verdict::Diverged { .. } => "diverged",
            Verdict::Incomplete { .. } => "incomplete",
            Verdict::Malformed { .. } => "malformed",
            Verdict::LimitExceeded { .. } => "limit_exceeded",
            Verdict::Unverifiable { .. } => "unverifiable",
        }
    }

    /// How many ticks were played again to reach it, as far as it tells.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        match self {
            Verdict::Match { ticks, .. }
            | Verdict::ClaimMismatch { ticks, .. }
            | Verdict::Incomplete { ticks, .. }
            | Verdict::Diverged { first_different: ticks, .. } => *ticks,
            Verdict::Malformed { .. } | Verdict::LimitExceeded { .. } | Verdict::Unverifiable { .. } => 0,
        }
    }

    /// The hash of the last state that was reached along the recorded course.
    #[must_use]
    pub fn hash(&self) -> Option<StateHash> {
        match self {
            Verdict::Match { hash, .. }
            | Verdict::ClaimMismatch { hash, .. }
            | Verdict::Incomplete { hash, .. } => Some(*hash),
            _ => None,
        }
    }
}

impl From<ReadError> for Verdict {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::Malformed { offset, flaw } => Verdict::Malformed { offset, flaw },
            ReadError::LimitExceeded { limit, value, max } => Verdict::LimitExceeded { limit, value, max },
            ReadError::OtherFormat { version } => {
                Verdict::Unverifiable { why: Mismatch::Format { file: version, here: super::FORMAT_VERSION } }
            }
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Match { ticks, hash } => write!(f, "match: {ticks} ticks, final hash {hash}"),
            Verdict::ClaimMismatch { ticks, difference, .. } => {
                write!(f, "claim mismatch: all {ticks} ticks agree, but {difference}")
            }
            Verdict::Diverged { last_equal: Some(tick), first_different } => {
                write!(f, "diverged: equal at tick {tick}, different at tick {first_different}")
            }
            Verdict::Diverged { last_equal: None, first_different } => {
                write!(f, "diverged: different at tick {first_different}, where it starts")
            }
            Verdict::Incomplete { ticks, .. } => {
                write!(f, "incomplete: the first {ticks} ticks agree, then the file ends without a trailer")
            }
            Verdict::Malformed { offset, flaw } => write!(f, "malformed: at byte {offset}: {flaw}"),
            Verdict::LimitExceeded { limit, value, max } => {
                write!(f, "limit exceeded: {value} {limit}, at most {max} are allowed")
            }
            Verdict::Unverifiable { why } => write!(f, "unverifiable: {why}"),
        }
    }
}

impl fmt::Display for ClaimDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ClaimDifference::FinalHash { claimed, actual } => {
                write!(f, "the trailer states the final hash {claimed}, the game has {actual}")
            }
            ClaimDifference::Value { name, claimed: Some(claimed), actual: Some(actual) } => {
                write!(f, "the trailer claims {claimed} as {name:?}, the game reports {actual}")
            }
            ClaimDifference::Value { name, claimed: Some(claimed), actual: None } => {
                write!(f, "the trailer claims {claimed} as {name:?}, the game reports no such value")
            }
            ClaimDifference::Value { name, claimed: None, actual: Some(actual) } => {
                write!(f, "the trailer leaves out {name:?}, which the game reports as {actual}")
            }
            ClaimDifference::Value { name, claimed: None, actual: None } => {
                write!(f, "neither the trailer nor the game has {name:?}")
            }
        }
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Mismatch::Format { file, here } => {
                write!(f, "made in version {file} of the file format, this program reads {here}")
            }
            Mismatch::Semantics { file, here } => {
                write!(f, "made with engine semantics {file}, this program has {here}")
            }
            Mismatch::Rules { file, here } => write!(
                f,
                "made with the rules {:?} version {}, this program has {:?} version {}",
                file.0, file.1, here.0, here.1
            ),
        }
    }
}
