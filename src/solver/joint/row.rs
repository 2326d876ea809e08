//! The scalar rows of a joint: springs, motors, limits, and rows that hold a position.
//!
//! `x` is the position along a direction, `mA` and `mB` are the inverse masses, and `D` is the denominator of the row
//! (`row`). Angles and angular speeds are multiplied by the length `s` of the row:
//!
//! ```text
//! spring   d = -massScale (vn + biasRate (x - target)) - impulseScale L      bias pass only
//! motor    d = -(vn - speed),  |L| <= F h (mA + mB) D                        (divided by s for a torque)
//!          towards a limit, speed is at most C / h before the limit, and massScale biasRate C beyond it
//!          (0 in the relax pass, in which the limit does not push either)
//! limit    d = -massScale (vn + biasRate C) - impulseScale L,  L >= 0        C = x - lower or upper - x
//!          d = -(vn + C / h)                                                 while C > 0
//! hold     as a limit that is reached, with L of either sign
//! ```
//!
//! A spring along a line has the stiffness `omega^2 m` and the damping `2 zeta omega m` of point masses, with
//! `m = 1 / (mA + mB)`, so that its force follows from a potential. If the spring also turns the bodies, its
//! `massScale` and `impulseScale` depend on `D` ([`Softness::at_mobility`]). With constant scales, the stiffness would
//! be `omega^2 m / D`, which changes as arms turn.
//!
//! The impulse is `L / ((mA + mB) D)`, times `s` for an angle.
//!
//! **Springs are not solved in the relax pass.** In the bias pass, the row is the implicit step of a damped spring.
//! Solving it again would remove a further share of the velocity, `massScale biasRate h`, and lightly damped springs
//! would come to rest too early.

use super::super::body::SolverBody;
use super::super::body_pair::BodyPair;
use super::super::context::Pass;
use super::super::limits::{Faults, IMPULSE_MAX};
use super::super::row::{Denominator, Row};
use super::super::softness::Softness;
use super::list::BlockedTask;
use super::options::JointLimit;
use super::parts::Direction;
use crate::math::{Fx, Ratio, Speed, fx_div, fx_mul, narrow, saturate_wide};

#[derive(Clone, Copy, Debug)]
pub(super) enum RowTask {
    /// Drives the position to a target, with impulses times `mA + mB` within `lower..=upper`. `softness` is that of a
    /// spring between point masses, which each refresh adapts to the pose.
    Spring { softness: Softness, target: Fx, lower: Fx, upper: Fx },
    /// Drives the velocity to a speed, with impulses times `mA + mB` of at most `max`, and not beyond `limit`.
    /// `return_rate` is `massScale biasRate` of the joint.
    Drive { speed: Fx, max: Fx, limit: Option<JointLimit>, return_rate: Fx },
    /// Keeps the position from falling below a bound.
    Lower { bound: Fx },
    /// Keeps the position from rising above a bound.
    Upper { bound: Fx },
    /// Keeps the position on a target.
    Hold { target: Fx },
}

/// The row along a direction at one pose of the bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    pub(super) row: Row,
    pub(super) denominator: Denominator,
    /// Position along the direction in m or rad.
    pub(super) position: Fx,
    /// Units of the row per unit of the position: `s` for an angle, the common factor of both directions for a pulley,
    /// otherwise 1.
    pub(super) scale: Fx,
    /// For an axis that turns with A, the arm lengths of A and of B, each divided by the body's radius of gyration.
    /// Otherwise [`NO_REACH`].
    pub(super) reach: [Ratio; 2],
}

pub(super) const NO_REACH: [Ratio; 2] = [Ratio::ZERO; 2];

#[derive(Clone, Copy, Debug)]
pub(super) struct JointRow {
    pub(super) slot: u8,
    pub(super) direction: Direction,
    task: RowTask,
    pub(super) row: Row,
    /// For a spring: [`Softness::push`] of its stretch. Otherwise: the negated target speed.
    bias: Speed,
    /// For a motor: `bias` in the relax pass.
    relax_bias: Speed,
    /// Softness at the current pose for a spring, [`Softness::RIGID`] for a motor, otherwise the softness of the joint.
    softness: Softness,
    /// Whether the row is a limit that is not reached.
    open: bool,
    bounds: (Speed, Speed),
    denominator: Denominator,
    pub(super) reach: [Ratio; 2],
    pub(super) is_blocked: bool,
    pub(super) lambda: Speed,
}

impl JointRow {
    pub(super) fn new(
        slot: u8,
        direction: Direction,
        task: RowTask,
        softness: Softness,
        lambda: Speed,
    ) -> Self {
        let bounds = (Speed::ZERO, Speed::ZERO);
        let (row, bias, denominator) = (Row::NONE, Speed::ZERO, 0);
        let softness = match task {
            RowTask::Spring { softness, .. } => softness,
            RowTask::Drive { .. } => Softness::RIGID,
            _ => softness,
        };
        JointRow {
            slot,
            direction,
            task,
            row,
            bias,
            relax_bias: Speed::ZERO,
            softness,
            open: false,
            bounds,
            denominator,
            reach: NO_REACH,
            is_blocked: false,
            lambda,
        }
    }

    pub(super) fn is_limited_spring(&self) -> bool {
        matches!(self.task, RowTask::Spring { lower, upper, .. } if lower != Fx::MIN || upper != Fx::MAX)
    }

    pub(super) fn bounds(&self) -> (Speed, Speed) {
        self.bounds
    }

    pub(super) fn blocked_task(&self) -> BlockedTask {
        match self.task {
            RowTask::Spring { .. } => BlockedTask::Spring,
            RowTask::Lower { .. } | RowTask::Upper { .. } => BlockedTask::Limit,
            RowTask::Drive { .. } => BlockedTask::Drive,
            RowTask::Hold { .. } => BlockedTask::Hold,
        }
    }

    pub(super) fn is_open(&self) -> bool {
        self.open
    }

    /// The change of a limit's impulse in one iteration, computed with an impulse of 0 and without bounds.
    pub(super) fn wanted_of_limit(
        &self,
        pass: Pass,
        a: &SolverBody,
        b: &SolverBody,
        faults: &mut Faults,
    ) -> i64 {
        let vn = self.row.velocity(a, b, faults);
        let (softness, bias) = match pass {
            _ if self.open => (&Softness::RIGID, self.bias),
            Pass::Bias => (&self.softness, self.bias),
            Pass::Relax => (&Softness::RIGID, Speed::ZERO),
        };
        softness.wanted(vn, bias, Speed::ZERO)
    }

    pub(super) fn denominator(&self) -> Denominator {
        self.denominator
    }

    /// Softness in the bias pass. A limit that is not reached does not use it.
    pub(super) fn softness(&self) -> &Softness {
        &self.softness
    }

    pub(super) fn refresh(&mut self, measure: &Measure, rate: u32) {
        let Measure { row, denominator, position, scale, reach } = *measure;
        (self.row, self.denominator, self.reach) = (row, denominator, reach);
        self.bounds = (-IMPULSE_MAX, IMPULSE_MAX);
        let metres = |x: Fx| fx_mul(x, scale);
        match self.task {
            RowTask::Spring { softness, target, lower, upper } => {
                self.softness = match self.direction {
                    // `D` of a row on the angle is about 1 and does not depend on the pose.
                    Direction::Angle => softness,
                    _ => softness.at_mobility(denominator),
                };
                self.bias = self.softness.push(metres(position.saturating_sub(target)));
                self.bounds = (measure.lambda(lower), measure.lambda(upper));
            }
            RowTask::Drive { speed, max, limit, return_rate } => {
                let within = |JointLimit { lower, upper }: JointLimit, return_rate: Fx| {
                    let approach = |gap: Fx| approach(metres(gap), return_rate, rate);
                    let ahead = approach(upper.saturating_sub(position));
                    let behind = approach(position.saturating_sub(lower));
                    metres(speed).min(ahead).max(behind.saturating_neg())
                };
                [self.bias, self.relax_bias] = [return_rate, Fx::ZERO].map(|return_rate| {
                    let speed = limit.map_or_else(|| metres(speed), |limit| within(limit, return_rate));
                    -narrow::<fixed::types::extra::U21>(speed).max(-Speed::MAX)
                });
                let max = measure.lambda(max);
                self.bounds = (-max, max);
            }
            RowTask::Hold { target } => {
                let gap = metres(position.saturating_sub(target));
                self.bias = narrow(fx_mul(gap, self.softness.bias_rate.into()));
            }
            RowTask::Lower { bound } => self.refresh_limit(position.saturating_sub(bound), measure, rate),
            RowTask::Upper { bound } => {
                self.row = row.reversed();
                self.refresh_limit(bound.saturating_sub(position), measure, rate);
            }
        }
        if denominator == 0 {
            // Impulses move neither body along this row.
            self.bounds = (Speed::ZERO, Speed::ZERO);
        }
    }

    /// `gap` is the distance to the limit in m or rad, negative beyond the limit.
    fn refresh_limit(&mut self, gap: Fx, measure: &Measure, rate: u32) {
        let gap = fx_mul(gap, measure.scale);
        self.open = gap > Fx::ZERO;
        self.bias = narrow(approach(gap, self.softness.bias_rate.into(), rate));
        self.bounds = (Speed::ZERO, IMPULSE_MAX);
    }

    pub(super) fn warm_start(&mut self, bodies: &mut BodyPair<'_>) {
        self.lambda = self.lambda.clamp(self.bounds.0, self.bounds.1);
        self.row.apply(self.lambda, bodies);
    }

    pub(super) fn solve(&mut self, pass: Pass, bodies: &mut BodyPair<'_>) {
        if let Some(d) = self.wanted(pass, bodies.a, bodies.b, bodies.faults) {
            self.row.accumulate(d, self.bounds, &mut self.lambda, bodies);
        }
    }

    /// The change of the impulse before bounds apply, in units of [`Speed`]. `None` if the pass leaves out the row.
    pub(super) fn wanted(
        &self,
        pass: Pass,
        a: &SolverBody,
        b: &SolverBody,
        faults: &mut Faults,
    ) -> Option<i64> {
        let vn = self.row.velocity(a, b, faults);
        let (softness, bias, push) = match (&self.task, pass) {
            (RowTask::Spring { .. }, Pass::Bias) => (&self.softness, Speed::ZERO, self.bias),
            (RowTask::Spring { .. }, Pass::Relax) => return None,
            // As with contacts, the relax pass leaves out a limit that is not reached and has no impulse.
            (RowTask::Lower { .. } | RowTask::Upper { .. }, Pass::Relax) if self.open && self.lambda == 0 => {
                return None;
            }
            // Limits the bias, so that a wide gap reduces `L` to 0 and not below.
            (RowTask::Lower { .. } | RowTask::Upper { .. }, _) if self.open => {
                (&Softness::RIGID, self.bias.min(self.lambda.saturating_sub(vn)), Speed::ZERO)
            }
            (RowTask::Drive { .. }, Pass::Bias) => (&Softness::RIGID, self.bias, Speed::ZERO),
            (RowTask::Drive { .. }, Pass::Relax) => (&Softness::RIGID, self.relax_bias, Speed::ZERO),
            (_, Pass::Bias) => (&self.softness, self.bias, Speed::ZERO),
            (_, Pass::Relax) => (&Softness::RIGID, Speed::ZERO, Speed::ZERO),
        };
        Some(softness.wanted(vn, bias, self.lambda) - i64::from(push.to_bits()))
    }
}

/// The largest speed in m/s at which the position may approach a limit without passing it within a sub-step. If the
/// position is beyond the limit, `gap` is negative, and so is the result: `bias_rate` times the gap.
fn approach(gap: Fx, bias_rate: Fx, rate: u32) -> Fx {
    fx_mul(gap, if gap > Fx::ZERO { Fx::from_num(rate) } else { bias_rate })
}

impl Measure {
    fn lambda(&self, impulse: Fx) -> Speed {
        lambda_of(impulse, self.denominator, self.scale)
    }
}

/// `L` of an impulse times `mA + mB`, clamped to [`IMPULSE_MAX`]. `scale` is [`Measure::scale`].
pub(super) fn lambda_of(impulse: Fx, denominator: Denominator, scale: Fx) -> Speed {
    // The denominator has 30 fraction bits.
    let denominator = Fx::from_bits(saturate_wide(i128::from(denominator) << 2));
    let lambda = fx_div(fx_mul(impulse, denominator), scale).unwrap_or(Fx::ZERO);
    narrow::<fixed::types::extra::U21>(lambda).clamp(-IMPULSE_MAX, IMPULSE_MAX)
}
