//! Rows on the angle between two bodies: `vn = s (w_b - w_a)`, with `e = s / k` and without linear part.
//!
//! The length `s` may be chosen for each row. The following choice makes `D = aA eA^2 + aB eB^2` about 1 and keeps the
//! coefficients small:
//!
//! ```text
//! s^2 = 1 / (aA / kA^2 + aB / kB^2),  so that  f = a e / D <= sqrt(a) <= 1  and  e <= 1 / sqrt(a)
//! ```
//!
//! `e` is limited to 100. A larger `e` would occur only if one body is more than 10 000 times as heavy as the other
//! body, and the lighter body does not turn or has a radius of gyration at least about 100 times as large. An angular
//! impulse `P` corresponds to `L = P (mA + mB) D / s`, with inverse masses `mA` and `mB`.

use super::{Denominator, MassFractions, RATIO_MAX, Row, turning};
use crate::math::{Length, Ratio, Reciprocal, Unit, div_round, mul, round_shift, saturate, saturate_wide};

impl Row {
    /// The row, its denominator and `s`. The last two are 0 if impulses turn neither body.
    pub(crate) fn angular(
        a: Reciprocal,
        b: Reciprocal,
        fractions: MassFractions,
    ) -> (Row, Denominator, Length) {
        let s = angular_scale([a, b], fractions);
        let ratio = |inverse_gyration: Reciprocal| -> Ratio {
            inverse_gyration.times::<_, fixed::types::extra::U24>(s).min(RATIO_MAX)
        };
        let (e_a, e_b) = (ratio(a), ratio(b));
        let denominator = turning(fractions.a, e_a, e_a) + turning(fractions.b, e_b, e_b);
        let gain = |fraction: Unit, e: Ratio| {
            let product = i64::from(fraction.to_bits()) * i64::from(e.to_bits());
            // Rounding must not make a gain larger than 1: a velocity change would then exceed `L`.
            Unit::from_bits(saturate(quotient(product, denominator.max(1)))).min(Unit::ONE)
        };
        let (f_a, f_b) = (gain(fractions.a, e_a), gain(fractions.b, e_b));
        (Row { e_a, e_b, f_a, f_b, ..Row::NONE }, denominator, s)
    }

    /// The shares of A and B in a change of the relative angular velocity.
    pub(crate) fn shares(&self) -> (Unit, Unit) {
        (mul(self.f_a, self.e_a), mul(self.f_b, self.e_b))
    }
}

/// `2^6 n / d`, rounded to nearest. `n` and `d` must not be negative.
fn quotient(n: i64, d: i64) -> i64 {
    if n < 1 << 56 && d < 1 << 62 {
        ((n << 6) + d / 2) / d
    } else {
        saturate_wide(div_round(i128::from(n) << 6, d.into()))
    }
}

/// `1 / sqrt(aA / kA^2 + aB / kB^2)`, at most a hundred times the radius of gyration of each body that impulses turn.
/// It need not be exact, because it only sets the units of a row.
pub(in crate::solver) fn angular_scale([a, b]: [Reciprocal; 2], fractions: MassFractions) -> Length {
    // `1 / k` has 21 fraction bits, so that the sum has 72. In gears, `1 / k` is up to 5e5.
    let inverse = |inverse_gyration: Reciprocal, fraction: Unit| -> u64 {
        let (product, extra) = inverse_gyration.times_exact(Unit::ONE);
        if fraction == 0 { 0 } else { round_shift(product, (extra + 9).min(63)).unsigned_abs() }
    };
    let (a, b) = (inverse(a, fractions.a), inverse(b, fractions.b));
    let square = |inverse: u64, fraction: Unit| {
        u128::from(inverse).pow(2) * u128::from(fraction.to_bits().unsigned_abs())
    };
    let sum = square(a, fractions.a) + square(b, fractions.b);
    if sum == 0 {
        return Length::ZERO;
    }
    // An even shift leaves 31 or 32 bits of the sum. `2^62` divided by them has 31 or 32 bits as well, and the root of
    // the quotient has 16. The root is increased by more than its rounding error, so that `f` is not above 1.
    let shift = (i64::from(128 - sum.leading_zeros()) - 31) & !1;
    let top = if shift >= 0 { sum >> shift } else { sum << -shift };
    let root = ((1u64 << 62) / u64::try_from(top).unwrap_or(u64::MAX).max(1)).isqrt();
    let root = u128::from(root + (root >> 14) + 1);
    // `root` is `2^(31 + shift/2) / sqrt(sum)`. The bits of the length are `2^(22 + 36) / sqrt(sum)`.
    let up = 27 - shift / 2;
    let length = if up >= 0 { root << up } else { root >> -up };
    let most = (100 << 43) / a.max(b).max(1);
    Length::from_bits(i32::try_from(length.min(most.into())).unwrap_or(i32::MAX))
}

#[cfg(test)]
mod tests;
