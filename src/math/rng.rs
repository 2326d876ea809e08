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
            // Rejects the `2^32 mod bound` lowest values, which would make some results likelier.
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
mod tests {
    use super::*;
    use crate::fx;
    use alloc::vec::Vec;

    #[test]
    fn follows_the_reference_implementation() {
        // The first round of `pcg32-demo` in the reference implementation: pcg32_srandom(42, 54).
        let mut rng = Rng::with_stream(42, 54);
        let reference = [0xa15c_02b7, 0x7b47_f409, 0xba1d_3330, 0x83d2_f293, 0xbfa4_784b, 0xcbed_606e];
        assert_eq!(reference.map(|_| rng.next_u32()), reference);
    }

    #[test]
    fn every_remainder_is_equally_likely() {
        let mut rng = Rng::new(1);
        // The first bound rejects a quarter of the draws. Without these rejections, every third number would be twice
        // as likely.
        for (bound, buckets) in [(3 << 30, 3), (6, 6), (1000, 10)] {
            let mut counts = [0_i64; 10];
            for _ in 0..60_000 {
                counts[(rng.below(bound) % buckets) as usize] += 1;
            }
            let expected = 60_000 / i64::from(buckets);
            let counts = &counts[..buckets as usize];
            assert!(
                counts.iter().all(|n| (n - expected).pow(2) < 25 * expected),
                "bound {bound} is biased: {counts:?}"
            );
        }
    }

    #[test]
    fn ranges_are_half_open_and_reach_their_ends() {
        let mut rng = Rng::new(2);
        let low = fx!(-1);
        let high = Fx::from_bits(low.to_bits() + 3);
        let drawn: Vec<i64> = (0..200).map(|_| rng.range(low, high).to_bits() - low.to_bits()).collect();
        assert!((0..3).all(|step| drawn.contains(&step)) && drawn.iter().all(|&step| (0..3).contains(&step)));
        assert_eq!(rng.range(high, low), high);
        assert_eq!(rng.range(low, low), low);
        let wide: Vec<Fx> = (0..100).map(|_| rng.range(Fx::MIN, Fx::MAX)).collect();
        assert!(
            wide.iter().any(|x| *x < fx!(-1_000_000_000)) && wide.iter().any(|x| *x > fx!(1_000_000_000))
        );
    }

    #[test]
    fn bounds_without_numbers_are_harmless() {
        let mut rng = Rng::new(3);
        assert_eq!(rng.below(0), 0);
        assert_eq!(rng.below(1), 0);
        assert_eq!(rng.below_u64(0), 0);
        assert!(!rng.chance(1, 0) && !rng.chance(0, 5) && rng.chance(5, 5));
    }

    #[test]
    fn shuffles_reach_every_order() {
        let mut rng = Rng::new(4);
        let mut counts = [0_i32; 6];
        for _ in 0..6000 {
            let mut items = [0, 1, 2];
            rng.shuffle(&mut items);
            let order: usize = items[0] * 2 + usize::from(items[1] > items[2]);
            counts[order] += 1;
        }
        assert!(
            counts.iter().all(|n| (n - 1000).abs() < 150),
            "each order should occur about 1000 times: {counts:?}"
        );
    }

    /// The expected numbers are those of a second implementation in Python. Changing these numbers breaks replays.
    #[test]
    fn golden() {
        let mut rng = Rng::new(5);
        let mut items: Vec<u32> = (0..8).collect();
        rng.shuffle(&mut items);
        let drawn = (
            rng.next_u64(),
            rng.below(100),
            rng.range(fx!(-1), fx!(1)).to_bits(),
            rng.angle().to_bits(),
            rng.chance(1, 2),
        );
        assert_eq!(items, [4, 3, 6, 2, 7, 5, 1, 0]);
        assert_eq!(drawn, (15_387_767_790_010_577_869, 1, -751_192_307, 1_891_896_190, true));
    }
}
