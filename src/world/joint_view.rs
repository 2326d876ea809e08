//! What a joint is doing: measured at the present poses of its bodies.

use super::World;
use crate::body::{Body, JointId};
use crate::math::{Fx, Vec2};
use crate::solver::{Joint, JointKind, Tuning};

impl World {
    /// Where the anchors of a joint are in the world, A's first.
    #[must_use]
    pub fn joint_anchors(&self, id: JointId) -> Option<(Vec2<Fx>, Vec2<Fx>)> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        let def = joint.def();
        Some((a.transform().apply(def.frame_a.anchor), b.transform().apply(def.frame_b.anchor)))
    }

    /// The angle of B's frame in A's in radians, counter-clockwise. It counts turns: a wheel's grows as it rolls.
    #[must_use]
    pub fn joint_angle(&self, id: JointId) -> Option<Fx> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        Some(joint.angle(a, b))
    }

    /// How fast the angle grows, in rad/s.
    #[must_use]
    pub fn joint_angular_velocity(&self, id: JointId) -> Option<Fx> {
        let (_, a, b) = self.joint_and_bodies(id)?;
        Some(b.angular_velocity().saturating_sub(a.angular_velocity()))
    }

    /// Where B's anchor is in A's frame of the joint, in metres: `x` is the translation of joints that slide.
    #[must_use]
    pub fn joint_translation(&self, id: JointId) -> Option<Vec2<Fx>> {
        let (joint, a, _) = self.joint_and_bodies(id)?;
        let (from, to) = self.joint_anchors(id)?;
        Some(joint.axes(a).apply_inverse_wide(to - from))
    }

    /// The velocity of B's anchor in A's frame of the joint in m/s, as someone on A sees it.
    #[must_use]
    pub fn joint_velocity(&self, id: JointId) -> Option<Vec2<Fx>> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        let (_, anchor) = self.joint_anchors(id)?;
        Some(joint.axes(a).apply_inverse_wide(b.velocity_at(anchor) - a.velocity_at(anchor)))
    }

    /// How far the anchors are apart, in metres.
    #[must_use]
    pub fn joint_length(&self, id: JointId) -> Option<Fx> {
        self.joint_anchors(id).map(|(a, b)| a.distance(b))
    }

    /// How far the anchors are from where the joint would have them if nothing gave way, in metres: across the axis of
    /// joints that slide, beyond the range of a distance; not the limits, springs and motors of the others. `None` for
    /// kinds that ask for no place.
    #[must_use]
    pub fn joint_error(&self, id: JointId) -> Option<Fx> {
        match &self.joint(id)?.def().kind {
            JointKind::Revolute(_) | JointKind::Weld(_) => self.joint_length(id),
            JointKind::Prismatic(_) | JointKind::Wheel(_) => {
                self.joint_translation(id).map(|translation| translation.y.saturating_abs())
            }
            JointKind::Distance(distance) => {
                let length = self.joint_length(id)?;
                let nearest = match (distance.rod, distance.limit) {
                    (Some(rod), _) => rod,
                    (None, Some(limit)) => length.max(limit.lower).min(limit.upper),
                    (None, None) => length,
                };
                Some(length.saturating_sub(nearest).saturating_abs())
            }
            JointKind::Motor(_) | JointKind::Filter => None,
        }
    }

    /// The force in N that the joint exerted on B in the last sub-step, and the torque in N m about B's anchor.
    #[must_use]
    pub fn joint_force(&self, id: JointId) -> Option<(Vec2<Fx>, Fx)> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        let config = &self.state.config;
        let tuning = Tuning::new(&config.solver, config.gravity, config.tick_rate);
        Some(joint.reaction(a, b, &tuning))
    }

    fn joint_and_bodies(&self, id: JointId) -> Option<(&Joint, &Body, &Body)> {
        let joint = self.joint(id)?;
        let (a, b) = joint.def().bodies();
        Some((joint, self.body(a)?, self.body(b)?))
    }
}
