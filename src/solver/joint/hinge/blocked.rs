//! Hinges in blocks. The block (`joint/block`) computes their impulses.

use super::super::super::batches::{BatchParts, Operation};
use super::super::super::context::{Pass, StepContext};
use super::super::super::limits::Faults;
use super::super::super::pair::BodyPairW;
use super::super::super::row::MassFractions;
use super::super::super::softness::Softness;
use super::super::list::BlockedTask;
use super::angle::AngleRows;
use super::refresh::Refresh;
use super::solve::{ratios_of, relative_velocity, wanted};
use super::{HingeSet, Hinges, Poses};
use crate::math::{Ratio, Speed, Unit, Vec2};
use crate::simd::{Lanes, Scalar};

#[derive(Clone, Copy)]
struct RefreshBlocked<'a> {
    refresh: Refresh<'a>,
}

impl Operation<Hinges> for RefreshBlocked<'_> {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Hinges, N>) {
        let BatchParts { batch, record, extra, bodies, .. } = parts;
        self.refresh.refresh::<L, N>(batch, record, extra, bodies);
    }
}

pub(in super::super) struct BlockedHinge {
    pub(in super::super) changed: [u32; 2],
    pub(in super::super) fractions: MassFractions,
    pub(in super::super) e: [Vec2<Ratio>; 2],
    /// The row that holds the angle, or the spring on the angle.
    pub(in super::super) angle: Option<BlockedAngle>,
    pub(in super::super) has_limits: bool,
    pub(in super::super) has_drive: bool,
    pub(in super::super) softness: Softness,
}

pub(in super::super) struct BlockedAngle {
    pub(in super::super) e: [Ratio; 2],
    pub(in super::super) mass_scale: Unit,
    pub(in super::super) task: BlockedTask,
}

impl HingeSet {
    /// Adds a hinge to the hinges in blocks, and returns its index among them.
    pub(in super::super) fn push_blocked(&mut self, index: u32) -> usize {
        let HingeSet { inputs, angles, blocked, blocked_extras, .. } = self;
        blocked.push(inputs, angles, core::iter::once(index));
        let has_angle = inputs[index as usize].angle.is_some();
        blocked_extras.push(has_angle.then(|| blocked.extras.len() - 1));
        blocked_extras.len() - 1
    }

    pub(super) fn refresh_blocked(&mut self, refresh: Refresh<'_>, context: &StepContext<'_>) {
        self.blocked.run_in_order(RefreshBlocked { refresh }, context);
    }

    fn blocked_softness(&self, number: usize) -> &Softness {
        &self.blocked.records[number].softness
    }

    pub(in super::super) fn blocked_hinge(&self, number: usize) -> BlockedHinge {
        let batch = &self.blocked.batches[number];
        let record = &self.blocked.records[number];
        let ratio = |side: usize| {
            let [x, y] = [0, 1].map(|axis: usize| Ratio::from_bits(batch.e[side][axis].0[0]));
            Vec2::new(x, y)
        };
        let [a, b] = [0, 1].map(|side: usize| Unit::from_bits(record.shape.fractions[side].0[0]));
        let has_limits = self.blocked_rows(number).is_some_and(AngleRows::has_blocked_limits);
        BlockedHinge {
            softness: *self.blocked_softness(number),
            has_limits,
            has_drive: self.blocked_rows(number).is_some_and(AngleRows::has_blocked_drive),
            changed: [batch.changed[0][0], batch.changed[1][0]],
            fractions: MassFractions { a, b },
            e: [ratio(0), ratio(1)],
            angle: self.blocked_extras[number].and_then(|extra| self.blocked.extras[extra].blocked_row()),
        }
    }

    /// The changes of the impulses at the point and on the angle, if an iteration solved each of these parts alone. The
    /// impulses start at 0, because [`Self::take_impulses`] has moved them to the block.
    pub(in super::super) fn blocked_wanted(
        &self,
        number: usize,
        pass: Pass,
        poses: Poses<'_>,
        context: &StepContext<'_>,
        faults: &mut Faults,
    ) -> [i32; 3] {
        type L = Scalar<1>;
        let batch = &self.blocked.batches[number];
        let softness = self.blocked_softness(number);
        let pair = BodyPairW::<L, 1>::load(context.bodies, &batch.bodies);
        let (e_a, e_b) = ratios_of::<L, 1>(batch, pass, poses.quads);
        let vr = relative_velocity::<L, 1>(e_a, e_b, &pair, faults);
        let point = [0, 1].map(|axis: usize| {
            let [w] = wanted::<L, 1>(batch, axis, vr[axis], pass, softness);
            w.saturating_neg()
        });
        let angle = self.blocked_extras[number].map_or(0, |extra| {
            self.blocked.extras[extra].blocked_wanted::<L>(pass, &pair, faults)[0].saturating_neg()
        });
        [point[0], point[1], angle]
    }

    fn blocked_rows(&self, number: usize) -> Option<&AngleRows<1>> {
        self.blocked_extras[number].map(|extra| &self.blocked.extras[extra])
    }

    fn blocked_rows_mut(&mut self, number: usize) -> Option<&mut AngleRows<1>> {
        self.blocked_extras[number].map(|extra| &mut self.blocked.extras[extra])
    }

    /// The lever ratios of a limit. Side 0 is the lower limit.
    pub(in super::super) fn blocked_limit(&self, number: usize, side: usize) -> [Ratio; 2] {
        self.blocked_rows(number).map_or([Ratio::ZERO; 2], |rows| rows.limit_ratios(side))
    }

    pub(in super::super) fn blocked_limit_is_open(&self, number: usize, side: usize) -> bool {
        self.blocked_rows(number).is_none_or(|rows| rows.limit_is_open(side))
    }

    /// The change of the impulse of a limit if an iteration solved this limit alone, with an impulse of 0 so far.
    pub(in super::super) fn blocked_limit_wanted(
        &self,
        number: usize,
        side: usize,
        pass: Pass,
        context: &StepContext<'_>,
        faults: &mut Faults,
    ) -> i64 {
        let bodies = &self.blocked.batches[number].bodies;
        let pair = BodyPairW::<Scalar<1>, 1>::load(context.bodies, bodies);
        let softness = self.blocked_softness(number);
        let rows = self.blocked_rows(number);
        rows.map_or(0, |rows| -rows.wanted_of_limit(side, pass, softness, &pair, faults))
    }

    pub(in super::super) fn blocked_drive_ratios(&self, number: usize) -> [Ratio; 2] {
        self.blocked_limit(number, 0)
    }

    pub(in super::super) fn blocked_drive_wanted(
        &self,
        number: usize,
        context: &StepContext<'_>,
        faults: &mut Faults,
    ) -> i64 {
        let bodies = &self.blocked.batches[number].bodies;
        let pair = BodyPairW::<Scalar<1>, 1>::load(context.bodies, bodies);
        self.blocked_rows(number).map_or(0, |rows| -rows.wanted_of_drive(&pair, faults))
    }

    pub(in super::super) fn blocked_drive_max(&self, number: usize) -> Speed {
        self.blocked_rows(number).map_or(Speed::ZERO, AngleRows::drive_max)
    }

    pub(in super::super) fn take_drive_impulse(&mut self, number: usize) -> i32 {
        self.blocked_rows_mut(number).map_or(0, |rows| core::mem::take(rows.drive_impulse()))
    }

    pub(in super::super) fn return_drive_impulse(&mut self, number: usize, impulse: i32) {
        if let Some(rows) = self.blocked_rows_mut(number) {
            *rows.drive_impulse() = impulse;
        }
    }

    pub(in super::super) fn take_limit_impulse(&mut self, number: usize, side: usize) -> i32 {
        self.blocked_rows_mut(number).map_or(0, |rows| core::mem::take(rows.limit_impulse(side)))
    }

    pub(in super::super) fn return_limit_impulse(&mut self, number: usize, side: usize, impulse: i32) {
        if let Some(rows) = self.blocked_rows_mut(number) {
            *rows.limit_impulse(side) = impulse;
        }
    }

    /// Moves impulses to the block: along x and y at the point, and on the angle.
    pub(in super::super) fn take_impulses(&mut self, number: usize) -> [i32; 3] {
        let HingeSet { blocked, blocked_extras, .. } = self;
        let [x, y] = &mut blocked.batches[number].lambda;
        let angle =
            blocked_extras[number].map_or(0, |extra| core::mem::take(blocked.extras[extra].held_impulse()));
        [core::mem::take(&mut x.0[0]), core::mem::take(&mut y.0[0]), angle]
    }

    /// Returns impulses from the block to the hinge. Each must be within ±`IMPULSE_MAX`, because the hinge's impulses are
    /// stored in the state, which allows no larger ones.
    pub(in super::super) fn return_impulses(&mut self, number: usize, [x, y, angle]: [i32; 3]) {
        let HingeSet { blocked, blocked_extras, .. } = self;
        let batch = &mut blocked.batches[number];
        (batch.lambda[0].0[0], batch.lambda[1].0[0]) = (x, y);
        if let Some(extra) = blocked_extras[number] {
            *blocked.extras[extra].held_impulse() = angle;
        }
    }
}
