//! Bounds-checked access to eight records by index.
#![expect(unsafe_code, reason = "vendor intrinsics")]

use core::arch::x86_64::*;

use super::super::WIDTH;
use super::super::body::GROUND;

pub(super) struct Records<'a, T> {
    all: &'a [T],
    at: &'a [u32; WIDTH],
}

impl<'a, T> Records<'a, T> {
    /// Checks all indices at once, because a check of each index takes as long as processing the record.
    #[inline(always)]
    #[expect(clippy::cast_possible_wrap, reason = "compared as unsigned")]
    pub(super) fn new(all: &'a [T], at: &'a [u32; WIDTH]) -> Self {
        let last = u32::try_from(all.len().saturating_sub(1)).unwrap_or(u32::MAX);
        // SAFETY: see `super::avx2::Avx2`; loads 32 bytes.
        let outside = unsafe {
            let at = _mm256_loadu_si256(at.as_ptr().cast());
            let within = _mm256_min_epu32(at, _mm256_set1_epi32(last as i32));
            _mm256_movemask_epi8(_mm256_cmpeq_epi32(at, within)) != -1
        };
        assert!(!(outside || all.is_empty()), "every index should be within the records");
        Records { all, at }
    }

    #[inline(always)]
    fn has_ground(&self) -> bool {
        const { assert!(GROUND == 0) };
        // SAFETY: see `super::avx2::Avx2`; loads 32 bytes.
        unsafe {
            let at = _mm256_loadu_si256(self.at.as_ptr().cast());
            _mm256_movemask_epi8(_mm256_cmpeq_epi32(at, _mm256_setzero_si256())) != 0
        }
    }

    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> &'a T {
        // A volatile read: otherwise the compiler would extract the index from the vector that `new` has loaded, which
        // occupies the execution units that the kernels need.
        let at: *const u32 = &self.at[lane];
        // SAFETY: the index can be read, and `new` has checked that it is within the slice.
        unsafe { self.all.get_unchecked(at.read_volatile() as usize) }
    }

    /// Calls `each` with the lane and the record of every body except the ground. Most batches do not contain the
    /// ground, and then no lane is compared with it.
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
