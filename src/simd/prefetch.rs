//! Cache prefetch.

/// Prefetches a value into the cache. Does nothing on architectures other than x86-64.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
#[expect(unsafe_code, reason = "vendor intrinsics")]
pub(crate) fn prefetch<T>(of: &T) {
    use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    const LINE: usize = 64;
    let start = core::ptr::from_ref(of).cast::<i8>();
    let ask = |offset| {
        // SAFETY: every processor of this architecture has the instruction, and the address is within the value.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(offset)) };
    };
    // A `while` loop, because the compiler unrolls it.
    let mut offset = 0;
    while offset < size_of::<T>() {
        ask(offset);
        offset += LINE;
    }
    // A value that is not aligned to a line may extend into one more line.
    if align_of::<T>() < LINE.min(size_of::<T>()) {
        ask(size_of::<T>() - 1);
    }
}

#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub(crate) fn prefetch<T>(_: &T) {}
