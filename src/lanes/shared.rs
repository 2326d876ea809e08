//! Bodies that several threads work on.
#![expect(unsafe_code, reason = "what colours promise is not in the types")]

use core::cell::Cell;

use super::body::SolverBody;

/// Bodies of which no thread changes one that another looks at.
#[derive(Clone, Copy)]
pub(crate) struct Shared<'a>(&'a [Cell<SolverBody>]);

// SAFETY: who makes one has promised that no body is changed by one thread and looked at by another.
unsafe impl Send for Shared<'_> {}
// SAFETY: the same.
unsafe impl Sync for Shared<'_> {}

impl<'a> Shared<'a> {
    /// Bodies for the batches of one colour: no two of its constraints touch the same body that any impulse changes, and
    /// batches write only those ([`super::Lanes::set_velocities`] leaves out the ground).
    pub(crate) fn within_a_colour(bodies: &'a [Cell<SolverBody>]) -> Self {
        Shared(bodies)
    }

    pub(crate) fn bodies(self) -> &'a [Cell<SolverBody>] {
        self.0
    }
}
