use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt;

use super::finding::Finding;
use crate::lockstep::InputError;
use crate::replay::{RecordError, Verdict};

/// A fault of a game, with a replay that reproduces it.
///
/// ```
/// # use lockstep2d::{hash::StateHash, lockstep::{Game, RulesId, SetupError}};
/// use lockstep2d::check::{CheckOptions, Failure, Fault, Variant, check, check_replay};
/// /// A game in which each press scores one point more than the press in the tick before.
/// #[derive(Default)]
/// struct Combo { score: u32, row: u32 }
/// impl Game for Combo {
///     // `row` is missing from the save.
///     fn save(&self) -> u32 { self.score }
///     fn load(&mut self, save: &u32) { self.score = *save; }
///     fn step(&mut self, inputs: &[bool]) {
///         self.row = if inputs[0] { self.row + 1 } else { 0 };
///         self.score += self.row;
///     }
/// #     type Setup = ();
/// #     type Input = bool;
/// #     type Save = u32;
/// #     const RULES: RulesId = RulesId { name: "combo", version: 1 };
/// #     fn new(_: &()) -> Result<Self, SetupError> { Ok(Combo::default()) }
/// #     fn players(&self) -> u32 { 1 }
/// #     fn tick_rate(&self) -> u32 { 60 }
/// #     fn state_hash(&self) -> StateHash { StateHash::of(&self.score) }
/// #     fn work(&self, _: &[bool]) -> u64 { 1 }
///     // ...
/// }
/// let inputs: Vec<_> = (0..60).map(|tick| vec![tick > 20]).collect();
/// let options = CheckOptions::default().only(&[Variant::Reloaded]);
/// let error = check::<Combo>(&(), &inputs, &options).expect_err("a part of the state is not saved");
/// let failure: &Failure = error.failure().expect("a fault of the game");
/// assert_eq!((&failure.finding.variant, &failure.finding.fault), (&Variant::Reloaded, &Fault::Hash));
/// // Two presses in a row are enough, and the replay reproduces the fault.
/// assert_eq!(failure.ticks, 2);
/// assert!(check_replay::<Combo>(&failure.replay, &options).is_err());
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct Failure {
    /// The finding in the original log.
    pub finding: Finding,
    /// The finding in the minimised replay.
    pub minimised: Finding,
    /// Replay file with the fewest ticks and inputs that the search found within the budget.
    /// [`check_replay`](super::check_replay) with the options of the check, but from tick 0, reproduces the failure,
    /// unless the failure is random or a replay cannot represent the setup, inputs or claims. If the failure is random,
    /// the checkpoints of the replay may be wrong too.
    pub replay: Vec<u8>,
    /// Number of ticks in the replay.
    pub ticks: u64,
    /// Number of runs of the replay that failed, and number of all runs. Random failures do not occur in every run.
    pub failed: (u32, u32),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Failure { finding, minimised, ticks, failed: (failed, of), .. } = self;
        write!(f, "{finding}\na replay of {ticks} ticks fails in this way {failed} times out of {of}")?;
        if minimised != finding { write!(f, ":\n{minimised}") } else { Ok(()) }
    }
}

/// Prints the [`Display`](fmt::Display) text, for tests that unwrap.
impl fmt::Debug for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// Reason why a check of a log of inputs did not succeed.
///
/// ```
/// use lockstep2d::check::{CheckError, CheckOptions, check_replay};
/// use lockstep2d::{lockstep::Sandbox, replay::Verdict};
/// // A tool distinguishes a bad file from a game with a fault.
/// match check_replay::<Sandbox>(b"not a replay", &CheckOptions::default()) {
///     Err(CheckError::Replay(Verdict::Malformed { .. })) => {}
///     Err(CheckError::Failed(failure)) => panic!("the game has a fault: {failure}"),
///     other => panic!("{other:?}"),
/// }
/// ```
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

/// Prints the [`Display`](fmt::Display) text, for tests that unwrap.
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
