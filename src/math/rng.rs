//! Pseudo-random numbers that are part of the simulated state.
//!
//! PCG-XSH-RR 64/32 (M. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random
//! Number Generation", 2014): `s <- 6364136223846793005 s + i`, with an output permutation of the old `s`. The state
//! has 16 bytes, half that of xoshiro256**, and the period is 2^64. Not cryptographically secure.
//!
//! Bounded numbers are unbiased (D. Lemire, "Fast Random Integer Generation in an Interval", 2019). A bounded number
//! may take several draws. Their count depends only on the state and the bound.

use serde::{Deserialize, Serialize};

use super::angle::Angle;
use super::formats::Fx;

/// A random number generator. Store it in the game state, so that rollbacks restore it and the state hash covers it.
///
/// ```
/// use lockstep2d::{fx, math::Rng};
/// let mut rng = Rng::new(2024);
/// let mut again = rng.clone();
/// let height = rng.range(fx!(1), fx!(2.5));
/// assert!(fx!(1) <= height && height < fx!(2.5));
/// assert_eq!(again.range(fx!(1), fx!(2.5)), height);
/// ```
// Not `Copy`: an accidental copy would repeat numbers.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Rng {
    state: u64,
    increment: u64,
}

impl Rng {
    /// A generator on the default stream of the reference implementation.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self::with_stream(seed, 721_347_520_444_481_703)
    }

    /// A generator on one of 2^63 streams. The top bit of `stream` is ignored.
    #[must_use]
    pub const fn with_stream(seed: u64, stream: u64) -> Self {
        let mut rng = Rng { state: 0, increment: (stream << 1) | 1 };
        rng.step();
        rng.state = rng.state.wrapping_add(seed);
        rng.step();
        rng
    }

    /// A uniform 32-bit number.
    #[inline]
    pub const fn next_u32(&mut self) -> u32 {
        let state = self.state;
        self.step();
        low_half(((state >> 18) ^ state) >> 27).rotate_right((state >> 59) as u32)
    }

    /// A uniform 64-bit number from two 32-bit draws, the upper half first.
    #[inline]
    pub const fn next_u64(&mut self) -> u64 {
        let high = self.next_u32() as u64;
        high << 32 | self.next_u32() as u64
    }

    /// A uniform number from 0 to below `bound`; 0 for the bound 0.
    #[inline]
    pub const fn below(&mut self, bound: u32) -> u32 {
        let mut product = self.next_u32() as u64 * bound as u64;
        if low_half(product) < bound {
            // Rejects products whose lower half is below `2^32 mod bound`. With these products, some results would be
            // likelier than others.
            let unfair = bound.wrapping_neg() % bound;
            while low_half(product) < unfair {
                product = self.next_u32() as u64 * bound as u64;
            }
        }
        (product >> 32) as u32
    }

    /// [`below`](Self::below) with a 64-bit bound.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "the halves of a product")]
    pub const fn below_u64(&mut self, bound: u64) -> u64 {
        let mut product = self.next_u64() as u128 * bound as u128;
        if (product as u64) < bound {
            let unfair = bound.wrapping_neg() % bound;
            while (product as u64) < unfair {
                product = self.next_u64() as u128 * bound as u128;
            }
        }
        (product >> 64) as u64
    }

    /// A uniform number from `low` to below `high`, in steps of 2^-32; `low` if the range is empty.
    #[inline]
    pub const fn range(&mut self, low: Fx, high: Fx) -> Fx {
        let (low, high) = (low.to_bits(), high.to_bits());
        let span = if low < high { low.abs_diff(high) } else { 0 };
        // Intermediate values wrap if the span exceeds half the range of `Fx`.
        Fx::from_bits(low.wrapping_add_unsigned(self.below_u64(span)))
    }

    /// A uniform angle.
    #[inline]
    pub const fn angle(&mut self) -> Angle {
        Angle::from_bits(self.next_u32())
    }

    /// True with probability `numerator / denominator`; false for a denominator of 0.
    #[inline]
    pub const fn chance(&mut self, numerator: u32, denominator: u32) -> bool {
        self.below(denominator) < numerator && denominator != 0
    }

    /// Shuffles the items (Fisher and Yates).
    #[expect(clippy::cast_possible_truncation, reason = "below an index, hence an index")]
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            // 64 bits, so that the draws do not depend on the pointer width.
            let chosen = self.below_u64(last as u64 + 1) as usize;
            items.swap(last, chosen);
        }
    }

    /// Advances the state. A deserialized increment may be even, which would shorten the period, so bit 0 of the
    /// increment is set here.
    #[inline]
    const fn step(&mut self) {
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(self.increment | 1);
    }
}

#[inline]
#[expect(clippy::cast_possible_truncation, reason = "only the lower half is wanted")]
const fn low_half(x: u64) -> u32 {
    x as u32
}

#[cfg(test)]
mod tests;
