//! The rows and points of a joint, which each kind of joint adds to [`Parts`].

use alloc::vec::Vec;

use super::super::softness::Softness;
use super::options::{Drive, JointLimit, Soft, Spring};
use super::point::{JointPoint, PointTask};
use super::row::{JointRow, RowTask};
use super::state::JointImpulses;
use crate::math::{Fx, Vec2, fx_div, fx_mul};
use crate::solver::limits::SPEED_MAX;

/// Indices into [`JointImpulses`]. A point uses the given slot and the next one, for x and y.
pub(super) mod slot {
    /// A spring along or about an axis, or the row that holds the angle of a weld.
    pub(in super::super) const SPRING: u8 = 0;
    pub(in super::super) const DRIVE: u8 = 1;
    /// The lower limit; the upper limit has the next slot. In a motor joint, the point of the linear spring.
    pub(in super::super) const LIMIT: u8 = 2;
    /// The point that pins the anchors, or one or two rows that hold a position. In a motor joint, the point of the
    /// linear motor.
    pub(in super::super) const HOLD: u8 = 4;
}

/// The position on which a row of a joint acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    /// The angle of B's frame relative to A's frame.
    Angle,
    /// The position of B's anchor along the x axis of A's frame.
    Along,
    /// The position of B's anchor along the y axis of A's frame.
    Across,
    /// Like `Across`, but at the point at which an impulse does not rotate the bodies relative to each other. For
    /// prismatic joints, which also hold the angle.
    AcrossBalanced,
    /// The distance between the anchors.
    Apart,
    /// The position that the coupling with this index computes.
    Coupled(u32),
}

pub(super) struct Parts<'a> {
    pub(super) rows: &'a mut Vec<JointRow>,
    pub(super) points: &'a mut Vec<JointPoint>,
    pub(super) impulses: &'a JointImpulses,
    /// Masses of the two bodies in kg; 0 for a body that no impulse moves.
    pub(super) masses: (Fx, Fx),
    /// Sub-steps per second.
    pub(super) rate: u32,
    /// Softness of limits and of rows that hold a position.
    pub(super) softness: Softness,
    /// Index of the joint's coupling, if it has one.
    pub(super) coupling: u32,
}

impl Parts<'_> {
    pub(super) fn spring(&mut self, direction: Direction, spring: Option<Spring>) {
        self.spring_within(direction, spring, JointLimit { lower: Fx::MIN, upper: Fx::MAX });
    }

    pub(super) fn spring_within(&mut self, direction: Direction, spring: Option<Spring>, force: JointLimit) {
        if let Some(Spring { hertz, damping_ratio, target }) = spring {
            let softness = Softness::spring(hertz, damping_ratio, self.rate);
            let (lower, upper) = (self.impulse(force.lower), self.impulse(force.upper));
            self.row(slot::SPRING, direction, RowTask::Spring { softness, target, lower, upper });
        }
    }

    pub(super) fn drive(&mut self, direction: Direction, drive: Option<Drive>) {
        self.drive_within(direction, drive, None);
    }

    /// Adds a motor that does not drive beyond a limit along the same direction. If a motor of unlimited force pushed
    /// against the limit, the impulses of the motor and of the limit would grow in every sub-step.
    pub(super) fn drive_within(
        &mut self,
        direction: Direction,
        drive: Option<Drive>,
        limit: Option<JointLimit>,
    ) {
        if let Some(Drive { speed, max }) = drive {
            let Softness { bias_rate, mass_scale, .. } = self.softness;
            let return_rate = fx_mul(bias_rate.into(), mass_scale.into());
            let task = RowTask::Drive { speed, max: self.impulse(max), limit, return_rate };
            self.row(slot::DRIVE, direction, task);
        }
    }

    pub(super) fn limit(&mut self, direction: Direction, limit: Option<JointLimit>) {
        if let Some(JointLimit { lower, upper }) = limit {
            self.row(slot::LIMIT, direction, RowTask::Lower { bound: lower });
            self.row(slot::LIMIT + 1, direction, RowTask::Upper { bound: upper });
        }
    }

    pub(super) fn upper(&mut self, direction: Direction, bound: Fx) {
        self.row(slot::LIMIT + 1, direction, RowTask::Upper { bound });
    }

    pub(super) fn hold(&mut self, slot: u8, direction: Direction, target: Fx) {
        self.row(slot, direction, RowTask::Hold { target });
    }

    pub(super) fn pull(&mut self, slot: u8, soft: Soft, max_force: Fx) {
        let softness = Softness::spring(soft.hertz, soft.damping_ratio, self.rate);
        let max = crate::math::narrow(self.impulse(max_force));
        self.point(slot, PointTask::Spring { softness, max });
    }

    pub(super) fn push(&mut self, velocity: Vec2<Fx>, max_force: Fx) {
        let max = crate::math::narrow(self.impulse(max_force));
        self.point(
            slot::HOLD,
            PointTask::Drive { velocity: velocity.shortened(SPEED_MAX.into()).narrow(), max },
        );
    }

    fn row(&mut self, slot: u8, direction: Direction, task: RowTask) {
        let lambda = self.impulses.0[usize::from(slot)];
        self.rows.push(JointRow::new(slot, direction, task, self.softness, lambda));
    }

    fn point(&mut self, slot: u8, task: PointTask) {
        self.points.push(JointPoint::new(slot, task, self.impulses.point(slot)));
    }

    fn impulse(&self, force: Fx) -> Fx {
        impulse(force, self.masses, self.rate)
    }
}

/// The impulse of a force during a sub-step, times the sum of the inverse masses, in m/s. For a torque, the unit is
/// m²/s. [`Fx::MAX`] and [`Fx::MIN`] mean no limit, and are returned unchanged.
pub(super) fn impulse(force: Fx, masses: (Fx, Fx), rate: u32) -> Fx {
    if force == Fx::MAX || force == Fx::MIN {
        return force;
    }
    let over = |mass: Fx| fx_div(force, mass).unwrap_or(Fx::ZERO);
    let per_second = over(masses.0).saturating_add(over(masses.1));
    fx_div(per_second, Fx::from_num(rate)).unwrap_or(Fx::ZERO)
}
