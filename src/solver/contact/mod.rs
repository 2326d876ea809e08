//! Contacts: one row along the normal and one along the tangent for each point, eight contacts at a time.
//!
//! `prepare` fills batches with the contacts of one colour each, `kernel` solves them, `store` brings their impulses
//! back. The contacts of bodies that have too many to be coloured are solved one by one, before all others.

mod batch;
mod input;
mod kernel;
mod prepare;
mod rolling;

use alloc::vec::Vec;

use super::body::SolverBody;
use super::lanes::{Kernel, Lanes, Machine, Scalar, WIDTH};
use super::limits::Faults;
use super::settings::Tuning;
use crate::body::Material;
use crate::collision::Contact;
use crate::math::{Fx, Speed, fx_mul};
use batch::Batch;
use kernel::Constants;
use input::Input;
use prepare::Records;
use rolling::RollingRows;

/// Whether a pass removes position errors or only velocity errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Removes position errors by velocity.
    Bias,
    /// Takes the velocity away again that removing position errors has left.
    Relax,
}

/// Which of a contact's two points is solved first. It alternates: the first one turns the body a little, and always
/// the same way it makes a stack of ten boxes sway by 4.7 mm while it settles instead of 0.05 mm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sweep {
    Forward,
    Backward,
}

impl Sweep {
    /// For an iteration of a sub-step: neighbours differ in either direction.
    pub(crate) const fn of(sub_step: u64, iteration: u32) -> Self {
        if sub_step % 2 == iteration as u64 % 2 { Sweep::Forward } else { Sweep::Backward }
    }
}

/// Two points that bounce are solved against each other until both leave as they should. After one round the first
/// leaves too fast: a tall box dropped flat gained a third of its energy, and spun. A round takes away at least 3/4
/// of what is wrong for boxes of up to 1 to 3.
const RESTITUTION_ITERATIONS: u32 = 12;

/// Rounds in which the two points of a contact are solved against each other, and the change below which the second
/// leaves the first alone, in m/s. At an impact one round turns the body: ten boxes that fall on each other from 5 or
/// 10 mm then sway by 12 mm, and with up to four rounds by 1 mm. Where piles rest the first round is mostly enough: a
/// pyramid of 5050 boxes costs a tenth more.
const NORMAL_ROUNDS_MAX: u32 = 4;
const SETTLED: Speed = Speed::lit("0.005");

/// The largest impulse of friction and of rolling resistance. The difference of two fits the format.
const TANGENT_MAX: Speed = Speed::lit("511");

/// The surface that two shapes have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(crate) friction: Fx,
    pub(crate) restitution: Fx,
    /// In metres: the largest torque for each unit of normal force.
    pub(crate) rolling_resistance: Fx,
    /// In m/s.
    pub(crate) surface_speed: Fx,
}

impl Surface {
    /// What two materials have in common, on shapes that are rounded by a radius in metres.
    pub(crate) fn between((a, radius_a): (&Material, Fx), (b, radius_b): (&Material, Fx)) -> Self {
        let resistance = a.rolling_resistance.max(b.rolling_resistance);
        Surface {
            friction: a.mixed_friction(b),
            restitution: a.mixed_restitution(b),
            rolling_resistance: fx_mul(resistance, radius_a.max(radius_b)),
            surface_speed: a.surface_speed.saturating_add(b.surface_speed),
        }
    }
}

/// How the impulses of the last tick were carried over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct WarmStarts {
    /// Points in contact.
    pub(crate) points: u32,
    /// Points that were there in the last tick.
    pub(crate) kept: u32,
    /// Points with an impulse in the last tick that are gone, although the shapes still touch.
    pub(crate) lost: u32,
}

/// The contacts of a tick.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactSet {
    /// Those that fit no colour, in their own order.
    serial: Batches<1>,
    /// The others, colour by colour.
    coloured: Batches<WIDTH>,
    /// What they are made of, in the order of the state.
    inputs: Vec<Input>,
}

/// Batches of contacts in the order in which they are solved.
#[derive(Clone, Debug)]
struct Batches<const N: usize> {
    batches: Vec<Batch<N>>,
    rolling: Vec<RollingRows<N>>,
    /// For each batch, where its results belong.
    records: Vec<Records<N>>,
}

impl<const N: usize> Default for Batches<N> {
    fn default() -> Self {
        Batches { batches: Vec::new(), rolling: Vec::new(), records: Vec::new() }
    }
}

/// What is done to all batches in turn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Task {
    /// Remember how fast what bounces approaches.
    Observe,
    WarmStart,
    Solve(Pass, Sweep),
    /// Find the separations anew, where no relax pass does it.
    Measure,
    Restitution,
}

impl ContactSet {
    /// Performs a task for the contacts that come before the joints.
    pub(super) fn perform_serial(
        &mut self,
        task: Task,
        tuning: &Tuning,
        bodies: &mut [SolverBody],
        faults: &mut Faults,
    ) {
        let constants = Constants::new(tuning);
        Perform { batches: &mut self.serial, task, constants, bodies, faults }.run::<Scalar<1>>();
    }

    /// Performs a task for the contacts that come after them.
    pub(super) fn perform_coloured(
        &mut self,
        task: Task,
        machine: Machine,
        tuning: &Tuning,
        bodies: &mut [SolverBody],
        faults: &mut Faults,
    ) {
        let constants = Constants::new(tuning);
        machine.run(Perform { batches: &mut self.coloured, task, constants, bodies, faults });
    }

    /// Keeps the impulses for the next tick. `pushed` says of each contact whether its shapes have pushed each other.
    pub(super) fn store(&self, contacts: &mut [Contact], pushed: &mut Vec<bool>) {
        pushed.clear();
        pushed.resize(contacts.len(), false);
        self.serial.store(contacts, pushed);
        self.coloured.store(contacts, pushed);
    }
}

/// A task, for the batches of `N` contacts.
struct Perform<'a, const N: usize> {
    batches: &'a mut Batches<N>,
    task: Task,
    constants: Constants,
    bodies: &'a mut [SolverBody],
    faults: &'a mut Faults,
}

impl<const N: usize> Kernel<N> for Perform<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Perform { batches: Batches { batches, rolling, .. }, task, constants, bodies, faults } = self;
        match task {
            Task::Observe => {
                for batch in batches.iter_mut().filter(|batch| batch.bounces) {
                    kernel::observe::<L, N>(batch, bodies, faults);
                }
            }
            Task::WarmStart => {
                for batch in batches {
                    kernel::warm_start::<L, N>(batch, rolling, bodies, faults);
                }
            }
            // Named twice, so that each pass is compiled for itself.
            Task::Solve(Pass::Bias, sweep) => {
                for batch in batches {
                    let how = (Pass::Bias, sweep);
                    kernel::solve::<L, N>(batch, rolling, how, &constants, bodies, faults);
                }
            }
            Task::Solve(Pass::Relax, sweep) => {
                for batch in batches {
                    let how = (Pass::Relax, sweep);
                    kernel::solve::<L, N>(batch, rolling, how, &constants, bodies, faults);
                }
            }
            Task::Measure => {
                for batch in batches {
                    kernel::measure::<L, N>(batch, bodies);
                }
            }
            Task::Restitution => {
                for batch in batches.iter_mut().filter(|batch| batch.bounces) {
                    kernel::apply_restitution::<L, N>(batch, &constants, bodies, faults);
                }
            }
        }
    }
}

impl<const N: usize> Batches<N> {
    fn store(&self, contacts: &mut [Contact], pushed: &mut [bool]) {
        for (batch, records) in self.batches.iter().zip(&self.records) {
            for (lane, index, count) in records.lanes() {
                let memory = &mut contacts[index];
                memory.clear_points();
                if let Some(place) = batch.rolling {
                    memory.rolling = self.rolling[place as usize].impulse(lane);
                }
                for (i, point) in batch.points.iter().take(count).enumerate() {
                    let lambdas = (point.normal_lambda.0[lane], point.tangent_lambda.0[lane]);
                    memory.push_point(records.impulse(lane, i, lambdas));
                    pushed[index] |= point.pushed.0[lane] != 0;
                }
            }
        }
    }
}

