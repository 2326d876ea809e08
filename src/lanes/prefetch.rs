//! What will soon be looked at.

/// Brings a value into the cache: a hint that changes nothing, for processors whose compiler has a way to give it.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
#[expect(unsafe_code, reason = "vendor intrinsics")]
pub(crate) fn prefetch<T>(of: &T) {
    use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    /// The bytes that a processor reads at a time.
    const LINE: usize = 64;
    let start = core::ptr::from_ref(of).cast::<i8>();
    let last = size_of::<T>().saturating_sub(1);
    // What is not aligned to a line may end in one more.
    let end = if align_of::<T>() < LINE { Some(last) } else { None };
    for offset in (0..=last).step_by(LINE).chain(end) {
        // SAFETY: every processor of this architecture has the instruction, and the address is within the value.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(offset)) };
    }
}

#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub(crate) fn prefetch<T>(_: &T) {}
