//! [`SecretKey`] and [`PublicKey`] of Ed25519.

use std::fmt;
use std::str::FromStr;

use ed25519_dalek::{Signer, SigningKey, VerifyingKey};

use super::hex::{self, Hex};
use super::line_error::{Flaw, LineError};
use super::signatures::{Signature, message};
use crate::identity::GameDigest;

/// Beginning of the line of a secret key file.
const PREFIX: &str = "lockstep2d secret key 1 ";

/// A key to sign games with. `str::parse` reads the text that [`SecretKey::text`] returns.
///
/// The module [`signature`](crate::signature) has an example.
pub struct SecretKey(SigningKey);

/// Error: the system provides no random numbers.
#[derive(Debug)]
pub struct RandomError(getrandom::Error);

impl SecretKey {
    /// Makes a new key from the random numbers of the operating system.
    ///
    /// # Errors
    /// [`RandomError`] if the system provides none.
    pub fn generate() -> Result<Self, RandomError> {
        let mut seed = [0; 32];
        getrandom::fill(&mut seed).map_err(RandomError)?;
        Ok(SecretKey(SigningKey::from_bytes(&seed)))
    }

    /// The public key, with which others verify signatures by this key.
    #[must_use]
    pub fn public_key(&self) -> PublicKey {
        PublicKey(self.0.verifying_key().to_bytes())
    }

    /// Signs a game. Signing it again gives the same signature.
    #[must_use]
    pub fn sign(&self, game: &GameDigest) -> Signature {
        Signature { key: self.public_key(), bytes: self.0.sign(&message(game)).to_bytes() }
    }

    /// The text of a secret key file. Anyone who reads it can sign in the name of its owner.
    #[must_use]
    pub fn text(&self) -> String {
        format!("{PREFIX}{}\n", Hex(self.0.as_bytes()))
    }
}

/// The output omits the secret.
impl fmt::Debug for SecretKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SecretKey of {}", self.public_key())
    }
}

impl FromStr for SecretKey {
    type Err = LineError;

    /// Reads the text of a secret key file. White space at the end is ignored.
    fn from_str(text: &str) -> Result<Self, LineError> {
        let seed = text.trim_end().strip_prefix(PREFIX).and_then(hex::parse);
        let seed = seed.ok_or(LineError { line: 1, flaw: Flaw::NoSecretKey })?;
        Ok(SecretKey(SigningKey::from_bytes(&seed)))
    }
}

/// A public key: 32 bytes, shown as 64 hexadecimal digits. The type does not check that the bytes are a valid key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PublicKey(pub [u8; 32]);

impl PublicKey {
    /// Decodes the key. Returns `None` if it is invalid, or if it is a weak key, for which anyone can forge signatures.
    pub(super) fn decode(self) -> Option<VerifyingKey> {
        VerifyingKey::from_bytes(&self.0).ok().filter(|key| !key.is_weak())
    }
}

impl fmt::Display for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Hex(&self.0).fmt(f)
    }
}

impl fmt::Display for RandomError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the system has no random numbers: {}", self.0)
    }
}

impl std::error::Error for RandomError {}
