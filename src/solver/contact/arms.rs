//! The normal and the lever arms of a contact.
//!
//! They do not change within a tick. If two bodies that press on each other turn as one, the normal and the arms are
//! those at the mean time of the sub-steps. With those at the start of the tick, a force `F` on an arm `d` would leave
//! a couple of `F d w t` in each tick, with the angular velocity `w` and the mean time `t`, and the bodies would lose
//! their angular momentum.

#[cfg(test)]
mod tests;

use crate::collision::{KeptManifold, Manifold};
use crate::math::{Angle, Fx, Length, Rot, Unit, Vec2, fx_mul};

pub(super) struct Arms {
    pub(super) normal: Vec2<Unit>,
    /// Vectors from the centres of mass of A and B to the first point.
    pub(super) to_a: Vec2<Length>,
    pub(super) to_b: Vec2<Length>,
    /// Vector from the first point to the second, or zero.
    pub(super) to_second: Vec2<Length>,
}

impl Arms {
    pub(super) fn of(manifold: &Manifold, kept: &KeptManifold) -> Self {
        let KeptManifold { arm_a, arm_b, to_second, .. } = *kept;
        Arms { normal: manifold.normal, to_a: arm_a, to_b: arm_b, to_second }
    }

    /// Rotates the normal and the arms by the common rotation of the bodies, if the bodies move as one. Returns whether
    /// it has rotated them. If the bodies slide on each other, as two balls do that roll in the same direction, the
    /// normal does not follow their rotations.
    #[inline]
    pub(super) fn turn_with(&mut self, [a, b]: [BodyMotion; 2]) -> bool {
        let common = common_rotation(a.rotation, b.rotation);
        if common == 0 {
            return false;
        }
        let at_contact =
            |body: BodyMotion, arm: Vec2<Length>| body.shift + arm.widen().perp().scale(body.rotation);
        let slip = at_contact(b, self.to_b) - at_contact(a, self.to_a);
        let size = |v: Vec2<Fx>| v.x.abs().saturating_add(v.y.abs());
        let reach = size(self.to_a.widen()).saturating_add(size(self.to_b.widen()));
        size(slip) <= fx_mul(reach, common.abs()) / 2 && self.turn(common)
    }

    /// Rotates the normal and the arms by an angle in radians. Returns `false` if the angle is 0.
    #[inline]
    fn turn(&mut self, radians: Fx) -> bool {
        if radians == 0 {
            return false;
        }
        let rotation = Rot::from_angle(Angle::from_radians(radians));
        self.normal = rotation.apply(self.normal);
        for arm in [&mut self.to_a, &mut self.to_b, &mut self.to_second] {
            *arm = rotation.apply(*arm);
        }
        true
    }
}

/// The motion of a body from the start of the tick to the mean time of its sub-steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyMotion {
    /// Displacement of the centre of mass in metres.
    pub(super) shift: Vec2<Fx>,
    /// Rotation in radians.
    pub(super) rotation: Fx,
}

/// The rotation that two bodies have in common: the smaller one if they turn in the same direction, otherwise 0.
#[inline]
fn common_rotation(a: Fx, b: Fx) -> Fx {
    if a > 0 && b > 0 {
        a.min(b)
    } else if a < 0 && b < 0 {
        a.max(b)
    } else {
        Fx::ZERO
    }
}
