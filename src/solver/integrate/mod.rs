//! Semi-implicit Euler: velocities first, then displacements from the new velocities.
//!
//! Vector instructions integrate several bodies at a time (`kernel`) if all of them are dynamic, have no locked axis
//! and certainly stay within the limits. Other bodies are integrated one by one.

mod area_effect;
mod kernel;
mod sub_step;
#[cfg(test)]
mod tests;

use super::body::SolverBody;
use super::context::StepContext;
use super::limits::{Faults, STEP_MAX, shortened, units};
use super::settings::Tuning;
use crate::body::{Body, BodyKind, BodySettings, MotionLocks};
use crate::math::{Fx, Shift, Speed, Unit, Vec2, fx_div, fx_mul, narrow, saturate};
use crate::simd::Quad;
pub(crate) use area_effect::AreaEffect;
use sub_step::SubStep;

/// Largest displacement along an axis in a tick, and largest rotation times the radius of gyration, in metres.
const SHIFT_MAX: Shift = Shift::lit("15.999");

/// A body that moves, with its velocity changes in a sub-step.
#[derive(Clone, Copy, Debug)]
pub(super) struct MovingBody {
    /// Changes of the velocity and of the spin in a sub-step by gravity, applied forces and torques, and areas.
    step: Quad,
    /// Damping factors of the velocity and of the spin, `1 / (1 + h c)`: an implicit step, stable for any damping rate
    /// `c`. The third number is negative if the body is not dynamic or has a locked axis.
    factors: Quad,
    index: u32,
    dynamic: bool,
    locks: MotionLocks,
}

impl MovingBody {
    pub(super) fn prepare(index: u32, body: &Body, tuning: &Tuning) -> Option<Self> {
        match body.kind() {
            BodyKind::Fixed => None,
            BodyKind::Kinematic => {
                let factors = Quad([Unit::ONE.to_bits(), Unit::ONE.to_bits(), -1, 0]);
                Some(MovingBody {
                    step: Quad::default(),
                    factors,
                    index,
                    dynamic: false,
                    locks: MotionLocks::default(),
                })
            }
            BodyKind::Dynamic if body.has_mass() => {
                let (force_step, spin_step) = body.acceleration_step(tuning.rate);
                Some(Self::dynamic(index, force_step, spin_step, &body.settings, tuning))
            }
            // Gravity is a force, and forces do not move a body without mass.
            BodyKind::Dynamic => {
                let settings = BodySettings { gravity_scale: Fx::ZERO, ..body.settings };
                Some(Self::dynamic(index, [0; 2], Speed::ZERO, &settings, tuning))
            }
        }
    }

    #[inline(always)]
    fn dynamic(
        index: u32,
        force_step: [i64; 2],
        spin_step: Speed,
        settings: &BodySettings,
        tuning: &Tuning,
    ) -> Self {
        let BodySettings { linear_damping, angular_damping, gravity_scale, locks, .. } = *settings;
        let with_gravity = |force: i64, step: Fx| {
            let step = if gravity_scale == Fx::ONE { step } else { fx_mul(step, gravity_scale) };
            force.saturating_add(units(step))
        };
        let [x, y] = force_step;
        let step = [with_gravity(x, tuning.gravity_step.x), with_gravity(y, tuning.gravity_step.y)];
        let most = u64::from(STEP_MAX.to_bits().unsigned_abs());
        let step = if step[0].unsigned_abs().max(step[1].unsigned_abs()) > most {
            shortened_step(step, linear_damping, tuning.rate)
        } else {
            shortened(step, STEP_MAX, &mut 0)
        };
        let factor = |damping| damping_factor(damping, tuning.rate).to_bits();
        let is_held = i32::from(locks.x || locks.y);
        MovingBody {
            step: Quad([step.x.to_bits(), step.y.to_bits(), spin_step.to_bits(), 0]),
            factors: Quad([factor(linear_damping), factor(angular_damping), -is_held, 0]),
            index,
            dynamic: true,
            locks,
        }
    }

    pub(super) fn index(&self) -> u32 {
        self.index
    }

    /// Whether the body is not dynamic or has a locked axis.
    #[inline(always)]
    pub(super) fn has_extras(&self) -> bool {
        let Quad([_, _, extras, _]) = self.factors;
        extras < 0
    }

    /// `v' = (v + h F / m) / (1 + h c)`, within the speed limit.
    fn integrate_velocity(&self, body: &mut SolverBody, speed_max: Speed) {
        if !self.dynamic {
            return;
        }
        let [x, y, turn, _] = self.step.0.map(Speed::from_bits);
        let [linear_factor, angular_factor, ..] = self.factors.0.map(Unit::from_bits);
        body.velocity += Vec2::new(x, y);
        body.spin = body.spin.saturating_add(turn);
        if linear_factor != Unit::ONE {
            body.velocity = Vec2::new(
                towards_rest(body.velocity.x, linear_factor),
                towards_rest(body.velocity.y, linear_factor),
            );
        }
        if angular_factor != Unit::ONE {
            body.spin = towards_rest(body.spin, angular_factor);
        }
        self.hold_locked_axes(body);
        limit_speed(&mut body.velocity, speed_max);
        body.spin = body.spin.clamp(-speed_max, speed_max);
    }

    /// Removes the velocity along locked axes. A locked rotation needs no action here: the reciprocal radius of
    /// gyration of the body is 0.
    fn hold_locked_axes(&self, body: &mut SolverBody) {
        if self.locks.x {
            body.velocity.x = Speed::ZERO;
        }
        if self.locks.y {
            body.velocity.y = Speed::ZERO;
        }
    }

    /// `x' = x + h v'`.
    fn integrate_displacement(&self, body: &mut SolverBody, sub_step: SubStep, faults: &mut Faults) {
        self.hold_locked_axes(body);
        let mut advance = |sum: &mut Shift, speed: Speed| {
            // Both summands are within ±16 m, so that the sum does not saturate. It exceeds `SHIFT_MAX` only below 32
            // ticks per second, and only if impulses have raised a speed above the speed limit.
            let wanted = sum.saturating_add(sub_step.distance(speed));
            *sum = wanted.clamp(-SHIFT_MAX, SHIFT_MAX);
            *faults += u64::from(*sum != wanted);
        };
        advance(&mut body.shift.x, body.velocity.x);
        advance(&mut body.shift.y, body.velocity.y);
        advance(&mut body.turn, body.spin);
    }
}

pub(super) fn integrate_velocities(moving: &[MovingBody], context: &StepContext<'_>) {
    let &StepContext { machine, bodies, tuning, .. } = context;
    machine.run(kernel::Velocities { moving, bodies, speed_max: tuning.speed_max });
}

pub(super) fn integrate_displacements(moving: &[MovingBody], context: &StepContext<'_>) {
    let &StepContext { machine, bodies, tuning, .. } = context;
    let mut faults = 0;
    let sub_step = SubStep::of(tuning.rate);
    machine.run(kernel::Displacements { moving, bodies, sub_step, faults: &mut faults });
    context.add_faults(faults);
}

/// Shortens a velocity change so that 512 m/s of it remain after damping. No speed limit exceeds 512 m/s, so the
/// shortening matters only if the force reverses the velocity of the body: the final velocity is then lower than it
/// would be without the shortening.
#[cold]
fn shortened_step(step: [i64; 2], damping: Fx, rate: u32) -> Vec2<Speed> {
    let most = Fx::from(STEP_MAX).saturating_add((damping / i64::from(rate)).saturating_mul_int(512));
    shortened(step, narrow(most), &mut 0)
}

/// A damped speed, rounded towards 0, so that a body does not creep for ever.
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

/// Shortens a velocity to the limit. This is no fault, because the limit is a setting.
pub(crate) fn limit_speed(velocity: &mut Vec2<Speed>, speed_max: Speed) {
    let square = |speed: Speed| i64::from(speed.to_bits()) * i64::from(speed.to_bits());
    if square(velocity.x).saturating_add(square(velocity.y)) <= square(speed_max) {
        return;
    }
    if let Some(direction) = velocity.normalized() {
        *velocity = direction.scale(speed_max);
    }
}
