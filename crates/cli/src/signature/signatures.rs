//! [`Signatures`]: the contents of a signature file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::hex::{self, Hex};
use super::key::PublicKey;
use super::line_error::{Flaw, LineError};
use crate::identity::GameDigest;

/// Maximum number of signatures in a file.
pub const SIGNATURES_MAX: usize = 256;

/// Maximum size of a signature file in bytes, enough for [`SIGNATURES_MAX`] signatures.
pub const FILE_BYTES_MAX: u64 = 64 << 10;

/// Suffix of a signature file.
const SUFFIX: &str = ".sig";

/// Beginning of every line of a signature file.
const PREFIX: &str = "lockstep2d signature 1 ";

/// Prefix of the signed message, which distinguishes it from other messages signed with the same key.
const DOMAIN: &[u8; 22] = b"lockstep2d signature 1";

/// The signature of one key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signature {
    /// The public key of the signer.
    pub key: PublicKey,
    /// The bytes of the Ed25519 signature.
    pub bytes: [u8; 64],
}

/// The signatures of a replay: at most one by each key, in the order of the lines of the signature file. The text of
/// the file is canonical: each value of this type has exactly one text.
///
/// ```
/// use lockstep2d::{lockstep::Sandbox, replay::{Limits, Recording}};
/// use lockstep2d_cli::signature::{GameDigest, PublicKey, SecretKey, Signature, Signatures};
/// # let replay = Recording::<Sandbox>::start(&Default::default(), 60)?.finish()?;
/// // Both players sign a match.
/// let digest = GameDigest::of_replay::<Sandbox>(&replay, &Limits::default()).expect("a replay");
/// let players = [SecretKey::generate()?, SecretKey::generate()?];
/// let mut signatures = Signatures::default();
/// for player in &players {
///     let signature: Signature = player.sign(&digest);
///     signatures.add(signature)?;
/// }
/// // The keys of the signatures in the file. `AllowedKeys::check` checks whether the signatures are valid.
/// let text = signatures.to_string();
/// let read: Signatures = text.parse()?;
/// let keys: Vec<PublicKey> = read.all().iter().map(|signature| signature.key).collect();
/// assert_eq!(keys, players.map(|player| player.public_key()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Signatures(Vec<Signature>);

/// Path of the signature file of a replay: the path of the replay with `.sig` appended.
#[must_use]
pub fn path_beside(replay: &Path) -> PathBuf {
    let mut path = replay.as_os_str().to_os_string();
    path.push(SUFFIX);
    path.into()
}

pub(super) fn message(game: &GameDigest) -> Vec<u8> {
    [DOMAIN.as_slice(), game.as_bytes()].concat()
}

impl Signatures {
    /// The signatures.
    #[must_use]
    pub fn all(&self) -> &[Signature] {
        &self.0
    }

    /// Adds a signature. An earlier signature by the same key is replaced.
    ///
    /// # Errors
    /// [`Flaw::TooMany`] if there are already [`SIGNATURES_MAX`] signatures by other keys.
    pub fn add(&mut self, signature: Signature) -> Result<(), LineError> {
        if let Some(known) = self.0.iter_mut().find(|known| known.key == signature.key) {
            *known = signature;
        } else if self.0.len() < SIGNATURES_MAX {
            self.0.push(signature);
        } else {
            let line = u64::try_from(SIGNATURES_MAX).unwrap_or(u64::MAX).saturating_add(1);
            return Err(LineError { line, flaw: Flaw::TooMany });
        }
        Ok(())
    }
}

impl FromStr for Signatures {
    type Err = LineError;

    fn from_str(text: &str) -> Result<Self, LineError> {
        let mut signatures = Signatures::default();
        for (line, text) in (1..).zip(text.split_inclusive('\n')) {
            let failed = |flaw| LineError { line, flaw };
            let text = text.strip_suffix('\n').ok_or(failed(Flaw::Unfinished))?;
            let signature = parse_line(text).ok_or(failed(Flaw::NoSignature))?;
            if signatures.0.iter().any(|known| known.key == signature.key) {
                return Err(failed(Flaw::KeyTwice));
            }
            signatures.add(signature)?;
        }
        Ok(signatures)
    }
}

fn parse_line(text: &str) -> Option<Signature> {
    let (key, bytes) = text.strip_prefix(PREFIX)?.split_once(' ')?;
    Some(Signature { key: PublicKey(hex::parse(key)?), bytes: hex::parse(bytes)? })
}

impl fmt::Display for Signatures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0
            .iter()
            .try_for_each(|signature| writeln!(f, "{PREFIX}{} {}", signature.key, Hex(&signature.bytes)))
    }
}
