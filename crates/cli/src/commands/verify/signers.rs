//! [`Signers`]: checks the signatures of a file (`--keys`).

use std::fmt;
use std::io;
use std::path::Path;

use serde::Serialize;

use super::tasks;
use crate::commands::sign;
use crate::error::CommandError;
use crate::signature::{AllowedKeys, Check, GameDigest, path_beside};

pub(super) struct Signers {
    keys: AllowedKeys,
    /// Number of different names that have to sign each file.
    required: usize,
}

/// Result of the signature check, as fields of the JSON line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Signed {
    signature: State,
    /// Names with a valid signature.
    signed_by: Vec<String>,
    /// Names with a signature that is not valid for this game.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    forged: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    signature_error: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum State {
    /// Enough names have signed, and no signature is forged.
    Valid,
    /// Too few names have signed.
    Missing,
    /// A signature by an allowed key is not valid for this game.
    Forged,
    /// The signature file cannot be parsed, is too large, or is not a regular file.
    Malformed,
}

/// Maximum size of the file of public keys in bytes. Enough for 100 000 keys with names of the maximum length.
const KEYS_BYTES_MAX: u64 = 16 << 20;

impl Signers {
    /// Reads the public keys. Fails for a file with fewer than `required` names.
    pub(super) fn read(path: &Path, required: usize) -> Result<Self, CommandError> {
        let text = sign::read_text(path, KEYS_BYTES_MAX)?;
        let keys: AllowedKeys = text.parse().map_err(CommandError::line(path))?;
        let names = keys.name_count();
        if names < required {
            return Err(CommandError::Require { required, names });
        }
        Ok(Signers { keys, required })
    }

    /// Checks the signature file beside a replay. `game` is the digest of the replay. If it is `None`, for example
    /// because the replay is damaged, all signatures count as missing. Fails for the standard input, and if there is a
    /// signature file that cannot be read.
    pub(super) fn check(&self, replay: &Path, game: Option<&GameDigest>) -> Result<Signed, CommandError> {
        if replay.as_os_str() == tasks::INPUT {
            return Err(CommandError::InputSignatures);
        }
        let beside = path_beside(replay);
        let signatures = match sign::read_signatures(&beside) {
            Ok(signatures) => signatures,
            Err(CommandError::Read { error, .. }) if error.kind() == io::ErrorKind::NotFound => {
                return Ok(self.signed(Check::default()));
            }
            Err(error @ (CommandError::Line { .. } | CommandError::NoText { .. })) => {
                return Ok(Signed::malformed(&error));
            }
            // The error is reported with the path of the replay, so its text names the signature file.
            Err(CommandError::Read { error, .. }) => {
                let why = format!("{}: {error}", beside.display());
                return Err(CommandError::read(replay)(io::Error::new(error.kind(), why)));
            }
            Err(error) => return Err(error),
        };
        Ok(self.signed(game.map(|game| self.keys.check(&signatures, game)).unwrap_or_default()))
    }

    fn signed(&self, check: Check) -> Signed {
        let Check { signed_by, forged } = check;
        let signature = match () {
            () if !forged.is_empty() => State::Forged,
            () if signed_by.len() < self.required => State::Missing,
            () => State::Valid,
        };
        Signed { signature, signed_by, forged, signature_error: None }
    }
}

impl Signed {
    fn malformed(error: &CommandError) -> Self {
        Signed {
            signature: State::Malformed,
            signed_by: Vec::new(),
            forged: Vec::new(),
            signature_error: Some(error.to_string()),
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        self.signature == State::Valid
    }
}

impl fmt::Display for Signed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let signed_by = self.signed_by.join(", ");
        match (self.signature, &self.signature_error) {
            (State::Valid, _) => write!(f, "signed by {signed_by}"),
            (State::Missing, _) if self.signed_by.is_empty() => write!(f, "not signed"),
            (State::Missing, _) => write!(f, "signed only by {signed_by}"),
            (State::Forged, _) => write!(f, "forged signature of {}", self.forged.join(", ")),
            (State::Malformed, error) => {
                write!(f, "malformed signatures: {}", error.as_deref().unwrap_or_default())
            }
        }
    }
}
