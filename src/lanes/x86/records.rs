//! Eight records of many, which lanes read and write.
#![expect(unsafe_code, reason = "vendor intrinsics")]

use core::arch::x86_64::*;

use super::super::WIDTH;
use super::super::body::GROUND;

/// Eight records of many.
pub(super) struct Records<'a, T> {
    all: &'a [T],
    at: &'a [u32; WIDTH],
}

impl<'a, T> Records<'a, T> {
    /// Looks at all eight places at once: a check for each of them took as long as what is done with its record.
    #[inline(always)]
    #[expect(clippy::cast_possible_wrap, reason = "compared without a sign")]
    pub(super) fn new(all: &'a [T], at: &'a [u32; WIDTH]) -> Self {
        let last = u32::try_from(all.len().saturating_sub(1)).unwrap_or(u32::MAX);
        // SAFETY: see `super::avx2::Avx2`; 32 bytes.
        let outside = unsafe {
            let at = _mm256_loadu_si256(at.as_ptr().cast());
            let within = _mm256_min_epu32(at, _mm256_set1_epi32(last as i32));
            _mm256_movemask_epi8(_mm256_cmpeq_epi32(at, within)) != -1
        };
        assert!(!(outside || all.is_empty()), "places of records that are there");
        Records { all, at }
    }

    /// Whether the ground is among them.
    #[inline(always)]
    fn has_ground(&self) -> bool {
        const { assert!(GROUND == 0) };
        // SAFETY: see `super::avx2::Avx2`; 32 bytes.
        unsafe {
            let at = _mm256_loadu_si256(self.at.as_ptr().cast());
            _mm256_movemask_epi8(_mm256_cmpeq_epi32(at, _mm256_setzero_si256())) != 0
        }
    }

    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> &'a T {
        // Read by itself: the compiler would take the place out of the vector that `new` has looked at, by the units of
        // the processor that kernels wait for.
        let at: *const u32 = &self.at[lane];
        // SAFETY: a place that can be read; `new` has seen that a record is there.
        unsafe { self.all.get_unchecked(at.read_volatile() as usize) }
    }

    /// Does something with each of eight bodies but those at the ground's place. Most batches are away from it: then no
    /// lane has to be asked.
    #[inline(always)]
    pub(super) fn each_but_the_ground(&self, mut each: impl FnMut(usize, &'a T)) {
        let has_ground = self.has_ground();
        for lane in 0..WIDTH {
            if !has_ground || self.at[lane] != GROUND {
                each(lane, self.get(lane));
            }
        }
    }
}
