//! Rotation of bodies.

use super::body::Body;
use crate::math::{Fx, Reciprocal, Speed, fx_mul};

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

    /// Whether both bodies turn, in the same direction.
    #[inline]
    pub(crate) fn turns_with(&self, other: &Body) -> bool {
        self.is_turning() && other.is_turning() && (self.spin > 0) == (other.spin > 0)
    }

    /// Rotation in radians in the given time in seconds. 0 if the body hardly turns.
    #[inline]
    pub(crate) fn rotation_in(&self, time: Fx) -> Fx {
        if self.is_turning() { fx_mul(self.angular_velocity(), time) } else { Fx::ZERO }
    }
}
