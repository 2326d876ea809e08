//! The 128-bit state hash.
//!
//! XXH3-128 is fast and well mixed but not cryptographic: it finds accidents, not forgers. Where someone gains
//! by a collision (a cache key, a signature) hash the bytes with BLAKE3 or SHA-256 instead.

use alloc::vec::Vec;
use core::fmt;

use serde::{Deserialize, Serialize};

/// A 128-bit digest, shown as 32 hexadecimal digits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct StateHash(pub u128);

impl StateHash {
    /// The XXH3-128 digest of some bytes.
    #[must_use]
    pub fn of_bytes(bytes: &[u8]) -> Self {
        StateHash(twox_hash::XxHash3_128::oneshot(bytes))
    }

    /// The digest of a value's canonical bytes.
    #[must_use]
    pub fn of<T: Serialize + ?Sized>(value: &T) -> Self {
        Self::of_bytes(&crate::codec::encode(value))
    }

    /// The digest of a sequence of digests, in order.
    #[must_use]
    pub fn of_digests(digests: impl IntoIterator<Item = StateHash>) -> Self {
        let bytes: Vec<u8> = digests.into_iter().flat_map(|digest| digest.0.to_le_bytes()).collect();
        Self::of_bytes(&bytes)
    }
}

impl fmt::Display for StateHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}
