use alloc::string::String;
use core::fmt;

use super::flaw::Flaw;
use super::limits::LimitKind;
use super::reader::ReadError;
use crate::hash::StateHash;

/// Result of verifying a file. Only `Match` means that the file is valid.
///
/// ```
/// use lockstep2d::{lockstep::Sandbox, replay::{Limits, Verdict, verify}};
/// match verify::<Sandbox>(b"not a replay", &Limits::default()) {
///     Verdict::Match { ticks, hash } => println!("valid: {ticks} ticks, {hash}"),
///     // `Display` has a line for every case.
///     verdict => assert!(matches!(verdict, Verdict::Malformed { offset: 0, .. }), "{verdict}"),
/// }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The setup and the inputs lead to every checkpoint, to the end state and to the claims.
    Match {
        /// Number of ticks in the game.
        ticks: u64,
        /// Hash of the last state.
        hash: StateHash,
    },
    /// The checkpoints agree, but a claim or the final hash in the trailer differs.
    ClaimMismatch {
        /// Number of ticks in the game.
        ticks: u64,
        /// Hash of the last simulated state.
        hash: StateHash,
        /// The first difference.
        difference: ClaimDifference,
    },
    /// The simulated state differs at a checkpoint.
    Diverged {
        /// Tick of the last checkpoint that agrees; `None` if the start checkpoint differs.
        last_equal: Option<u64>,
        /// Tick of the first checkpoint that differs.
        first_different: u64,
    },
    /// The file ends before the end of its trailer, or [`VerifiedReplay::conclude`](super::VerifiedReplay::conclude)
    /// was called early. The checkpoints so far agree.
    Incomplete {
        /// Number of ticks played.
        ticks: u64,
        /// Hash of the state after these ticks.
        hash: StateHash,
    },
    /// The bytes are not what a recorder writes.
    Malformed {
        /// Offset in the file.
        offset: u64,
        /// The flaw at this offset.
        flaw: Flaw,
    },
    /// The file exceeds a limit of the verifier.
    LimitExceeded {
        /// The limit.
        limit: LimitKind,
        /// Value found. For work, this may be a lower bound, because the count stops when it exceeds the limit.
        value: u64,
        /// Maximum allowed value.
        max: u64,
    },
    /// This program cannot verify the file, which may be valid.
    Unverifiable {
        /// Reason.
        why: Mismatch,
    },
}

/// A statement in the trailer that differs from the game.
///
/// ```
/// use lockstep2d::replay::{ClaimDifference, Verdict};
/// /// A line for the log of a scoreboard.
/// fn line(verdict: &Verdict) -> String {
///     match verdict {
///         Verdict::ClaimMismatch { difference: ClaimDifference::Value { name, claimed, actual }, .. } => {
///             format!("{name}: claims {}, has {}", claimed.unwrap_or(0), actual.unwrap_or(0))
///         }
///         verdict => verdict.name().into(),
///     }
/// }
/// let difference = ClaimDifference::Value { name: "score".into(), claimed: Some(9000), actual: Some(12) };
/// let forged = Verdict::ClaimMismatch { ticks: 600, hash: Default::default(), difference };
/// assert_eq!(line(&forged), "score: claims 9000, has 12");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ClaimDifference {
    /// The final hash differs.
    FinalHash {
        /// Hash in the trailer.
        claimed: StateHash,
        /// Hash of the game.
        actual: StateHash,
    },
    /// A claim differs.
    Value {
        /// Name of the claim.
        name: String,
        /// Value in the trailer; `None` if the trailer has no claim with this name.
        claimed: Option<i64>,
        /// Value of the game; `None` if the game has no claim with this name.
        actual: Option<i64>,
    },
}

/// A version that the file requires and this program does not have.
///
/// ```
/// use lockstep2d::replay::{Mismatch, Verdict};
/// /// Name of the program that verifies files of other engine semantics.
/// fn other_verifier(verdict: &Verdict) -> Option<String> {
///     match verdict {
///         Verdict::Unverifiable { why: Mismatch::Semantics { file, .. } } => Some(format!("verify-{file}")),
///         _ => None,
///     }
/// }
/// let old = Verdict::Unverifiable { why: Mismatch::Semantics { file: 9, here: 10 } };
/// assert_eq!(other_verifier(&old).as_deref(), Some("verify-9"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mismatch {
    /// The file format has another version.
    Format {
        /// Version of the file.
        file: u32,
        /// Version of this program.
        here: u32,
    },
    /// The engine has other semantics.
    Semantics {
        /// Semantics of the file.
        file: u32,
        /// Semantics of this program.
        here: u32,
    },
    /// The file belongs to another game, or to another version of its rules.
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

    /// The verdict as one word, for tools.
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

    /// Number of ticks played, or 0 if the verdict does not contain this number.
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

    /// Hash of the last state played, if the verdict contains it.
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
                write!(f, "diverged: different at tick {first_different}, the start")
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
