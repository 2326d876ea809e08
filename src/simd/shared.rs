//! Data that several threads access in place.
#![expect(unsafe_code, reason = "which thread owns an element is not expressed in the types")]

use core::cell::Cell;

/// A slice shared between the threads of a team, under the condition that no thread writes an element that another
/// thread accesses between the same two barriers.
///
/// The shared slices are the bodies of the solver (`Solver::sub_steps`), and the contacts of the state with their
/// results (`ContactStore::new`). Each body is in at most one constraint of a colour, and is integrated by one thread.
/// Each contact and its results are written only by the thread that solves the contact. `new` is not an `unsafe`
/// function, because each access, not the sharing, has to meet the condition. Tests compare the results of 1, 2, 4 and
/// 8 threads.
pub(crate) struct Shared<'a, T>(&'a [Cell<T>]);

impl<T> Clone for Shared<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Shared<'_, T> {}

// SAFETY: the uses that are listed above write no element that another thread accesses between the same two barriers,
// and a barrier synchronises memory.
unsafe impl<T: Send> Send for Shared<'_, T> {}
// SAFETY: as above.
unsafe impl<T: Send> Sync for Shared<'_, T> {}

impl<'a, T> Shared<'a, T> {
    /// Shares a slice. Every access must meet the condition in the documentation of the type.
    pub(crate) fn new(elements: &'a mut [T]) -> Self {
        Shared(Cell::from_mut(elements).as_slice_of_cells())
    }

    pub(crate) fn cells(self) -> &'a [Cell<T>] {
        self.0
    }
}
