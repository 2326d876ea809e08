//! 2D vectors.

#[cfg(test)]
mod tests;

use core::fmt::{self, Display, Formatter};
use core::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use fixed::FixedI32;
use fixed::traits::Fixed;
use fixed::types::extra::LeEqU32;
use serde::{Deserialize, Serialize};

use super::formats::{
    Fx, Unit, convert, fx_mul, mul, mul_add, mul_sub, narrow, round_product, round_shift_wide, saturate_wide,
    widen,
};

/// A vector or a point. Sums and differences saturate.
///
/// Functions that accept `impl Into<Vec2<Fx>>` take a vector, a pair or an array:
/// `BodyDef::dynamic().position((fx!(0), fx!(10)))`.
///
/// ```
/// use lockstep2d::{fx, math::Vec2};
/// let a = Vec2::new(fx!(3), fx!(4));
/// assert_eq!(a.length(), fx!(5));
/// assert_eq!(a - Vec2::new(fx!(3), fx!(0)), Vec2::from((fx!(0), fx!(4))));
/// assert_eq!(format!("{a:.1}"), "(3.0, 4.0)");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(C)]
pub struct Vec2<T> {
    /// Horizontal component, positive to the right.
    pub x: T,
    /// Vertical component, positive upwards.
    pub y: T,
}

impl<T> Vec2<T> {
    /// Vector from its components.
    #[inline]
    pub const fn new(x: T, y: T) -> Self {
        Vec2 { x, y }
    }
}

/// Prints `(x, y)`. Width and precision apply to each component.
impl<T: Display> Display for Vec2<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("(")?;
        self.x.fmt(f)?;
        f.write_str(", ")?;
        self.y.fmt(f)?;
        f.write_str(")")
    }
}

impl<T> From<(T, T)> for Vec2<T> {
    #[inline]
    fn from((x, y): (T, T)) -> Self {
        Vec2 { x, y }
    }
}

impl<T> From<[T; 2]> for Vec2<T> {
    #[inline]
    fn from([x, y]: [T; 2]) -> Self {
        Vec2 { x, y }
    }
}

impl<T: Fixed> Add for Vec2<T> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Vec2::new(self.x.saturating_add(other.x), self.y.saturating_add(other.y))
    }
}

impl<T: Fixed> Sub for Vec2<T> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Vec2::new(self.x.saturating_sub(other.x), self.y.saturating_sub(other.y))
    }
}

impl<T: Fixed> Neg for Vec2<T> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Vec2::new(self.x.saturating_neg(), self.y.saturating_neg())
    }
}

impl<T: Fixed> AddAssign for Vec2<T> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Fixed> SubAssign for Vec2<T> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// Multiplication by a factor, rounded to nearest, saturated.
///
/// ```
/// # use lockstep2d::{fx, math::Vec2};
/// assert_eq!(Vec2::new(fx!(3), fx!(-4)) * fx!(0.5), Vec2::new(fx!(1.5), fx!(-2)));
/// ```
impl Mul<Fx> for Vec2<Fx> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: Fx) -> Self {
        self.scale(factor)
    }
}

impl<T: Fixed> Vec2<T> {
    /// The zero vector.
    pub const ZERO: Self = Vec2::new(T::ZERO, T::ZERO);

    /// The vector rotated by a quarter turn counter-clockwise: `(-y, x)`.
    #[inline]
    #[must_use]
    pub fn perp(self) -> Self {
        Vec2::new(self.y.saturating_neg(), self.x)
    }

    /// Component-wise minimum.
    #[inline]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Vec2::new(Ord::min(self.x, other.x), Ord::min(self.y, other.y))
    }

    /// Component-wise maximum.
    #[inline]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Vec2::new(Ord::max(self.x, other.x), Ord::max(self.y, other.y))
    }
}

impl<A: LeEqU32> Vec2<FixedI32<A>> {
    /// `self . other`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub fn dot<B: LeEqU32, C: LeEqU32>(self, other: Vec2<FixedI32<B>>) -> FixedI32<C> {
        mul_add(self.x, other.x, self.y, other.y)
    }

    /// `self x other = x1 y2 - y1 x2`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub fn cross<B: LeEqU32, C: LeEqU32>(self, other: Vec2<FixedI32<B>>) -> FixedI32<C> {
        mul_sub(self.x, other.y, self.y, other.x)
    }

    /// `self s`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub fn scale<B: LeEqU32, C: LeEqU32>(self, s: FixedI32<B>) -> Vec2<FixedI32<C>> {
        Vec2::new(mul(self.x, s), mul(self.y, s))
    }

    /// Converts to another 32-bit format, rounded to nearest, saturated.
    #[inline]
    #[must_use]
    pub fn convert<B: LeEqU32>(self) -> Vec2<FixedI32<B>> {
        Vec2::new(convert(self.x), convert(self.y))
    }

    /// Converts to world format: exact.
    #[inline]
    #[must_use]
    pub fn widen(self) -> Vec2<Fx> {
        Vec2::new(widen(self.x), widen(self.y))
    }
}

impl Vec2<Fx> {
    /// Sum without the cost of saturation. An overflow wraps.
    #[inline]
    pub(crate) fn wrapping_add(self, other: Self) -> Self {
        Vec2::new(self.x.wrapping_add(other.x), self.y.wrapping_add(other.y))
    }

    /// Difference without the cost of saturation. An overflow wraps.
    #[inline]
    pub(crate) fn wrapping_sub(self, other: Self) -> Self {
        Vec2::new(self.x.wrapping_sub(other.x), self.y.wrapping_sub(other.y))
    }

    /// A vector in the direction from this point to another: the difference of the points, or half of the difference if
    /// it does not fit.
    pub(crate) fn towards(self, to: Self) -> Self {
        match (to.x.checked_sub(self.x), to.y.checked_sub(self.y)) {
            (Some(x), Some(y)) => Vec2::new(x, y),
            _ => Vec2::new((to.x >> 1) - (self.x >> 1), (to.y >> 1) - (self.y >> 1)),
        }
    }

    /// Converts to a 32-bit format, rounded to nearest, saturated.
    #[inline]
    #[must_use]
    pub fn narrow<A: LeEqU32>(self) -> Vec2<FixedI32<A>> {
        Vec2::new(narrow(self.x), narrow(self.y))
    }

    /// The vector, scaled down if necessary, so that the magnitude of no component exceeds `max`.
    pub(crate) fn shortened(self, max: Fx) -> Self {
        let largest = self.x.unsigned_abs().max(self.y.unsigned_abs()).to_bits();
        if largest <= max.unsigned_abs().to_bits() {
            return self;
        }
        let shorten = |v: Fx| {
            let bits = i128::from(v.to_bits()) * i128::from(max.to_bits()) / i128::from(largest);
            Fx::from_bits(saturate_wide(bits))
        };
        Vec2::new(shorten(self.x), shorten(self.y))
    }

    /// `self . other`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn dot(self, other: Self) -> Fx {
        sum_of_products(self.x, other.x, self.y, other.y, 1)
    }

    /// `self x other = x1 y2 - y1 x2`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn cross(self, other: Self) -> Fx {
        sum_of_products(self.x, other.y, self.y, other.x, -1)
    }

    /// `self s`, rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn scale(self, s: Fx) -> Self {
        Vec2::new(fx_mul(self.x, s), fx_mul(self.y, s))
    }

    /// `self + (other - self) t`, rounded once, saturated. Extrapolates outside of 0 to 1.
    #[inline]
    #[must_use]
    pub const fn lerp(self, other: Self, t: Unit) -> Self {
        Vec2::new(interpolate(self.x, other.x, t), interpolate(self.y, other.y, t))
    }
}

/// `a x + sign b y`, rounded once, saturated.
const fn sum_of_products(a: Fx, x: Fx, b: Fx, y: Fx, sign: i128) -> Fx {
    let ax = a.to_bits() as i128 * x.to_bits() as i128;
    let by = b.to_bits() as i128 * y.to_bits() as i128;
    // The sum fits an `i128`, unless all four numbers are `i64::MIN`.
    Fx::from_bits(round_product(ax.saturating_add(sign * by)))
}

/// `a (1 - t) + b t`, rounded once, saturated. `a + (b - a) t` could overflow in `b - a`.
const fn interpolate(a: Fx, b: Fx, t: Unit) -> Fx {
    let t = t.to_bits() as i128;
    let sum = a.to_bits() as i128 * ((1 << Unit::FRAC_NBITS) - t) + b.to_bits() as i128 * t;
    Fx::from_bits(saturate_wide(round_shift_wide(sum, Unit::FRAC_NBITS)))
}

impl Vec2<Unit> {
    /// `(1, 0)`.
    pub const X: Self = Vec2::new(Unit::ONE, Unit::ZERO);
    /// `(0, 1)`.
    pub const Y: Self = Vec2::new(Unit::ZERO, Unit::ONE);
}
