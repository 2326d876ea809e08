//! Warm start of contacts, body by body: one sum applies the accumulated impulses of all contacts of a body.
//!
//! The rows of contacts do not change within a tick. Applied again, the accumulated impulses therefore cause the same
//! velocity change as in the last sub-step:
//!
//! ```text
//! change = v - v_free,    v' = v_free' + change
//! ```
//!
//! where `v_free` is the velocity without contacts. Joints (whose rows turn with their bodies), locked axes and
//! restitution also change velocities within a sub-step. Their changes are added to `v_free`, so that they are not
//! applied again.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;
use core::cell::Cell;

use super::body::SolverBody;
use super::context::StepContext;
use super::limits::Faults;
use super::pair::BodyPairW;
use crate::simd::{GROUND, Ints, Kernel, Lanes, Layout, Machine, Scalar, VelocityW, WIDTH, with_data};

/// The velocity changes that contacts cause to the bodies that one thread integrates.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactVelocities {
    groups: Layout<Groups<WIDTH>, Groups<1>>,
    /// Whether the tick has already had a sub-step, whose velocity changes can be measured.
    known: bool,
    /// Whether any group of any thread is shared ([`PushedBody::shared`]).
    pub(super) shared: bool,
}

type Groups<const N: usize> = Vec<Group<N>>;

#[derive(Clone, Debug)]
#[repr(align(32))]
struct Group<const N: usize> {
    /// The indices of the bodies. Lanes without a body have the ground.
    at: [u32; N],
    /// Whether one of the bodies is shared ([`PushedBody::shared`]). [`Task::Suspend`] and [`Task::Resume`] then also
    /// act on the other bodies of the group, whose `free` stays exact: `free - v + v` does not round or saturate,
    /// because `free` and `v` are below 512 m/s.
    shared: bool,
    free: VelocityW<Ints<N>>,
    /// The velocity change by contacts in the last sub-step. During [`ContactVelocities::forget`], the velocities before.
    change: VelocityW<Ints<N>>,
}

#[derive(Clone, Copy, Debug)]
enum Task {
    /// Computes `change` from the velocities and `v_free`.
    Measure,
    /// Records `v_free`, and adds `change` to the velocities.
    Apply,
    /// Subtracts the velocity from `v_free`, in shared groups.
    Suspend,
    /// Adds the velocity to `v_free`, in shared groups.
    Resume,
    /// Records the velocities in `change`, in shared groups.
    Save,
    /// Restores the recorded velocities, and adds their difference from the present ones to `v_free`, in shared groups.
    Forget,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct PushedBody {
    pub(super) index: u32,
    /// Whether joints, locked axes or restitution may change the velocity between the warm start and the end of a
    /// sub-step.
    pub(super) shared: bool,
}

impl ContactVelocities {
    pub(super) fn begin(&mut self, machine: Machine, bodies: impl Iterator<Item = PushedBody>) {
        self.known = false;
        self.groups.fit(machine);
        self.shared = with_data!(&mut self.groups, groups => arrange(groups, bodies));
    }

    /// Measures the velocity changes of the last sub-step, unless this is the first sub-step of the tick.
    pub(super) fn measure(&mut self, context: &StepContext<'_>) {
        if self.known {
            self.perform(Task::Measure, context);
        }
    }

    /// Records the free velocities and applies the velocity changes of the last sub-step. Returns `false` in the first
    /// sub-step of a tick, when there are no changes to apply.
    pub(super) fn apply(&mut self, context: &StepContext<'_>) -> bool {
        self.perform(Task::Apply, context);
        core::mem::replace(&mut self.known, true)
    }

    /// Runs `change`. The velocity changes that it makes do not count as changes by contacts.
    pub(super) fn exempt(&mut self, context: &StepContext<'_>, change: impl FnOnce()) {
        if self.shared {
            self.perform(Task::Suspend, context);
            context.wait();
        }
        change();
        if self.shared {
            context.wait();
            self.perform(Task::Resume, context);
            context.wait();
        }
    }

    /// Runs `withdraw`, which takes velocity changes by contacts back, and restores the velocities. The changes then do
    /// not count as changes by contacts.
    pub(super) fn forget(&mut self, context: &StepContext<'_>, withdraw: impl FnOnce()) {
        if self.shared {
            self.perform(Task::Save, context);
            context.wait();
            withdraw();
            context.wait();
            self.perform(Task::Forget, context);
            context.wait();
        }
    }

    fn perform(&mut self, task: Task, context: &StepContext<'_>) {
        let mut faults = 0;
        let (bodies, faults_of_run) = (context.bodies, &mut faults);
        match &mut self.groups {
            Layout::Wide(groups, vectors) => {
                vectors.run(Perform { groups, task, bodies, faults: faults_of_run });
            }
            Layout::Single(groups) => {
                Perform { groups, task, bodies, faults: faults_of_run }.run::<Scalar<1>>();
            }
        }
        context.add_faults(faults);
    }
}

impl<const N: usize> Group<N> {
    const NONE: Self = Group { at: [GROUND; N], shared: false, free: Self::STILL, change: Self::STILL };
    const STILL: VelocityW<Ints<N>> = VelocityW { x: Ints::ZERO, y: Ints::ZERO, turn: Ints::ZERO };
}

/// Arranges bodies in groups. Returns whether any body is shared.
fn arrange<const N: usize>(groups: &mut Groups<N>, bodies: impl Iterator<Item = PushedBody>) -> bool {
    groups.clear();
    let mut shared = false;
    for (number, body) in bodies.enumerate() {
        let lane = number % N;
        if lane == 0 {
            groups.push(Group::NONE);
        }
        if let Some(group) = groups.last_mut() {
            group.at[lane] = body.index;
            group.shared |= body.shared;
        }
        shared |= body.shared;
    }
    shared
}

struct Perform<'a, const N: usize> {
    groups: &'a mut [Group<N>],
    task: Task,
    bodies: &'a [Cell<SolverBody>],
    faults: &'a mut Faults,
}

impl<const N: usize> Kernel<N> for Perform<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Perform { groups, task, bodies, faults } = self;
        for Group { at, shared, free, change } in groups {
            match task {
                Task::Measure => {
                    let v = L::velocities(bodies, at);
                    store::<L, N>(difference::<L, N>(v, load::<L, N>(free)), change);
                }
                Task::Apply => {
                    let v = L::velocities(bodies, at);
                    store::<L, N>(v, free);
                    let mut changed = BodyPairW::<L, N> { a: v, b: sum::<L, N>(v, load::<L, N>(change)) };
                    changed.keep_in_range(faults);
                    L::set_velocities(bodies, at, changed.b);
                }
                Task::Suspend if *shared => {
                    let v = L::velocities(bodies, at);
                    store::<L, N>(difference::<L, N>(load::<L, N>(free), v), free);
                }
                Task::Resume if *shared => {
                    let v = L::velocities(bodies, at);
                    store::<L, N>(sum::<L, N>(load::<L, N>(free), v), free);
                }
                Task::Save if *shared => store::<L, N>(L::velocities(bodies, at), change),
                Task::Forget if *shared => {
                    let (v, saved) = (L::velocities(bodies, at), load::<L, N>(change));
                    let forgotten = difference::<L, N>(saved, v);
                    store::<L, N>(sum::<L, N>(load::<L, N>(free), forgotten), free);
                    L::set_velocities(bodies, at, saved);
                }
                Task::Suspend | Task::Resume | Task::Save | Task::Forget => {}
            }
        }
    }
}

#[inline(always)]
fn load<L: Lanes<N>, const N: usize>(from: &VelocityW<Ints<N>>) -> VelocityW<L::Int> {
    VelocityW { x: L::load(&from.x), y: L::load(&from.y), turn: L::load(&from.turn) }
}

#[inline(always)]
fn store<L: Lanes<N>, const N: usize>(v: VelocityW<L::Int>, to: &mut VelocityW<Ints<N>>) {
    L::store(v.x, &mut to.x);
    L::store(v.y, &mut to.y);
    L::store(v.turn, &mut to.turn);
}

#[inline(always)]
fn sum<L: Lanes<N>, const N: usize>(a: VelocityW<L::Int>, b: VelocityW<L::Int>) -> VelocityW<L::Int> {
    VelocityW {
        x: L::add_saturating(a.x, b.x),
        y: L::add_saturating(a.y, b.y),
        turn: L::add_saturating(a.turn, b.turn),
    }
}

#[inline(always)]
fn difference<L: Lanes<N>, const N: usize>(a: VelocityW<L::Int>, b: VelocityW<L::Int>) -> VelocityW<L::Int> {
    VelocityW {
        x: L::sub_saturating(a.x, b.x),
        y: L::sub_saturating(a.y, b.y),
        turn: L::sub_saturating(a.turn, b.turn),
    }
}
