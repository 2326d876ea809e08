//! Points of a joint: a spring pulls the anchors together, or a motor drives them to a relative velocity.

use super::super::body::SolverBody;
use super::super::body_pair::BodyPair;
use super::super::context::Pass;
use super::super::limits::{Faults, IMPULSE_MAX, STEP_MAX, shortened};
use super::super::point_block::{PointBlock, PointGoal};
use super::super::softness::Softness;
use super::pose::JointPose;
use crate::fx;
use crate::math::{Fx, Speed, Unit, Vec2};

/// Largest component of [`PointGoal::push`] in m/s, for a spring with limited force. It is so much larger than the
/// velocities of the bodies that they hardly change the direction of the impulse before it is shortened to the limit.
const PUSH_MAX: Fx = fx!(1048576);

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
    goal: PointGoal,
    /// Whether a block computes the impulse.
    pub(super) is_blocked: bool,
    /// `L`, in world axes.
    pub(super) lambda: Vec2<Speed>,
}

impl JointPoint {
    pub(super) fn new(slot: u8, task: PointTask, lambda: Vec2<Speed>) -> Self {
        let block = PointBlock::default();
        JointPoint { slot, task, block, goal: PointGoal::default(), is_blocked: false, lambda }
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
    ) -> [i64; 2] {
        self.block.wanted(a, b, self.goal, softness, self.lambda, faults)
    }

    #[inline]
    pub(super) fn refresh(&mut self, pose: &JointPose) {
        let mass_scale = match &self.task {
            PointTask::Spring { softness, max } => {
                let most = if *max == Speed::MAX { IMPULSE_MAX.into() } else { PUSH_MAX };
                self.goal.push = softness.push_along(pose.gap, most);
                softness.mass_scale
            }
            PointTask::Drive { velocity, .. } => {
                self.goal.bias = -*velocity;
                Unit::ONE
            }
        };
        self.block = pose.block(mass_scale);
    }

    #[inline]
    pub(super) fn warm_start(&mut self, bodies: &mut BodyPair<'_>) {
        let lambda = [self.lambda.x, self.lambda.y].map(|part| part.to_bits().into());
        self.lambda = shortened(lambda, STEP_MAX, bodies.faults);
        self.block.apply(self.lambda, bodies);
    }

    #[inline]
    pub(super) fn solve(&mut self, pass: Pass, bodies: &mut BodyPair<'_>) {
        let lambda = &mut self.lambda;
        match (&self.task, pass) {
            (PointTask::Spring { softness, max }, Pass::Bias) => {
                self.block.solve_within(bodies, self.goal, softness, *max, lambda);
            }
            (PointTask::Spring { .. }, Pass::Relax) => {}
            (PointTask::Drive { max, .. }, _) => {
                self.block.solve_within(bodies, self.goal, &Softness::RIGID, *max, lambda);
            }
        }
    }
}
