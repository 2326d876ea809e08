//! [`AllowedKeys`]: the public keys that a verifier accepts.

use std::collections::{BTreeMap, BTreeSet};
use std::str::FromStr;

use ed25519_dalek::VerifyingKey;

use super::hex;
use super::key::PublicKey;
use super::line_error::{Flaw, LineError};
use super::signatures::{Signatures, message};
use crate::identity::GameDigest;

/// Maximum length of a name in bytes.
const NAME_BYTES_MAX: usize = 64;

/// Public keys and the names of their owners. A name may have several keys.
///
/// The text has a line for each key: 64 hexadecimal digits, a space, the name. Empty lines and lines that begin with
/// `#` are ignored. The module [`signature`](crate::signature) has an example.
#[derive(Clone, Debug, Default)]
pub struct AllowedKeys(BTreeMap<PublicKey, Owner>);

#[derive(Clone, Debug)]
struct Owner {
    key: VerifyingKey,
    name: String,
}

/// Result of checking the signatures of a game.
///
/// ```
/// use lockstep2d_cli::signature::Check;
/// /// Whether a match counts: both players have signed it, and no signature is forged.
/// fn counts(check: &Check) -> bool {
///     check.forged.is_empty() && ["alice", "bob"].iter().all(|name| check.signed_by.iter().any(|by| by == name))
/// }
/// let check = Check { signed_by: vec!["alice".into(), "bob".into()], forged: vec![] };
/// assert!(counts(&check));
/// assert!(!counts(&Check { forged: vec!["bob".into()], ..check }));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Check {
    /// Names with a valid signature, sorted, each once.
    pub signed_by: Vec<String>,
    /// Names with a signature that is not valid for this game, sorted, each once.
    pub forged: Vec<String>,
}

impl AllowedKeys {
    /// Number of different names.
    #[must_use]
    pub fn name_count(&self) -> usize {
        self.0.values().map(|owner| &owner.name).collect::<BTreeSet<_>>().len()
    }

    /// Checks the signatures of a game. Signatures by keys that are not in the list are ignored.
    #[must_use]
    pub fn check(&self, signatures: &Signatures, game: &GameDigest) -> Check {
        let message = message(game);
        let (mut valid, mut forged) = (BTreeSet::new(), BTreeSet::new());
        for signature in signatures.all() {
            let Some(Owner { key, name }) = self.0.get(&signature.key) else { continue };
            let bytes = ed25519_dalek::Signature::from_bytes(&signature.bytes);
            // With strict verification, nobody can derive a second valid signature from a valid one.
            let is_valid = key.verify_strict(&message, &bytes).is_ok();
            if is_valid { &mut valid } else { &mut forged }.insert(name.clone());
        }
        Check { signed_by: valid.into_iter().collect(), forged: forged.into_iter().collect() }
    }
}

impl FromStr for AllowedKeys {
    type Err = LineError;

    fn from_str(text: &str) -> Result<Self, LineError> {
        let mut keys = BTreeMap::new();
        for (line, text) in (1..).zip(text.lines()) {
            let failed = |flaw| LineError { line, flaw };
            let text = text.trim();
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            let (digits, name) = text.split_once(' ').ok_or(failed(Flaw::NoAllowedKey))?;
            let public = PublicKey(hex::parse(digits).ok_or(failed(Flaw::NoAllowedKey))?);
            let key = public.decode().ok_or(failed(Flaw::InvalidKey))?;
            let name = name.trim().to_string();
            if !is_name(&name) {
                return Err(failed(Flaw::Name));
            }
            if keys.insert(public, Owner { key, name }).is_some() {
                return Err(failed(Flaw::KeyTwice));
            }
        }
        Ok(AllowedKeys(keys))
    }
}

pub(crate) fn is_name(name: &str) -> bool {
    let is_possible = !name.is_empty() && name.trim() == name && name.len() <= NAME_BYTES_MAX;
    is_possible && !name.chars().any(char::is_control)
}
