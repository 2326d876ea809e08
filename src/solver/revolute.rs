//! The hinge: a point block that is refreshed after every displacement, arms and gains together.
//!
//! Gains older than their arms over-correct and explode at long arms, and arms kept for the tick blow a grid of
//! joints up (`docs/DESIGN.md` has the figures).

use super::body::SolverBody;
use super::contact::Pass;
use super::joint::{Joint, JointDef};
use super::limits::{Faults, clamp_warm_start};
use super::point_block::PointBlock;
use super::row::{Lever, MassFractions};
use super::settings::Tuning;
use super::softness::Softness;
use crate::body::{Body, JointId};
use crate::math::{Fx, Length, Ratio, Reciprocal, Rot, Speed, Step, Unit, Vec2, mul, round_shift, saturate};

/// A hinge, for one tick.
#[derive(Clone, Debug)]
pub(crate) struct RevoluteConstraint {
    pub(crate) joint: JointId,
    body_a: u32,
    body_b: u32,
    /// Anchors from the centres of mass, in the frames of the bodies.
    local_a: Vec2<Length>,
    local_b: Vec2<Length>,
    inverse_gyration_a: Reciprocal,
    inverse_gyration_b: Reciprocal,
    fractions: MassFractions,
    /// Centre of mass of B from that of A at the start of the tick.
    between: Vec2<Fx>,
    block: PointBlock,
    /// How far the anchors are apart, at the last refresh.
    gap: Vec2<Step>,
    /// `L`, in world axes.
    lambda: Vec2<Speed>,
    /// Lever ratios for the solve pass.
    ratios_ahead: (Vec2<Ratio>, Vec2<Ratio>),
}

impl RevoluteConstraint {
    pub(crate) fn prepare(
        id: JointId,
        joint: &Joint,
        (slot_a, a): (u32, &Body),
        (slot_b, b): (u32, &Body),
    ) -> Self {
        let JointDef::Revolute(def) = &joint.def;
        RevoluteConstraint {
            joint: id,
            body_a: slot_a,
            body_b: slot_b,
            local_a: (def.anchor_a - a.local_centre_of_mass()).narrow(),
            local_b: (def.anchor_b - b.local_centre_of_mass()).narrow(),
            inverse_gyration_a: a.mass.inverse_gyration,
            inverse_gyration_b: b.mass.inverse_gyration,
            fractions: MassFractions::of(a, b),
            between: b.centre_of_mass() - a.centre_of_mass(),
            block: PointBlock::default(),
            gap: Vec2::ZERO,
            lambda: joint.lambda,
            ratios_ahead: Default::default(),
        }
    }

    /// Arms, gains and gap at the present pose.
    pub(crate) fn refresh(&mut self, bodies: &[SolverBody], rotations: &[Rot]) {
        let (a, b) = (self.body_a as usize, self.body_b as usize);
        let arm_a = WideArm::rotated(rotations[a], self.local_a);
        let arm_b = WideArm::rotated(rotations[b], self.local_b);
        let moved = bodies[b].shift - bodies[a].shift;
        self.gap = Vec2::new(
            gap(self.between.x, moved.x, arm_b.x - arm_a.x),
            gap(self.between.y, moved.y, arm_b.y - arm_a.y),
        );
        self.block = PointBlock::new(
            Lever { arm: arm_a.narrow(), inverse_gyration: self.inverse_gyration_a },
            Lever { arm: arm_b.narrow(), inverse_gyration: self.inverse_gyration_b },
            self.fractions,
        );
    }

    /// Looks ahead along the turn of the coming sub-step, at the velocities that the last one has left.
    pub(crate) fn aim(&mut self, bodies: &[SolverBody], h: Reciprocal, tuning: &Tuning) {
        let turn = |body: u32, inverse_gyration: Reciprocal| -> Unit {
            let step: Step = h.times(bodies[body as usize].spin);
            inverse_gyration.times(step)
        };
        let turns = (turn(self.body_a, self.inverse_gyration_a), turn(self.body_b, self.inverse_gyration_b));
        self.ratios_ahead = self.block.ratios_ahead(turns, tuning.joint_stretch);
    }

    pub(crate) fn warm_start(&mut self, bodies: &mut [SolverBody], faults: &mut Faults) {
        clamp_warm_start(&mut self.lambda.x, faults);
        clamp_warm_start(&mut self.lambda.y, faults);
        let (a, b) = SolverBody::pair(bodies, self.body_a, self.body_b);
        self.block.apply(self.lambda, a, b, faults);
    }

    /// Removes the relative velocity of the anchors and, in the bias pass, their gap.
    pub(crate) fn solve(
        &mut self,
        pass: Pass,
        tuning: &Tuning,
        bodies: &mut [SolverBody],
        faults: &mut Faults,
    ) {
        let (softness, ratios) = match pass {
            Pass::Bias => (&tuning.joint, self.ratios_ahead),
            Pass::Relax => (&Softness::RIGID, self.block.ratios()),
        };
        let bias = Vec2::new(mul(self.gap.x, softness.bias_rate), mul(self.gap.y, softness.bias_rate));
        let (a, b) = SolverBody::pair(bodies, self.body_a, self.body_b);
        self.block.solve(a, b, ratios, bias, softness, &mut self.lambda, faults);
    }

    pub(crate) fn store(&self, joint: &mut Joint) {
        joint.lambda = self.lambda;
    }
}

/// A rotated arm before it is rounded: 52 fraction bits. The gap is the small difference of two long arms, so
/// they are subtracted first.
#[derive(Clone, Copy)]
struct WideArm {
    x: i64,
    y: i64,
}

impl WideArm {
    fn rotated(rotation: Rot, local: Vec2<Length>) -> Self {
        let (c, s) = (i64::from(rotation.cos.to_bits()), i64::from(rotation.sin.to_bits()));
        let (x, y) = (i64::from(local.x.to_bits()), i64::from(local.y.to_bits()));
        WideArm { x: c * x - s * y, y: s * x + c * y }
    }

    fn narrow(self) -> Vec2<Length> {
        let narrow = |wide: i64| Length::from_bits(saturate(round_shift(wide, 30)));
        Vec2::new(narrow(self.x), narrow(self.y))
    }
}

/// `C = xB - xA + rB - rA` on one axis: exact until it is rounded once.
fn gap(between: Fx, moved: Step, arms: i64) -> Step {
    // 20 bits fewer than the arms' 52 are the 32 of a world coordinate.
    let wide = between
        .to_bits()
        .saturating_add(i64::from(moved.to_bits()) << 5)
        .saturating_add(round_shift(arms, 20));
    Step::from_bits(saturate(round_shift(wide, 5)))
}
