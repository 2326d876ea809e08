//! Rows on the angle of a hinge in a block. The block (`joint/block`) computes their impulses.

use super::super::super::super::context::Pass;
use super::super::super::super::limits::Faults;
use super::super::super::super::pair::BodyPairW;
use super::super::super::super::softness::Softness;
use super::super::super::list::BlockedTask;
use super::super::blocked::BlockedAngle;
use super::{AngleRows, SpringRow, velocity};
use crate::math::{Ratio, Speed, Unit, round_shift};
use crate::simd::{Ints, Lanes};

impl AngleRows<1> {
    /// The row of the spring on the angle, or the row that holds the angle. `None` if there is neither, or if impulses
    /// turn neither body.
    pub(in super::super) fn blocked_row(&self) -> Option<BlockedAngle> {
        let SpringRow { max, mass_scale, holds, .. } = &self.spring;
        (self.has_spring && max.0[0] > 0).then(|| BlockedAngle {
            e: [0, 1].map(|side: usize| Ratio::from_bits(self.e[side].0[0])),
            mass_scale: Unit::from_bits(mass_scale.0[0]),
            task: if holds.0[0] < 0 { BlockedTask::Hold } else { BlockedTask::Spring },
        })
    }

    pub(in super::super) fn blocked_wanted<L: Lanes<1>>(
        &self,
        pass: Pass,
        pair: &BodyPairW<L, 1>,
        faults: &mut Faults,
    ) -> L::Int {
        if self.has_spring { self.wanted_of_spring(pass, pair, faults) } else { L::splat(0) }
    }

    pub(in super::super) fn has_blocked_limits(&self) -> bool {
        self.has_limit && self.limit_max.0[0] > 0
    }

    /// The lever ratios of a limit. Side 0 is the lower limit.
    pub(in super::super) fn limit_ratios(&self, side: usize) -> [Ratio; 2] {
        self.e.each_ref().map(|e| Ratio::from_bits(if side == 0 { e.0[0] } else { -e.0[0] }))
    }

    pub(in super::super) fn limit_is_open(&self, side: usize) -> bool {
        self.limits[side].open.0[0] < 0
    }

    /// `w` of a limit, for an impulse of 0 and without bounds.
    pub(in super::super) fn wanted_of_limit<L: Lanes<1>>(
        &self,
        side: usize,
        pass: Pass,
        softness: &Softness,
        pair: &BodyPairW<L, 1>,
        faults: &mut Faults,
    ) -> i64 {
        let mut vn = Ints([0]);
        L::store(velocity::<L, 1>(&self.e, L::load(&self.limit_max), pair, faults), &mut vn);
        let vn = if side == 0 { i64::from(vn.0[0]) } else { -i64::from(vn.0[0]) };
        let push = i64::from(self.limits[side].push.0[0]);
        match pass {
            _ if self.limit_is_open(side) => vn + push,
            Pass::Bias => round_shift(i64::from(softness.mass_scale.to_bits()) * vn, Unit::FRAC_NBITS) + push,
            Pass::Relax => vn,
        }
    }

    pub(in super::super) fn has_blocked_drive(&self) -> bool {
        self.has_drive && self.drive.max.0[0] > 0
    }

    /// `w` of the motor, whose target is at most the speed at which the limits may be approached.
    pub(in super::super) fn wanted_of_drive<L: Lanes<1>>(
        &self,
        pair: &BodyPairW<L, 1>,
        faults: &mut Faults,
    ) -> i64 {
        let mut vn = Ints([0]);
        L::store(velocity::<L, 1>(&self.e, L::load(&self.drive.max), pair, faults), &mut vn);
        let speed = -i64::from(self.drive.bias.0[0]);
        let speed = if self.has_blocked_limits() {
            let [behind, ahead] = self.limits.each_ref().map(|limit| i64::from(limit.push.0[0]));
            speed.min(ahead).max(-behind)
        } else {
            speed
        };
        i64::from(vn.0[0]) - speed
    }

    pub(in super::super) fn drive_max(&self) -> Speed {
        Speed::from_bits(self.drive.max.0[0])
    }

    pub(in super::super) fn drive_impulse(&mut self) -> &mut i32 {
        &mut self.drive.lambda.0[0]
    }

    pub(in super::super) fn limit_impulse(&mut self, side: usize) -> &mut i32 {
        &mut self.limits[side].lambda.0[0]
    }

    pub(in super::super) fn held_impulse(&mut self) -> &mut i32 {
        &mut self.spring.lambda.0[0]
    }
}
