//! Hinges: revolute joints and welds with rigid anchors, solved in batches.
//!
//! `refresh` computes lever ratios, gains and gaps at the current pose. `warm_start` and `solve` apply the equations of
//! `point_block.rs`, and `angle` applies the equations of the rows on the angle. `prepare` fills batches with hinges of
//! one colour, and returns their impulses to the state.

mod angle;
mod angle_input;
mod batch;
mod blocked;
mod input;
mod jacobian;
mod prepare;
mod refresh;
mod solve;
#[cfg(test)]
mod tests;
mod warm_start;

use alloc::vec::Vec;
use core::mem;

use super::super::batches::{BatchKind, Batches, Coloured};
use super::super::context::{SolverPass, StepContext};
use super::pose::BodyRotation;
use crate::simd::Quad;
use angle::AngleRows;
pub(super) use angle_input::{ANGLE_MAX, AngleParts};
use angle_input::{AngleInput, Memo};
use batch::{Batch, Records};
use input::Input;
pub(super) use input::{HingeBody, Turning, node, shares};
use refresh::{Refresh, Stiffness};
use solve::Solve;
use warm_start::WarmStart;

/// Hinges as a kind of constraint.
#[derive(Clone, Debug)]
pub(super) enum Hinges {}

impl BatchKind for Hinges {
    type Batch<const N: usize> = Batch<N>;
    type Record<const N: usize> = Records<N>;
    type Extra<const N: usize> = AngleRows<N>;

    #[inline(always)]
    fn bodies<const N: usize>(batch: &Batch<N>) -> &[[u32; N]; 2] {
        &batch.bodies
    }

    #[inline(always)]
    fn has_extra<const N: usize>(batch: &Batch<N>) -> bool {
        batch.has_angle
    }
}

#[derive(Clone, Copy)]
pub(super) struct Poses<'a> {
    /// Cosine and sine of the rotation, `M t/2` and `M t^2/6` (see `point_block.rs`).
    pub(super) quads: &'a [Quad],
    pub(super) body_rotations: &'a [BodyRotation],
}

/// Inputs of all hinges, and batches of the overflow and of hinges in blocks. [`HingeShare`] has the other batches.
#[derive(Clone, Debug, Default)]
pub(super) struct HingeSet {
    /// Inputs of all hinges, in the order of the state.
    inputs: Vec<Input>,
    angles: Vec<AngleInput>,
    memo: Memo,
    /// Working memory: the hinges of a colour that have a softness of their own.
    tuned: Vec<u32>,
    /// Hinges that fit no colour.
    overflow: Batches<Hinges, 1>,
    /// Hinges in blocks (`joint/block`), in the order of the blocks.
    blocked: Batches<Hinges, 1>,
    /// Index of the rows on the angle of each hinge in a block.
    blocked_extras: Vec<Option<usize>>,
    /// Whether bodies have moved since the batches were refreshed.
    is_stale: bool,
}

impl HingeSet {
    /// Invalidates the batches. The next operation refreshes each batch before using it, so that the batch is fetched
    /// from memory once.
    pub(super) fn expire(&mut self) {
        self.is_stale = true;
    }

    pub(super) fn warm_start(&mut self, poses: Poses<'_>, context: &StepContext<'_>) {
        let [refresh, _] = refreshes(&mut self.is_stale, poses, context);
        self.overflow.run_in_order(WarmStart { refresh }, context);
        self.blocked.run_in_order(WarmStart { refresh }, context);
    }

    /// Solves the overflow. Also refreshes the hinges in blocks, which `joint/block` solves.
    pub(super) fn solve(&mut self, pass: impl SolverPass, poses: Poses<'_>, context: &StepContext<'_>) {
        let [refresh, _] = refreshes(&mut self.is_stale, poses, context);
        self.overflow.run_in_order(Solve { pass, refresh }, context);
        self.refresh_blocked(refresh, context);
    }
}

/// The coloured hinges that one thread solves.
#[derive(Clone, Debug, Default)]
pub(super) struct HingeShare {
    ordinary: Coloured<Hinges>,
    /// Anchored hinges, whose points are stiffer: they connect a body without another joint to a body that no impulse
    /// moves, and have no softness of their own.
    anchored: Coloured<Hinges>,
    is_stale: bool,
}

impl HingeShare {
    /// Like [`HingeSet::expire`].
    pub(super) fn expire(&mut self) {
        self.is_stale = true;
    }

    pub(super) fn warm_start(&mut self, poses: Poses<'_>, context: &StepContext<'_>) {
        let [refresh, refresh_anchored] = refreshes(&mut self.is_stale, poses, context);
        self.ordinary.run_coloured(WarmStart { refresh }, context);
        self.anchored.run_coloured(WarmStart { refresh: refresh_anchored }, context);
    }

    pub(super) fn solve(&mut self, pass: impl SolverPass, poses: Poses<'_>, context: &StepContext<'_>) {
        let [refresh, refresh_anchored] = refreshes(&mut self.is_stale, poses, context);
        self.ordinary.run_coloured(Solve { pass, refresh }, context);
        self.anchored.run_coloured(Solve { pass, refresh: refresh_anchored }, context);
    }
}

/// The refresh that the next operation performs, for ordinary and for anchored hinges.
fn refreshes<'a>(is_stale: &mut bool, poses: Poses<'a>, context: &StepContext<'_>) -> [Refresh<'a>; 2] {
    let (is_stale, tuning) = (mem::take(is_stale), context.tuning);
    [tuning.joint, tuning.anchored].map(|points| {
        let stiffness = Stiffness { points, limits: tuning.joint };
        Refresh { is_stale, stiffness, poses }
    })
}
