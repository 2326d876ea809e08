//! [`Exit`]: the outcome of a command as an exit code.

use std::process::ExitCode;

/// The outcome of a command, as an exit code. For several files, it is the worst of their outcomes. The variants are
/// ordered from best to worst.
///
/// ```
/// use lockstep2d_cli::Exit;
/// // The worst of several files decides, as in `verify`.
/// let worst = [Exit::Success, Exit::NoMatch, Exit::Success].into_iter().max();
/// assert_eq!(worst.map(Exit::code), Some(1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Exit {
    /// The command succeeded. Exit code 0.
    Success,
    /// All files match, but a required signature is missing or not valid. Exit code 3.
    Unsigned,
    /// A file does not match, something differs, or a replay is damaged or cannot be played. Exit code 1.
    NoMatch,
    /// Another failure, such as wrong usage or a path that cannot be read or written. Exit code 2.
    Trouble,
}

impl Exit {
    /// Exit code of the process.
    #[must_use]
    pub fn code(self) -> u8 {
        match self {
            Exit::Success => 0,
            Exit::NoMatch => 1,
            Exit::Trouble => 2,
            Exit::Unsigned => 3,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        exit.code().into()
    }
}
