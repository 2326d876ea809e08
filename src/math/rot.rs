//! A rotation as the cosine and sine of its angle: `R v = (c x - s y, s x + c y)`.
//!
//! Derived from an [`Angle`], never integrated: the state is the angle, so the length of `(c, s)` is 1 within
//! two units of 2^-30 and does not drift. Each component of a result is a sum of two exact products, rounded once.

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
    /// The rotation by nothing.
    pub const IDENTITY: Self = Rot { cos: Unit::ONE, sin: Unit::ZERO };

    /// The rotation by an angle.
    #[inline]
    #[must_use]
    pub const fn from_angle(angle: Angle) -> Self {
        let (sin, cos) = angle.sin_cos();
        Rot { cos, sin }
    }

    /// The rotation the other way: exact.
    #[inline]
    #[must_use]
    pub const fn inverse(self) -> Self {
        Rot { cos: self.cos, sin: self.sin.saturating_neg() }
    }

    /// The rotated vector: each component rounded once, saturated.
    #[inline]
    #[must_use]
    pub fn apply<F: LeEqU32>(self, v: Vec2<FixedI32<F>>) -> Vec2<FixedI32<F>> {
        let minus_sin = self.sin.saturating_neg();
        Vec2::new(mul_add(self.cos, v.x, minus_sin, v.y), mul_add(self.sin, v.x, self.cos, v.y))
    }

    /// The vector rotated the other way: each component rounded once, saturated.
    #[inline]
    #[must_use]
    pub fn apply_inverse<F: LeEqU32>(self, v: Vec2<FixedI32<F>>) -> Vec2<FixedI32<F>> {
        self.inverse().apply(v)
    }

    /// The rotated vector in world format: each component rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn apply_wide(self, v: Vec2<Fx>) -> Vec2<Fx> {
        self.apply_and_move(v, Vec2::new(Fx::ZERO, Fx::ZERO))
    }

    /// The vector in world format rotated the other way: each component rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn apply_inverse_wide(self, v: Vec2<Fx>) -> Vec2<Fx> {
        self.inverse().apply_wide(v)
    }

    /// The rotation by this and then by another angle: the sum of the angles, each component rounded once.
    #[inline]
    #[must_use]
    pub fn then(self, other: Self) -> Self {
        let Vec2 { x: cos, y: sin } = other.apply(Vec2::new(self.cos, self.sin));
        Rot { cos, sin }
    }

    /// `R v + offset`: each component rounded once, saturated once.
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
