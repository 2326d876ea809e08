//! Data that several threads access in place.
#![expect(unsafe_code, reason = "which thread owns an element is not expressed in the types")]

use core::cell::Cell;

/// A slice shared between the threads of a team. No thread may write an element that another thread accesses between
/// the same two barriers.
///
/// The shared slices are the bodies of the solver (`Solver::sub_steps`), and the contacts of the state with their
/// results (`ContactStore::new`). Each body is in at most one constraint of a colour, and is integrated by one thread.
/// Each contact is written only by the thread that solves it. `new` is not `unsafe`, because it accesses no element:
/// the condition applies to each later access.
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
    pub(crate) fn new(elements: &'a mut [T]) -> Self {
        Shared(Cell::from_mut(elements).as_slice_of_cells())
    }

    pub(crate) fn cells(self) -> &'a [Cell<T>] {
        self.0
    }
}
