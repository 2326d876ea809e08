//! Points of a joint: a spring pulls the anchors together, or a motor drives them to a relative velocity.

use super::super::body::SolverBody;
use super::super::body_pair::BodyPair;
use super::super::context::Pass;
use super::super::limits::{Faults, clamp_lambda};
use super::super::point_block::{PointBlock, PointGoal};
use super::super::softness::Softness;
use super::pose::JointPose;
use crate::math::{Speed, Unit, Vec2};

#[derive(Clone, Copy, Debug)]
pub(super) enum PointTask {
    /// Pulls the anchors together with isotropic stiffness, in the bias pass only. Impulses times the sum of the
    /// inverse masses are at most `max`.
    Spring { softness: Softness, max: Speed },
    /// Drives the anchors to a relative velocity. Impulses times the sum of the inverse masses are at most `max`.
    Drive { velocity: Vec2<Speed>, max: Speed },
}

#[derive(Clone, Copy, Debug)]
pub(super) struct JointPoint {
    pub(super) slot: u8,
    task: PointTask,
    pub(super) block: PointBlock,
    /// For a motor: the negated target velocity. For a spring: [`Softness::push`] of its stretch.
    bias: Vec2<Speed>,
    /// Whether a block computes the impulse.
    pub(super) is_blocked: bool,
    /// `L`, in world axes.
    pub(super) lambda: Vec2<Speed>,
}

impl JointPoint {
    pub(super) fn new(slot: u8, task: PointTask, lambda: Vec2<Speed>) -> Self {
        let block = PointBlock::default();
        JointPoint { slot, task, block, bias: Vec2::ZERO, is_blocked: false, lambda }
    }

    pub(super) fn softness(&self) -> Option<&Softness> {
        match &self.task {
            PointTask::Spring { softness, .. } => Some(softness),
            PointTask::Drive { .. } => None,
        }
    }

    /// Largest impulse times the sum of the inverse masses; [`Speed::MAX`] is unlimited.
    pub(super) fn impulse_max(&self) -> Speed {
        let (PointTask::Spring { max, .. } | PointTask::Drive { max, .. }) = self.task;
        max
    }

    /// The change of the impulse of a spring in the bias pass, before [`Self::impulse_max`] applies.
    pub(super) fn wanted(
        &self,
        softness: &Softness,
        a: &SolverBody,
        b: &SolverBody,
        faults: &mut Faults,
    ) -> Vec2<Speed> {
        let goal = PointGoal { bias: Vec2::ZERO, push: self.bias };
        self.block.wanted(a, b, goal, softness, self.lambda, faults)
    }

    #[inline]
    pub(super) fn refresh(&mut self, pose: &JointPose) {
        (self.block, self.bias) = match &self.task {
            PointTask::Spring { softness, .. } => {
                let push = Vec2::new(softness.push(pose.gap.x), softness.push(pose.gap.y));
                (pose.block(softness.mass_scale), push)
            }
            PointTask::Drive { velocity, .. } => (pose.block(Unit::ONE), -*velocity),
        };
    }

    #[inline]
    pub(super) fn warm_start(&mut self, bodies: &mut BodyPair<'_>) {
        clamp_lambda(&mut self.lambda.x, bodies.faults);
        clamp_lambda(&mut self.lambda.y, bodies.faults);
        self.block.apply(self.lambda, bodies);
    }

    #[inline]
    pub(super) fn solve(&mut self, pass: Pass, bodies: &mut BodyPair<'_>) {
        let lambda = &mut self.lambda;
        match (&self.task, pass) {
            (PointTask::Spring { softness, max }, Pass::Bias) => {
                let goal = PointGoal { bias: Vec2::ZERO, push: self.bias };
                self.block.solve_within(bodies, goal, softness, *max, lambda);
            }
            (PointTask::Spring { .. }, Pass::Relax) => {}
            (PointTask::Drive { max, .. }, _) => {
                let goal = PointGoal { bias: self.bias, push: Vec2::ZERO };
                self.block.solve_within(bodies, goal, &Softness::RIGID, *max, lambda);
            }
        }
    }
}
