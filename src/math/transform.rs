#[cfg(test)]
mod tests;
use serde::{Deserialize, Serialize};

use super::formats::Fx;
use super::rot::Rot;
use super::vec2::Vec2;

/// A rotation followed by a translation, `R p + position`, from body to world coordinates.
///
/// ```
/// use lockstep2d::{fx, math::{Angle, Rot, Transform, Vec2}};
/// let pose = Transform::new(Vec2::new(fx!(10), fx!(0)), Rot::from_angle(Angle::QUARTER));
/// let world = pose.apply(Vec2::new(fx!(1), fx!(0)));
/// assert_eq!(world, Vec2::new(fx!(10), fx!(1)));
/// assert_eq!(pose.apply_inverse(world), Vec2::new(fx!(1), fx!(0)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Transform {
    /// Image of the origin, in metres.
    pub position: Vec2<Fx>,
    /// Rotation about the origin, applied first.
    pub rotation: Rot,
}

impl Transform {
    /// The identity transform.
    pub const IDENTITY: Self = Transform { position: Vec2::new(Fx::ZERO, Fx::ZERO), rotation: Rot::IDENTITY };

    /// Creates a transform from a position and a rotation.
    #[inline]
    #[must_use]
    pub const fn new(position: Vec2<Fx>, rotation: Rot) -> Self {
        Transform { position, rotation }
    }

    /// Transforms from body to world coordinates, rounded once, saturated.
    #[inline]
    #[must_use]
    pub const fn apply(self, point: Vec2<Fx>) -> Vec2<Fx> {
        self.rotation.apply_and_move(point, self.position)
    }

    /// Transforms from world to body coordinates, rounded once. The difference from the position saturates at 2.1e9 m.
    #[inline]
    #[must_use]
    pub fn apply_inverse(self, point: Vec2<Fx>) -> Vec2<Fx> {
        self.rotation.apply_inverse_wide(point - self.position)
    }
}
