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
    let ask = |offset| {
        // SAFETY: every processor of this architecture has the instruction, and the address is within the value.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(offset)) };
    };
    // A plain loop is unrolled.
    let mut offset = 0;
    while offset < size_of::<T>() {
        ask(offset);
        offset += LINE;
    }
    // What is not aligned to a line may end in one more.
    if align_of::<T>() < LINE.min(size_of::<T>()) {
        ask(size_of::<T>() - 1);
    }
}

#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub(crate) fn prefetch<T>(_: &T) {}
