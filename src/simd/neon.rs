//! NEON backend: four lanes in a vector of 128 bits, and their products in two.
#![expect(unsafe_code, reason = "vendor intrinsics")]

use core::arch::aarch64::*;
use core::cell::Cell;

use super::body::{GROUND, SolverBody};
use super::scalar::map;
use super::{Backend, Ints, Kernel, Lanes, Quad, VelocityW};

/// Number of lanes. With eight lanes, one number for each lane would take two vectors.
pub(crate) const WIDTH: usize = 4;

/// NEON instructions. This file is compiled only for targets that have them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neon;

pub(crate) use Neon as Vectors;

impl Neon {
    /// Whether the scalar backend is compiled in as well.
    pub(super) const ARE_OPTIONAL: bool = true;

    pub(super) fn backends() -> impl Iterator<Item = Backend> {
        core::iter::once(Backend::Neon)
    }

    #[inline]
    pub(super) fn of(backend: Backend) -> Option<Self> {
        (backend == Backend::Neon).then_some(Neon)
    }

    pub(crate) fn run(self, kernel: impl Kernel<WIDTH>) {
        kernel.run::<Neon>();
    }
}

/// Two products per vector: lanes 0 and 1, lanes 2 and 3.
type Products = [int64x2_t; 2];

impl Lanes<WIDTH> for Neon {
    type Int = int32x4_t;
    type Wide = Products;
    type Mask = uint32x4_t;

    #[inline(always)]
    fn load(from: &Ints<WIDTH>) -> int32x4_t {
        // SAFETY: see `Neon`; loads 16 bytes.
        unsafe { vld1q_s32(from.0.as_ptr()) }
    }

    #[inline(always)]
    fn store(value: int32x4_t, to: &mut Ints<WIDTH>) {
        // SAFETY: see `Neon`; stores 16 bytes.
        unsafe { vst1q_s32(to.0.as_mut_ptr(), value) };
    }

    #[inline(always)]
    fn splat(value: i32) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vdupq_n_s32(value) }
    }

    #[inline(always)]
    fn add(a: int32x4_t, b: int32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vaddq_s32(a, b) }
    }

    #[inline(always)]
    fn sub(a: int32x4_t, b: int32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vsubq_s32(a, b) }
    }

    #[inline(always)]
    fn add_saturating(a: int32x4_t, b: int32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vqaddq_s32(a, b) }
    }

    #[inline(always)]
    fn sub_saturating(a: int32x4_t, b: int32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vqsubq_s32(a, b) }
    }

    #[inline(always)]
    fn min(a: int32x4_t, b: int32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vminq_s32(a, b) }
    }

    #[inline(always)]
    fn max(a: int32x4_t, b: int32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vmaxq_s32(a, b) }
    }

    #[inline(always)]
    fn or(a: int32x4_t, b: int32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vorrq_s32(a, b) }
    }

    #[inline(always)]
    fn greater(a: int32x4_t, b: int32x4_t) -> uint32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vcgtq_s32(a, b) }
    }

    #[inline(always)]
    fn both(a: uint32x4_t, b: uint32x4_t) -> uint32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vandq_u32(a, b) }
    }

    #[inline(always)]
    fn either(a: uint32x4_t, b: uint32x4_t) -> uint32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vorrq_u32(a, b) }
    }

    #[inline(always)]
    fn any(mask: uint32x4_t) -> bool {
        // SAFETY: see `Neon`.
        unsafe { vmaxvq_u32(mask) != 0 }
    }

    #[inline(always)]
    fn bits(mask: uint32x4_t) -> u32 {
        const PLACES: [u32; WIDTH] = [1, 2, 4, 8];
        // SAFETY: see `Neon`; loads 16 bytes.
        unsafe { vaddvq_u32(vandq_u32(mask, vld1q_u32(PLACES.as_ptr()))) }
    }

    #[inline(always)]
    fn count(mask: uint32x4_t) -> u32 {
        // SAFETY: see `Neon`. True is -1, so the sum is minus the count.
        unsafe { vaddvq_s32(vreinterpretq_s32_u32(mask)).unsigned_abs() }
    }

    #[inline(always)]
    fn select(mask: uint32x4_t, yes: int32x4_t, no: int32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vbslq_s32(mask, yes, no) }
    }

    #[inline(always)]
    fn to_int(mask: uint32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vreinterpretq_s32_u32(mask) }
    }

    #[inline(always)]
    fn negative(a: int32x4_t) -> uint32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vcltzq_s32(a) }
    }

    #[inline(always)]
    fn mul(a: int32x4_t, b: int32x4_t) -> Products {
        // SAFETY: see `Neon`.
        unsafe { [vmull_s32(vget_low_s32(a), vget_low_s32(b)), vmull_high_s32(a, b)] }
    }

    #[inline(always)]
    fn add_wide(a: Products, b: Products) -> Products {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vaddq_s64(a, b) })
    }

    #[inline(always)]
    fn sub_wide(a: Products, b: Products) -> Products {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vsubq_s64(a, b) })
    }

    #[inline(always)]
    fn max_wide(a: Products, b: Products) -> Products {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vbslq_s64(vcgtq_s64(a, b), a, b) })
    }

    #[inline(always)]
    fn abs_wide(a: Products) -> Products {
        // SAFETY: see `Neon`.
        a.map(|a| unsafe { vabsq_s64(a) })
    }

    #[inline(always)]
    fn greater_wide(a: Products, b: Products) -> uint32x4_t {
        // SAFETY: see `Neon`.
        let [low, high] = map(a, b, |a, b| unsafe { vcgtq_s64(a, b) });
        // SAFETY: see `Neon`.
        unsafe { vmovn_high_u64(vmovn_u64(low), high) }
    }

    #[inline(always)]
    fn narrow<const SHIFT: i32>([low, high]: Products) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vrshrn_high_n_s64::<SHIFT>(vrshrn_n_s64::<SHIFT>(low), high) }
    }

    #[inline(always)]
    fn narrow_saturating<const SHIFT: i32>([low, high]: Products) -> (int32x4_t, uint32x4_t) {
        // SAFETY: see `Neon`. A number that saturation has changed did not fit.
        unsafe {
            let (low, high) = (vrshrq_n_s64::<SHIFT>(low), vrshrq_n_s64::<SHIFT>(high));
            let narrow = vqmovn_high_s64(vqmovn_s64(low), high);
            let fits_low = vceqq_s64(vmovl_s32(vget_low_s32(narrow)), low);
            let fits_high = vceqq_s64(vmovl_high_s32(narrow), high);
            (narrow, vmvnq_u32(vmovn_high_u64(vmovn_u64(fits_low), fits_high)))
        }
    }

    #[inline(always)]
    fn narrow_by([low, high]: Products, shift: int32x4_t) -> int32x4_t {
        // SAFETY: see `Neon`. A rounding left shift by a negative count is a rounding right shift.
        unsafe {
            let shift = vnegq_s32(shift);
            let low = vrshlq_s64(low, vmovl_s32(vget_low_s32(shift)));
            let high = vrshlq_s64(high, vmovl_high_s32(shift));
            vqmovn_high_s64(vqmovn_s64(low), high)
        }
    }

    #[inline(always)]
    fn low([low, high]: Products) -> int32x4_t {
        // SAFETY: see `Neon`.
        unsafe { vmovn_high_s64(vmovn_s64(low), high) }
    }

    #[inline(always)]
    fn to_array(a: Products) -> [i64; WIDTH] {
        let mut array = [0; WIDTH];
        for (to, a) in array.chunks_exact_mut(2).zip(a) {
            // SAFETY: see `Neon`; stores 16 bytes.
            unsafe { vst1q_s64(to.as_mut_ptr(), a) };
        }
        array
    }

    #[inline(always)]
    fn shift_down<const SHIFT: i32>(a: Products) -> Products {
        // SAFETY: see `Neon`.
        a.map(|a| unsafe { vshrq_n_s64::<SHIFT>(a) })
    }

    #[inline(always)]
    fn load_wide(from: &[i64; WIDTH]) -> Products {
        // SAFETY: see `Neon`; loads 16 bytes each.
        core::array::from_fn(|i| unsafe { vld1q_s64(from[2 * i..2 * i + 2].as_ptr()) })
    }

    #[inline(always)]
    fn transposed(rows: [&Quad; WIDTH]) -> [int32x4_t; 4] {
        // SAFETY: see `Neon`; loads 16 bytes.
        transposed(rows.map(|row| unsafe { vld1q_s32(row.0.as_ptr()) }))
    }

    #[inline(always)]
    fn velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<int32x4_t> {
        // SAFETY: see `Neon`; loads the first 16 bytes of a body.
        velocity_w(at.map(|at| unsafe { vld1q_s32(SolverBody::velocity_bits(&bodies[at as usize])) }))
    }

    #[inline(always)]
    fn shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<int32x4_t> {
        // SAFETY: see `Neon`; loads the last 16 bytes of a body.
        velocity_w(at.map(|at| unsafe { vld1q_s32(SolverBody::shift_bits(&bodies[at as usize])) }))
    }

    #[inline(always)]
    fn set_velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], velocities: VelocityW<int32x4_t>) {
        set_velocities_w(at, velocities, |at| SolverBody::velocity_bits(&bodies[at as usize]));
    }

    #[inline(always)]
    fn set_shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], shifts: VelocityW<int32x4_t>) {
        set_velocities_w(at, shifts, |at| SolverBody::shift_bits(&bodies[at as usize]));
    }
}

/// Scatters three numbers and a 0 to each body, except the ground.
#[inline(always)]
fn set_velocities_w(at: &[u32; WIDTH], v: VelocityW<int32x4_t>, place: impl Fn(u32) -> *mut i32) {
    // SAFETY: see `Neon`.
    let zero = unsafe { vdupq_n_s32(0) };
    let rows = transposed([v.x, v.y, v.turn, zero]);
    for (&at, row) in at.iter().zip(rows).filter(|&(&at, _)| at != GROUND) {
        // SAFETY: see `Neon`; stores 16 bytes of a body.
        unsafe { vst1q_s32(place(at), row) };
    }
}

#[inline(always)]
fn velocity_w(rows: [int32x4_t; WIDTH]) -> VelocityW<int32x4_t> {
    let [x, y, turn, _] = transposed(rows);
    VelocityW { x, y, turn }
}

#[inline(always)]
fn transposed([r0, r1, r2, r3]: [int32x4_t; 4]) -> [int32x4_t; 4] {
    // SAFETY: see `Neon`.
    unsafe {
        let wide = |v| vreinterpretq_s64_s32(v);
        let (even_01, odd_01) = (wide(vtrn1q_s32(r0, r1)), wide(vtrn2q_s32(r0, r1)));
        let (even_23, odd_23) = (wide(vtrn1q_s32(r2, r3)), wide(vtrn2q_s32(r2, r3)));
        [
            vtrn1q_s64(even_01, even_23),
            vtrn1q_s64(odd_01, odd_23),
            vtrn2q_s64(even_01, even_23),
            vtrn2q_s64(odd_01, odd_23),
        ]
        .map(|row| vreinterpretq_s32_s64(row))
    }
}
