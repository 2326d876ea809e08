//! WebAssembly backend: four lanes in a vector of 128 bits, and their products in two.
#![expect(unsafe_code, reason = "loads and stores of vectors")]

use core::arch::wasm32::*;
use core::cell::Cell;

use super::body::{GROUND, SolverBody};
use super::scalar::{Scalar, map};
use super::{Backend, Ints, Kernel, Lanes, Quad, VelocityW};

/// Vector instructions of WebAssembly. Every machine that accepts the module has them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simd128;

pub(crate) use Simd128 as Vectors;

impl Simd128 {
    /// Whether the scalar backend is compiled in as well.
    pub(super) const ARE_OPTIONAL: bool = !cfg!(feature = "sole_backend");

    pub(super) fn backends() -> impl Iterator<Item = Backend> {
        core::iter::once(Backend::Simd128)
    }

    #[inline]
    pub(super) fn of(backend: Backend) -> Option<Self> {
        (!Self::ARE_OPTIONAL || backend == Backend::Simd128).then_some(Simd128)
    }

    pub(crate) fn run(self, kernel: impl Kernel<WIDTH>) {
        kernel.run::<Simd128>();
    }
}

/// Number of lanes. With eight lanes, one number for each lane would take two vectors.
pub(crate) const WIDTH: usize = 4;

/// Two products per vector: lanes 0 and 1, lanes 2 and 3.
type Products = [v128; 2];

impl Lanes<WIDTH> for Simd128 {
    type Int = v128;
    type Wide = Products;
    type Mask = v128;

    #[inline(always)]
    fn load(from: &Ints<WIDTH>) -> v128 {
        // SAFETY: loads 16 bytes.
        unsafe { v128_load(from.0.as_ptr().cast()) }
    }

    #[inline(always)]
    fn store(value: v128, to: &mut Ints<WIDTH>) {
        // SAFETY: stores 16 bytes.
        unsafe { v128_store(to.0.as_mut_ptr().cast(), value) };
    }

    #[inline(always)]
    fn splat(value: i32) -> v128 {
        i32x4_splat(value)
    }

    #[inline(always)]
    fn add(a: v128, b: v128) -> v128 {
        i32x4_add(a, b)
    }

    #[inline(always)]
    fn sub(a: v128, b: v128) -> v128 {
        i32x4_sub(a, b)
    }

    #[inline(always)]
    fn add_saturating(a: v128, b: v128) -> v128 {
        // The sum overflows where its sign differs from the signs of `a` and `b`.
        let sum = i32x4_add(a, b);
        limited(sum, v128_and(v128_xor(a, sum), v128_xor(b, sum)), a)
    }

    #[inline(always)]
    fn sub_saturating(a: v128, b: v128) -> v128 {
        // The difference overflows where `a` and `b` have different signs and its sign is not that of `a`.
        let difference = i32x4_sub(a, b);
        limited(difference, v128_and(v128_xor(a, b), v128_xor(a, difference)), a)
    }

    #[inline(always)]
    fn min(a: v128, b: v128) -> v128 {
        i32x4_min(a, b)
    }

    #[inline(always)]
    fn max(a: v128, b: v128) -> v128 {
        i32x4_max(a, b)
    }

    #[inline(always)]
    fn or(a: v128, b: v128) -> v128 {
        v128_or(a, b)
    }

    #[inline(always)]
    fn greater(a: v128, b: v128) -> v128 {
        i32x4_gt(a, b)
    }

    #[inline(always)]
    fn both(a: v128, b: v128) -> v128 {
        v128_and(a, b)
    }

    #[inline(always)]
    fn either(a: v128, b: v128) -> v128 {
        v128_or(a, b)
    }

    #[inline(always)]
    fn any(mask: v128) -> bool {
        v128_any_true(mask)
    }

    #[inline(always)]
    fn bits(mask: v128) -> u32 {
        u32::from(i32x4_bitmask(mask))
    }

    #[inline(always)]
    fn count(mask: v128) -> u32 {
        Self::bits(mask).count_ones()
    }

    #[inline(always)]
    fn select(mask: v128, yes: v128, no: v128) -> v128 {
        v128_bitselect(yes, no, mask)
    }

    #[inline(always)]
    fn to_int(mask: v128) -> v128 {
        mask
    }

    #[inline(always)]
    fn negative(a: v128) -> v128 {
        sign(a)
    }

    #[inline(always)]
    fn mul(a: v128, b: v128) -> Products {
        [i64x2_extmul_low_i32x4(a, b), i64x2_extmul_high_i32x4(a, b)]
    }

    #[inline(always)]
    fn add_wide(a: Products, b: Products) -> Products {
        map(a, b, |a, b| i64x2_add(a, b))
    }

    #[inline(always)]
    fn sub_wide(a: Products, b: Products) -> Products {
        map(a, b, |a, b| i64x2_sub(a, b))
    }

    #[inline(always)]
    fn max_wide(a: Products, b: Products) -> Products {
        map(a, b, |a, b| v128_bitselect(a, b, i64x2_gt(a, b)))
    }

    #[inline(always)]
    fn abs_wide(a: Products) -> Products {
        a.map(|a| i64x2_abs(a))
    }

    #[inline(always)]
    fn greater_wide(a: Products, b: Products) -> v128 {
        Self::low(map(a, b, |a, b| i64x2_gt(a, b)))
    }

    #[inline(always)]
    fn narrow<const SHIFT: i32>(a: Products) -> v128 {
        shifted::<SHIFT>(rounded::<SHIFT>(a))
    }

    #[inline(always)]
    fn narrow_saturating<const SHIFT: i32>(a: Products) -> (v128, v128) {
        let a = rounded::<SHIFT>(a);
        // A number fits if all bits above the 32 bits of the result equal the sign bit of the result.
        let low = shifted::<SHIFT>(a);
        let high = i32x4_shuffle::<1, 3, 5, 7>(a[0], a[1]);
        let out = i32x4_ne(i32x4_shr(high, (SHIFT - 1).unsigned_abs()), sign(low));
        (limited(low, out, high), out)
    }

    #[inline(always)]
    fn narrow_by(a: Products, shift: v128) -> v128 {
        // WebAssembly has no shift with a count per lane.
        let mut shifts = Ints::ZERO;
        Self::store(shift, &mut shifts);
        Self::load(&Ints(<Scalar<WIDTH> as Lanes<WIDTH>>::narrow_by(Self::to_array(a), shifts.0)))
    }

    #[inline(always)]
    fn low([a, b]: Products) -> v128 {
        i32x4_shuffle::<0, 2, 4, 6>(a, b)
    }

    #[inline(always)]
    fn to_array([a, b]: Products) -> [i64; WIDTH] {
        let (first, second) = (i64x2_extract_lane::<0>, i64x2_extract_lane::<1>);
        [first(a), second(a), first(b), second(b)]
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, reason = "a shift count is not negative")]
    fn shift_down<const SHIFT: i32>(a: Products) -> Products {
        a.map(|a| i64x2_shr(a, SHIFT as u32))
    }

    #[inline(always)]
    fn load_wide(from: &[i64; WIDTH]) -> Products {
        [i64x2(from[0], from[1]), i64x2(from[2], from[3])]
    }

    #[inline(always)]
    fn transposed(rows: [&Quad; WIDTH]) -> [v128; 4] {
        // SAFETY: loads 16 bytes.
        transposed(rows.map(|row| unsafe { v128_load(row.0.as_ptr().cast()) }))
    }

    #[inline(always)]
    fn velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<v128> {
        // SAFETY: loads the first 16 bytes of a body.
        velocity_w(at.map(|at| unsafe { v128_load(SolverBody::velocity_bits(&bodies[at as usize]).cast()) }))
    }

    #[inline(always)]
    fn shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<v128> {
        // SAFETY: loads the last 16 bytes of a body.
        velocity_w(at.map(|at| unsafe { v128_load(SolverBody::shift_bits(&bodies[at as usize]).cast()) }))
    }

    #[inline(always)]
    fn set_velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], velocities: VelocityW<v128>) {
        set_velocities_w(at, velocities, |at| SolverBody::velocity_bits(&bodies[at as usize]));
    }

    #[inline(always)]
    fn set_shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], shifts: VelocityW<v128>) {
        set_velocities_w(at, shifts, |at| SolverBody::shift_bits(&bodies[at as usize]));
    }
}

/// Scatters three numbers and a 0 to each body, except the ground.
#[inline(always)]
fn set_velocities_w(at: &[u32; WIDTH], v: VelocityW<v128>, place: impl Fn(u32) -> *mut i32) {
    let rows = transposed([v.x, v.y, v.turn, i32x4_splat(0)]);
    for (&at, row) in at.iter().zip(rows).filter(|&(&at, _)| at != GROUND) {
        // SAFETY: stores 16 bytes of a body.
        unsafe { v128_store(place(at).cast(), row) };
    }
}

#[inline(always)]
fn sign(a: v128) -> v128 {
    i32x4_shr(a, 31)
}

/// In lanes where `overflows` is negative, the smallest or largest `i32`, with the sign of `toward`. In other lanes,
/// `result`.
#[inline(always)]
fn limited(result: v128, overflows: v128, toward: v128) -> v128 {
    let limit = v128_xor(sign(toward), i32x4_splat(i32::MAX));
    v128_bitselect(limit, result, sign(overflows))
}

#[inline(always)]
fn rounded<const SHIFT: i32>(a: Products) -> Products {
    a.map(|a| i64x2_add(a, i64x2_splat(1 << (SHIFT - 1))))
}

/// The 32 bits above the lowest `SHIFT` bits. A logical and an arithmetic shift give the same 32 bits.
#[inline(always)]
fn shifted<const SHIFT: i32>([a, b]: Products) -> v128 {
    let shift = |a| u64x2_shr(a, SHIFT.unsigned_abs());
    i32x4_shuffle::<0, 2, 4, 6>(shift(a), shift(b))
}

#[inline(always)]
fn velocity_w(rows: [v128; WIDTH]) -> VelocityW<v128> {
    let [x, y, turn, _] = transposed(rows);
    VelocityW { x, y, turn }
}

#[inline(always)]
fn transposed([r0, r1, r2, r3]: [v128; 4]) -> [v128; 4] {
    let (low_01, high_01) = (i32x4_shuffle::<0, 4, 1, 5>(r0, r1), i32x4_shuffle::<2, 6, 3, 7>(r0, r1));
    let (low_23, high_23) = (i32x4_shuffle::<0, 4, 1, 5>(r2, r3), i32x4_shuffle::<2, 6, 3, 7>(r2, r3));
    [
        i64x2_shuffle::<0, 2>(low_01, low_23),
        i64x2_shuffle::<1, 3>(low_01, low_23),
        i64x2_shuffle::<0, 2>(high_01, high_23),
        i64x2_shuffle::<1, 3>(high_01, high_23),
    ]
}
