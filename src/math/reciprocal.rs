//! `1 / x` with 31 significant bits, for `x` from 2^-30 to below 2^30.
//!
//! In the format of [`Ratio`](super::formats::Ratio), the reciprocal of 500 m would have 16 significant bits, and that
//! of 2 mm would overflow. Multiplying by a [`Reciprocal`] takes one widening 32-bit product.

#[cfg(test)]
mod tests;

use fixed::FixedI32;
use fixed::types::extra::LeEqU32;
use serde::{Deserialize, Serialize};

use super::formats::{Fx, div_round, round_shift, round_shift_wide, saturate, saturate_wide};

/// The reciprocal of a positive number: `mantissa / 2^shift`.
///
/// ```
/// use lockstep2d::{fx, math::{Length, Reciprocal}};
/// // One division serves many products: a prize is shared among seven players.
/// let seventh = Reciprocal::of_integer(7);
/// let share: Length = seventh.times(Length::from_num(21));
/// assert_eq!(share, Length::from_num(3));
/// assert_eq!(Reciprocal::of(fx!(7)), seventh);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reciprocal {
    /// 0, or from 2^30 to 2^31 - 1.
    mantissa: i32,
    /// From 0 to 60.
    shift: u32,
}

impl Reciprocal {
    /// Reciprocal of infinity, for a body that does not rotate.
    pub const ZERO: Self = Reciprocal { mantissa: 0, shift: 0 };

    /// `1 / x`, with a relative error of at most 2^-31.
    ///
    /// # Panics
    /// If `x` is not from 2^-30 to below 2^30.
    #[must_use]
    pub const fn of(x: Fx) -> Self {
        let bits = x.to_bits();
        assert!(bits >= 4 && bits < 1 << 62, "a reciprocal needs a number from 2^-30 to below 2^30");
        // The quotient is above 2^30 and at most 2^31.
        let width = 64 - bits.leading_zeros();
        let quotient = div_round(1 << (width + 30), bits as i128);
        let mantissa = saturate(super::formats::saturate_wide(quotient));
        Reciprocal { mantissa, shift: width + 30 - 32 }
    }

    /// Reciprocal of a positive integer.
    ///
    /// # Panics
    /// If `n` is 0, or at least 2^30.
    #[must_use]
    pub const fn of_integer(n: u32) -> Self {
        Self::of(Fx::from_bits((n as i64) << 32))
    }

    /// The product of `a` and the reciprocal, rounded once, saturated. It differs from `a / x` by at most 2^-31 of its
    /// value, plus the rounding error. A reciprocal of a power of two is too small by 2^-31 of its value.
    #[inline]
    #[must_use]
    pub fn times<A: LeEqU32, B: LeEqU32>(self, a: FixedI32<A>) -> FixedI32<B> {
        let product = i64::from(a.to_bits()) * i64::from(self.mantissa);
        let shift = i64::from(self.shift) + i64::from(A::U32) - i64::from(B::U32);
        FixedI32::from_bits(match u32::try_from(shift) {
            Ok(shift) if shift < 63 => saturate(round_shift(product, shift)),
            Ok(_) => 0,
            Err(_) => saturate(product.saturating_mul(1 << (-shift).min(62))),
        })
    }

    /// [`Reciprocal::times`] for world format.
    #[inline]
    pub(crate) fn times_wide(self, a: Fx) -> Fx {
        let product = i128::from(a.to_bits()) * i128::from(self.mantissa);
        let rounded = if self.shift == 0 { product } else { round_shift_wide(product, self.shift) };
        Fx::from_bits(saturate_wide(rounded))
    }

    #[inline]
    #[expect(clippy::cast_possible_wrap, reason = "at most 63")]
    pub(crate) const fn parts(self) -> (i32, i32) {
        (self.mantissa, self.shift as i32)
    }

    /// The exact product, and its number of fraction bits beyond those of `a`.
    #[inline]
    pub(crate) fn times_exact<A: LeEqU32>(self, a: FixedI32<A>) -> (i64, u32) {
        (i64::from(a.to_bits()) * i64::from(self.mantissa), self.shift)
    }
}
