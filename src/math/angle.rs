//! Angles as a fraction of a turn.
//!
//! `turns = bits / 2^32`, a resolution of 1.46e-9 rad. Addition wraps at a full turn. The angle between two bodies is a
//! subtraction, while rotations stored as complex numbers would need an `atan2` per joint.

#[cfg(test)]
mod tests;

use core::ops::{Add, AddAssign, Neg, Sub, SubAssign};

use serde::{Deserialize, Serialize};

use super::formats::{Fx, Unit, round_shift_wide};
use super::trig::{arc_tangent, signed, sine};
use super::vec2::Vec2;

/// Pi.
pub const PI: Fx = Fx::from_bits(13_493_037_705);
/// 2 pi.
pub const TAU: Fx = Fx::from_bits(26_986_075_409);
/// Radians in a degree. A product with this constant also multiplies the rounding error of the constant: prefer
/// [`Angle::from_degrees`].
pub const DEGREE: Fx = Fx::from_bits(74_961_321);

/// An angle, counter-clockwise, as a fraction of a turn. Sums and differences wrap.
///
/// Angles have no order: compare signed differences instead.
///
/// ```
/// use lockstep2d::{fx, math::{Angle, Vec2}};
/// let north_west = Angle::from_degrees(fx!(135));
/// assert_eq!(north_west + Angle::EIGHTH, Angle::HALF);
/// assert_eq!(Angle::of(Vec2::new(fx!(-2), fx!(2))), north_west);
/// assert_eq!((Angle::ZERO - north_west).to_degrees(), fx!(-135));
/// assert_eq!(Angle::QUARTER.sin(), 1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Angle(u32);

impl Angle {
    /// Direction of the x axis.
    pub const ZERO: Self = Angle(0);
    /// 45 degrees.
    pub const EIGHTH: Self = Angle(1 << 29);
    /// 90 degrees, the direction of the y axis.
    pub const QUARTER: Self = Angle(1 << 30);
    /// 180 degrees.
    pub const HALF: Self = Angle(1 << 31);

    /// Angle from units of 2^-32 turn.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Angle(bits)
    }

    /// Angle in units of 2^-32 turn.
    #[inline]
    #[must_use]
    pub const fn to_bits(self) -> u32 {
        self.0
    }

    /// `fraction` times a rotation of `turns` units of 2^-32 turn. The rotation may exceed a turn.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "angles wrap")]
    pub(crate) const fn from_wide_turns(turns: i64, fraction: Fx) -> Self {
        let part = super::formats::round_shift_wide(turns as i128 * fraction.to_bits() as i128, 32);
        Self::from_bits(part as u32)
    }

    /// Converts units of 2^-32 turn to radians.
    pub(crate) const fn turns_to_radians(turns: i64) -> Fx {
        super::formats::fx_mul(Fx::from_bits(turns), TAU)
    }

    /// Angle from turns: exact. Whole turns are dropped.
    #[inline]
    #[must_use]
    pub const fn from_turns(turns: Fx) -> Self {
        Angle(low_bits(turns.to_bits()))
    }

    /// Angle from radians, rounded to nearest. Whole turns are dropped.
    #[inline]
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "a 127-bit product shifted by 66")]
    pub const fn from_radians(radians: Fx) -> Self {
        /// 1 / (2 pi) in units of 2^-66. The rounding error of this constant changes the angle by less than 1/16 unit,
        /// even for 2^31 rad.
        const TURNS: i128 = 11_743_562_013_128_004_906;
        Angle(low_bits(round_shift_wide(radians.to_bits() as i128 * TURNS, 66) as i64))
    }

    /// Angle from degrees, rounded to nearest (halves away from zero). Whole turns are dropped.
    #[inline]
    #[must_use]
    pub const fn from_degrees(degrees: Fx) -> Self {
        let bits = degrees.to_bits();
        let rest = bits % 360;
        let carry = if rest >= 180 {
            1
        } else if rest <= -180 {
            -1
        } else {
            0
        };
        Angle(low_bits(bits / 360 + carry))
    }

    /// Angle in radians, above -pi and up to pi, rounded to nearest.
    #[inline]
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "at most 2^31 * 2 pi")]
    pub const fn to_radians(self) -> Fx {
        /// 2 pi in units of 2^-60.
        const RADIANS: i128 = 7_244_019_458_077_122_842;
        Fx::from_bits(round_shift_wide(self.signed() as i128 * RADIANS, 60) as i64)
    }

    /// Angle in degrees, above -180 and up to 180: exact.
    #[inline]
    #[must_use]
    pub const fn to_degrees(self) -> Fx {
        Fx::from_bits(self.signed() * 360)
    }

    /// Angle in turns, above -1/2 and up to 1/2: exact.
    #[inline]
    #[must_use]
    pub const fn to_turns(self) -> Fx {
        Fx::from_bits(self.signed())
    }

    /// Sine, within 0.8 units of 2^-30. The function is odd, and exact at the quarter turns.
    #[inline]
    #[must_use]
    pub const fn sin(self) -> Unit {
        Unit::from_bits(sine(self.0))
    }

    /// Cosine: the sine of the angle plus a quarter turn.
    #[inline]
    #[must_use]
    pub const fn cos(self) -> Unit {
        Unit::from_bits(sine(self.0.wrapping_add(Self::QUARTER.0)))
    }

    /// Sine and cosine.
    #[inline]
    #[must_use]
    pub const fn sin_cos(self) -> (Unit, Unit) {
        (self.sin(), self.cos())
    }

    /// Unit vector in this direction: `(cos, sin)`.
    ///
    /// ```
    /// use lockstep2d::{fx, math::{Angle, Vec2}};
    /// assert_eq!(Angle::from_degrees(fx!(90)).direction(), Vec2::Y);
    /// ```
    #[inline]
    #[must_use]
    pub const fn direction(self) -> Vec2<Unit> {
        Vec2::new(self.cos(), self.sin())
    }

    /// Direction of a vector, within 0.7 units of 2^-32 turn; [`Angle::ZERO`] for zero. Exact on axes and diagonals.
    #[inline]
    #[must_use]
    pub const fn of(vector: Vec2<Fx>) -> Self {
        Angle(arc_tangent(vector.x.to_bits(), vector.y.to_bits()))
    }

    /// The angle in units of 2^-32 turn, above minus one half turn and up to plus one half turn.
    const fn signed(self) -> i64 {
        let bits = signed(self.0) as i64;
        if self.0 == Self::HALF.0 { -bits } else { bits }
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "angles wrap by definition")]
const fn low_bits(bits: i64) -> u32 {
    bits as u32
}

impl Add for Angle {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Angle(self.0.wrapping_add(other.0))
    }
}

impl Sub for Angle {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Angle(self.0.wrapping_sub(other.0))
    }
}

impl Neg for Angle {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Angle(self.0.wrapping_neg())
    }
}

impl AddAssign for Angle {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Angle {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
