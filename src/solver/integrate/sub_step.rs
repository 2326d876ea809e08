//! The distance that a speed covers in a sub-step.

#[cfg(test)]
mod tests;

use crate::math::{Shift, Speed};
use crate::simd::Lanes;

/// A time step of `1 / rate` seconds, not rounded.
#[derive(Clone, Copy)]
pub(super) struct SubStep {
    /// Twice the rate, `d`.
    divisor: u64,
    /// `2^64 / d`, rounded up.
    reciprocal: u64,
    rate: i32,
    /// `2^36 / rate`, rounded.
    coarse: i32,
}

impl SubStep {
    /// The time step for `rate` sub-steps per second, 60 to 4000.
    pub(super) fn of(rate: u32) -> Self {
        let divisor = 2 * u64::from(rate);
        let bits = |number: u64| i32::try_from(number).expect("at least 60 sub-steps in a second");
        SubStep {
            divisor,
            reciprocal: u64::MAX / divisor + 1,
            rate: bits(rate.into()),
            coarse: bits(((1 << 37) / u64::from(rate)).div_ceil(2)),
        }
    }

    /// `v / rate`, rounded to nearest, ties towards +infinity, by a product instead of a division (T. Granlund, P.
    /// Montgomery, 1994). The reciprocal of the divisor `d` is `2^64 / d` rounded up, so their product
    /// exceeds 2^64 by less than `d`. Multiplied by a dividend below 2^48, the excess is below 2^64, because `d` is below
    /// 2^16. The quotient therefore does not reach the next integer.
    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_sign_loss,
        reason = "at most 512 m/s in a sixtieth of a second, and the dividend is positive"
    )]
    pub(super) fn distance(&self, speed: Speed) -> Shift {
        /// Keeps the dividend positive.
        const BIAS: u64 = 1 << 34;
        // A distance has 5 more fraction bits than a speed. The sixth bit is for rounding to nearest.
        let doubled = (i64::from(speed.to_bits()) << 6) + (self.divisor / 2) as i64;
        let dividend = (doubled + (BIAS * self.divisor) as i64) as u64;
        let quotient = ((u128::from(dividend) * u128::from(self.reciprocal)) >> 64) as u64;
        Shift::from_bits((quotient as i64 - BIAS as i64) as i32)
    }

    /// Computes [`Self::distance`] in each lane. The quotient `q` may be off by one. The remainder `64 v + rate - 2
    /// rate q` shows the error, and its lowest 32 bits suffice.
    #[inline(always)]
    pub(super) fn distances<L: Lanes<N>, const N: usize>(&self, speed: L::Int) -> L::Int {
        let double = L::splat(2 * self.rate);
        // The product is off by at most half a unit, and its rounding adds at most another half.
        let q = L::narrow::<31>(L::mul(speed, L::splat(self.coarse)));
        let dividend = L::add(L::low(L::mul(speed, L::splat(64))), L::splat(self.rate));
        let rest = L::sub(dividend, L::low(L::mul(q, double)));
        let less = L::to_int(L::negative(rest));
        let more = L::to_int(L::greater(rest, L::sub(double, L::splat(1))));
        L::sub(L::add(q, less), more)
    }
}
