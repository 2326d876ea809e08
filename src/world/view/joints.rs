use crate::body::{Body, JointId};
use crate::math::{Fx, Vec2};
use crate::solver::{Joint, JointKind, JointPart, Tuning, Weld};
use crate::world::World;

impl World {
    /// Returns the anchors of a joint on body A and on body B, in world coordinates in metres. This and all other
    /// methods for one joint return `None` if the joint is not in the world.
    #[must_use]
    pub fn joint_anchors(&self, id: JointId) -> Option<(Vec2<Fx>, Vec2<Fx>)> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        let def = joint.def();
        Some((a.transform().apply(def.frame_a.anchor), b.transform().apply(def.frame_b.anchor)))
    }

    /// Returns the angle of B's frame relative to A's frame in radians, counter-clockwise, including full turns. Full
    /// turns are counted only while the joint acts on a dynamic body.
    #[must_use]
    pub fn joint_angle(&self, id: JointId) -> Option<Fx> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        Some(joint.angle(a, b))
    }

    /// Returns the rate of the joint angle in rad/s.
    #[must_use]
    pub fn joint_angular_velocity(&self, id: JointId) -> Option<Fx> {
        let (_, a, b) = self.joint_and_bodies(id)?;
        Some(b.angular_velocity().saturating_sub(a.angular_velocity()))
    }

    /// Returns the position of B's anchor in the joint's frame on A, in metres. `x` is the translation of prismatic and
    /// wheel joints.
    #[must_use]
    pub fn joint_translation(&self, id: JointId) -> Option<Vec2<Fx>> {
        let (joint, a, _) = self.joint_and_bodies(id)?;
        let (from, to) = self.joint_anchors(id)?;
        Some(joint.axes(a).apply_inverse_wide(to - from))
    }

    /// Returns the velocity of B's anchor relative to A, in the joint's frame on A, in m/s.
    #[must_use]
    pub fn joint_velocity(&self, id: JointId) -> Option<Vec2<Fx>> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        let (_, anchor) = self.joint_anchors(id)?;
        Some(joint.axes(a).apply_inverse_wide(b.velocity_at(anchor) - a.velocity_at(anchor)))
    }

    /// Returns the distance between the anchors in metres.
    #[must_use]
    pub fn joint_length(&self, id: JointId) -> Option<Fx> {
        self.joint_anchors(id).map(|(a, b)| a.distance(b))
    }

    /// Returns the distance in metres by which the bodies violate the joint. `None` for motor and filter joints.
    ///
    /// The error is the distance of the anchors for a revolute joint or a weld with rigid anchors, the offset across
    /// the axis for a prismatic or wheel joint, the deviation from the allowed lengths for a distance joint, the
    /// distance of the teeth along the pitch line for a gear or rack, and the missing length of the rope for a pulley.
    /// For a gear without a pitch point, the error is an angle in radians. Springs, motors and the limits of other
    /// kinds do not count: the error of a weld with soft anchors is 0.
    #[doc(alias = "separation")]
    #[must_use]
    pub fn joint_error(&self, id: JointId) -> Option<Fx> {
        match &self.joint(id)?.def().kind {
            JointKind::Revolute(_) | JointKind::Weld(Weld { linear: None, .. }) => self.joint_length(id),
            JointKind::Weld(_) => Some(Fx::ZERO),
            JointKind::Prismatic(_) | JointKind::Wheel(_) => {
                self.joint_translation(id).map(|translation| translation.y.saturating_abs())
            }
            JointKind::Distance(distance) => {
                let length = self.joint_length(id)?;
                Some(length.saturating_sub(distance.nearest_allowed(length)).saturating_abs())
            }
            JointKind::Gear(_) | JointKind::Rack(_) | JointKind::Pulley(_) => {
                let (joint, a, b) = self.joint_and_bodies(id)?;
                joint.coupling_error(a, b)
            }
            JointKind::Motor(_) | JointKind::Filter => None,
        }
    }

    /// Returns whether [`World::joint_error`] is an angle in radians, as for a gear without a pitch point.
    #[must_use]
    pub fn joint_error_is_angle(&self, id: JointId) -> Option<bool> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        Some(joint.is_coupling_error_angle(a, b))
    }

    /// Returns the largest [error](World::joint_error) of enabled joints in metres; 0 without joints. Errors that are
    /// angles do not count.
    #[must_use]
    pub fn widest_joint_gap(&self) -> Fx {
        let enabled = self.joints().filter(|(_, joint)| joint.def().enabled);
        let lengths = enabled.filter(|&(id, _)| self.joint_error_is_angle(id) == Some(false));
        lengths.filter_map(|(id, _)| self.joint_error(id)).fold(Fx::ZERO, Fx::max)
    }

    /// Returns the force in N that the joint exerted on B in the last sub-step, and the torque in N m about B's anchor,
    /// computed with the present masses and poses. 0 while the joint is disabled or neither body has mass.
    #[doc(alias = "reaction force")]
    #[must_use]
    pub fn joint_force(&self, id: JointId) -> Option<(Vec2<Fx>, Fx)> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        let config = &self.state.config;
        let tuning = Tuning::new(&config.solver, config.gravity, config.tick_rate);
        Some(joint.reaction(a, b, &tuning))
    }

    /// Returns the share of [`World::joint_force`] of one part of the joint: its motor, limits or springs. 0 if the
    /// joint has no such part. For example, [`JointPart::Motor`] gives the torque of a motor without the force that
    /// holds the hinge together.
    #[doc(alias = "motor torque")]
    #[must_use]
    pub fn joint_part_force(&self, id: JointId, part: JointPart) -> Option<(Vec2<Fx>, Fx)> {
        let (joint, a, b) = self.joint_and_bodies(id)?;
        let config = &self.state.config;
        let tuning = Tuning::new(&config.solver, config.gravity, config.tick_rate);
        Some(joint.part_reaction(part, (a, b), &tuning))
    }

    fn joint_and_bodies(&self, id: JointId) -> Option<(&Joint, &Body, &Body)> {
        let joint = self.joint(id)?;
        let (a, b) = joint.def().bodies();
        Some((joint, self.body(a)?, self.body(b)?))
    }
}
