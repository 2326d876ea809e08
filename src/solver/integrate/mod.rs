//! Semi-implicit Euler: velocities first, then displacements from the new velocities. Damping is implicit, so it is
//! stable for any decay rate `c`. With the length `h` of a sub-step:
//!
//! ```text
//! v' = (v + h F / m) / (1 + h c)
//! x' = x + h v'
//! ```
//!
//! Vector instructions integrate several bodies at a time (`kernel`) if all of them have no locked axis and certainly
//! stay within the limits. Other bodies are integrated one by one.

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
use crate::math::{
    Fx, Shift, Speed, Unit, Vec2, fx_div, fx_mul, narrow, round_shift_wide, saturate, saturate_wide,
};
use crate::simd::{GROUND, Quad};
pub(crate) use area_effect::AreaEffect;
use sub_step::SubStep;

/// Largest displacement along an axis in a tick, and largest rotation times the radius of gyration, in metres.
const SHIFT_MAX: Shift = Shift::lit("15.999");

/// A body that moves, with its velocity changes in a sub-step.
#[derive(Clone, Copy, Debug)]
pub(super) struct MovingBody {
    /// Changes of the velocity and of the spin in a sub-step by gravity, applied forces and torques, and areas, times
    /// the damping factors.
    step: Quad,
    /// Damping factors of the velocity and of the spin, `1 / (1 + h c)`. The third number is negative if the body has a
    /// locked axis.
    factors: Quad,
    index: u32,
    dynamic: bool,
    locks: MotionLocks,
}

impl MovingBody {
    /// A body whose velocity does not change: a kinematic body, or the ground in a lane without a body.
    pub(super) const STEADY: Self = MovingBody {
        step: Quad([0; 4]),
        factors: Quad([Unit::ONE.to_bits(), Unit::ONE.to_bits(), 0, 0]),
        index: GROUND,
        dynamic: false,
        locks: MotionLocks { x: false, y: false, rotation: false },
    };

    pub(super) fn prepare(index: u32, body: &Body, tuning: &Tuning) -> Option<Self> {
        match body.kind() {
            BodyKind::Fixed => None,
            BodyKind::Kinematic => Some(MovingBody { index, ..Self::STEADY }),
            BodyKind::Dynamic if body.has_mass() => {
                Some(Self::dynamic(index, body.acceleration_step(tuning.rate), &body.settings, tuning))
            }
            // Gravity is a force, and forces do not move a body without mass.
            BodyKind::Dynamic => {
                let settings = BodySettings { gravity_scale: Fx::ZERO, ..body.settings };
                Some(Self::dynamic(index, [0; 3], &settings, tuning))
            }
        }
    }

    /// `force_step` is the velocity change, along x and y and of the spin, in units of [`Speed`].
    #[inline(always)]
    fn dynamic(index: u32, force_step: [i64; 3], settings: &BodySettings, tuning: &Tuning) -> Self {
        let BodySettings { linear_damping, angular_damping, gravity_scale, locks, .. } = *settings;
        let with_gravity = |force: i64, step: Fx| {
            let step = if gravity_scale == Fx::ONE { step } else { fx_mul(step, gravity_scale) };
            force.saturating_add(units(step))
        };
        let [linear, angular] = [linear_damping, angular_damping].map(|c| damping_factor(c, tuning.rate));
        let [x, y, turn] = force_step;
        let step = [with_gravity(x, tuning.gravity_step.x), with_gravity(y, tuning.gravity_step.y)];
        let step = shortened(step.map(|part| damped(part, linear)), STEP_MAX, &mut 0);
        let turn = Speed::from_bits(saturate(damped(turn, angular)));
        let is_held = i32::from(locks.x || locks.y);
        MovingBody {
            step: Quad([step.x.to_bits(), step.y.to_bits(), turn.to_bits(), 0]),
            factors: Quad([linear.to_bits(), angular.to_bits(), -is_held, 0]),
            index,
            dynamic: true,
            locks,
        }
    }

    pub(super) fn index(&self) -> u32 {
        self.index
    }

    /// Whether the body has a locked axis.
    #[inline(always)]
    pub(super) fn has_extras(&self) -> bool {
        let Quad([_, _, extras, _]) = self.factors;
        extras < 0
    }

    /// The new velocity, within the speed limit.
    fn integrate_velocity(&self, body: &mut SolverBody, speed_max: Speed) {
        if !self.dynamic {
            return;
        }
        let [x, y, turn, _] = self.step.0.map(Speed::from_bits);
        let [linear_factor, angular_factor, ..] = self.factors.0.map(Unit::from_bits);
        if linear_factor != Unit::ONE {
            body.velocity = Vec2::new(
                towards_rest(body.velocity.x, linear_factor),
                towards_rest(body.velocity.y, linear_factor),
            );
        }
        if angular_factor != Unit::ONE {
            body.spin = towards_rest(body.spin, angular_factor);
        }
        body.velocity += Vec2::new(x, y);
        body.spin = body.spin.saturating_add(turn);
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

    /// The new displacement in the tick.
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

/// A damped speed, rounded towards 0, so that a body does not creep for ever.
fn towards_rest(speed: Speed, factor: Unit) -> Speed {
    // The lanes of the kernel cannot negate the minimum.
    let product = i64::from(speed.max(-Speed::MAX).to_bits()) * i64::from(factor.to_bits());
    Speed::from_bits(saturate(product / (1 << 30)))
}

/// A velocity change in units of [`Speed`], multiplied by a damping factor.
fn damped(step: i64, factor: Unit) -> i64 {
    if factor == Unit::ONE {
        return step;
    }
    saturate_wide(round_shift_wide(i128::from(step) * i128::from(factor.to_bits()), Unit::FRAC_NBITS))
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
