//! 2x2 matrices: `(M v)_i = sum_j a_ij v_j`, rounded once per component.

#[cfg(test)]
mod tests;

use fixed::FixedI32;
use fixed::types::extra::LeEqU32;
use serde::{Deserialize, Serialize};

use super::formats::{Fx, div_round, mul_add, saturate_wide};
use super::vec2::Vec2;

/// A 2x2 matrix.
///
/// ```
/// use lockstep2d::{fx, math::{Mat2, Vec2}};
/// let m = Mat2::new(fx!(2), fx!(1), fx!(0), fx!(4));
/// let v = m.apply(Vec2::new(fx!(1), fx!(0.5)));
/// assert_eq!(v, Vec2::new(fx!(2.5), fx!(2)));
/// assert_eq!(m.inverse().unwrap().apply(v), Vec2::new(fx!(1), fx!(0.5)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Mat2<T> {
    /// First row, first column.
    pub a11: T,
    /// First row, second column.
    pub a12: T,
    /// Second row, first column.
    pub a21: T,
    /// Second row, second column.
    pub a22: T,
}

impl<T> Mat2<T> {
    /// Matrix from its rows.
    #[inline]
    pub const fn new(a11: T, a12: T, a21: T, a22: T) -> Self {
        Mat2 { a11, a12, a21, a22 }
    }

    /// Transpose of the matrix.
    #[inline]
    #[must_use]
    pub fn transpose(self) -> Self {
        Mat2 { a11: self.a11, a12: self.a21, a21: self.a12, a22: self.a22 }
    }
}

impl<A: LeEqU32> Mat2<FixedI32<A>> {
    /// `M v`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub fn apply<B: LeEqU32, C: LeEqU32>(self, v: Vec2<FixedI32<B>>) -> Vec2<FixedI32<C>> {
        Vec2::new(mul_add(self.a11, v.x, self.a12, v.y), mul_add(self.a21, v.x, self.a22, v.y))
    }

    /// `a11 a22 - a12 a21`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub fn determinant<C: LeEqU32>(self) -> FixedI32<C> {
        Vec2::new(self.a11, self.a12).cross(Vec2::new(self.a21, self.a22))
    }
}

impl Mat2<Fx> {
    /// The identity matrix.
    pub const IDENTITY: Self = Mat2::new(Fx::ONE, Fx::ZERO, Fx::ZERO, Fx::ONE);

    /// `M v`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn apply(self, v: Vec2<Fx>) -> Vec2<Fx> {
        Vec2::new(Vec2::new(self.a11, self.a12).dot(v), Vec2::new(self.a21, self.a22).dot(v))
    }

    /// `a11 a22 - a12 a21`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn determinant(self) -> Fx {
        Vec2::new(self.a11, self.a12).cross(Vec2::new(self.a21, self.a22))
    }

    /// `M^-1`, from the exact determinant, rounded once, saturated; `None` if the determinant is 0.
    #[must_use]
    pub const fn inverse(self) -> Option<Self> {
        let Mat2 { a11, a12, a21, a22 } = self;
        let plus = a11.to_bits() as i128 * a22.to_bits() as i128;
        let minus = a12.to_bits() as i128 * a21.to_bits() as i128;
        // The determinant in units of 2^-64. Its magnitude is at most 2^127 - 2^63, so that it fits an `i128`.
        let determinant = plus.saturating_sub(minus);
        if determinant == 0 {
            return None;
        }
        Some(Mat2::new(
            quotient(a22.to_bits() as i128, determinant),
            quotient(-(a12.to_bits() as i128), determinant),
            quotient(-(a21.to_bits() as i128), determinant),
            quotient(a11.to_bits() as i128, determinant),
        ))
    }
}

/// The quotient of an entry in units of 2^-32 and a determinant in units of 2^-64, rounded to nearest, saturated.
const fn quotient(entry: i128, determinant: i128) -> Fx {
    Fx::from_bits(saturate_wide(div_round(entry.saturating_mul(1 << 64), determinant)))
}
