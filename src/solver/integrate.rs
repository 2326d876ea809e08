//! Semi-implicit Euler: velocities first, then displacements from the new velocities.

use super::body::SolverBody;
use super::limits::Faults;
use super::settings::Tuning;
use crate::body::{Body, BodyKind, MotionLocks};
use crate::math::{Fx, Shift, Speed, Unit, Vec2, fx_div, fx_mul, narrow, saturate};

/// How far a body comes in a tick, at most.
const SHIFT_MAX: Shift = Shift::lit("15.999");

/// A body that moves, and what changes its velocity in every sub-step of the tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mover {
    index: u32,
    dynamic: bool,
    locks: MotionLocks,
    /// By gravity and applied force.
    velocity_step: Vec2<Speed>,
    /// By applied torque.
    spin_step: Speed,
    /// What damping leaves of the velocity: `1 / (1 + h c)`, the implicit step, stable for any rate `c`.
    linear_factor: Unit,
    angular_factor: Unit,
}

impl Mover {
    pub(crate) fn prepare(index: u32, body: &Body, tuning: &Tuning) -> Option<Self> {
        let mut mover = Mover {
            index,
            dynamic: false,
            locks: MotionLocks::default(),
            velocity_step: Vec2::ZERO,
            spin_step: Speed::ZERO,
            linear_factor: Unit::ONE,
            angular_factor: Unit::ONE,
        };
        match body.kind() {
            BodyKind::Fixed => return None,
            BodyKind::Kinematic => {}
            BodyKind::Dynamic => {
                let (force_step, spin_step) = body.acceleration_step(tuning.rate);
                let gravity = |step: Fx| {
                    if body.settings().gravity_scale == Fx::ONE {
                        narrow(step)
                    } else {
                        narrow(fx_mul(step, body.settings().gravity_scale))
                    }
                };
                mover.dynamic = true;
                mover.locks = body.settings().locks;
                mover.velocity_step =
                    Vec2::new(gravity(tuning.gravity_step.x), gravity(tuning.gravity_step.y)) + force_step;
                mover.spin_step = spin_step;
                mover.linear_factor = damping_factor(body.settings().linear_damping, tuning.rate);
                mover.angular_factor = damping_factor(body.settings().angular_damping, tuning.rate);
            }
        }
        Some(mover)
    }

    /// `v' = (v + h F / m) / (1 + h c)`, within the world's speed limit.
    pub(crate) fn integrate_velocity(&self, bodies: &mut [SolverBody], speed_max: Speed) {
        if !self.dynamic {
            return;
        }
        let body = &mut bodies[self.index as usize];
        body.velocity += self.velocity_step;
        body.spin = body.spin.saturating_add(self.spin_step);
        if self.linear_factor != Unit::ONE {
            body.velocity = Vec2::new(
                towards_rest(body.velocity.x, self.linear_factor),
                towards_rest(body.velocity.y, self.linear_factor),
            );
        }
        if self.angular_factor != Unit::ONE {
            body.spin = towards_rest(body.spin, self.angular_factor);
        }
        self.hold_locked_axes(body);
        limit_speed(&mut body.velocity, speed_max);
        body.spin = body.spin.clamp(-speed_max, speed_max);
    }

    /// Takes away what impulses have put along locked axes. Rotation is locked by a reciprocal gyration of 0.
    fn hold_locked_axes(&self, body: &mut SolverBody) {
        if self.locks.x {
            body.velocity.x = Speed::ZERO;
        }
        if self.locks.y {
            body.velocity.y = Speed::ZERO;
        }
    }

    /// `x' = x + h v'`.
    pub(crate) fn integrate_displacement(
        &self,
        bodies: &mut [SolverBody],
        sub_step: &SubStep,
        faults: &mut Faults,
    ) {
        let body = &mut bodies[self.index as usize];
        self.hold_locked_axes(body);
        let mut advance = |sum: &mut Shift, speed: Speed| {
            // Each is below 32, and so is the sum unless impulses exceed the speed limit at less than 32 Hz.
            let wanted = sum.saturating_add(sub_step.distance(speed));
            *sum = wanted.clamp(-SHIFT_MAX, SHIFT_MAX);
            *faults += u64::from(*sum != wanted);
        };
        advance(&mut body.shift.x, body.velocity.x);
        advance(&mut body.shift.y, body.velocity.y);
        advance(&mut body.turn, body.spin);
    }
}

/// `1 / rate` seconds: no time step is ever rounded.
pub(crate) struct SubStep {
    /// Twice the rate, `d`.
    divisor: u64,
    /// `2^64 / d`, rounded up.
    reciprocal: u64,
}

impl SubStep {
    /// Of so many in a second, 60 to 4000.
    pub(crate) fn of(rate: u32) -> Self {
        let divisor = 2 * u64::from(rate);
        SubStep { divisor, reciprocal: u64::MAX / divisor + 1 }
    }

    /// `v / rate`, rounded to nearest, ties towards +infinity, by a product instead of a division (T. Granlund,
    /// P. Montgomery, 1994): the dividend is below 2^48, so that the product is too large by less than `2^48 d`, which
    /// does not reach the next multiple of `2^64`.
    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_sign_loss,
        reason = "at most 512 m/s in a sixtieth of a second, and the dividend is positive"
    )]
    fn distance(&self, speed: Speed) -> Shift {
        /// Added to every quotient, so that none is negative.
        const BIAS: u64 = 1 << 34;
        // A distance has 5 more fraction bits than a speed, and one more is for the half that rounds.
        let doubled = (i64::from(speed.to_bits()) << 6) + (self.divisor / 2) as i64;
        let dividend = (doubled + (BIAS * self.divisor) as i64) as u64;
        let quotient = ((u128::from(dividend) * u128::from(self.reciprocal)) >> 64) as u64;
        Shift::from_bits((quotient as i64 - BIAS as i64) as i32)
    }
}

/// A damped speed, rounded towards 0: rounded to nearest it would creep on for ever.
fn towards_rest(speed: Speed, factor: Unit) -> Speed {
    let product = i64::from(speed.to_bits()) * i64::from(factor.to_bits());
    Speed::from_bits(saturate(product / (1 << 30)))
}

fn damping_factor(damping: Fx, rate: u32) -> Unit {
    if damping == Fx::ZERO {
        return Unit::ONE;
    }
    narrow(fx_div(Fx::ONE, Fx::ONE + damping / i64::from(rate)).unwrap_or(Fx::ONE))
}

/// Shortens a velocity to the limit, which is a setting and so no fault. Its components are within ±1024, so its
/// square fits 64 bits.
fn limit_speed(velocity: &mut Vec2<Speed>, speed_max: Speed) {
    let square = |speed: Speed| i64::from(speed.to_bits()) * i64::from(speed.to_bits());
    if square(velocity.x).saturating_add(square(velocity.y)) <= square(speed_max) {
        return;
    }
    if let Some(direction) = velocity.normalized() {
        *velocity = direction.scale(speed_max);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;
    use std::vec::Vec;

    #[test]
    fn a_distance_is_the_rounded_quotient() {
        let mut rng = Rng::new(1);
        for rate in 60..=4000 {
            let sub_step = SubStep::of(rate);
            let ends = [i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX - 1, i32::MAX];
            let random =
                core::iter::repeat_with(|| i32::from_le_bytes(rng.next_u32().to_le_bytes())).take(50);
            // Those just before, at and behind a tie.
            let ties: Vec<i32> = (0..50).map(|i| (i * i32::try_from(rate).unwrap()) / 64 - 40 + i).collect();
            for bits in random.collect::<Vec<_>>().into_iter().chain(ends).chain(ties) {
                let rate = i64::from(rate);
                let expected = ((i64::from(bits) << 6) + rate).div_euclid(2 * rate);
                assert_eq!(i64::from(sub_step.distance(Speed::from_bits(bits)).to_bits()), expected);
            }
        }
    }
}
