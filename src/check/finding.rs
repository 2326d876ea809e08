use alloc::boxed::Box;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use serde::Serialize;

use super::options::Variant;
use crate::inspect::{Difference, differences, fields};
use crate::replay::{RecordError, Verdict};
use crate::world::Phase;

/// Kind of a fault that a check finds while it plays a [`Variant`].
///
/// ```
/// use lockstep2d::check::Fault;
/// // The most frequent causes of a fault.
/// let cause = |fault: &Fault| match fault {
///     Fault::Hash => "a field that `save` or `load` leaves out, a clock, a hash map",
///     Fault::Unhashed => "a field that `state_hash` leaves out",
///     _ => "see docs/FUZZING.md",
/// };
/// assert!(cause(&Fault::Unhashed).contains("state_hash"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// The hash after the tick differs from that of the reference run.
    Hash,
    /// The hash agrees, but the digest of a phase of the physics step differs.
    Phase,
    /// The state that was loaded from a save has another hash than the saved state.
    Loaded,
    /// Decoding a save and encoding it again gives different bytes.
    Encoding,
    /// Saving a loaded state gives different bytes.
    SavedAgain,
    /// The bytes of a save cannot be decoded.
    Unreadable {
        /// Decoding error.
        why: String,
    },
    /// The setup started a game the first time, but a later attempt to start a game failed.
    Refused {
        /// Reason given by the game.
        why: String,
    },
    /// Two calls in succession of `state_hash`, `work`, `claims` or `save` return different results, or the claims at
    /// the end of two runs differ.
    Answers {
        /// Name of the function.
        of: &'static str,
    },
    /// Two states have the same hash but different futures under the same inputs.
    Unhashed,
    /// The recording fails verification, or the reference run exceeds a limit.
    Verdict(Verdict),
    /// The game cannot be recorded to its end.
    Unrecordable(RecordError),
}

/// The inputs with which a game first plays some ticks. It is then rolled back and plays these ticks with the actual
/// inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guess {
    /// The actual inputs.
    Right,
    /// The default input for every player.
    Default,
    /// In each of these ticks, the inputs of the last tick before them.
    Held,
}

impl Guess {
    pub(super) const ALL: [Guess; 3] = [Guess::Right, Guess::Default, Guess::Held];
}

/// A fault, its variant and its tick.
///
/// ```
/// use lockstep2d::check::{Fault, Finding, Guess, Variant};
/// let finding = Finding {
///     variant: Variant::RolledBack,
///     fault: Fault::Hash,
///     tick: 40,
///     played: 43,
///     phase: None,
///     rollback: Some((3, Guess::Held)),
///     differences: vec![],
/// };
/// // The text that a failed test prints.
/// let text = finding.to_string();
/// assert!(text.contains("40") && text.contains('3'), "{text}");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The variant in which the fault was found. [`Variant::Recorded`] if the reference run exceeds a limit.
    pub variant: Variant,
    /// The fault.
    pub fault: Fault,
    /// Number of ticks after which the state has the fault.
    pub tick: u64,
    /// Number of ticks played when the fault was detected. May exceed `tick` for [`Variant::RolledBack`] and
    /// [`Variant::ByteSwapped`]. Includes a tick that exceeded a limit or could not be recorded.
    pub played: u64,
    /// The first phase whose digest differs, if phases are compared. `None` also if the states differed before the
    /// step.
    pub phase: Option<Phase>,
    /// Depth of the rollback in ticks, and the predicted inputs that were played before it.
    pub rollback: Option<(u32, Guess)>,
    /// The fields that differ. `a` is the reference run or the saved state, `b` is the variant or the loaded state.
    /// Empty if the states are not available, or if their saves are equal.
    pub differences: Vec<Difference>,
}

impl Finding {
    pub(super) fn new(variant: Variant, fault: Fault, tick: u64) -> Self {
        Finding { variant, fault, tick, played: tick, phase: None, rollback: None, differences: Vec::new() }
    }

    /// A fault in the tick that follows `tick` ticks, such as an exceeded limit. The inputs of that tick are needed to
    /// reproduce the fault.
    pub(super) fn in_next(variant: Variant, fault: Fault, tick: u64) -> Box<Self> {
        Box::new(Finding { played: tick + 1, ..Finding::new(variant, fault, tick) })
    }

    pub(super) fn with_saves<S: Serialize>(self, a: &S, b: &S) -> Self {
        let found = fields(a).ok().zip(fields(b).ok()).map(|(a, b)| differences(&a, &b));
        Finding { differences: found.unwrap_or_default(), ..self }
    }

    /// The most frequent cause of the fault.
    #[must_use]
    pub const fn hint(&self) -> &'static str {
        match (self.variant, &self.fault) {
            (Variant::Again, _) | (_, Fault::Refused { .. }) => {
                "a HashMap or HashSet that is iterated, a static or thread-local, an address, a clock, or \
                 uninitialised memory"
            }
            (_, Fault::Answers { .. }) | (Variant::HashPolled | Variant::HashUnpolled, Fault::Hash) => {
                "state that changes when it is read: a Cell, a static, or a HashMap in the result"
            }
            (_, Fault::Unhashed) => "a field that `state_hash` leaves out and `step` reads",
            (_, Fault::Encoding | Fault::SavedAgain) => {
                "a HashMap or HashSet in the save, a `load` that does not restore all of it, or a Serialize \
                 and a Deserialize that are not inverses"
            }
            (_, Fault::Unreadable { .. }) => "a Serialize and a Deserialize that do not match",
            (Variant::Reloaded, _) => "a field that is missing from `Save`, or that `load` does not restore",
            (Variant::RolledBack, _) => {
                "a cache or a field that `load` does not restore, saved or not: it is right in a new game and \
                 stale in a game that has already run"
            }
            (_, Fault::Verdict(Verdict::LimitExceeded { .. })) => "`work` returns more than the limits allow",
            (_, Fault::Verdict(_) | Fault::Unrecordable(_)) | (Variant::Recorded, _) => {
                "claims that share a name or change between calls, or a setup or input that does not survive \
                 its encoding"
            }
            _ => {
                "the game depends on data that is not state of its world, such as the order of `contacts`, or on a \
                 second world of its own; if not, it is a fault of the engine"
            }
        }
    }
}

const SHOWN: usize = 8;

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Finding { variant, fault, tick, .. } = self;
        match fault {
            Fault::Verdict(Verdict::LimitExceeded { .. }) => write!(f, "played within the limits")?,
            _ => write!(f, "{variant}")?,
        }
        if let Some((depth, guess)) = self.rollback {
            write!(f, " by {depth} {}", if depth == 1 { "tick" } else { "ticks" })?;
            f.write_str(match guess {
                Guess::Right => "",
                Guess::Default => " after guessing default inputs",
                Guess::Held => " after guessing that inputs are held",
            })?;
        }
        write!(f, ": after tick {tick}{} {fault}", InPhase(self.phase))?;
        for difference in self.differences.iter().take(SHOWN) {
            write!(f, "\n    {difference}")?;
        }
        match self.differences.len().saturating_sub(SHOWN) {
            0 => {}
            more => write!(f, "\n    and {more} more")?,
        }
        if self.differences.is_empty() && matches!(fault, Fault::Hash | Fault::Loaded) {
            write!(f, "\n    the saves are equal: the difference is in state that is not saved")?;
        }
        write!(f, "\nusually {}", self.hint())
    }
}

struct InPhase(Option<Phase>);

impl fmt::Display for InPhase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |phase| write!(f, ", phase {phase:?},"))
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::Hash => write!(f, "the state hash differs from the reference run"),
            Fault::Phase => write!(f, "the results differ from the reference run"),
            Fault::Loaded => {
                write!(f, "the loaded state has another hash than the saved state")
            }
            Fault::Encoding => write!(f, "the save has other bytes after decoding and encoding"),
            Fault::SavedAgain => write!(f, "saving the loaded state leads to other bytes"),
            Fault::Unreadable { why } => write!(f, "the save cannot be decoded: {why}"),
            Fault::Refused { why } => write!(f, "the setup can no longer start a game: {why}"),
            Fault::Answers { of } => write!(f, "`{of}` returns different results for the same state"),
            Fault::Unhashed => {
                write!(
                    f,
                    "two states with the same hash but different saves reach different hashes with the same inputs"
                )
            }
            Fault::Verdict(verdict @ Verdict::LimitExceeded { .. }) => verdict.fmt(f),
            Fault::Verdict(verdict) => write!(f, "the recording does not verify: {verdict}"),
            Fault::Unrecordable(error) => write!(f, "the recording cannot be finished: {error}"),
        }
    }
}
