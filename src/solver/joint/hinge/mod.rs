//! Hinges: joints that pin two points together, with rows on the angle or without, eight at a time.
//!
//! Revolute joints and rigid welds are hinges. `input` is what is known of one, `prepare` fills batches with the hinges
//! of one colour each, `kernel` solves the points and `angle` the rows. The hinges of bodies that have too many to be
//! coloured are solved one by one, before all others.

mod angle;
mod angle_input;
mod batch;
mod input;
mod kernel;
mod pair;
mod prepare;
#[cfg(test)]
mod tests;

use alloc::vec::Vec;
use core::cell::Cell;
use core::mem;

use super::super::body::SolverBody;
use super::super::contact::Pass;
use super::super::limits::Faults;
use super::super::settings::Tuning;
use super::place::Turned;
use crate::lanes::{Kernel, Lanes, Machine, Quad, Scalar, WIDTH};
use angle::AngleRows;
pub(super) use angle_input::AngleParts;
use angle_input::{AngleInput, Memo};
use batch::{Batch, Shape};
use input::Input;
pub(super) use input::{End, Turning, node};
use kernel::Stiffness;
use prepare::Records;

/// How the bodies of a tick are turned, by their indices.
#[derive(Clone, Copy)]
pub(super) struct Poses<'a> {
    /// Cosine and sine, and how far a lever ratio averaged over the turn ahead is moved across itself and along itself.
    pub(super) quads: &'a [Quad],
    pub(super) turned: &'a [Turned],
}

/// The hinges of a tick.
#[derive(Clone, Debug, Default)]
pub(super) struct HingeSet {
    /// What they are made of, in the order of the state.
    inputs: Vec<Input>,
    angles: Vec<AngleInput>,
    memo: Memo,
    /// Those that fit no colour, in their own order.
    serial: Batches<1>,
    /// The others, colour by colour.
    coloured: Batches<WIDTH>,
    /// Those that hold a body which has no other joint to one that nothing moves.
    mounts: Batches<WIDTH>,
    /// What of the batches is no longer true.
    expired: Expired,
}

/// What bodies that have moved leave of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Expired {
    #[default]
    Nothing,
    /// No body has turned: lever ratios and gains are what they were.
    Gaps,
    Everything,
}

/// Batches of hinges in the order in which they are solved.
#[derive(Clone, Debug)]
struct Batches<const N: usize> {
    batches: Vec<Batch<N>>,
    /// For each batch, what its points are made of.
    shapes: Vec<Shape<N>>,
    angles: Vec<AngleRows<N>>,
    /// For each batch, where its results belong.
    records: Vec<Records<N>>,
}

impl<const N: usize> Default for Batches<N> {
    fn default() -> Self {
        Batches { batches: Vec::new(), shapes: Vec::new(), angles: Vec::new(), records: Vec::new() }
    }
}

/// What is done to all batches in turn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Task {
    WarmStart,
    Solve(Pass),
}

impl HingeSet {
    /// Bodies have moved: the next task finds arms, gains and gaps at the new poses, batch by batch, so that a batch is
    /// fetched from memory once for both.
    pub(super) fn expire(&mut self, what: Expired) {
        self.expired = self.expired.max(what);
    }

    /// Performs a task for all of them.
    pub(super) fn perform(
        &mut self,
        task: Task,
        (poses, machine): (Poses<'_>, Machine),
        tuning: &Tuning,
        bodies: &[Cell<SolverBody>],
        faults: &mut Faults,
    ) {
        let expired = mem::take(&mut self.expired);
        let HingeSet { serial, coloured, mounts, .. } = self;
        let stiffness = Stiffness { points: tuning.joint, limits: tuning.joint };
        Perform { batches: serial, task, expired, stiffness, poses, bodies, faults }.run::<Scalar<1>>();
        machine.run(Perform { batches: coloured, task, expired, stiffness, poses, bodies, faults });
        let stiffness = Stiffness { points: tuning.mount, ..stiffness };
        machine.run(Perform { batches: mounts, task, expired, stiffness, poses, bodies, faults });
    }
}

/// A task, for the batches of `N` hinges.
struct Perform<'a, const N: usize> {
    batches: &'a mut Batches<N>,
    task: Task,
    /// What is to be found anew before.
    expired: Expired,
    stiffness: Stiffness,
    poses: Poses<'a>,
    bodies: &'a [Cell<SolverBody>],
    faults: &'a mut Faults,
}

impl<const N: usize> Kernel<N> for Perform<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        match self.task {
            // Named one by one, so that each is compiled for itself.
            Task::WarmStart => self.each::<L>(Task::WarmStart),
            Task::Solve(Pass::Bias) => self.each::<L>(Task::Solve(Pass::Bias)),
            Task::Solve(Pass::Relax) => self.each::<L>(Task::Solve(Pass::Relax)),
        }
    }
}

impl<const N: usize> Perform<'_, N> {
    #[inline(always)]
    fn each<L: Lanes<N>>(self, task: Task) {
        let Perform { batches, task: _, expired, stiffness, poses, bodies, faults } = self;
        let Batches { batches, shapes, angles, records } = batches;
        for ((batch, shape), records) in batches.iter_mut().zip(shapes).zip(records) {
            if expired >= Expired::Gaps {
                let quads = kernel::turns::<L, N>(batch, poses.quads);
                kernel::refresh_gaps::<L, N>(batch, shape, &quads, bodies, &stiffness.points);
                if expired == Expired::Everything {
                    kernel::refresh_gains::<L, N>(batch, shape, &quads);
                }
                if let Some(place) = batch.angle {
                    angles[place as usize].refresh(&records.turns, &batch.bodies, poses.turned);
                }
            }
            match task {
                Task::WarmStart => kernel::warm_start::<L, N>(batch, angles, bodies, faults),
                Task::Solve(pass) => {
                    kernel::solve::<L, N>(batch, angles, pass, (stiffness, poses.quads), bodies, faults);
                }
            }
        }
    }
}
