//! A rotation as cosine and sine: `R v = (c x - s y, s x + c y)`.
//!
//! A rotation is computed from an [`Angle`] and not integrated. The length of `(c, s)` therefore stays within two units
//! of 2^-30 of 1, and does not drift.

#[cfg(test)]
mod tests;

use fixed::FixedI32;
use fixed::types::extra::LeEqU32;
use serde::{Deserialize, Serialize};

use super::angle::Angle;
use super::formats::{Fx, Unit, mul_add, round_shift_wide, saturate_wide};
use super::vec2::Vec2;

/// A rotation about the origin, counter-clockwise.
///
/// ```
/// use lockstep2d::{fx, math::{Angle, Rot, Vec2}};
/// let turn = Rot::from_angle(Angle::QUARTER);
/// assert_eq!(turn.apply_wide(Vec2::new(fx!(2), fx!(1))), Vec2::new(fx!(-1), fx!(2)));
/// assert_eq!(turn.then(turn.inverse()), Rot::IDENTITY);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Rot {
    /// Cosine of the angle.
    pub cos: Unit,
    /// Sine of the angle.
    pub sin: Unit,
}

impl Rot {
    /// The identity rotation.
    pub const IDENTITY: Self = Rot { cos: Unit::ONE, sin: Unit::ZERO };

    /// Creates the rotation by an angle.
    #[inline]
    #[must_use]
    pub const fn from_angle(angle: Angle) -> Self {
        let (sin, cos) = angle.sin_cos();
        Rot { cos, sin }
    }

    /// Creates the rotations by several angles. The compiler vectorises the loop where it inlines this function.
    #[inline(always)]
    pub(crate) fn from_angles<const N: usize>(angles: &[Angle; N]) -> [Self; N] {
        let mut rotations = [Rot::IDENTITY; N];
        for (rotation, &angle) in rotations.iter_mut().zip(angles) {
            *rotation = Rot::from_angle(angle);
        }
        rotations
    }

    /// Inverse rotation.
    #[inline]
    #[must_use]
    pub const fn inverse(self) -> Self {
        Rot { cos: self.cos, sin: self.sin.saturating_neg() }
    }

    /// Rotates a vector, rounded once, saturated.
    #[inline]
    #[must_use]
    pub fn apply<F: LeEqU32>(self, v: Vec2<FixedI32<F>>) -> Vec2<FixedI32<F>> {
        let minus_sin = self.sin.saturating_neg();
        Vec2::new(mul_add(self.cos, v.x, minus_sin, v.y), mul_add(self.sin, v.x, self.cos, v.y))
    }

    /// Rotates by the inverse, rounded once, saturated.
    #[inline]
    #[must_use]
    pub fn apply_inverse<F: LeEqU32>(self, v: Vec2<FixedI32<F>>) -> Vec2<FixedI32<F>> {
        self.inverse().apply(v)
    }

    /// Rotates a vector in world format, rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn apply_wide(self, v: Vec2<Fx>) -> Vec2<Fx> {
        self.apply_and_move(v, Vec2::new(Fx::ZERO, Fx::ZERO))
    }

    /// Rotates by the inverse in world format, rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn apply_inverse_wide(self, v: Vec2<Fx>) -> Vec2<Fx> {
        self.inverse().apply_wide(v)
    }

    /// This rotation followed by another, rounded once.
    #[inline]
    #[must_use]
    pub fn then(self, other: Self) -> Self {
        let Vec2 { x: cos, y: sin } = other.apply(Vec2::new(self.cos, self.sin));
        Rot { cos, sin }
    }

    /// `R v + offset`, rounded once and saturated once.
    #[inline]
    pub(super) const fn apply_and_move(self, v: Vec2<Fx>, offset: Vec2<Fx>) -> Vec2<Fx> {
        let (cos, sin) = (self.cos.to_bits() as i128, self.sin.to_bits() as i128);
        let (x, y) = (v.x.to_bits() as i128, v.y.to_bits() as i128);
        let rotated_x = round_shift_wide(cos * x - sin * y, Unit::FRAC_NBITS);
        let rotated_y = round_shift_wide(sin * x + cos * y, Unit::FRAC_NBITS);
        Vec2::new(
            Fx::from_bits(saturate_wide(rotated_x + offset.x.to_bits() as i128)),
            Fx::from_bits(saturate_wide(rotated_y + offset.y.to_bits() as i128)),
        )
    }
}

impl Default for Rot {
    fn default() -> Self {
        Self::IDENTITY
    }
}
