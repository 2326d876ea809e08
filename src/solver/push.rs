//! How contacts apply their impulses again in all sub-steps of a tick but the first: all at once.
//!
//! The rows of contacts stay what they are for a whole tick. So what the impulses that have accumulated in them change of
//! a body's velocity is what contacts have changed of it in the sub-step before, from their warm start to its end:
//!
//! ```text
//! push = v - v_free,    v' = v_free' + push
//! ```
//!
//! with the velocity `v_free` that the body would have without contacts. That is one sum for each body, where the rows
//! would take a pass over all of them. Hinges, whose rows turn with their bodies, and locked axes change velocities
//! meanwhile: that is taken into `v_free`.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;
use core::cell::Cell;

use super::body::SolverBody;
use super::limits::Faults;
use super::pair::Pair;
use crate::lanes::{GROUND, Ints, Kernel, Lanes, Machine, Motion, WIDTH};

/// What contacts have changed of the velocities of all that they push.
#[derive(Clone, Debug, Default)]
pub(super) struct Pushes {
    groups: Vec<Group<WIDTH>>,
    /// Whether there has been a sub-step in this tick.
    known: bool,
    /// Whether any group is shared.
    shared: bool,
}

/// As many bodies as there are lanes.
#[derive(Clone, Debug)]
struct Group<const N: usize> {
    /// Where they are among the bodies; the ground for none.
    at: [u32; N],
    /// Whether anything but contacts changes the velocity of any of them between a warm start and the end of a sub-step.
    shared: bool,
    free: Motion<Ints<N>>,
    push: Motion<Ints<N>>,
}

/// What is done for all bodies in turn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Task {
    /// Find what contacts have changed in the last sub-step, if there was one in this tick.
    Measure,
    /// Remember the free velocities, and push again.
    Apply,
    /// Something else is about to change velocities.
    Suspend,
    /// It has.
    Resume,
}

impl Pushes {
    /// Starts a tick with the bodies that contacts change, and for each of them whether something else changes its
    /// velocity while contacts are solved.
    pub(super) fn begin(&mut self, bodies: impl Iterator<Item = (u32, bool)>) {
        let Pushes { groups, shared, known } = self;
        (*shared, *known) = (false, false);
        groups.clear();
        for (number, (index, is_shared)) in bodies.enumerate() {
            let lane = number % WIDTH;
            if lane == 0 {
                groups.push(Group::NONE);
            }
            if let Some(group) = groups.last_mut() {
                group.at[lane] = index;
                group.shared |= is_shared;
            }
            *shared |= is_shared;
        }
    }

    /// Whether what contacts change is known from a sub-step before.
    pub(super) fn are_known(&self) -> bool {
        self.known
    }

    /// Does nothing where nothing is to do.
    pub(super) fn perform(
        &mut self,
        task: Task,
        machine: Machine,
        bodies: &[Cell<SolverBody>],
        faults: &mut Faults,
    ) {
        let is_needed = match task {
            Task::Measure => self.known,
            Task::Apply => !self.groups.is_empty(),
            Task::Suspend | Task::Resume => self.shared,
        };
        if is_needed {
            machine.run(Perform { groups: &mut self.groups, task, bodies, faults });
            self.known = true;
        }
    }
}

impl<const N: usize> Group<N> {
    const NONE: Self = Group { at: [GROUND; N], shared: false, free: Self::STILL, push: Self::STILL };
    const STILL: Motion<Ints<N>> = Motion { x: Ints::ZERO, y: Ints::ZERO, turn: Ints::ZERO };
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
        for Group { at, shared, free, push } in groups {
            match task {
                Task::Measure => {
                    let v = L::velocities(bodies, at);
                    store::<L, N>(difference::<L, N>(v, load::<L, N>(free)), push);
                }
                Task::Apply => {
                    let v = L::velocities(bodies, at);
                    store::<L, N>(v, free);
                    // The free velocity is within all limits.
                    let mut pushed = Pair::<L, N> { a: v, b: sum::<L, N>(v, load::<L, N>(push)) };
                    pushed.keep_in_range(faults);
                    L::set_velocities(bodies, at, pushed.b);
                }
                Task::Suspend if *shared => {
                    let v = L::velocities(bodies, at);
                    store::<L, N>(difference::<L, N>(load::<L, N>(free), v), free);
                }
                Task::Resume if *shared => {
                    let v = L::velocities(bodies, at);
                    store::<L, N>(sum::<L, N>(load::<L, N>(free), v), free);
                }
                Task::Suspend | Task::Resume => {}
            }
        }
    }
}

#[inline(always)]
fn load<L: Lanes<N>, const N: usize>(from: &Motion<Ints<N>>) -> Motion<L::Int> {
    Motion { x: L::load(&from.x), y: L::load(&from.y), turn: L::load(&from.turn) }
}

#[inline(always)]
fn store<L: Lanes<N>, const N: usize>(v: Motion<L::Int>, to: &mut Motion<Ints<N>>) {
    L::store(v.x, &mut to.x);
    L::store(v.y, &mut to.y);
    L::store(v.turn, &mut to.turn);
}

#[inline(always)]
fn sum<L: Lanes<N>, const N: usize>(a: Motion<L::Int>, b: Motion<L::Int>) -> Motion<L::Int> {
    Motion {
        x: L::add_saturating(a.x, b.x),
        y: L::add_saturating(a.y, b.y),
        turn: L::add_saturating(a.turn, b.turn),
    }
}

#[inline(always)]
fn difference<L: Lanes<N>, const N: usize>(a: Motion<L::Int>, b: Motion<L::Int>) -> Motion<L::Int> {
    Motion {
        x: L::sub_saturating(a.x, b.x),
        y: L::sub_saturating(a.y, b.y),
        turn: L::sub_saturating(a.turn, b.turn),
    }
}
