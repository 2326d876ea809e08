//! [`OpenError`]: why a file cannot be shown.

use std::fmt;

use lockstep2d::replay::Verdict;
use lockstep2d::report::EvidenceError;

use super::SourceError;

/// Reason why a file cannot be shown.
///
/// ```
/// use lockstep2d_viewer::{App, OpenError};
///
/// let error = App::default().show_file("notes.txt", b"not a replay".to_vec());
/// assert!(matches!(error, Err(OpenError::File(_))));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OpenError {
    /// No tick of the replay can be played.
    Replay(Verdict),
    /// The file is a replay of another game.
    OtherGame {
        /// Name of the rules of the replay.
        rules: String,
        /// Name of the rules that this viewer shows.
        shown: &'static str,
    },
    /// The file is damaged or of an unknown kind.
    File(EvidenceError),
    /// The divergence report contains no replay.
    EmptyReport,
    /// The file cannot be compared with the file that is already shown, because the files have no tick in common.
    NoCommonTick {
        /// Name of the file that is shown.
        first: String,
    },
    /// A tick of a file cannot be shown.
    Tick(SourceError),
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OpenError::Replay(verdict) => verdict.fmt(f),
            OpenError::OtherGame { rules, shown } => {
                write!(f, "a replay of {rules:?}: this viewer shows {shown:?}")
            }
            OpenError::File(error) => error.fmt(f),
            OpenError::NoCommonTick { first } => write!(f, "no tick is both in this file and in {first}"),
            OpenError::Tick(error) => error.fmt(f),
            OpenError::EmptyReport => write!(f, "the report contains no replay: there is nothing to play"),
        }
    }
}

impl std::error::Error for OpenError {}
