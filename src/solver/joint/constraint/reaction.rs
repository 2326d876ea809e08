//! Forces that joints have exerted.

use super::super::super::body::SolverBody;
use super::super::super::context::StepContext;
use super::super::super::settings::Tuning;
use super::super::Pulley;
use super::super::def::{JointFrame, JointKind};
use super::super::hinge::{HingeBody, HingeShare};
use super::super::pose::{BodyRotation, Ends};
use super::super::state::Joint;
use super::{JointSet, hinge_parts};
use crate::body::Body;
use crate::math::{Fx, Vec2, fx_mul, widen};
use crate::simd::{Machine, Quad};

impl JointSet {
    /// The force, and the torque about B's anchor, that a joint exerted on B in the last sub-step. Both are computed
    /// from the velocity that the joint's warm start gives to a body at rest. Overwrites the set's constraints.
    pub(in crate::solver) fn reaction(
        &mut self,
        joint: &Joint,
        (a, b): (&Body, &Body),
        tuning: &Tuning,
    ) -> (Vec2<Fx>, Fx) {
        if !joint.is_solved() || !(a.has_mass() || b.has_mass()) {
            return (Vec2::ZERO, Fx::ZERO);
        }
        self.parts.resize_with(1, HingeShare::default);
        self.clear();
        // Index 0 is the ground.
        let indices = [1, 2];
        let end = |index: u32, body: &Body, frame: &JointFrame| match frame.is_far() {
            true => HingeBody::far_anchor(index, frame.far_pose(body), frame),
            false => HingeBody::new(index, body, tuning.rate),
        };
        let ends = [end(indices[0], a, &joint.def.frame_a), end(indices[1], b, &joint.def.frame_b)];
        self.turning.extend(ends.map(|end| end.turning));
        self.body_rotations.resize(self.body_rotations.len().max(3), BodyRotation::default());
        self.quads.resize(self.quads.len().max(3), Quad::default());
        match hinge_parts(&joint.def.kind) {
            Some(parts) => {
                let input = self.hinges.push_input(0, joint, ends.each_ref(), &parts, tuning);
                self.hinges.push_overflow(core::iter::once(input));
            }
            None => self.list.push(0, joint, indices, [a, b], tuning, false),
        }
        let (mut bodies, mut faults) = ([SolverBody::default(); 3], 0);
        let context = StepContext::new(Machine::default(), tuning, &mut bodies, &mut faults);
        self.refresh(&context);
        let pose = Ends::prepare(joint, indices, [a, b]).pose(context.bodies, &self.body_rotations);
        self.split().shares().for_each(|mut share| share.warm_start(&context));
        if let JointKind::Pulley(pulley) = &joint.def.kind {
            return pulley_reaction(pulley, joint, (a, b), &bodies, tuning);
        }
        let measured = |is_a: bool| {
            let (body, moved, arm) = match is_a {
                true => (a, bodies[1].reversed(), pose.reach_of_a().arm),
                false => (b, bodies[2], pose.lever_b.arm),
            };
            let per_second = |speed| fx_mul(widen(speed), body.mass()).saturating_mul_int(tuning.rate.into());
            let force = Vec2::new(per_second(moved.velocity.x), per_second(moved.velocity.y));
            let torque = fx_mul(per_second(moved.spin), body.radius_of_gyration());
            (force, torque.saturating_sub(arm.widen().cross(force)))
        };
        // The velocity of the lighter body has more significant bits. If a body cannot turn, its spin is 0, and the
        // torque is measured at the other body.
        let is_lighter = a.has_mass() && (!b.has_mass() || a.mass() < b.mass());
        let (force, _) = measured(is_lighter);
        let torque = match (turns(a), turns(b)) {
            (false, false) => Fx::ZERO,
            (true, b_turns) if is_lighter || !b_turns => joint.torque_on_b(measured(true).1, pose.gap),
            _ => measured(false).1,
        };
        (force, torque)
    }
}

fn turns(body: &Body) -> bool {
    body.has_mass() && body.turns()
}

/// The force of a rope on B. The impulse of either body gives the tension.
fn pulley_reaction(
    pulley: &Pulley,
    joint: &Joint,
    (a, b): (&Body, &Body),
    bodies: &[SolverBody; 3],
    tuning: &Tuning,
) -> (Vec2<Fx>, Fx) {
    let (body, moved, ratio) = match a.has_mass() && (!b.has_mass() || a.mass() < b.mass()) {
        true => (a, &bodies[1], pulley.ratio),
        false => (b, &bodies[2], Fx::ONE),
    };
    let change = moved.velocity.widen().length();
    let force = fx_mul(fx_mul(change, body.mass()).saturating_mul_int(tuning.rate.into()), ratio);
    let to_wheel = pulley.wheel_b - b.transform().apply(joint.def.frame_b.anchor);
    let direction = to_wheel.normalized().unwrap_or(Vec2::Y);
    (direction.widen().scale(force), Fx::ZERO)
}
