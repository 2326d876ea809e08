//! AVX2 backend: eight lanes in a vector of 256 bits. Their products take two vectors: one for the even lanes, and one
//! for the odd lanes.
#![expect(unsafe_code, reason = "vendor intrinsics")]

#[path = "avx2/rows.rs"]
mod rows;

use core::arch::x86_64::*;
use core::cell::Cell;

use super::super::body::SolverBody;
use super::super::{Ints, Lanes, Quad, VelocityW, WIDTH};
use super::records::Records;
use rows::{set_velocities_w, transposed, velocity_w};

/// AVX2 instructions. Only a [`super::super::Machine`] that has them runs kernels with this backend.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2;

#[derive(Clone, Copy)]
pub(super) struct Products {
    even: __m256i,
    odd: __m256i,
}

/// Combines the even lanes of one vector with the odd lanes of another.
#[inline(always)]
fn interleave(even: __m256i, odd: __m256i) -> __m256i {
    // SAFETY: see `Avx2`.
    unsafe { _mm256_blend_epi32::<0b1010_1010>(even, odd) }
}

impl Lanes<WIDTH> for Avx2 {
    type Int = __m256i;
    type Wide = Products;
    type Mask = __m256i;

    #[inline(always)]
    fn load(from: &Ints<WIDTH>) -> __m256i {
        // SAFETY: see `Avx2`; loads 32 bytes.
        unsafe { _mm256_loadu_si256(from.0.as_ptr().cast()) }
    }

    #[inline(always)]
    fn store(value: __m256i, to: &mut Ints<WIDTH>) {
        // SAFETY: see `Avx2`; stores 32 bytes.
        unsafe { _mm256_storeu_si256(to.0.as_mut_ptr().cast(), value) }
    }

    #[inline(always)]
    fn splat(value: i32) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_set1_epi32(value) }
    }

    #[inline(always)]
    fn add(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_add_epi32(a, b) }
    }

    #[inline(always)]
    fn sub(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_sub_epi32(a, b) }
    }

    #[inline(always)]
    fn add_saturating(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`. The sum overflows where its sign differs from the signs of `a` and `b`.
        unsafe {
            let sum = _mm256_add_epi32(a, b);
            let overflows = _mm256_and_si256(_mm256_xor_si256(a, sum), _mm256_xor_si256(b, sum));
            limited(sum, overflows, a)
        }
    }

    #[inline(always)]
    fn sub_saturating(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`. The difference overflows where `a` and `b` have different signs and its sign is not that
        // of `a`.
        unsafe {
            let difference = _mm256_sub_epi32(a, b);
            let overflows = _mm256_and_si256(_mm256_xor_si256(a, b), _mm256_xor_si256(a, difference));
            limited(difference, overflows, a)
        }
    }

    #[inline(always)]
    fn min(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_min_epi32(a, b) }
    }

    #[inline(always)]
    fn max(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_max_epi32(a, b) }
    }

    #[inline(always)]
    fn or(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_or_si256(a, b) }
    }

    #[inline(always)]
    fn greater(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_cmpgt_epi32(a, b) }
    }

    #[inline(always)]
    fn both(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_and_si256(a, b) }
    }

    #[inline(always)]
    fn either(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_or_si256(a, b) }
    }

    #[inline(always)]
    fn any(mask: __m256i) -> bool {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_movemask_epi8(mask) != 0 }
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, reason = "the mask has eight bits")]
    fn bits(mask: __m256i) -> u32 {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_movemask_ps(_mm256_castsi256_ps(mask)) as u32 }
    }

    #[inline(always)]
    fn count(mask: __m256i) -> u32 {
        Self::bits(mask).count_ones()
    }

    #[inline(always)]
    fn select(mask: __m256i, yes: __m256i, no: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_blendv_epi8(no, yes, mask) }
    }

    #[inline(always)]
    fn to_int(mask: __m256i) -> __m256i {
        mask
    }

    #[inline(always)]
    fn negative(a: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_srai_epi32::<31>(a) }
    }

    #[inline(always)]
    fn mul(a: __m256i, b: __m256i) -> Products {
        // SAFETY: see `Avx2`. The instruction multiplies the even lanes.
        unsafe {
            let odd = |v| _mm256_castps_si256(_mm256_movehdup_ps(_mm256_castsi256_ps(v)));
            Products { even: multiplied(a, b), odd: multiplied(odd(a), odd(b)) }
        }
    }

    #[inline(always)]
    fn add_wide(a: Products, b: Products) -> Products {
        // SAFETY: see `Avx2`.
        unsafe { Products { even: _mm256_add_epi64(a.even, b.even), odd: _mm256_add_epi64(a.odd, b.odd) } }
    }

    #[inline(always)]
    fn sub_wide(a: Products, b: Products) -> Products {
        // SAFETY: see `Avx2`.
        unsafe { Products { even: _mm256_sub_epi64(a.even, b.even), odd: _mm256_sub_epi64(a.odd, b.odd) } }
    }

    #[inline(always)]
    fn max_wide(a: Products, b: Products) -> Products {
        Products { even: larger(a.even, b.even), odd: larger(a.odd, b.odd) }
    }

    #[inline(always)]
    fn abs_wide(a: Products) -> Products {
        Products { even: magnitude(a.even), odd: magnitude(a.odd) }
    }

    #[inline(always)]
    fn greater_wide(a: Products, b: Products) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { interleave(_mm256_cmpgt_epi64(a.even, b.even), _mm256_cmpgt_epi64(a.odd, b.odd)) }
    }

    #[inline(always)]
    fn narrow<const SHIFT: i32>(a: Products) -> __m256i {
        let a = rounded::<SHIFT>(a);
        shifted::<SHIFT>(a)
    }

    #[inline(always)]
    fn narrow_saturating<const SHIFT: i32>(a: Products) -> (__m256i, __m256i) {
        let a = rounded::<SHIFT>(a);
        let low = shifted::<SHIFT>(a);
        // SAFETY: see `Avx2`. A number fits if all bits above the 32 bits of the result equal the sign bit of the
        // result.
        unsafe {
            let high = interleave(_mm256_srli_epi64::<32>(a.even), a.odd);
            let above = _mm256_sra_epi32(high, _mm_cvtsi32_si128(SHIFT - 1));
            let fits = _mm256_cmpeq_epi32(above, _mm256_srai_epi32::<31>(low));
            let limit = _mm256_xor_si256(_mm256_srai_epi32::<31>(high), _mm256_set1_epi32(i32::MAX));
            let out = _mm256_xor_si256(fits, _mm256_set1_epi32(-1));
            (_mm256_blendv_epi8(limit, low, fits), out)
        }
    }

    #[inline(always)]
    fn narrow_by(a: Products, shift: __m256i) -> __m256i {
        // SAFETY: see `Avx2`.
        let less = unsafe { _mm256_sub_epi32(shift, _mm256_set1_epi32(1)) };
        let (even, odd) =
            unsafe { (interleave(less, _mm256_setzero_si256()), _mm256_srli_epi64::<32>(less)) };
        let twice = Products { even: shifted_by(a.even, even), odd: shifted_by(a.odd, odd) };
        Self::narrow_saturating::<1>(twice).0
    }

    #[inline(always)]
    fn low(a: Products) -> __m256i {
        // SAFETY: see `Avx2`.
        unsafe { interleave(a.even, _mm256_slli_epi64::<32>(a.odd)) }
    }

    #[inline(always)]
    fn shift_down<const SHIFT: i32>(a: Products) -> Products {
        // SAFETY: see `Avx2`.
        unsafe {
            let shift = _mm_cvtsi32_si128(SHIFT);
            Products { even: _mm256_srl_epi64(a.even, shift), odd: _mm256_srl_epi64(a.odd, shift) }
        }
    }

    #[inline(always)]
    fn load_wide(from: &[i64; WIDTH]) -> Products {
        // SAFETY: see `Avx2`; loads 32 bytes each.
        unsafe {
            let front = _mm256_loadu_si256(from.as_ptr().cast());
            let back = _mm256_loadu_si256(from.as_ptr().add(4).cast());
            Products {
                even: _mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_unpacklo_epi64(front, back)),
                odd: _mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_unpackhi_epi64(front, back)),
            }
        }
    }

    #[inline(always)]
    fn quads(from: &[Quad], at: &[u32; WIDTH]) -> [__m256i; 4] {
        let quads = Records::new(from, at);
        transposed(|lane| quads.get(lane).0.as_ptr())
    }

    #[inline(always)]
    fn transposed(rows: [&Quad; WIDTH]) -> [__m256i; 4] {
        transposed(|lane| rows[lane].0.as_ptr())
    }

    #[inline(always)]
    fn to_array(a: Products) -> [i64; WIDTH] {
        let mut array = [0i64; WIDTH];
        // SAFETY: see `Avx2`; stores 32 bytes each.
        unsafe {
            let (low, high) = (_mm256_unpacklo_epi64(a.even, a.odd), _mm256_unpackhi_epi64(a.even, a.odd));
            let front = _mm256_permute2x128_si256::<0x20>(low, high);
            let back = _mm256_permute2x128_si256::<0x31>(low, high);
            _mm256_storeu_si256(array.as_mut_ptr().cast(), front);
            _mm256_storeu_si256(array.as_mut_ptr().add(4).cast(), back);
        }
        array
    }

    #[inline(always)]
    fn velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<__m256i> {
        velocity_w(&Records::new(bodies, at), SolverBody::velocity_bits)
    }

    #[inline(always)]
    fn shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH]) -> VelocityW<__m256i> {
        velocity_w(&Records::new(bodies, at), SolverBody::shift_bits)
    }

    #[inline(always)]
    fn set_velocities(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], velocities: VelocityW<__m256i>) {
        set_velocities_w(&Records::new(bodies, at), velocities, SolverBody::velocity_bits);
    }

    #[inline(always)]
    fn set_shifts(bodies: &[Cell<SolverBody>], at: &[u32; WIDTH], shifts: VelocityW<__m256i>) {
        set_velocities_w(&Records::new(bodies, at), shifts, SolverBody::shift_bits);
    }
}

#[inline(always)]
fn larger(a: __m256i, b: __m256i) -> __m256i {
    // SAFETY: see `Avx2`.
    unsafe { _mm256_blendv_epi8(b, a, _mm256_cmpgt_epi64(a, b)) }
}

#[inline(always)]
fn magnitude(a: __m256i) -> __m256i {
    // SAFETY: see `Avx2`. `-a` is `!a + 1`.
    unsafe {
        let sign = _mm256_cmpgt_epi64(_mm256_setzero_si256(), a);
        _mm256_sub_epi64(_mm256_xor_si256(a, sign), sign)
    }
}

/// Products of the even lanes, in inline assembly. The compiler would hoist the sign extension of the intrinsic out of
/// loops and past branches, and then compute full 64-bit products, which costs a fifth of the time of a kernel.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn multiplied(a: __m256i, b: __m256i) -> __m256i {
    let product: __m256i;
    // SAFETY: see `Avx2`. The assembly changes nothing but the result.
    unsafe {
        core::arch::asm!(
            "vpmuldq {product}, {a}, {b}",
            a = in(ymm_reg) a,
            b = in(ymm_reg) b,
            product = lateout(ymm_reg) product,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    product
}

/// In lanes where `overflows` is negative, the smallest or largest `i32`, with the sign of `sign`. In other lanes,
/// `result`.
#[inline(always)]
fn limited(result: __m256i, overflows: __m256i, sign: __m256i) -> __m256i {
    // SAFETY: see `Avx2`.
    unsafe {
        let limit = _mm256_xor_si256(_mm256_srai_epi32::<31>(sign), _mm256_set1_epi32(i32::MAX));
        let lanes = |v| _mm256_castsi256_ps(v);
        // `blendv_ps` selects by the sign bit of a lane.
        _mm256_castps_si256(_mm256_blendv_ps(lanes(result), lanes(limit), lanes(overflows)))
    }
}

#[inline(always)]
fn rounded<const SHIFT: i32>(a: Products) -> Products {
    // SAFETY: see `Avx2`.
    unsafe {
        let half = _mm256_set1_epi64x(1 << (SHIFT - 1));
        Products { even: _mm256_add_epi64(a.even, half), odd: _mm256_add_epi64(a.odd, half) }
    }
}

/// The 32 bits above the lowest `SHIFT` bits. A logical and an arithmetic shift give the same 32 bits.
#[inline(always)]
fn shifted<const SHIFT: i32>(a: Products) -> __m256i {
    // SAFETY: see `Avx2`.
    unsafe {
        let even = _mm256_srl_epi64(a.even, _mm_cvtsi32_si128(SHIFT));
        let odd = _mm256_sll_epi64(a.odd, _mm_cvtsi32_si128(32 - SHIFT));
        interleave(even, odd)
    }
}

/// `a / 2^shift`, rounded down. AVX2 has only a logical shift of 64-bit numbers, so the function first adds 2^62 to
/// make the number positive.
#[inline(always)]
fn shifted_by(a: __m256i, shift: __m256i) -> __m256i {
    // SAFETY: see `Avx2`.
    unsafe {
        let offset = _mm256_set1_epi64x(1 << 62);
        let sum = _mm256_srlv_epi64(_mm256_add_epi64(a, offset), shift);
        _mm256_sub_epi64(sum, _mm256_srlv_epi64(offset, shift))
    }
}
