//! Gather and scatter of eight records of four numbers.
#![expect(unsafe_code, reason = "vendor intrinsics")]

use core::arch::x86_64::*;

use super::super::records::Records;
use super::VelocityW;

/// Scatters three numbers and a 0 to each body, except the ground.
#[inline(always)]
pub(super) fn set_velocities_w<T>(
    bodies: &Records<'_, T>,
    v: VelocityW<__m256i>,
    place: impl Fn(&T) -> *mut i32,
) {
    // SAFETY: see `super::Avx2`; stores 16 bytes of a body.
    unsafe {
        let zero = _mm256_setzero_si256();
        let (xy_low, xy_high) = (_mm256_unpacklo_epi32(v.x, v.y), _mm256_unpackhi_epi32(v.x, v.y));
        let (t_low, t_high) = (_mm256_unpacklo_epi32(v.turn, zero), _mm256_unpackhi_epi32(v.turn, zero));
        let pairs = [
            _mm256_unpacklo_epi64(xy_low, t_low),
            _mm256_unpackhi_epi64(xy_low, t_low),
            _mm256_unpacklo_epi64(xy_high, t_high),
            _mm256_unpackhi_epi64(xy_high, t_high),
        ];
        bodies.each_but_the_ground(|lane, body| {
            let pair = pairs[lane % 4];
            let row =
                if lane < 4 { _mm256_castsi256_si128(pair) } else { _mm256_extracti128_si256::<1>(pair) };
            _mm_store_si128(place(body).cast(), row);
        });
    }
}

#[inline(always)]
pub(super) fn velocity_w<T>(bodies: &Records<'_, T>, place: impl Fn(&T) -> *mut i32) -> VelocityW<__m256i> {
    let [x, y, turn, _] = transposed(|lane| place(bodies.get(lane)).cast_const());
    VelocityW { x, y, turn }
}

/// Gathers rows of four numbers, transposed.
#[inline(always)]
pub(super) fn transposed(row: impl Fn(usize) -> *const i32) -> [__m256i; 4] {
    // SAFETY: see `super::Avx2`; loads 16 bytes, aligned to 16.
    unsafe {
        let row = |lane: usize| _mm_load_si128(row(lane).cast());
        let pair = |lane: usize| _mm256_set_m128i(row(lane + 4), row(lane));
        let (r0, r1, r2, r3) = (pair(0), pair(1), pair(2), pair(3));
        let (front_01, front_23) = (_mm256_unpacklo_epi32(r0, r1), _mm256_unpacklo_epi32(r2, r3));
        let (back_01, back_23) = (_mm256_unpackhi_epi32(r0, r1), _mm256_unpackhi_epi32(r2, r3));
        [
            _mm256_unpacklo_epi64(front_01, front_23),
            _mm256_unpackhi_epi64(front_01, front_23),
            _mm256_unpacklo_epi64(back_01, back_23),
            _mm256_unpackhi_epi64(back_01, back_23),
        ]
    }
}
