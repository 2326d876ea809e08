//! Access to the memory of callers. No other module dereferences pointers of callers.
//!
//! An [`In`] or [`Out`] comes from a Rust reference, or from a caller in another language. Such a caller guarantees
//! that the pointer is null or points to as many items as the function reads or writes, and that nothing else accesses
//! these items during the call. This module checks for null pointers, alignment and counts.

use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::status::{Failure, Outcome, Status, note};

/// Types that may be read from the memory of a caller and written to it.
///
/// # Safety
/// Every byte pattern has to be a value of the type, and the type must have no padding.
pub unsafe trait Plain: Copy + 'static {}

// SAFETY: integers have neither padding nor invalid bytes.
unsafe impl Plain for u8 {}
// SAFETY: integers have neither padding nor invalid bytes.
unsafe impl Plain for u32 {}
// SAFETY: integers have neither padding nor invalid bytes.
unsafe impl Plain for i32 {}
// SAFETY: integers have neither padding nor invalid bytes.
unsafe impl Plain for u64 {}
// SAFETY: integers have neither padding nor invalid bytes.
unsafe impl Plain for i64 {}
// SAFETY: integers have neither padding nor invalid bytes.
unsafe impl Plain for usize {}
// SAFETY: an array of plain items has no padding between them.
unsafe impl<T: Plain, const N: usize> Plain for [T; N] {}

/// A pointer to items that a function reads.
#[repr(transparent)]
#[derive(Clone, Copy, Debug)]
pub struct In<'a, T>(*const T, PhantomData<&'a [T]>);

/// A pointer to items that a function writes.
#[repr(transparent)]
#[derive(Debug)]
pub struct Out<'a, T>(*mut T, PhantomData<&'a mut [T]>);

fn check<T>(pointer: *const T) -> Outcome {
    if pointer.is_null() {
        return Err(Failure::new(Status::Null, "a pointer is null"));
    }
    if !pointer.is_aligned() {
        return Err(Failure::new(Status::Misaligned, "a pointer is not aligned"));
    }
    Ok(())
}

fn check_count<T>(count: usize) -> Outcome {
    let bytes = count.checked_mul(size_of::<T>()).and_then(|bytes| isize::try_from(bytes).ok());
    bytes.map(|_| ()).ok_or_else(|| Failure::new(Status::Value, "a count exceeds the memory"))
}

impl<'a, T: Plain> In<'a, T> {
    /// Points to a value.
    #[must_use]
    pub const fn of(value: &'a T) -> Self {
        In(value, PhantomData)
    }

    /// Points to the first of some items.
    #[must_use]
    pub const fn all(items: &'a [T]) -> Self {
        In(items.as_ptr(), PhantomData)
    }

    /// A null pointer.
    #[must_use]
    pub const fn null() -> Self {
        In(std::ptr::null(), PhantomData)
    }

    #[cfg(any(test, feature = "fuzzing"))]
    pub(crate) const fn to(pointer: *const T) -> Self {
        In(pointer, PhantomData)
    }

    pub(crate) const fn is_null(&self) -> bool {
        self.0.is_null()
    }

    pub(crate) fn get(&self) -> Outcome<T> {
        check(self.0)?;
        // SAFETY: not null and aligned; the caller promises an item, and every byte pattern is an item.
        Ok(unsafe { self.0.read() })
    }

    /// Returns `count` items. If `count` is 0, the pointer may be null.
    pub(crate) fn slice(&self, count: usize) -> Outcome<&[T]> {
        if count == 0 {
            return Ok(&[]);
        }
        check(self.0)?;
        check_count::<T>(count)?;
        // SAFETY: not null, aligned, and of a possible size; the caller promises `count` items that do not change
        // during the call, and every byte pattern is an item.
        Ok(unsafe { std::slice::from_raw_parts(self.0, count) })
    }
}

impl In<'_, u8> {
    pub(crate) fn text(&self, bytes: usize) -> Outcome<&str> {
        std::str::from_utf8(self.slice(bytes)?)
            .map_err(|error| Failure::new(Status::Text, format!("not UTF-8: {error}")))
    }
}

impl<'a, T: Plain> Out<'a, T> {
    /// Points to a value.
    #[must_use]
    pub const fn of(value: &'a mut T) -> Self {
        Out(value, PhantomData)
    }

    /// Points to the first of some items.
    #[must_use]
    pub const fn all(items: &'a mut [T]) -> Self {
        Out(items.as_mut_ptr(), PhantomData)
    }

    /// A null pointer.
    #[must_use]
    pub const fn null() -> Self {
        Out(std::ptr::null_mut(), PhantomData)
    }

    #[cfg(any(test, feature = "fuzzing"))]
    pub(crate) const fn to(pointer: *mut T) -> Self {
        Out(pointer, PhantomData)
    }

    pub(crate) const fn is_null(&self) -> bool {
        self.0.is_null()
    }

    /// Checks the pointer of a required result. Call this before an operation whose result would be lost if it could
    /// not be written.
    pub(crate) fn check(&self) -> Outcome {
        check(self.0)
    }

    /// Checks the pointer of an optional result, for which the caller may pass a null pointer.
    pub(crate) fn check_if_wanted(&self) -> Outcome {
        if self.0.is_null() { Ok(()) } else { self.check() }
    }

    pub(crate) fn set(&mut self, value: T) -> Outcome {
        check(self.0)?;
        // SAFETY: not null and aligned; the caller promises that it points to memory for an item.
        unsafe { self.0.write(value) };
        Ok(())
    }

    /// Writes the value, unless the pointer is null.
    pub(crate) fn set_if_wanted(&mut self, value: T) -> Outcome {
        if self.0.is_null() { Ok(()) } else { self.set(value) }
    }

    /// Writes the number of items to `count`. Writes the items if there are at most `capacity`; otherwise the result is
    /// [`Status::Buffer`].
    pub(crate) fn set_all(&mut self, capacity: usize, count: &mut Out<'_, usize>, items: &[T]) -> Outcome {
        count.set(items.len())?;
        if items.len() > capacity {
            let (needed, given) = (items.len(), capacity);
            return Err(Failure::new(
                Status::Buffer,
                format!("a buffer of {given} items, {needed} are needed"),
            ));
        }
        if items.is_empty() {
            return Ok(());
        }
        check(self.0)?;
        // SAFETY: not null and aligned; the caller promises memory for `capacity` items that does not belong to this
        // library, and at most `capacity` items are written.
        unsafe { std::ptr::copy_nonoverlapping(items.as_ptr(), self.0, items.len()) };
        Ok(())
    }
}

/// Runs the body of a function, and converts failures and panics to status codes.
pub(crate) fn guard(body: impl FnOnce() -> Outcome) -> i32 {
    // Unwinding is safe: a panic poisons the mutexes of the objects that it may leave in an invalid state, and later
    // calls refuse these objects.
    let result = catch_unwind(AssertUnwindSafe(body));
    let status = match result {
        Ok(Ok(())) => Status::Ok,
        // `Status::None` is not a failure, so the text of the last failure stays.
        Ok(Err(Failure { status: Status::None, .. })) => Status::None,
        Ok(Err(failure)) => note(failure),
        Err(_) => note(Failure::new(Status::Internal, "an error in the library")),
    };
    status as i32
}
