//! Contacts: one row along the normal for each point and one along the tangent for both, eight contacts at a time.
//!
//! `prepare` fills batches with the contacts of one colour each, `kernel` and `iteration` solve them with as much `care`
//! as they need, `store` brings their impulses back. The contacts of bodies that have too many to be coloured are solved one by one, before all others.

mod batch;
mod care;
mod input;
mod iteration;
mod kernel;
mod pair;
mod prepare;
mod rolling;
mod rows;
mod special;
mod store;

use alloc::vec::Vec;
use core::cell::Cell;

use super::body::SolverBody;
use super::limits::Faults;
use super::settings::Tuning;
use crate::body::Material;
use crate::collision::Contact;
use crate::lanes::{Kernel, Lanes, Machine, Scalar, Shared, WIDTH, prefetch};
use crate::math::{Fx, Grip, Speed, Unit, fx_mul, narrow};
use crate::threads::Threads;
use batch::Batch;
use input::Input;
use kernel::Constants;
use special::Special;
use store::{Records, Store};

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

/// A job with fewer batches costs more to hand over than to do.
const BATCHES_PER_JOB: usize = 16;

/// The largest impulse of friction and of rolling resistance. The difference of two fits the format.
const TANGENT_MAX: Speed = Speed::lit("511");

/// The surface that two shapes have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(crate) friction: Grip,
    pub(crate) restitution: Unit,
    /// In m/s.
    pub(crate) surface_speed: Speed,
    /// In metres: the largest torque for each unit of normal force.
    pub(crate) rolling_resistance: Fx,
}

impl Surface {
    /// What two materials have in common, on shapes that are rounded by a radius in metres.
    pub(crate) fn between((a, radius_a): (&Material, Fx), (b, radius_b): (&Material, Fx)) -> Self {
        let resistance = a.rolling_resistance.max(b.rolling_resistance);
        Surface {
            friction: narrow(a.mixed_friction(b)),
            restitution: narrow(a.mixed_restitution(b)),
            surface_speed: narrow(a.surface_speed.saturating_add(b.surface_speed)),
            rolling_resistance: fx_mul(resistance, radius_a.max(radius_b)),
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
    /// In the same order, for those that have any.
    special: Vec<Special<N>>,
    /// Where the batches of each colour end.
    colours: Vec<usize>,
    /// For each batch, where its results belong.
    records: Vec<Records<N>>,
}

impl<const N: usize> Default for Batches<N> {
    fn default() -> Self {
        Batches { batches: Vec::new(), special: Vec::new(), colours: Vec::new(), records: Vec::new() }
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
        bodies: &[Cell<SolverBody>],
        faults: &mut Faults,
    ) {
        let constants = Constants::new(tuning);
        self.serial.task(task, constants, bodies, faults).run::<Scalar<1>>();
    }

    /// Performs a task for the contacts that come after them, on several threads where a colour has enough of them.
    pub(super) fn perform_coloured(
        &mut self,
        task: Task,
        (machine, threads): (Machine, &Threads),
        tuning: &Tuning,
        bodies: &[Cell<SolverBody>],
        faults: &mut Faults,
    ) {
        let constants = Constants::new(tuning);
        *faults += self.coloured.perform_on(threads, machine, task, constants, bodies);
    }

    /// Keeps the impulses for the next tick. `pushed` says of each contact whether its shapes have pushed each other.
    pub(super) fn store(&self, machine: Machine, contacts: &mut [Contact], pushed: &mut Vec<bool>) {
        pushed.clear();
        pushed.resize(contacts.len(), false);
        Store { batches: &self.serial, contacts, pushed }.run::<Scalar<1>>();
        machine.run(Store { batches: &self.coloured, contacts, pushed });
    }
}

/// A task, for the batches of `N` contacts.
struct Perform<'a, const N: usize> {
    batches: &'a mut [Batch<N>],
    special: &'a mut [Special<N>],
    task: Task,
    constants: Constants,
    bodies: &'a [Cell<SolverBody>],
    faults: &'a mut Faults,
}

impl<const N: usize> Kernel<N> for Perform<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Perform { batches, special, task, constants, bodies, faults } = self;
        let mut special = special.iter_mut();
        let mut rest = batches;
        while let [batch, others @ ..] = rest {
            rest = others;
            if let Some(next) = rest.first() {
                // What its bodies are read by. The rest comes in order, as processors expect it: asked for all at
                // once it takes the room that this batch's bodies need.
                prefetch(&next.bodies);
            }
            let special = if batch.special { special.next() } else { None };
            match (task, special) {
                (Task::WarmStart, special) => kernel::warm_start::<L, N>(batch, special, bodies, faults),
                // Named twice, so that each pass is compiled for itself.
                (Task::Solve(Pass::Bias, sweep), special) => {
                    let how = (Pass::Bias, sweep);
                    kernel::solve::<L, N>(batch, special, how, &constants, bodies, faults);
                }
                (Task::Solve(Pass::Relax, sweep), special) => {
                    let how = (Pass::Relax, sweep);
                    kernel::solve::<L, N>(batch, special, how, &constants, bodies, faults);
                }
                (Task::Measure, _) => kernel::measure::<L, N>(batch, bodies),
                (Task::Observe, Some(special)) => {
                    kernel::observe::<L, N>(batch, special, bodies, faults);
                }
                (Task::Restitution, Some(special)) => {
                    kernel::apply_restitution::<L, N>(batch, special, &constants, bodies, faults);
                }
                (Task::Observe | Task::Restitution, None) => {}
            }
        }
    }
}

impl Batches<WIDTH> {
    /// Performs a task colour by colour, each on all threads. Returns the faults.
    fn perform_on(
        &mut self,
        threads: &Threads,
        machine: Machine,
        task: Task,
        constants: Constants,
        bodies: &[Cell<SolverBody>],
    ) -> Faults {
        let mut total = 0;
        let bodies = Shared::within_a_colour(bodies);
        let (mut start, mut rest) = (0, &mut self.special[..]);
        for &end in &self.colours {
            let colour = &mut self.batches[start..end];
            start = end;
            let share = threads.share(colour.len(), BATCHES_PER_JOB);
            let jobs = colour.chunks_mut(share).map(|batches| {
                // Few ticks have any, and to look at every batch costs a cache miss each.
                let special = |batch: &&Batch<WIDTH>| batch.special;
                let count = if rest.is_empty() { 0 } else { batches.iter().filter(special).count() };
                let (special, others) = core::mem::take(&mut rest).split_at_mut(count);
                rest = others;
                (batches, special)
            });
            total += threads.run(jobs, |(batches, special)| {
                let mut faults = 0;
                let bodies = bodies.bodies();
                machine.run(Perform { batches, special, task, constants, bodies, faults: &mut faults });
                faults
            });
        }
        total
    }
}

impl<const N: usize> Batches<N> {
    fn task<'a>(
        &'a mut self,
        task: Task,
        constants: Constants,
        bodies: &'a [Cell<SolverBody>],
        faults: &'a mut Faults,
    ) -> Perform<'a, N> {
        Perform { batches: &mut self.batches, special: &mut self.special, task, constants, bodies, faults }
    }
}
