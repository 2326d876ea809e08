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

use super::super::body::SolverBody;
use super::super::contact::Pass;
use super::super::lanes::{Kernel, Lanes, Machine, Quad, Scalar, WIDTH};
use super::super::limits::Faults;
use super::super::settings::Tuning;
use super::place::Turned;
use angle::AngleRows;
pub(super) use angle_input::AngleParts;
use angle_input::{AngleInput, Memo};
use batch::{Batch, Shape};
use input::Input;
pub(super) use input::{End, node};
use kernel::Constants;
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
    /// The spring that was prepared last: mostly the next one is like it.
    memo: Option<Memo>,
    /// Those that fit no colour, in their own order.
    serial: Batches<1>,
    /// The others, colour by colour.
    coloured: Batches<WIDTH>,
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
    /// Arms, gains and gaps at the present pose.
    pub(super) fn refresh(
        &mut self,
        bodies: &[Cell<SolverBody>],
        poses: Poses<'_>,
        machine: Machine,
        tuning: &Tuning,
    ) {
        let constants = Constants::new(tuning);
        Refresh { batches: &mut self.serial, constants, bodies, poses }.run::<Scalar<1>>();
        machine.run(Refresh { batches: &mut self.coloured, constants, bodies, poses });
    }

    /// Performs a task for all of them.
    pub(super) fn perform(
        &mut self,
        task: Task,
        (quads, machine): (&[Quad], Machine),
        tuning: &Tuning,
        bodies: &[Cell<SolverBody>],
        faults: &mut Faults,
    ) {
        let constants = Constants::new(tuning);
        Perform { batches: &mut self.serial, task, constants, quads, bodies, faults }.run::<Scalar<1>>();
        machine.run(Perform { batches: &mut self.coloured, task, constants, quads, bodies, faults });
    }
}

/// The refresh of the batches of `N` hinges.
struct Refresh<'a, const N: usize> {
    batches: &'a mut Batches<N>,
    constants: Constants,
    bodies: &'a [Cell<SolverBody>],
    poses: Poses<'a>,
}

impl<const N: usize> Kernel<N> for Refresh<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Refresh { batches: Batches { batches, shapes, angles, records }, constants, bodies, poses } =
            self;
        for ((batch, shape), records) in batches.iter_mut().zip(shapes).zip(records) {
            kernel::refresh::<L, N>(batch, shape, bodies, poses.quads, &constants);
            if let Some(place) = batch.angle {
                angles[place as usize].refresh(&records.turns, &batch.bodies, poses.turned);
            }
        }
    }
}

/// A task, for the batches of `N` hinges.
struct Perform<'a, const N: usize> {
    batches: &'a mut Batches<N>,
    task: Task,
    constants: Constants,
    quads: &'a [Quad],
    bodies: &'a [Cell<SolverBody>],
    faults: &'a mut Faults,
}

impl<const N: usize> Kernel<N> for Perform<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Perform { batches: Batches { batches, angles, .. }, task, constants, quads, bodies, faults } =
            self;
        match task {
            Task::WarmStart => {
                for batch in batches {
                    kernel::warm_start::<L, N>(batch, angles, bodies, faults);
                }
            }
            // Named twice, so that each pass is compiled for itself.
            Task::Solve(Pass::Bias) => {
                for batch in batches {
                    kernel::solve::<L, N>(batch, angles, Pass::Bias, (&constants, quads), bodies, faults);
                }
            }
            Task::Solve(Pass::Relax) => {
                for batch in batches {
                    kernel::solve::<L, N>(batch, angles, Pass::Relax, (&constants, quads), bodies, faults);
                }
            }
        }
    }
}
