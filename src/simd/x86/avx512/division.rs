//! Quotients `2^BITS / d` of eight numbers at a time, in integers. These formulas leave out the powers of two that
//! scale the numbers:
//!
//! ```text
//! x  = 1 / m              for the highest 32 bits m of d, on a chord of the curve: 10 correct bits
//! x' = x (2 - x m)        Newton step: 20 correct bits
//! q  = x'                 first approximation of the quotient 1 / d
//! q' = q + (1 - q d) x'   40 correct bits; a quotient has at most 34, so its error is at most 1
//! ```
#![expect(unsafe_code, reason = "vendor intrinsics")]

use core::arch::x86_64::*;

use super::{LANES, multiplied};

/// Number of chords that approximate the curve `1 / m`. The leading bits of `m` select the chord.
const CHORDS: usize = 16;
/// Number of the other bits of `m`, which give the position on the chord.
const REST: u32 = 27;

/// `2^62 / m` at the start of each chord, minus 1, so that the values fit 31 bits.
const STARTS: [i32; CHORDS] = CURVE.0;
/// Decrease of `2^62 / m` along each chord.
const FALLS: [i32; CHORDS] = CURVE.1;
const CURVE: ([i32; CHORDS], [i32; CHORDS]) = {
    let (mut starts, mut falls) = ([0; CHORDS], [0; CHORDS]);
    let (mut chord, mut m) = (0, 1i64 << 31);
    while chord < CHORDS {
        let next = m + (1 << REST);
        #[expect(clippy::cast_possible_truncation, reason = "from 2^30 to 2^31, less 1")]
        let (start, end) = (((1 << 62) / m - 1) as i32, ((1 << 62) / next - 1) as i32);
        (starts[chord], falls[chord]) = (start, start - end);
        (chord, m) = (chord + 1, next);
    }
    (starts, falls)
};

/// `2^60 / d`, like [`super::super::super::division::reciprocal`].
#[inline(always)]
pub(super) fn reciprocal(d: __m512i) -> __m512i {
    // SAFETY: see `super::Avx512`.
    quotient::<60>(unsafe { _mm512_max_epi64(d, _mm512_set1_epi64(1 << 30)) })
}

/// `G = K^-1`, like [`super::super::super::division::inverse`]. Each entry `k` of `K` is split into two parts:
///
/// ```text
/// k = H 2^32 + l,    det = (H11 H22 - H12^2) 2^64 + (H11 l22 + H22 l11 - 2 H12 l12) 2^32 + l11 l22 - l12^2
/// ```
#[inline(always)]
pub(super) fn inverse([xx, xy, yy]: [__m512i; 3]) -> [__m512i; 3] {
    // SAFETY: see `super::Avx512`.
    unsafe {
        let one = _mm512_set1_epi64(1 << 46);
        let (k11, k22) = (_mm512_add_epi64(one, xx), _mm512_add_epi64(one, yy));
        let high = |k| _mm512_srli_epi64::<32>(_mm512_add_epi64(k, _mm512_set1_epi64(1 << 31)));
        let (h11, h12, h22) = (high(k11), high(xy), high(k22));
        let highest = _mm512_sub_epi64(multiplied(h11, h22), multiplied(h12, h12));
        let crossed = _mm512_slli_epi64::<1>(multiplied(h12, xy));
        let middle = _mm512_add_epi64(multiplied(h11, k22), multiplied(h22, k11));
        let lowest = _mm512_sub_epi64(multiplied(k11, k22), multiplied(xy, xy));
        let middle = _mm512_add_epi64(_mm512_sub_epi64(middle, crossed), _mm512_srai_epi64::<32>(lowest));
        let det = _mm512_add_epi64(_mm512_slli_epi64::<2>(highest), _mm512_srai_epi64::<30>(middle));

        let zero = _mm512_setzero_si512();
        let spare = _mm512_lzcnt_epi64(_mm512_or_si512(det, _mm512_set1_epi64(1)));
        let excess = _mm512_max_epi64(_mm512_sub_epi64(_mm512_set1_epi64(32), spare), zero);
        let divisor = _mm512_max_epi64(_mm512_srlv_epi64(det, excess), _mm512_set1_epi64(1 << 29));
        let reciprocal = quotient::<62>(divisor);
        let shift = _mm512_add_epi64(excess, _mm512_set1_epi64(16));
        let entry = |k| {
            let product = _mm512_mullo_epi64(_mm512_srav_epi64(k, shift), reciprocal);
            _mm512_srli_epi64::<32>(_mm512_add_epi64(product, _mm512_set1_epi64(1 << 31)))
        };
        [entry(k22), entry(_mm512_sub_epi64(zero, xy)), entry(k11)]
    }
}

/// `2^BITS / d`, rounded down, for divisors from 2^29 to 2^46 and quotients of at most 34 bits.
#[inline(always)]
fn quotient<const BITS: u32>(d: __m512i) -> __m512i {
    // SAFETY: see `super::Avx512`.
    unsafe {
        let less = |from: u32, a| _mm512_sub_epi64(_mm512_set1_epi64(from.into()), a);
        let spare = _mm512_lzcnt_epi64(d);
        let m = _mm512_srli_epi64::<32>(_mm512_sllv_epi64(d, spare));
        // The permutation uses only the lowest four bits of an index, which are those after the leading bit of `m`.
        let chord = _mm512_srli_epi64::<REST>(m);
        let looked_up = |table: &[i32; CHORDS]| {
            _mm512_maskz_permutexvar_epi32(LANES, chord, _mm512_loadu_si512(table.as_ptr().cast()))
        };
        let rest = _mm512_and_si512(m, _mm512_set1_epi64((1 << REST) - 1));
        let fallen = _mm512_srli_epi64::<REST>(_mm512_mul_epu32(looked_up(&FALLS), rest));
        let x = _mm512_sub_epi64(looked_up(&STARTS), fallen);

        let error = less(1 << 31, _mm512_srli_epi64::<31>(_mm512_mul_epu32(m, x)));
        let x = _mm512_add_epi64(x, _mm512_srai_epi64::<31>(multiplied(x, error)));

        let q = _mm512_srlv_epi64(_mm512_slli_epi64::<3>(x), less(97 - BITS, spare));
        let left_by = |q| _mm512_sub_epi64(_mm512_set1_epi64(1 << BITS), _mm512_mullo_epi64(q, d));
        let more = multiplied(_mm512_srai_epi64::<16>(left_by(q)), x);
        let q = _mm512_add_epi64(q, _mm512_srav_epi64(more, less(78, spare)));

        let (left, one) = (left_by(q), _mm512_set1_epi64(1));
        let q = _mm512_mask_sub_epi64(q, _mm512_movepi64_mask(left), q, one);
        _mm512_mask_add_epi64(q, _mm512_cmpge_epi64_mask(left, d), q, one)
    }
}
