//! 128-bit state hash.
//!
//! XXH3-128 detects accidental differences, not forgery. Where a collision could help an attacker (a cache key, a
//! signature), use BLAKE3 or SHA-256.

#[cfg(test)]
mod tests;

mod envelope;

use core::fmt;

use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

pub(crate) use envelope::{Envelope, EnvelopeError};

/// A 128-bit digest, shown as 32 hexadecimal digits by `Display` and by `Debug`.
///
/// ```
/// # use lockstep2d::hash::StateHash;
/// assert_eq!(format!("{:?}", StateHash(0xab)), "000000000000000000000000000000ab");
/// ```
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct StateHash(pub u128);

impl StateHash {
    /// Returns the XXH3-128 digest of bytes.
    #[must_use]
    pub fn of_bytes(bytes: &[u8]) -> Self {
        StateHash(twox_hash::XxHash3_128::oneshot(bytes))
    }

    /// Returns the digest of a value's canonical encoding.
    #[must_use]
    pub fn of<T: Serialize + ?Sized>(value: &T) -> Self {
        Self::of_bytes(&crate::codec::encode(value))
    }

    /// Returns the digest of a sequence of digests, in order.
    #[must_use]
    pub fn of_digests(digests: impl IntoIterator<Item = StateHash>) -> Self {
        let digests = digests.into_iter();
        // The buffer has room for 32 digests without an allocation, which is enough for small worlds.
        let mut bytes = SmallVec::<[u8; 512]>::with_capacity(digests.size_hint().0 * size_of::<Self>());
        digests.for_each(|digest| bytes.extend_from_slice(&digest.bytes()));
        Self::of_bytes(&bytes)
    }

    /// Bytes of the digest as input of another digest. They are equal on every machine.
    #[cfg(not(lockstep2d_broken))]
    fn bytes(self) -> [u8; 16] {
        self.0.to_le_bytes()
    }

    /// A deliberate mistake for the canary `tests/cross/run broken`: these bytes depend on the byte order and on the
    /// width of `usize`. They are right on 64-bit little-endian targets.
    #[cfg(lockstep2d_broken)]
    #[allow(clippy::cast_possible_truncation, reason = "a deliberate mistake")]
    fn bytes(self) -> alloc::vec::Vec<u8> {
        let halves = [self.0 as usize, (self.0 >> 64) as usize];
        halves.into_iter().flat_map(usize::to_ne_bytes).collect()
    }
}

impl fmt::Debug for StateHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl fmt::Display for StateHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}
