//! 128-bit state hash.
//!
//! XXH3-128 detects accidental differences, not forgery. Where a collision could help an attacker (a cache key, a
//! signature), use BLAKE3 or SHA-256.

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

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;

    #[test]
    fn it_is_shown_in_32_digits() {
        assert_eq!(alloc::format!("{}", StateHash(0xab)), "000000000000000000000000000000ab");
    }

    /// The expected values come from the reference implementation in C, xxHash 0.8.
    #[test]
    fn digests_of_all_lengths_are_those_of_the_reference() {
        let byte = |i: u32| u8::try_from((i * i + 7 * i + 13 * (i >> 8)) & 0xff).expect("masked");
        let bytes: Vec<u8> = (0..4096).map(byte).collect();
        // The lengths include those at which the algorithm changes. They end at many positions within the stripes and
        // blocks of XXH3.
        let lengths = (0..600).chain((600..4096).step_by(61));
        let all = StateHash::of_digests(lengths.map(|length| StateHash::of_bytes(&bytes[..length])));
        assert_eq!(all, StateHash(0x895a_7f64_9a6f_6e88_c604_0708_9b0a_5435));
        let known = [
            (0, 0x99aa_06d3_0147_98d8_6001_c324_468d_497f),
            (240, 0x7900_2818_6011_dfbd_c75f_5f21_7aea_b9c9),
            (241, 0x644d_48e8_ee0b_f9bb_2d68_73b1_28d3_f478),
            (4095, 0x92af_cdf9_4a3a_b5bc_921c_22ab_aeaa_06c5),
        ];
        for (length, digest) in known {
            assert_eq!(StateHash::of_bytes(&bytes[..length]), StateHash(digest), "{length} bytes");
        }
    }
}
