//! The motor of a hinge.

use super::super::super::super::limits::Faults;
use super::super::super::super::pair::{BodyPairW, beyond, clamp};
use super::super::batch::Batch;
use super::{AngleRows, DriveRow, LimitRow, velocity};
use crate::simd::Lanes;

impl<const N: usize> AngleRows<N> {
    #[inline(always)]
    pub(super) fn solve_drive<L: Lanes<N>>(
        &mut self,
        batch: &Batch<N>,
        pair: &mut BodyPairW<L, N>,
        faults: &mut Faults,
    ) {
        let target = self.drive_target::<L>();
        let DriveRow { lambda, max, .. } = &self.drive;
        let (old, max) = (L::load(lambda), L::load(max));
        let w = L::sub_saturating(velocity::<L, N>(&self.e, max, pair, faults), target);
        // A motor that keeps exerting its largest torque needs no effective mass.
        let alone = clamp::<L, N>(L::sub_saturating(old, w), max);
        if L::any(beyond::<L, N>(L::sub(alone, old), L::splat(0))) {
            self.pin::<L>(batch);
            let new = clamp::<L, N>(L::sub_saturating(old, self.pinned.impulse_of::<L>(w)), max);
            L::store(new, &mut self.drive.lambda);
            self.turn(batch, pair, L::sub(new, old), faults);
        }
    }

    /// Target speed, clamped to the speeds at which the limits may be approached (see `Parts::drive_within`).
    #[inline(always)]
    fn drive_target<L: Lanes<N>>(&self) -> L::Int {
        let zero = L::splat(0);
        let speed = L::sub(zero, L::load(&self.drive.bias));
        if !self.has_limit {
            return speed;
        }
        // A saturated push may be the smallest number, whose negative does not fit.
        let push = |limit: &LimitRow<N>| L::max(L::load(&limit.push), L::splat(-i32::MAX));
        let [behind, ahead] = self.limits.each_ref().map(push);
        let within = L::max(L::min(speed, ahead), L::sub(zero, behind));
        L::select(L::greater(L::load(&self.limit_max), zero), within, speed)
    }
}
