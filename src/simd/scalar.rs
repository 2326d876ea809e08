//! Scalar backend: lanes as arrays of plain integers.

use core::cell::Cell;

use super::body::{GROUND, SolverBody};
use super::{Ints, Lanes, Quad, VelocityW};
use crate::math::{round_shift, saturate};

/// Backend with arrays of `N` numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scalar<const N: usize>;

#[inline(always)]
pub(super) fn map<A: Copy, B: Copy, C, const N: usize>(
    a: [A; N],
    b: [B; N],
    f: impl Fn(A, B) -> C,
) -> [C; N] {
    core::array::from_fn(|i| f(a[i], b[i]))
}

impl<const N: usize> Lanes<N> for Scalar<N> {
    type Int = [i32; N];
    type Wide = [i64; N];
    type Mask = [bool; N];

    #[inline(always)]
    fn load(from: &Ints<N>) -> [i32; N] {
        from.0
    }

    #[inline(always)]
    fn store(value: [i32; N], to: &mut Ints<N>) {
        to.0 = value;
    }

    #[inline(always)]
    fn splat(value: i32) -> [i32; N] {
        [value; N]
    }

    #[inline(always)]
    fn add(a: [i32; N], b: [i32; N]) -> [i32; N] {
        map(a, b, i32::wrapping_add)
    }

    #[inline(always)]
    fn sub(a: [i32; N], b: [i32; N]) -> [i32; N] {
        map(a, b, i32::wrapping_sub)
    }

    #[inline(always)]
    fn add_saturating(a: [i32; N], b: [i32; N]) -> [i32; N] {
        map(a, b, i32::saturating_add)
    }

    #[inline(always)]
    fn sub_saturating(a: [i32; N], b: [i32; N]) -> [i32; N] {
        map(a, b, i32::saturating_sub)
    }

    #[inline(always)]
    fn min(a: [i32; N], b: [i32; N]) -> [i32; N] {
        map(a, b, i32::min)
    }

    #[inline(always)]
    fn max(a: [i32; N], b: [i32; N]) -> [i32; N] {
        map(a, b, i32::max)
    }

    #[inline(always)]
    fn or(a: [i32; N], b: [i32; N]) -> [i32; N] {
        map(a, b, |a, b| a | b)
    }

    #[inline(always)]
    fn greater(a: [i32; N], b: [i32; N]) -> [bool; N] {
        map(a, b, |a, b| a > b)
    }

    #[inline(always)]
    fn both(a: [bool; N], b: [bool; N]) -> [bool; N] {
        map(a, b, |a, b| a & b)
    }

    #[inline(always)]
    fn either(a: [bool; N], b: [bool; N]) -> [bool; N] {
        map(a, b, |a, b| a | b)
    }

    #[inline(always)]
    fn any(mask: [bool; N]) -> bool {
        mask.iter().fold(false, |any, &lane| any | lane)
    }

    #[inline(always)]
    fn bits(mask: [bool; N]) -> u32 {
        mask.iter().rev().fold(0, |bits, &lane| bits << 1 | u32::from(lane))
    }

    #[inline(always)]
    fn count(mask: [bool; N]) -> u32 {
        mask.iter().map(|&lane| u32::from(lane)).sum()
    }

    #[inline(always)]
    fn select(mask: [bool; N], yes: [i32; N], no: [i32; N]) -> [i32; N] {
        core::array::from_fn(|i| if mask[i] { yes[i] } else { no[i] })
    }

    #[inline(always)]
    fn to_int(mask: [bool; N]) -> [i32; N] {
        mask.map(|lane| -i32::from(lane))
    }

    #[inline(always)]
    fn negative(a: [i32; N]) -> [bool; N] {
        a.map(i32::is_negative)
    }

    #[inline(always)]
    fn mul(a: [i32; N], b: [i32; N]) -> [i64; N] {
        map(a, b, |a, b| i64::from(a) * i64::from(b))
    }

    #[inline(always)]
    fn add_wide(a: [i64; N], b: [i64; N]) -> [i64; N] {
        map(a, b, i64::wrapping_add)
    }

    #[inline(always)]
    fn sub_wide(a: [i64; N], b: [i64; N]) -> [i64; N] {
        map(a, b, i64::wrapping_sub)
    }

    #[inline(always)]
    fn max_wide(a: [i64; N], b: [i64; N]) -> [i64; N] {
        map(a, b, i64::max)
    }

    #[inline(always)]
    fn abs_wide(a: [i64; N]) -> [i64; N] {
        a.map(i64::wrapping_abs)
    }

    #[inline(always)]
    fn greater_wide(a: [i64; N], b: [i64; N]) -> [bool; N] {
        map(a, b, |a, b| a > b)
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the trait requires that the result fits")]
    fn narrow<const SHIFT: i32>(a: [i64; N]) -> [i32; N] {
        a.map(|a| (a.wrapping_add(1 << (SHIFT - 1)) >> SHIFT) as i32)
    }

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the value is compared afterwards; a shift count is not negative"
    )]
    fn narrow_saturating<const SHIFT: i32>(a: [i64; N]) -> ([i32; N], [bool; N]) {
        let rounded = a.map(|a| round_shift(a, SHIFT as u32));
        (rounded.map(saturate), rounded.map(|a| i64::from(a as i32) != a))
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, reason = "a shift count is not negative")]
    fn narrow_by(a: [i64; N], shift: [i32; N]) -> [i32; N] {
        map(a, shift, |a, shift| saturate(round_shift(a, shift as u32)))
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "truncation is the purpose")]
    fn low(a: [i64; N]) -> [i32; N] {
        a.map(|a| a as i32)
    }

    #[inline(always)]
    fn shift_down<const SHIFT: i32>(a: [i64; N]) -> [i64; N] {
        a.map(|a| a >> SHIFT)
    }

    #[inline(always)]
    fn to_array(a: [i64; N]) -> [i64; N] {
        a
    }

    #[inline(always)]
    fn load_wide(from: &[i64; N]) -> [i64; N] {
        *from
    }

    #[inline(always)]
    fn transposed(rows: [&Quad; N]) -> [[i32; N]; 4] {
        core::array::from_fn(|i| rows.map(|row| row.0[i]))
    }

    #[inline(always)]
    fn velocities(bodies: &[Cell<SolverBody>], at: &[u32; N]) -> VelocityW<[i32; N]> {
        let bodies = at.map(|at| bodies[at as usize].get());
        VelocityW {
            x: bodies.map(|body| body.velocity.x.to_bits()),
            y: bodies.map(|body| body.velocity.y.to_bits()),
            turn: bodies.map(|body| body.spin.to_bits()),
        }
    }

    #[inline(always)]
    fn shifts(bodies: &[Cell<SolverBody>], at: &[u32; N]) -> VelocityW<[i32; N]> {
        let bodies = at.map(|at| bodies[at as usize].get());
        VelocityW {
            x: bodies.map(|body| body.shift.x.to_bits()),
            y: bodies.map(|body| body.shift.y.to_bits()),
            turn: bodies.map(|body| body.turn.to_bits()),
        }
    }

    #[inline(always)]
    fn set_velocities(bodies: &[Cell<SolverBody>], at: &[u32; N], velocities: VelocityW<[i32; N]>) {
        for (lane, &at) in at.iter().enumerate().filter(|&(_, &at)| at != GROUND) {
            let mut body = bodies[at as usize].get();
            body.set_motion(velocities.x[lane], velocities.y[lane], velocities.turn[lane]);
            bodies[at as usize].set(body);
        }
    }

    #[inline(always)]
    fn set_shifts(bodies: &[Cell<SolverBody>], at: &[u32; N], shifts: VelocityW<[i32; N]>) {
        for (lane, &at) in at.iter().enumerate().filter(|&(_, &at)| at != GROUND) {
            let mut body = bodies[at as usize].get();
            body.set_shift(shifts.x[lane], shifts.y[lane], shifts.turn[lane]);
            bodies[at as usize].set(body);
        }
    }
}
