//! AVX-512 backend: eight lanes in a vector of 512 bits. Each number is the lower half of 64 bits, and the upper half
//! is undefined. In this layout, eight products fit one vector, factors need no shuffle, and a product that has been
//! shifted down is already a number.
#![expect(unsafe_code, reason = "vendor intrinsics")]

#[path = "avx512/division.rs"]
mod division;

use core::arch::x86_64::*;
use core::cell::Cell;

use super::super::body::SolverBody;
use super::super::{Ints, Lanes, Quad, VelocityW, WIDTH};
use super::records::Records;

/// AVX-512 instructions. Only a [`super::super::Machine`] that has them runs kernels with this backend.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512;

/// Bits of a mask that belong to lanes: those for the lower halves of the numbers. The other bits are undefined.
const LANES: u16 = 0x5555;

impl Lanes<WIDTH> for Avx512 {
    type Int = __m512i;
    type Wide = __m512i;
    type Mask = __mmask16;

    #[inline(always)]
    fn load(from: &Ints<WIDTH>) -> __m512i {
        // SAFETY: see `Avx512`; loads 32 bytes.
        unsafe { _mm512_cvtepu32_epi64(_mm256_loadu_si256(from.0.as_ptr().cast())) }
    }

    #[inline(always)]
    fn store(value: __m512i, to: &mut Ints<WIDTH>) {
        // SAFETY: see `Avx512`; stores 32 bytes.
        unsafe { _mm256_storeu_si256(to.0.as_mut_ptr().cast(), _mm512_cvtepi64_epi32(value)) }
    }

    #[inline(always)]
    fn splat(value: i32) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_set1_epi32(value) }
    }

    #[inline(always)]
    fn add(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_add_epi32(a, b) }
    }

    #[inline(always)]
    fn sub(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_sub_epi32(a, b) }
    }

    #[inline(always)]
    fn add_saturating(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`. The sum overflows where its sign differs from the signs of `a` and `b`.
        unsafe {
            let sum = _mm512_add_epi32(a, b);
            let overflows = _mm512_and_si512(_mm512_xor_si512(a, sum), _mm512_xor_si512(b, sum));
            limited(sum, _mm512_movepi32_mask(overflows), a)
        }
    }

    #[inline(always)]
    fn sub_saturating(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`. The difference overflows where `a` and `b` have different signs and its sign is not
        // that of `a`.
        unsafe {
            let difference = _mm512_sub_epi32(a, b);
            let overflows = _mm512_and_si512(_mm512_xor_si512(a, b), _mm512_xor_si512(a, difference));
            limited(difference, _mm512_movepi32_mask(overflows), a)
        }
    }

    #[inline(always)]
    fn min(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_min_epi32(a, b) }
    }

    #[inline(always)]
    fn max(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_max_epi32(a, b) }
    }

    #[inline(always)]
    fn or(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_or_si512(a, b) }
    }

    #[inline(always)]
    fn greater(a: __m512i, b: __m512i) -> __mmask16 {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_cmpgt_epi32_mask(a, b) }
    }

    #[inline(always)]
    fn both(a: __mmask16, b: __mmask16) -> __mmask16 {
        a & b
    }

    #[inline(always)]
    fn either(a: __mmask16, b: __mmask16) -> __mmask16 {
        a | b
    }

    #[inline(always)]
    fn any(mask: __mmask16) -> bool {
        mask & LANES != 0
    }

    #[inline(always)]
    fn bits(mask: __mmask16) -> u32 {
        // SAFETY: see `Avx512`.
        unsafe { _pext_u32(mask.into(), LANES.into()) }
    }

    #[inline(always)]
    fn count(mask: __mmask16) -> u32 {
        (mask & LANES).count_ones()
    }

    #[inline(always)]
    fn select(mask: __mmask16, yes: __m512i, no: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_mask_blend_epi32(mask, no, yes) }
    }

    #[inline(always)]
    fn to_int(mask: __mmask16) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_movm_epi32(mask) }
    }

    #[inline(always)]
    fn negative(a: __m512i) -> __mmask16 {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_movepi32_mask(a) }
    }

    #[inline(always)]
    fn mul(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { multiplied(a, b) }
    }

    #[inline(always)]
    fn add_wide(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_add_epi64(a, b) }
    }

    #[inline(always)]
    fn sub_wide(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_sub_epi64(a, b) }
    }

    #[inline(always)]
    fn max_wide(a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_max_epi64(a, b) }
    }

    #[inline(always)]
    fn abs_wide(a: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_abs_epi64(a) }
    }

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the mask has 16 bits, of which every second is used"
    )]
    fn greater_wide(a: __m512i, b: __m512i) -> __mmask16 {
        // SAFETY: see `Avx512`.
        unsafe { _pdep_u32(_mm512_cmpgt_epi64_mask(a, b).into(), LANES.into()) as __mmask16 }
    }

    #[inline(always)]
    fn narrow<const SHIFT: i32>(a: __m512i) -> __m512i {
        // A logical and an arithmetic shift give the same lower half.
        Self::shift_down::<SHIFT>(with_half::<SHIFT>(a))
    }

    #[inline(always)]
    fn narrow_saturating<const SHIFT: i32>(a: __m512i) -> (__m512i, __mmask16) {
        // SAFETY: see `Avx512`.
        unsafe { saturated(_mm512_sra_epi64(with_half::<SHIFT>(a), _mm_cvtsi32_si128(SHIFT))) }
    }

    #[inline(always)]
    fn narrow_by(a: __m512i, shift: __m512i) -> __m512i {
        // SAFETY: see `Avx512`. The rounding constant, half a unit of the result, is `2^(shift - 1)`.
        unsafe {
            let shift = _mm512_maskz_mov_epi32(LANES, shift);
            let one = _mm512_set1_epi64(1);
            let half = _mm512_sllv_epi64(one, _mm512_sub_epi64(shift, one));
            saturated(_mm512_srav_epi64(_mm512_add_epi64(a, half), shift)).0
        }
    }

    #[inline(always)]
    fn low(a: __m512i) -> __m512i {
        a
    }

    #[inline(always)]
    fn shift_down<const SHIFT: i32>(a: __m512i) -> __m512i {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_srl_epi64(a, _mm_cvtsi32_si128(SHIFT)) }
    }

    #[inline(always)]
    fn reciprocal(d: __m512i) -> __m512i {
        division::reciprocal(d)
    }

    #[inline(always)]
    fn inverse(entries: [__m512i; 3]) -> [__m512i; 3] {
        division::inverse(entries)
    }

    #[inline(always)]
    fn to_array(a: __m512i) -> [i64; WIDTH] {
        let mut array = [0; WIDTH];
        // SAFETY: see `Avx512`; stores 64 bytes.
        unsafe { _mm512_storeu_si512(array.as_mut_ptr().cast(), a) };
        array
    }

    #[inline(always)]
    fn load_wide(from: &[i64; WIDTH]) -> __m512i {
        // SAFETY: see `Avx512`; loads 64 bytes.
        unsafe { _mm512_loadu_si512(from.as_ptr().cast()) }
    }

    #[inline(always)]
    fn quads(from: &[Quad], at: &[u32; WIDTH]) -> [__m512i; 4] {
        let quads = Records::new(from, at);
        transposed(|lane| quads.get(lane).0.as_ptr())
    }

    #[inline(always)]
    fn transposed(rows: [&Quad; WIDTH]) -> [__m512i; 4] {
        transposed(|lane| rows[lane].0.as_ptr())
    }

    #[inline(always)]
    fn velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<__m512i> {
        velocity_w(&Records::new(bodies, at), SolverBody::velocity_bits)
    }

    #[inline(always)]
    fn shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<__m512i> {
        velocity_w(&Records::new(bodies, at), SolverBody::shift_bits)
    }

    #[inline(always)]
    fn set_velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], velocities: VelocityW<__m512i>) {
        set_velocities_w(&Records::new(bodies, at), velocities, SolverBody::velocity_bits);
    }

    #[inline(always)]
    fn set_shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], shifts: VelocityW<__m512i>) {
        set_velocities_w(&Records::new(bodies, at), shifts, SolverBody::shift_bits);
    }
}

/// Products of the lower halves, in inline assembly: see `multiplied` in `avx2.rs`.
#[inline]
#[target_feature(enable = "avx512f")]
unsafe fn multiplied(a: __m512i, b: __m512i) -> __m512i {
    let product: __m512i;
    // SAFETY: see `Avx512`. The assembly changes nothing but the result.
    unsafe {
        core::arch::asm!(
            "vpmuldq {product}, {a}, {b}",
            a = in(zmm_reg) a,
            b = in(zmm_reg) b,
            product = lateout(zmm_reg) product,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    product
}

/// In lanes where `overflows` is set, the smallest or largest `i32`, with the sign of `sign`. In other lanes, `result`.
#[inline(always)]
fn limited(result: __m512i, overflows: __mmask16, sign: __m512i) -> __m512i {
    // SAFETY: see `Avx512`.
    unsafe {
        let largest = _mm512_set1_epi32(i32::MAX);
        _mm512_mask_xor_epi32(result, overflows, _mm512_srai_epi32::<31>(sign), largest)
    }
}

#[inline(always)]
fn with_half<const SHIFT: i32>(a: __m512i) -> __m512i {
    // SAFETY: see `Avx512`.
    unsafe { _mm512_add_epi64(a, _mm512_set1_epi64(1 << (SHIFT - 1))) }
}

/// Saturates 64-bit numbers to 32 bits. Returns a mask of the lanes that saturated.
#[inline(always)]
fn saturated(a: __m512i) -> (__m512i, __mmask16) {
    // SAFETY: see `Avx512`. A number fits if its upper half equals the sign of its lower half.
    unsafe {
        let upper = upper_halves(a);
        let out = _mm512_cmpneq_epi32_mask(upper, _mm512_srai_epi32::<31>(a));
        (limited(a, out, upper), out)
    }
}

#[inline(always)]
fn upper_halves(a: __m512i) -> __m512i {
    // SAFETY: see `Avx512`.
    unsafe { _mm512_srli_epi64::<32>(a) }
}

#[inline(always)]
fn velocity_w<T>(bodies: &Records<'_, T>, place: impl Fn(&T) -> *mut i32) -> VelocityW<__m512i> {
    let [x, y, turn, _] = transposed(|lane| place(bodies.get(lane)).cast_const());
    VelocityW { x, y, turn }
}

/// Gathers rows of four numbers, transposed.
#[inline(always)]
fn transposed(row: impl Fn(usize) -> *const i32) -> [__m512i; 4] {
    // SAFETY: see `Avx512`; loads 16 bytes, aligned to 16.
    unsafe {
        let row = |lane: usize| _mm_load_si128(row(lane).cast());
        let two = |lane: usize| _mm256_set_m128i(row(lane + 2), row(lane));
        let four = |lane: usize| _mm512_inserti64x4::<1>(_mm512_castsi256_si512(two(lane)), two(lane + 4));
        let (even, odd) = (four(0), four(1));
        let (front, back) = (_mm512_unpacklo_epi64(even, odd), _mm512_unpackhi_epi64(even, odd));
        [front, upper_halves(front), back, upper_halves(back)]
    }
}

/// Scatters three numbers and a 0 to each body, except the ground.
#[inline(always)]
fn set_velocities_w<T>(bodies: &Records<'_, T>, v: VelocityW<__m512i>, place: impl Fn(&T) -> *mut i32) {
    // SAFETY: see `Avx512`; stores 16 bytes of a body.
    unsafe {
        let front = _mm512_mask_shuffle_epi32::<0b10_10_00_00>(v.x, !LANES, v.y);
        let back = _mm512_maskz_mov_epi32(LANES, v.turn);
        let even = _mm512_unpacklo_epi64(front, back);
        let odd = _mm512_unpackhi_epi64(front, back);
        bodies.each_but_the_ground(|lane, body| {
            let rows = if lane % 2 == 0 { even } else { odd };
            let row = match lane / 2 {
                0 => _mm512_extracti32x4_epi32::<0>(rows),
                1 => _mm512_extracti32x4_epi32::<1>(rows),
                2 => _mm512_extracti32x4_epi32::<2>(rows),
                _ => _mm512_extracti32x4_epi32::<3>(rows),
            };
            _mm_store_si128(place(body).cast(), row);
        });
    }
}
