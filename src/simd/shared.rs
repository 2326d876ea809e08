//! Solver bodies that several threads access.
#![expect(unsafe_code, reason = "the guarantee of graph colouring is not expressed in the types")]

use core::cell::Cell;

use super::body::SolverBody;

/// Bodies shared between threads, under the condition that no thread writes a body that another thread accesses.
#[derive(Clone, Copy)]
pub(crate) struct Shared<'a>(&'a [Cell<SolverBody>]);

// SAFETY: the creator guarantees that no body is written by one thread and accessed by another.
unsafe impl Send for Shared<'_> {}
// SAFETY: as above.
unsafe impl Sync for Shared<'_> {}

impl<'a> Shared<'a> {
    /// Shares the bodies between the batches of one colour. No two constraints of a colour have a common body that
    /// impulses can change, and batches write only such bodies ([`super::Lanes::set_velocities`] skips the ground).
    pub(crate) fn within_a_colour(bodies: &'a [Cell<SolverBody>]) -> Self {
        Shared(bodies)
    }

    pub(crate) fn bodies(self) -> &'a [Cell<SolverBody>] {
        self.0
    }
}
