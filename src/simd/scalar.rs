//! Scalar backend: lanes as arrays of plain integers.

use core::cell::Cell;

use super::body::{GROUND, SolverBody};
use super::{Ints, Lanes, Quad, VelocityW, division};
use crate::math::{round_shift, saturate};

/// Arrays of `M` numbers for the first `M` of `N` lanes. A store does not change the other lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scalar<const M: usize>;

#[inline(always)]
pub(super) fn map<A: Copy, B: Copy, C, const N: usize>(
    a: [A; N],
    b: [B; N],
    f: impl Fn(A, B) -> C,
) -> [C; N] {
    core::array::from_fn(|i| f(a[i], b[i]))
}

impl<const N: usize, const M: usize> Lanes<N> for Scalar<M> {
    type Int = [i32; M];
    type Wide = [i64; M];
    type Mask = [bool; M];

    #[inline(always)]
    fn load(from: &Ints<N>) -> [i32; M] {
        core::array::from_fn(|i| from.0[i])
    }

    #[inline(always)]
    fn store(value: [i32; M], to: &mut Ints<N>) {
        to.0[..M].copy_from_slice(&value);
    }

    #[inline(always)]
    fn splat(value: i32) -> [i32; M] {
        [value; M]
    }

    #[inline(always)]
    fn add(a: [i32; M], b: [i32; M]) -> [i32; M] {
        map(a, b, i32::wrapping_add)
    }

    #[inline(always)]
    fn sub(a: [i32; M], b: [i32; M]) -> [i32; M] {
        map(a, b, i32::wrapping_sub)
    }

    #[inline(always)]
    fn add_saturating(a: [i32; M], b: [i32; M]) -> [i32; M] {
        map(a, b, i32::saturating_add)
    }

    #[inline(always)]
    fn sub_saturating(a: [i32; M], b: [i32; M]) -> [i32; M] {
        map(a, b, i32::saturating_sub)
    }

    #[inline(always)]
    fn min(a: [i32; M], b: [i32; M]) -> [i32; M] {
        map(a, b, i32::min)
    }

    #[inline(always)]
    fn max(a: [i32; M], b: [i32; M]) -> [i32; M] {
        map(a, b, i32::max)
    }

    #[inline(always)]
    fn or(a: [i32; M], b: [i32; M]) -> [i32; M] {
        map(a, b, |a, b| a | b)
    }

    #[inline(always)]
    fn greater(a: [i32; M], b: [i32; M]) -> [bool; M] {
        map(a, b, |a, b| a > b)
    }

    #[inline(always)]
    fn both(a: [bool; M], b: [bool; M]) -> [bool; M] {
        map(a, b, |a, b| a & b)
    }

    #[inline(always)]
    fn either(a: [bool; M], b: [bool; M]) -> [bool; M] {
        map(a, b, |a, b| a | b)
    }

    #[inline(always)]
    fn any(mask: [bool; M]) -> bool {
        mask.iter().fold(false, |any, &lane| any | lane)
    }

    #[inline(always)]
    fn bits(mask: [bool; M]) -> u32 {
        mask.iter().rev().fold(0, |bits, &lane| bits << 1 | u32::from(lane))
    }

    #[inline(always)]
    fn count(mask: [bool; M]) -> u32 {
        mask.iter().map(|&lane| u32::from(lane)).sum()
    }

    #[inline(always)]
    fn select(mask: [bool; M], yes: [i32; M], no: [i32; M]) -> [i32; M] {
        core::array::from_fn(|i| if mask[i] { yes[i] } else { no[i] })
    }

    #[inline(always)]
    fn to_int(mask: [bool; M]) -> [i32; M] {
        mask.map(|lane| -i32::from(lane))
    }

    #[inline(always)]
    fn negative(a: [i32; M]) -> [bool; M] {
        a.map(i32::is_negative)
    }

    #[inline(always)]
    fn mul(a: [i32; M], b: [i32; M]) -> [i64; M] {
        map(a, b, |a, b| i64::from(a) * i64::from(b))
    }

    #[inline(always)]
    fn add_wide(a: [i64; M], b: [i64; M]) -> [i64; M] {
        map(a, b, i64::wrapping_add)
    }

    #[inline(always)]
    fn sub_wide(a: [i64; M], b: [i64; M]) -> [i64; M] {
        map(a, b, i64::wrapping_sub)
    }

    #[inline(always)]
    fn max_wide(a: [i64; M], b: [i64; M]) -> [i64; M] {
        map(a, b, i64::max)
    }

    #[inline(always)]
    fn abs_wide(a: [i64; M]) -> [i64; M] {
        a.map(i64::wrapping_abs)
    }

    #[inline(always)]
    fn greater_wide(a: [i64; M], b: [i64; M]) -> [bool; M] {
        map(a, b, |a, b| a > b)
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the trait requires that the result fits")]
    fn narrow<const SHIFT: i32>(a: [i64; M]) -> [i32; M] {
        a.map(|a| (a.wrapping_add(1 << (SHIFT - 1)) >> SHIFT) as i32)
    }

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the value is compared afterwards; a shift count is not negative"
    )]
    fn narrow_saturating<const SHIFT: i32>(a: [i64; M]) -> ([i32; M], [bool; M]) {
        let rounded = a.map(|a| round_shift(a, SHIFT as u32));
        (rounded.map(saturate), rounded.map(|a| i64::from(a as i32) != a))
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, reason = "a shift count is not negative")]
    fn narrow_by(a: [i64; M], shift: [i32; M]) -> [i32; M] {
        map(a, shift, |a, shift| saturate(round_shift(a, shift as u32)))
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "truncation is the purpose")]
    fn low(a: [i64; M]) -> [i32; M] {
        a.map(|a| a as i32)
    }

    #[inline(always)]
    fn shift_down<const SHIFT: i32>(a: [i64; M]) -> [i64; M] {
        a.map(|a| a >> SHIFT)
    }

    #[inline(always)]
    fn to_array(a: [i64; M]) -> [i64; N] {
        let mut all = [0; N];
        all[..M].copy_from_slice(&a);
        all
    }

    #[inline(always)]
    fn load_wide(from: &[i64; N]) -> [i64; M] {
        core::array::from_fn(|i| from[i])
    }

    #[inline(always)]
    fn reciprocal(d: [i64; M]) -> [i32; M] {
        d.map(division::reciprocal)
    }

    #[inline(always)]
    fn inverse([xx, xy, yy]: [[i64; M]; 3]) -> [[i32; M]; 3] {
        let mut g = [[0; M]; 3];
        for lane in 0..M {
            [g[0][lane], g[1][lane], g[2][lane]] = division::inverse([xx[lane], xy[lane], yy[lane]]);
        }
        g
    }

    #[inline(always)]
    fn quads(from: &[Quad], at: &[u32; N]) -> [[i32; M]; 4] {
        let rows: [Quad; M] = core::array::from_fn(|lane| from[at[lane] as usize]);
        core::array::from_fn(|i| core::array::from_fn(|lane| rows[lane].0[i]))
    }

    #[inline(always)]
    fn transposed(rows: [&Quad; N]) -> [[i32; M]; 4] {
        core::array::from_fn(|i| core::array::from_fn(|lane| rows[lane].0[i]))
    }

    #[inline(always)]
    fn velocities(bodies: &[Cell<SolverBody>], at: &[u32; N]) -> VelocityW<[i32; M]> {
        let bodies: [SolverBody; M] = core::array::from_fn(|lane| bodies[at[lane] as usize].get());
        VelocityW {
            x: bodies.map(|body| body.velocity.x.to_bits()),
            y: bodies.map(|body| body.velocity.y.to_bits()),
            turn: bodies.map(|body| body.spin.to_bits()),
        }
    }

    #[inline(always)]
    fn shifts(bodies: &[Cell<SolverBody>], at: &[u32; N]) -> VelocityW<[i32; M]> {
        let bodies: [SolverBody; M] = core::array::from_fn(|lane| bodies[at[lane] as usize].get());
        VelocityW {
            x: bodies.map(|body| body.shift.x.to_bits()),
            y: bodies.map(|body| body.shift.y.to_bits()),
            turn: bodies.map(|body| body.turn.to_bits()),
        }
    }

    #[inline(always)]
    fn set_velocities(bodies: &[Cell<SolverBody>], at: &[u32; N], velocities: VelocityW<[i32; M]>) {
        for (lane, &at) in at[..M].iter().enumerate().filter(|&(_, &at)| at != GROUND) {
            let mut body = bodies[at as usize].get();
            body.set_motion(velocities.x[lane], velocities.y[lane], velocities.turn[lane]);
            bodies[at as usize].set(body);
        }
    }

    #[inline(always)]
    fn set_shifts(bodies: &[Cell<SolverBody>], at: &[u32; N], shifts: VelocityW<[i32; M]>) {
        for (lane, &at) in at[..M].iter().enumerate().filter(|&(_, &at)| at != GROUND) {
            let mut body = bodies[at as usize].get();
            body.set_shift(shifts.x[lane], shifts.y[lane], shifts.turn[lane]);
            bodies[at as usize].set(body);
        }
    }
}
