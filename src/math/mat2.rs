//! 2x2 matrices: `(M v)_i = sum_j a_ij v_j`, rounded once per component.

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fx;
    use crate::math::{Rng, Unit, narrow};
    use fixed::types::extra::U30;

    #[test]
    fn inverse_undoes_the_matrix() {
        let mut rng = Rng::new(1);
        for _ in 0..2000 {
            let mut entry = || rng.range(fx!(-8), fx!(8));
            let m = Mat2::new(entry(), entry(), entry(), entry());
            let v = Vec2::new(entry(), entry());
            if m.determinant().abs() < fx!(0.5) {
                continue;
            }
            // The errors of two entries of the inverse (half a unit each) are multiplied by components of M v, at most
            // 128. The errors of two components of M v (half a unit each) are multiplied by entries of the inverse, at
            // most 16. With half a unit for the last rounding, the sum is below 145.
            let there = m.inverse().unwrap().apply(m.apply(v)) - v;
            assert!(
                there.x.abs().to_bits() <= 145 && there.y.abs().to_bits() <= 145,
                "{m:?} {v:?} {there:?}"
            );
        }
    }

    #[test]
    fn singular_and_extreme_matrices_do_not_panic() {
        let e = Fx::DELTA;
        assert_eq!(Mat2::new(fx!(1), fx!(2), fx!(3), fx!(6)).inverse(), None);
        assert_eq!(Mat2::new(e, Fx::ZERO, Fx::ZERO, e).determinant(), Fx::ZERO);
        let inverse = Mat2::new(e, Fx::ZERO, Fx::ZERO, e).inverse().unwrap();
        assert_eq!(inverse, Mat2::new(Fx::MAX, Fx::ZERO, Fx::ZERO, Fx::MAX));
        for bits in 0..81_u32 {
            let entry = |digit: u32| [Fx::MIN, Fx::ZERO, Fx::MAX][(bits / digit % 3) as usize];
            let m = Mat2::new(entry(1), entry(3), entry(9), entry(27));
            assert_eq!(m.inverse().is_none(), m.determinant() == Fx::ZERO, "{m:?}");
            let _ = m.apply(Vec2::new(Fx::MIN, Fx::MIN));
        }
    }

    #[test]
    fn formats_agree() {
        let mut rng = Rng::new(2);
        for _ in 0..1000 {
            let mut entry = || narrow(rng.range(fx!(-0.5), fx!(0.5)));
            let m: Mat2<Unit> = Mat2::new(entry(), entry(), entry(), entry());
            let v: Vec2<Unit> = Vec2::new(entry(), entry());
            let wide =
                Mat2::new(Fx::from_num(m.a11), Fx::from_num(m.a12), Fx::from_num(m.a21), Fx::from_num(m.a22));
            // In units of `Fx`, the rounding error is at most 2 for the product in `U30` and 0.5 for the product in
            // `Fx`. The difference is an integer, so it is at most 2.
            let apart = m.apply::<_, U30>(v).widen() - wide.apply(v.widen());
            assert!(apart.x.abs().to_bits() <= 2 && apart.y.abs().to_bits() <= 2, "{apart:?}");
            let determinant: Unit = m.determinant();
            assert_eq!(m.transpose().determinant::<U30>(), determinant);
        }
    }
}
