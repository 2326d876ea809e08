//! NEON backend: eight lanes in two vectors of 128 bits, and their products in four.
#![expect(unsafe_code, reason = "vendor intrinsics")]

use core::arch::aarch64::*;
use core::cell::Cell;

use super::body::{GROUND, SolverBody};
use super::scalar::map;
use super::{Backend, Ints, Kernel, Lanes, Quad, VelocityW, WIDTH};

/// NEON instructions. This file is only compiled for targets that have them, so every intrinsic in an `unsafe` block is
/// available.
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

    /// Runs a kernel.
    pub(crate) fn run(self, kernel: impl Kernel<WIDTH>) {
        kernel.run::<Neon>();
    }
}

type Ints32 = [int32x4_t; 2];

/// Two products per vector: lanes 0 and 1, 2 and 3, 4 and 5, 6 and 7.
type Products = [int64x2_t; 4];

type Masks = [uint32x4_t; 2];

impl Lanes<WIDTH> for Neon {
    type Int = Ints32;
    type Wide = Products;
    type Mask = Masks;

    #[inline(always)]
    fn load(from: &Ints<WIDTH>) -> Ints32 {
        let (low, high) = from.0.split_at(4);
        // SAFETY: see `Neon`; loads 16 bytes each.
        unsafe { [vld1q_s32(low.as_ptr()), vld1q_s32(high.as_ptr())] }
    }

    #[inline(always)]
    fn store(value: Ints32, to: &mut Ints<WIDTH>) {
        let (low, high) = to.0.split_at_mut(4);
        // SAFETY: see `Neon`; stores 16 bytes each.
        unsafe {
            vst1q_s32(low.as_mut_ptr(), value[0]);
            vst1q_s32(high.as_mut_ptr(), value[1]);
        }
    }

    #[inline(always)]
    fn splat(value: i32) -> Ints32 {
        // SAFETY: see `Neon`.
        [unsafe { vdupq_n_s32(value) }; 2]
    }

    #[inline(always)]
    fn add(a: Ints32, b: Ints32) -> Ints32 {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vaddq_s32(a, b) })
    }

    #[inline(always)]
    fn sub(a: Ints32, b: Ints32) -> Ints32 {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vsubq_s32(a, b) })
    }

    #[inline(always)]
    fn add_saturating(a: Ints32, b: Ints32) -> Ints32 {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vqaddq_s32(a, b) })
    }

    #[inline(always)]
    fn sub_saturating(a: Ints32, b: Ints32) -> Ints32 {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vqsubq_s32(a, b) })
    }

    #[inline(always)]
    fn min(a: Ints32, b: Ints32) -> Ints32 {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vminq_s32(a, b) })
    }

    #[inline(always)]
    fn max(a: Ints32, b: Ints32) -> Ints32 {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vmaxq_s32(a, b) })
    }

    #[inline(always)]
    fn or(a: Ints32, b: Ints32) -> Ints32 {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vorrq_s32(a, b) })
    }

    #[inline(always)]
    fn greater(a: Ints32, b: Ints32) -> Masks {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vcgtq_s32(a, b) })
    }

    #[inline(always)]
    fn both(a: Masks, b: Masks) -> Masks {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vandq_u32(a, b) })
    }

    #[inline(always)]
    fn either(a: Masks, b: Masks) -> Masks {
        // SAFETY: see `Neon`.
        map(a, b, |a, b| unsafe { vorrq_u32(a, b) })
    }

    #[inline(always)]
    fn any([low, high]: Masks) -> bool {
        // SAFETY: see `Neon`.
        unsafe { vmaxvq_u32(vorrq_u32(low, high)) != 0 }
    }

    #[inline(always)]
    fn bits(mask: Masks) -> u32 {
        // Bit values of lanes 0 to 3, and 4 to 7.
        const PLACES: [[u32; 4]; 2] = [[1, 2, 4, 8], [16, 32, 64, 128]];
        // SAFETY: see `Neon`; loads 16 bytes each.
        let places = map(mask, PLACES, |mask, places| unsafe { vandq_u32(mask, vld1q_u32(places.as_ptr())) });
        // SAFETY: see `Neon`.
        unsafe { vaddvq_u32(vorrq_u32(places[0], places[1])) }
    }

    #[inline(always)]
    fn count([low, high]: Masks) -> u32 {
        // SAFETY: see `Neon`. True is -1, so the sum is minus the count.
        unsafe { vaddvq_s32(vreinterpretq_s32_u32(vaddq_u32(low, high))).unsigned_abs() }
    }

    #[inline(always)]
    fn select(mask: Masks, yes: Ints32, no: Ints32) -> Ints32 {
        // SAFETY: see `Neon`.
        core::array::from_fn(|i| unsafe { vbslq_s32(mask[i], yes[i], no[i]) })
    }

    #[inline(always)]
    fn to_int(mask: Masks) -> Ints32 {
        // SAFETY: see `Neon`.
        mask.map(|mask| unsafe { vreinterpretq_s32_u32(mask) })
    }

    #[inline(always)]
    fn negative(a: Ints32) -> Masks {
        // SAFETY: see `Neon`.
        a.map(|a| unsafe { vcltzq_s32(a) })
    }

    #[inline(always)]
    fn mul(a: Ints32, b: Ints32) -> Products {
        // SAFETY: see `Neon`.
        let pairs =
            map(a, b, |a, b| unsafe { [vmull_s32(vget_low_s32(a), vget_low_s32(b)), vmull_high_s32(a, b)] });
        [pairs[0][0], pairs[0][1], pairs[1][0], pairs[1][1]]
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
    fn greater_wide(a: Products, b: Products) -> Masks {
        // SAFETY: see `Neon`.
        let [a, b, c, d] = map(a, b, |a, b| unsafe { vcgtq_s64(a, b) });
        // SAFETY: see `Neon`.
        unsafe { [vmovn_high_u64(vmovn_u64(a), b), vmovn_high_u64(vmovn_u64(c), d)] }
    }

    #[inline(always)]
    fn narrow<const SHIFT: i32>(a: Products) -> Ints32 {
        // SAFETY: see `Neon`.
        let four = |low, high| unsafe { vrshrn_high_n_s64::<SHIFT>(vrshrn_n_s64::<SHIFT>(low), high) };
        [four(a[0], a[1]), four(a[2], a[3])]
    }

    #[inline(always)]
    fn narrow_saturating<const SHIFT: i32>(a: Products) -> (Ints32, Masks) {
        // SAFETY: see `Neon`. A number that saturation has changed did not fit.
        let four = |low, high| unsafe {
            let (low, high) = (vrshrq_n_s64::<SHIFT>(low), vrshrq_n_s64::<SHIFT>(high));
            let narrow = vqmovn_high_s64(vqmovn_s64(low), high);
            let fits_low = vceqq_s64(vmovl_s32(vget_low_s32(narrow)), low);
            let fits_high = vceqq_s64(vmovl_high_s32(narrow), high);
            (narrow, vmvnq_u32(vmovn_high_u64(vmovn_u64(fits_low), fits_high)))
        };
        let (low, high) = (four(a[0], a[1]), four(a[2], a[3]));
        ([low.0, high.0], [low.1, high.1])
    }

    #[inline(always)]
    fn narrow_by(a: Products, shift: Ints32) -> Ints32 {
        // SAFETY: see `Neon`. A rounding left shift by a negative count is a rounding right shift.
        let four = |low, high, shift| unsafe {
            let shift = vnegq_s32(shift);
            let low = vrshlq_s64(low, vmovl_s32(vget_low_s32(shift)));
            let high = vrshlq_s64(high, vmovl_high_s32(shift));
            vqmovn_high_s64(vqmovn_s64(low), high)
        };
        [four(a[0], a[1], shift[0]), four(a[2], a[3], shift[1])]
    }

    #[inline(always)]
    fn low(a: Products) -> Ints32 {
        // SAFETY: see `Neon`.
        let four = |low, high| unsafe { vmovn_high_s64(vmovn_s64(low), high) };
        [four(a[0], a[1]), four(a[2], a[3])]
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
    fn transposed(rows: [&Quad; WIDTH]) -> [Ints32; 4] {
        // SAFETY: see `Neon`; loads 16 bytes.
        columns(rows.map(|row| unsafe { vld1q_s32(row.0.as_ptr()) }))
    }

    #[inline(always)]
    fn velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<Ints32> {
        // SAFETY: see `Neon`; loads the first 16 bytes of a body.
        velocity_w(at.map(|at| unsafe { vld1q_s32(SolverBody::velocity_bits(&bodies[at as usize])) }))
    }

    #[inline(always)]
    fn shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<Ints32> {
        // SAFETY: see `Neon`; loads the last 16 bytes of a body.
        velocity_w(at.map(|at| unsafe { vld1q_s32(SolverBody::shift_bits(&bodies[at as usize])) }))
    }

    #[inline(always)]
    fn set_velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], velocities: VelocityW<Ints32>) {
        set_velocities_w(at, velocities, |at| SolverBody::velocity_bits(&bodies[at as usize]));
    }

    #[inline(always)]
    fn set_shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], shifts: VelocityW<Ints32>) {
        set_velocities_w(at, shifts, |at| SolverBody::shift_bits(&bodies[at as usize]));
    }
}

/// Scatters three numbers and a 0 to each body, except the ground.
#[inline(always)]
fn set_velocities_w(at: &[u32; WIDTH], v: VelocityW<Ints32>, place: impl Fn(u32) -> *mut i32) {
    // SAFETY: see `Neon`.
    let zero = unsafe { vdupq_n_s32(0) };
    for (half, at) in at.chunks_exact(4).enumerate() {
        let rows = transposed([v.x[half], v.y[half], v.turn[half], zero]);
        for (&at, row) in at.iter().zip(rows).filter(|&(&at, _)| at != GROUND) {
            // SAFETY: see `Neon`; stores 16 bytes of a body.
            unsafe { vst1q_s32(place(at), row) };
        }
    }
}

/// Transposes rows of four numbers, and drops the last column.
#[inline(always)]
fn velocity_w(rows: [int32x4_t; WIDTH]) -> VelocityW<Ints32> {
    let [x, y, turn, _] = columns(rows);
    VelocityW { x, y, turn }
}

/// Transposes rows of four numbers into columns over all lanes.
#[inline(always)]
fn columns(rows: [int32x4_t; WIDTH]) -> [Ints32; 4] {
    let low = transposed([rows[0], rows[1], rows[2], rows[3]]);
    let high = transposed([rows[4], rows[5], rows[6], rows[7]]);
    map(low, high, |low, high| [low, high])
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
