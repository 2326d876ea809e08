//! [`Finding`]: what is wrong, where, and at which tick.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use serde::Serialize;

use super::options::Way;
use crate::inspect::{Difference, differences, fields};
use crate::replay::{RecordError, Verdict};
use crate::world::Phase;

/// What is wrong with a way of playing.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// The hash after the tick is not that of the straight run.
    Hash,
    /// The hash is, but a phase of the physics step has left something else behind.
    Phase,
    /// Loading a save gives a state with another hash than the one that was saved.
    Loaded,
    /// A save that was decoded is encoded to other bytes.
    Encoding,
    /// A save that was loaded is saved as other bytes.
    SavedAgain,
    /// The bytes of a save are not read.
    Unreadable {
        /// Why.
        why: String,
    },
    /// The setup starts a game once, and not another time.
    Refused {
        /// Why.
        why: String,
    },
    /// The same question, asked twice, has two answers: of `state_hash`, `work`, `claims` or `save`.
    Answers {
        /// What was asked for.
        of: &'static str,
    },
    /// Two states have the same hash and, with the same inputs, different futures.
    Unhashed,
    /// The recording of the game does not verify.
    Verdict(Verdict),
    /// The game cannot be recorded to its end.
    Unrecordable(RecordError),
}

/// The inputs with which a game was played before it was rolled back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guess {
    /// The right ones.
    Right,
    /// Nothing pressed.
    Default,
    /// Those of the tick before, held.
    Held,
}

impl Guess {
    pub(super) const ALL: [Guess; 3] = [Guess::Right, Guess::Default, Guess::Held];
}

/// What is wrong, where, and at which tick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How it was played.
    pub way: Way,
    /// What is wrong.
    pub fault: Fault,
    /// After how many ticks.
    pub tick: u64,
    /// How many ticks had been played when it showed: more, if the game had been rolled back.
    pub played: u64,
    /// The phase of the physics step after which something differs first, if phases are compared; `None` also if
    /// something differed before the step.
    pub phase: Option<Phase>,
    /// By how many ticks it had been rolled back, and after which guess.
    pub rollback: Option<(u32, Guess)>,
    /// What differs: the straight run, or what was saved, has `a`, and this way, or what came back, has `b`. Empty if the
    /// states cannot be had or have the same saves: then what differs is not saved.
    pub differences: Vec<Difference>,
}

impl Finding {
    pub(super) fn new(way: Way, fault: Fault, tick: u64) -> Self {
        Finding { way, fault, tick, played: tick, phase: None, rollback: None, differences: Vec::new() }
    }

    /// With what differs in two saves.
    pub(super) fn with_saves<S: Serialize>(self, a: &S, b: &S) -> Self {
        let found = fields(a).ok().zip(fields(b).ok()).map(|(a, b)| differences(&a, &b));
        Finding { differences: found.unwrap_or_default(), ..self }
    }

    /// What it usually is.
    #[must_use]
    pub const fn hint(&self) -> &'static str {
        match (self.way, &self.fault) {
            (Way::Again, _) | (_, Fault::Refused { .. }) => {
                "a HashMap or HashSet that is iterated, a static or thread-local, an address, a clock, or memory that is \
                 not initialised"
            }
            (_, Fault::Answers { .. }) | (Way::Asked | Way::Unasked, Fault::Hash) => {
                "something that changes when it is asked for: a Cell, a static, or a HashMap in what is answered"
            }
            (_, Fault::Unhashed) => "a field that `state_hash` leaves out and `step` reads",
            (_, Fault::Encoding | Fault::SavedAgain) => {
                "a HashMap or HashSet in the save, a `load` that does not bring all of it back, or a Serialize \
                 and a Deserialize that are no inverses"
            }
            (_, Fault::Unreadable { .. }) => "a Serialize and a Deserialize that do not fit each other",
            (Way::Reloaded, _) => "a field that is missing from `Save`, or that `load` does not bring back",
            (Way::RolledBack, _) => {
                "a cache or a field that `load` leaves as it was, saved or not: it is right in a new game and wrong in one that \
                 has lived"
            }
            (_, Fault::Verdict(Verdict::LimitExceeded { .. })) => "`work` answers more than the limits allow",
            (_, Fault::Verdict(_) | Fault::Unrecordable(_)) => {
                "claims with the same name or that change, or a setup or input that does not survive its encoding"
            }
            _ => {
                "the game depends on what is no state of its world, such as the order in which `contacts` come, or on a \
                  world of its own beside it; if not, it is a fault of the engine"
            }
        }
    }
}

/// Most differences that are shown.
const SHOWN: usize = 8;

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Finding { way, fault, tick, .. } = self;
        write!(f, "{way}")?;
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
            write!(f, "\n    the saves are the same: what differs is not saved")?;
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
            Fault::Hash => write!(f, "the state hash is not that of the straight run"),
            Fault::Phase => write!(f, "something else was left behind than in the straight run"),
            Fault::Loaded => {
                write!(f, "the state that was loaded has not the hash of the one that was saved")
            }
            Fault::Encoding => write!(f, "the save has other bytes after it was decoded and encoded"),
            Fault::SavedAgain => write!(f, "the state that was loaded is saved as other bytes"),
            Fault::Unreadable { why } => write!(f, "the bytes of the save are not read: {why}"),
            Fault::Refused { why } => write!(f, "the setup starts no game any more: {why}"),
            Fault::Answers { of } => write!(f, "`{of}` gives two answers to the same question"),
            Fault::Unhashed => {
                write!(
                    f,
                    "a state with the same hash and another save has come to another hash with the same inputs"
                )
            }
            Fault::Verdict(verdict) => write!(f, "the recording does not verify: {verdict}"),
            Fault::Unrecordable(error) => write!(f, "the recording cannot be finished: {error}"),
        }
    }
}
