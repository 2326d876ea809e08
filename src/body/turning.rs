//! Rotation of bodies.

use super::body::Body;
use crate::math::{Fx, Length, Reciprocal, Speed, Vec2, fx_mul};

/// Speed at the radius of gyration, in m/s, up to which a dynamic body hardly turns.
const TURNING_SPEED: Speed = Speed::lit("0.02");

impl Body {
    /// Whether the rotation is not locked.
    pub(crate) fn turns(&self) -> bool {
        self.mass.inverse_gyration != Reciprocal::ZERO
    }

    /// Whether the body turns. For a dynamic body, at more than [`TURNING_SPEED`].
    #[inline]
    pub(crate) fn is_turning(&self) -> bool {
        if self.is_dynamic() { self.spin.abs() > TURNING_SPEED } else { self.spin != 0 }
    }

    /// Whether two bodies turn as one: both turn, in the same direction, and at a contact point they slide on each other
    /// at most half as fast as their common rotation moves the lever arms. `arms` are the vectors from the centres of
    /// mass to this point. Two balls that roll in the same direction slide, and their normal does not follow their
    /// rotation.
    #[inline]
    pub(crate) fn turns_as_one_with(&self, other: &Body, arms: [Vec2<Length>; 2]) -> bool {
        if !self.is_turning() || !other.is_turning() || (self.spin > 0) != (other.spin > 0) {
            return false;
        }
        let [to_a, to_b] = arms.map(Vec2::widen);
        let at_contact =
            |body: &Body, arm: Vec2<Fx>| body.velocity.widen() + arm.perp().scale(body.angular_velocity());
        let slip = at_contact(other, to_b) - at_contact(self, to_a);
        let size = |v: Vec2<Fx>| v.x.saturating_abs().saturating_add(v.y.saturating_abs());
        let reach = size(to_a).saturating_add(size(to_b));
        let common = self.angular_velocity().abs().min(other.angular_velocity().abs());
        size(slip) <= fx_mul(reach, common) / 2
    }

    /// Rotation in radians in the given time in seconds. 0 if the body hardly turns.
    #[inline]
    pub(crate) fn rotation_in(&self, time: Fx) -> Fx {
        if self.is_turning() { fx_mul(self.angular_velocity(), time) } else { Fx::ZERO }
    }
}
