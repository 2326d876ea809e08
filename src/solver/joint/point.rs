//! A joint's points: pinned, pulled by a spring, or pushed to a velocity.

use super::super::body::SolverBody;
use super::super::contact::Pass;
use super::super::limits::{Faults, clamp_warm_start};
use super::super::point_block::PointBlock;
use super::super::settings::Tuning;
use super::super::softness::Softness;
use super::place::Place;
use crate::math::{Ratio, Speed, Step, Unit, Vec2, mul};

/// What a point is for.
#[derive(Clone, Copy, Debug)]
pub(super) enum PointTask {
    /// Keeps the anchors on each other.
    Pin,
    /// Pulls them onto each other, with impulses times `mA + mB` of a largest size. In the bias pass only, as for rows.
    Spring { softness: Softness, max: Speed },
    /// Brings their relative velocity to another, with impulses times `mA + mB` of a largest size.
    Drive { velocity: Vec2<Speed>, max: Speed },
}

/// A point of a joint, for one tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointPoint {
    pub(super) slot: u8,
    task: PointTask,
    pub(super) block: PointBlock,
    /// A velocity that is asked for, reversed: of a spring, the part that comes from its stretch.
    bias: Vec2<Speed>,
    /// `L`, in world axes.
    pub(super) lambda: Vec2<Speed>,
    /// Lever ratios for the bias pass.
    ratios_ahead: (Vec2<Ratio>, Vec2<Ratio>),
}

impl JointPoint {
    pub(super) fn new(slot: u8, task: PointTask, lambda: Vec2<Speed>) -> Self {
        let block = PointBlock::default();
        JointPoint { slot, task, block, bias: Vec2::ZERO, lambda, ratios_ahead: Default::default() }
    }

    /// Arms, gains and gap at the present pose.
    #[inline]
    pub(super) fn refresh(&mut self, place: &Place, tuning: &Tuning) {
        self.block = PointBlock::new(place.lever_a, place.lever_b, place.fractions);
        self.bias = match &self.task {
            PointTask::Pin => {
                let gap: Vec2<Step> = place.gap.narrow();
                Vec2::new(mul(gap.x, tuning.joint.bias_rate), mul(gap.y, tuning.joint.bias_rate))
            }
            PointTask::Spring { softness, .. } => {
                Vec2::new(softness.push(place.gap.x), softness.push(place.gap.y))
            }
            PointTask::Drive { velocity, .. } => -*velocity,
        };
    }

    /// Looks ahead along the turns of the bodies in the coming sub-step.
    #[inline]
    pub(super) fn aim(&mut self, turns: (Unit, Unit), tuning: &Tuning) {
        self.ratios_ahead = self.block.ratios_ahead(turns, tuning.joint_stretch);
    }

    #[inline]
    pub(super) fn warm_start(&mut self, a: &mut SolverBody, b: &mut SolverBody, faults: &mut Faults) {
        clamp_warm_start(&mut self.lambda.x, faults);
        clamp_warm_start(&mut self.lambda.y, faults);
        self.block.apply(self.lambda, a, b, faults);
    }

    #[inline]
    pub(super) fn solve(
        &mut self,
        pass: Pass,
        tuning: &Tuning,
        a: &mut SolverBody,
        b: &mut SolverBody,
        faults: &mut Faults,
    ) {
        let lambda = &mut self.lambda;
        match (&self.task, pass) {
            (PointTask::Pin, Pass::Bias) => {
                self.block.solve(a, b, self.ratios_ahead, self.bias, &tuning.joint, lambda, faults);
            }
            (PointTask::Pin, Pass::Relax) => {
                let ratios = self.block.ratios();
                self.block.solve(a, b, ratios, Vec2::ZERO, &Softness::RIGID, lambda, faults);
            }
            (PointTask::Spring { softness, max }, Pass::Bias) => {
                let push = self.bias;
                self.block.solve_within(a, b, (Vec2::ZERO, push), softness, *max, lambda, faults);
            }
            (PointTask::Spring { .. }, Pass::Relax) => {}
            (PointTask::Drive { max, .. }, _) => {
                let bias = (self.bias, Vec2::ZERO);
                self.block.solve_within(a, b, bias, &Softness::RIGID, *max, lambda, faults);
            }
        }
    }
}
