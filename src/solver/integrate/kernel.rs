//! Integrates a group of bodies, one in each lane, unless one of them needs special treatment.

use core::cell::Cell;

use super::super::body::SolverBody;
use super::super::limits::Faults;
use super::super::pair::{UNIT, beyond};
use super::sub_step::SubStep;
use super::{MovingBody, SHIFT_MAX};
use crate::math::{Speed, Unit};
use crate::simd::{Kernel, Lanes, VelocityW};

pub(super) struct Velocities<'a> {
    pub(super) moving: &'a [MovingBody],
    pub(super) bodies: &'a [Cell<SolverBody>],
    pub(super) speed_max: Speed,
}

pub(super) struct Displacements<'a> {
    pub(super) moving: &'a [MovingBody],
    pub(super) bodies: &'a [Cell<SolverBody>],
    pub(super) sub_step: SubStep,
    pub(super) faults: &'a mut Faults,
}

impl<const N: usize> Kernel<N> for Velocities<'_> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Velocities { moving, bodies, speed_max } = self;
        let limits = SpeedLimits { on_axis: on_axis(speed_max), turning: speed_max.to_bits() };
        for moving in moving.chunks(N) {
            let is_done =
                moving.first_chunk().is_some_and(|moving| velocities::<L, N>(moving, bodies, limits));
            if !is_done {
                one_by_one(moving, bodies, |moving, body| moving.integrate_velocity(body, speed_max));
            }
        }
    }
}

impl<const N: usize> Kernel<N> for Displacements<'_> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Displacements { moving, bodies, sub_step, faults } = self;
        for moving in moving.chunks(N) {
            let is_done =
                moving.first_chunk().is_some_and(|moving| displacements::<L, N>(moving, bodies, sub_step));
            if !is_done {
                one_by_one(moving, bodies, |moving, body| {
                    moving.integrate_displacement(body, sub_step, faults);
                });
            }
        }
    }
}

#[cold]
fn one_by_one(
    moving: &[MovingBody],
    bodies: &[Cell<SolverBody>],
    mut integrate: impl FnMut(&MovingBody, &mut SolverBody),
) {
    for moving in moving {
        let place = &bodies[moving.index as usize];
        let mut body = place.get();
        integrate(moving, &mut body);
        place.set(body);
    }
}

/// Limits of the components of a velocity. A velocity within these limits is within the speed limit.
#[derive(Clone, Copy)]
struct SpeedLimits {
    on_axis: i32,
    turning: i32,
}

/// The largest number `n` such that every velocity with components of at most `n` is within the speed limit.
fn on_axis(speed_max: Speed) -> i32 {
    let square = u64::from(speed_max.unsigned_abs().to_bits()).pow(2);
    i32::try_from((square / 2).isqrt()).expect("less than the limit")
}

/// Integrates the velocities of `N` bodies. Changes nothing and returns `false` if a body is not dynamic, has a locked
/// axis or may exceed the speed limit.
#[inline(always)]
fn velocities<L: Lanes<N>, const N: usize>(
    moving: &[MovingBody; N],
    bodies: &[Cell<SolverBody>],
    limits: SpeedLimits,
) -> bool {
    let [step_x, step_y, step_turn, _] = L::transposed(moving.each_ref().map(|moving| &moving.step));
    let [linear, angular, extras, _] = L::transposed(moving.each_ref().map(|moving| &moving.factors));
    let at = moving.each_ref().map(|moving| moving.index);
    let VelocityW { x, y, turn } = L::velocities(bodies, &at);
    let [x, y] = [L::add_saturating(x, step_x), L::add_saturating(y, step_y)];
    let turn = L::add_saturating(turn, step_turn);
    let (on_axis, turning) = (L::splat(limits.on_axis), L::splat(limits.turning));
    let fast = L::either(beyond::<L, N>(x, on_axis), beyond::<L, N>(y, on_axis));
    let unusual = L::either(L::negative(extras), L::either(fast, beyond::<L, N>(turn, turning)));
    if L::any(unusual) {
        return false;
    }
    let mut velocities = VelocityW { x, y, turn };
    if L::any(L::greater(L::splat(Unit::ONE.to_bits()), L::min(linear, angular))) {
        velocities.x = towards_rest::<L, N>(x, linear);
        velocities.y = towards_rest::<L, N>(y, linear);
        velocities.turn = towards_rest::<L, N>(turn, angular);
    }
    L::set_velocities(bodies, &at, velocities);
    true
}

/// A damped speed, rounded towards 0. `speed` must be above the minimum of its format.
#[inline(always)]
fn towards_rest<L: Lanes<N>, const N: usize>(speed: L::Int, factor: L::Int) -> L::Int {
    let reversed = L::sub(L::splat(0), speed);
    let size = L::mul(L::max(speed, reversed), factor);
    // Subtracting half a unit of the result turns rounding to nearest into rounding down.
    let less = L::narrow::<UNIT>(L::sub_wide(size, L::mul(L::splat(1 << (UNIT - 1)), L::splat(1))));
    L::select(L::negative(speed), L::sub(L::splat(0), less), less)
}

/// Integrates the displacements of `N` bodies. Changes nothing and returns `false` if a body is not dynamic, has a
/// locked axis or would move too far in the tick.
#[inline(always)]
fn displacements<L: Lanes<N>, const N: usize>(
    moving: &[MovingBody; N],
    bodies: &[Cell<SolverBody>],
    sub_step: SubStep,
) -> bool {
    let at = moving.each_ref().map(|moving| moving.index);
    let (speeds, shifts) = (L::velocities(bodies, &at), L::shifts(bodies, &at));
    let advance = |sum, speed| L::add_saturating(sum, sub_step.distances::<L, N>(speed));
    let (x, y) = (advance(shifts.x, speeds.x), advance(shifts.y, speeds.y));
    let turn = advance(shifts.turn, speeds.turn);
    let limit = L::splat(SHIFT_MAX.to_bits());
    let far = L::either(beyond::<L, N>(x, limit), beyond::<L, N>(y, limit));
    let has_extras = moving.iter().any(MovingBody::has_extras);
    if has_extras || L::any(L::either(far, beyond::<L, N>(turn, limit))) {
        return false;
    }
    L::set_shifts(bodies, &at, VelocityW { x, y, turn });
    true
}
