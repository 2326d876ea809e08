//! The context of all stages of a sub-step, like `b2StepContext` of Box2D.

use core::cell::Cell;
use core::fmt::Debug;

use super::body::SolverBody;
use super::limits::Faults;
use super::settings::Tuning;
use crate::simd::Machine;
use crate::threads::Member;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// Adds velocity that removes position errors.
    Bias,
    /// Removes the velocity that the bias pass has added to remove position errors.
    Relax,
}

/// A pass as a type, so that each pass is compiled separately.
pub(super) trait SolverPass: Copy + Debug + Send + Sync {
    fn kind(self) -> Pass;
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Bias;

#[derive(Clone, Copy, Debug)]
pub(super) struct Relax;

impl SolverPass for Bias {
    #[inline(always)]
    fn kind(self) -> Pass {
        Pass::Bias
    }
}

impl SolverPass for Relax {
    #[inline(always)]
    fn kind(self) -> Pass {
        Pass::Relax
    }
}

/// The settings and the bodies of a tick, and the thread that works on the tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepContext<'a> {
    pub(super) machine: Machine,
    member: Member<'a>,
    pub(super) tuning: &'a Tuning,
    pub(super) bodies: &'a [Cell<SolverBody>],
    faults: &'a Cell<Faults>,
}

impl<'a> StepContext<'a> {
    /// The context of a thread that works alone. The stages add their faults to `faults`.
    pub(super) fn new(
        machine: Machine,
        tuning: &'a Tuning,
        bodies: &'a mut [SolverBody],
        faults: &'a mut Faults,
    ) -> Self {
        let (bodies, faults) = (SolverBody::cells(bodies), Cell::from_mut(faults));
        StepContext { machine, member: Member::ALONE, tuning, bodies, faults }
    }

    /// The context of a member of a team, which shares the bodies with the other members.
    pub(super) fn of_member(
        machine: Machine,
        member: Member<'a>,
        tuning: &'a Tuning,
        bodies: &'a [Cell<SolverBody>],
        faults: &'a mut Faults,
    ) -> Self {
        StepContext { machine, member, tuning, bodies, faults: Cell::from_mut(faults) }
    }

    pub(super) fn is_alone(&self) -> bool {
        self.member.is_alone()
    }

    /// Waits for all other threads. Their results may be read afterwards.
    pub(super) fn wait(&self) {
        self.member.wait();
    }

    pub(super) fn add_faults(&self, faults: Faults) {
        self.faults.set(self.faults.get() + faults);
    }
}
