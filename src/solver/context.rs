//! The context of all stages of a sub-step, like `b2StepContext` of Box2D.

use core::cell::Cell;

use super::body::SolverBody;
use super::limits::Faults;
use super::settings::Tuning;
use crate::simd::Machine;
use crate::threads::Threads;

/// Whether a pass removes position errors or only velocity errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// Removes position errors by velocity.
    Bias,
    /// Removes the velocity that removing position errors has left.
    Relax,
}

/// Backend, threads and settings of a tick, and the bodies that the stages change.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepContext<'a> {
    pub(super) machine: Machine,
    pub(super) threads: &'a Threads,
    pub(super) tuning: &'a Tuning,
    /// The bodies of the tick, by their indices in the body list.
    pub(super) bodies: &'a [Cell<SolverBody>],
    faults: &'a Cell<Faults>,
}

impl<'a> StepContext<'a> {
    /// Creates the context. The faults of all stages are added to `faults`.
    pub(super) fn new(
        machine: Machine,
        threads: &'a Threads,
        tuning: &'a Tuning,
        bodies: &'a mut [SolverBody],
        faults: &'a mut Faults,
    ) -> Self {
        let (bodies, faults) = (SolverBody::cells(bodies), Cell::from_mut(faults));
        StepContext { machine, threads, tuning, bodies, faults }
    }

    /// Adds faults that a stage has counted.
    pub(super) fn add_faults(&self, faults: Faults) {
        self.faults.set(self.faults.get() + faults);
    }
}
