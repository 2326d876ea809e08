//! [`LineError`]: why a file of keys or signatures cannot be read.

use std::fmt;

use super::signatures::SIGNATURES_MAX;

/// Error: a line of a file of keys or signatures cannot be read.
///
/// ```
/// use lockstep2d_cli::signature::{AllowedKeys, Flaw, LineError};
/// // The file of an admin, with a mistake in its second line.
/// let keys = "# players\nalice\n".parse::<AllowedKeys>();
/// assert_eq!(keys.err(), Some(LineError { line: 2, flaw: Flaw::NoAllowedKey }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineError {
    /// Number of the line, from 1.
    pub line: u64,
    /// The flaw of the line.
    pub flaw: Flaw,
}

/// Flaw of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// The line does not have the form of a signature: `lockstep2d signature 1 KEY SIGNATURE`.
    NoSignature,
    /// The line does not have the form of a secret key: `lockstep2d secret key 1 SEED`.
    NoSecretKey,
    /// The line does not have the form of an allowed key: `KEY NAME`.
    NoAllowedKey,
    /// The digits are not a public key of Ed25519, or are a weak public key.
    InvalidKey,
    /// An earlier line has the same key.
    KeyTwice,
    /// The name is longer than 64 bytes or has control characters.
    Name,
    /// The line does not end with a line feed.
    Unfinished,
    /// There are more signatures than [`SIGNATURES_MAX`].
    TooMany,
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Flaw::NoSignature => {
                write!(
                    f,
                    "not \"lockstep2d signature 1\", a public key (64 hexadecimal digits) and a signature (128 digits)"
                )
            }
            Flaw::NoSecretKey => write!(f, "not \"lockstep2d secret key 1\" and 64 hexadecimal digits"),
            Flaw::NoAllowedKey => write!(f, "not a public key of 64 hexadecimal digits, a space and a name"),
            Flaw::InvalidKey => write!(f, "not a valid public key"),
            Flaw::KeyTwice => write!(f, "a second line of the same key"),
            Flaw::Name => write!(f, "the name is longer than 64 bytes or has control characters"),
            Flaw::Unfinished => write!(f, "the line does not end with a line feed"),
            Flaw::TooMany => write!(f, "more than {SIGNATURES_MAX} signatures"),
        }
    }
}

impl fmt::Display for LineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.flaw)
    }
}

impl std::error::Error for LineError {}
