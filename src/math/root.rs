//! Square roots, lengths and unit vectors.
//!
//! A length is the integer square root of an exact sum of squares. A unit vector is `v y` with `y = 1 / |v|` from
//! Newton's iteration `y <- y (3 - n y^2) / 2` with `n = |v|^2`. The iteration needs no division. Vectors along an axis
//! are exact.

use fixed::FixedI32;
use fixed::types::extra::LeEqU32;

use super::formats::{Fx, Unit};
use super::vec2::Vec2;

/// Square root, rounded to nearest; `None` for a negative number.
///
/// ```
/// use lockstep2d::{fx, math::sqrt};
/// assert_eq!(sqrt(fx!(6.25)), Some(fx!(2.5)));
/// assert_eq!(sqrt(fx!(-1)), None);
/// ```
#[must_use]
pub const fn sqrt(x: Fx) -> Option<Fx> {
    if x.to_bits() < 0 {
        return None;
    }
    Some(saturated(sqrt_rounded_wide((x.to_bits().unsigned_abs() as u128) << 32)))
}

/// `sqrt(x^2 + y^2)`, rounded to nearest, saturated.
///
/// ```
/// use lockstep2d::{fx, math::hypot};
/// assert_eq!(hypot(fx!(-1.5), fx!(2)), fx!(2.5));
/// ```
#[must_use]
pub const fn hypot(x: Fx, y: Fx) -> Fx {
    // Vectors along an axis are frequent, and need no root.
    if x.to_bits() == 0 {
        return y.saturating_abs();
    }
    if y.to_bits() == 0 {
        return x.saturating_abs();
    }
    saturated(sqrt_rounded_wide(sum_of_squares_wide(x.to_bits().unsigned_abs(), y.to_bits().unsigned_abs())))
}

impl Vec2<Fx> {
    /// Length of the vector, rounded to nearest, saturated.
    #[inline]
    #[must_use]
    pub const fn length(self) -> Fx {
        hypot(self.x, self.y)
    }

    /// Whether the length exceeds a limit. Most vectors are far from the limit and need no root.
    #[inline]
    pub(crate) fn is_longer_than(self, limit: Fx) -> bool {
        let (x, y) = (self.x.saturating_abs(), self.y.saturating_abs());
        x.max(y) > limit || (x.saturating_add(y) > limit && self.length() > limit)
    }

    /// Square of the length, rounded to nearest; saturates for lengths of 46 341 m or more.
    #[inline]
    #[must_use]
    pub const fn length_squared(self) -> Fx {
        self.dot(self)
    }

    /// Distance between two points, rounded to nearest, saturated.
    #[must_use]
    pub const fn distance(self, other: Self) -> Fx {
        let x = self.x.to_bits().abs_diff(other.x.to_bits());
        let y = self.y.to_bits().abs_diff(other.y.to_bits());
        // A difference of 2^63 or more saturates. The squares of smaller differences fit.
        if (x | y) >> 63 != 0 { Fx::MAX } else { saturated(sqrt_rounded_wide(sum_of_squares_wide(x, y))) }
    }

    /// Unit vector in the same direction, each component within 0.76 units of 2^-30; `None` for zero.
    #[inline]
    #[must_use]
    pub const fn normalized(self) -> Option<Vec2<Unit>> {
        let (x, y) = (self.x.to_bits(), self.y.to_bits());
        // The 32-bit path and the wide path give the same bits, because all shifts are exact.
        if let (Some(x), Some(y)) = (narrowed(x), narrowed(y)) {
            return match polar(x, y) {
                Some((direction, _)) => Some(direction),
                None => None,
            };
        }
        let sum = sum_of_squares_wide(x.unsigned_abs(), y.unsigned_abs());
        if sum == 0 {
            return None;
        }
        // `sum` is normalised to 127 or 128 bits, so that its root and each component have at most 64 bits.
        let shift = sum.leading_zeros() & !1;
        let scale = inverse_root(high_half(sum << shift)) as u128;
        let x_part = high_half(((x.unsigned_abs() << (shift / 2)) as u128 * scale) << 32);
        let y_part = high_half(((y.unsigned_abs() << (shift / 2)) as u128 * scale) << 32);
        Some(Vec2::new(unit(x_part, x < 0), unit(y_part, y < 0)))
    }

    /// Direction and [`length`](Self::length); `None` for zero.
    #[inline]
    #[must_use]
    pub const fn normalized_with_length(self) -> Option<(Vec2<Unit>, Fx)> {
        match self.normalized() {
            Some(direction) => Some((direction, self.length())),
            None => None,
        }
    }
}

impl<A: LeEqU32> Vec2<FixedI32<A>> {
    /// Length of the vector, rounded to nearest, saturated.
    #[inline]
    #[must_use]
    pub fn length(self) -> FixedI32<A> {
        FixedI32::from_bits(saturated_narrow(sqrt_rounded(sum_of_squares(
            self.x.to_bits(),
            self.y.to_bits(),
        ))))
    }

    /// Unit vector in the same direction, each component within 0.76 units of 2^-30; `None` for zero.
    #[inline]
    #[must_use]
    pub fn normalized(self) -> Option<Vec2<Unit>> {
        self.normalized_with_length().map(|(direction, _)| direction)
    }

    /// Direction and [`length`](Self::length), at little more cost than the direction; `None` for zero.
    #[inline]
    #[must_use]
    pub fn normalized_with_length(self) -> Option<(Vec2<Unit>, FixedI32<A>)> {
        let (direction, length) = polar(self.x.to_bits(), self.y.to_bits())?;
        Some((direction, FixedI32::from_bits(length)))
    }
}

/// Direction and length, with 64-bit products only.
#[inline]
const fn polar(x: i32, y: i32) -> Option<(Vec2<Unit>, i32)> {
    let sum = sum_of_squares(x, y);
    if sum == 0 {
        return None;
    }
    // `sum` is normalised to 63 or 64 bits, so that its root and each component have at most 32 bits.
    let shift = sum.leading_zeros() & !1;
    let scale = inverse_root(sum << shift);
    let x_part = ((x.unsigned_abs() as u64) << (shift / 2)) * scale;
    let y_part = ((y.unsigned_abs() as u64) << (shift / 2)) * scale;
    Some((
        Vec2::new(unit(x_part, x < 0), unit(y_part, y < 0)),
        saturated_narrow(root_from_inverse(sum, shift, scale)),
    ))
}

/// `sqrt(n)`, rounded to nearest. `inverse` is `2^63 / sqrt(n 2^shift)` with an error of at most 0.51.
#[inline]
const fn root_from_inverse(n: u64, shift: u32, inverse: u64) -> u64 {
    // The root of m = n 2^shift is m / sqrt(m). Because of the error of the inverse (0.51) and the rounding error (one
    // half), `root` may differ by one from `sqrt(n)` rounded to nearest.
    let m = n << shift;
    let product = (m >> 32) * inverse + (((m & 0xffff_ffff) * inverse) >> 32); // sqrt(m) in units of 2^-31
    let drop = 31 + shift / 2;
    let root = (product + (1 << (drop - 1))) >> drop;
    // `root` is nearest if (root - 1/2)^2 < n < (root + 1/2)^2. The squares are root^2 ± root + 1/4, and the 1/4 makes
    // no difference for an integer n.
    let root = if root * root - root >= n { root - 1 } else { root };
    if root * root + root < n { root + 1 } else { root }
}

#[inline]
#[expect(clippy::cast_possible_truncation, reason = "compared with the original")]
const fn narrowed(x: i64) -> Option<i32> {
    let low = x as i32;
    if low as i64 == x { Some(low) } else { None }
}

/// Converts a magnitude in units of 2^-63. If a rounding error makes the magnitude exceed 1, rounding to units of 2^-30
/// makes it 1 again.
#[inline]
const fn unit(magnitude: u64, negative: bool) -> Unit {
    let rounded = ((magnitude + (1 << 32)) >> 33) as i32;
    Unit::from_bits(if negative { -rounded } else { rounded })
}

/// `2^63 / sqrt(n)` with an error of at most 0.51, for `n >= 2^62`.
///
/// With `m = n / 2^64`, the result is `1 / sqrt(m)` in units of 2^-31, between 1 and 2. The initial parabola has a
/// relative error of 2.4e-2. Each step turns an error `e` into `1.5 e^2`: 8.7e-4, 1.2e-6, 2e-12.
#[inline]
#[expect(
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "the residual is taken modulo 2^64, the sum is positive"
)]
const fn inverse_root(n: u64) -> u64 {
    /// Coefficients of the parabola in units of 2^-30: minimax by Remez exchange, weighted by relative error.
    const START: [u64; 3] = [2_867_787_663, 3_527_624_814, 1_759_398_854];
    let m = n >> 32; // units of 2^-32
    let mut y = START[0] - ((m * (START[1] - ((m * START[2]) >> 32))) >> 32); // units of 2^-30
    y = (y * ((3 << 30) - ((((y * y) >> 30) * m) >> 32))) >> 31;
    y = (y * ((3 << 30) - ((((y * y) >> 30) * m) >> 32))) >> 31;

    // The residual `1 - m y^2` is small and therefore exact modulo 2^64. The 1 is 2^76 units, which is 0 modulo 2^64.
    let root = m * y + (((n & 0xffff_ffff) * y) >> 32); // m y in units of 2^-62
    let residual = (root >> 16).wrapping_mul(y).wrapping_neg() as i64; // units of 2^-76
    let correction = (y as i64 * (residual >> 32) + (1 << 43)) >> 44; // y residual / 2 in units of 2^-31
    (2 * y as i64 + correction) as u64
}

/// `x^2 + y^2`: at most 2^63.
#[inline]
const fn sum_of_squares(x: i32, y: i32) -> u64 {
    let (x, y) = (x.unsigned_abs() as u64, y.unsigned_abs() as u64);
    x * x + y * y
}

/// `x^2 + y^2` for magnitudes of at most 2^63: at most 2^127.
#[inline]
const fn sum_of_squares_wide(x: u64, y: u64) -> u128 {
    x as u128 * x as u128 + y as u128 * y as u128
}

/// `sqrt(n)` rounded to nearest.
#[inline]
const fn sqrt_rounded(n: u64) -> u64 {
    let root = n.isqrt();
    // Rounds up exactly if n exceeds (root + 1/2)^2 = root^2 + root + 1/4.
    if n - root * root > root { root + 1 } else { root }
}

/// `sqrt(n)` rounded to nearest, for `n <= 2^127`.
#[inline]
const fn sqrt_rounded_wide(n: u128) -> u128 {
    let root = root_wide(n);
    if n - root * root > root { root + 1 } else { root }
}

/// `sqrt(n)`, rounded down, for `n <= 2^127`, without the slow divisions of `u128::isqrt`.
#[inline]
#[expect(clippy::cast_possible_wrap, clippy::cast_sign_loss, reason = "the residual is taken modulo 2^128")]
const fn root_wide(n: u128) -> u128 {
    if n == 0 {
        return 0;
    }
    // `m / sqrt(m)` gives the first 32 bits of the root, the number `r`. `(n - r^2) / (2 sqrt(n))` gives the next 31
    // bits. The loops correct the last unit.
    let shift = n.leading_zeros() & !1;
    let m = high_half(n << shift);
    let inverse = inverse_root(m); // 2^63 / sqrt(m)
    let rough = ((m as u128 * inverse as u128) >> 31) >> (shift / 2);
    let left = n.wrapping_sub(rough * rough) as i128;
    let mut root = rough.wrapping_add((((left >> 2) * inverse as i128) >> (94 - shift / 2)) as u128);
    while root * root > n {
        root -= 1;
    }
    while (root + 1) * (root + 1) <= n {
        root += 1;
    }
    root
}

#[expect(clippy::cast_possible_truncation, reason = "compared with the largest value first")]
const fn saturated(bits: u128) -> Fx {
    if bits > i64::MAX as u128 { Fx::MAX } else { Fx::from_bits(bits as i64) }
}

#[inline]
#[expect(clippy::cast_possible_truncation, reason = "compared with the largest value first")]
const fn saturated_narrow(bits: u64) -> i32 {
    if bits > i32::MAX as u64 { i32::MAX } else { bits as i32 }
}

const fn high_half(x: u128) -> u64 {
    (x >> 64) as u64
}

#[cfg(test)]
mod tests;
