//! The solver: sequential impulses over rows and point blocks, in sub-steps, in a fixed order.
//!
//! Rows solve whatever acts along a direction, point blocks what pins two points together. Contacts (`contact`) and
//! hinges (`joint/hinge`) are solved eight at a time by kernels that are written once for any number of lanes
//! (`lanes`); the rows and points of all other joints one by one (`row`, `point_block`).

mod body;
mod body_list;
mod colour;
mod contact;
mod integrate;
mod joint;
mod limits;
mod pair;
mod point_block;
mod push;
mod row;
mod settings;
mod softness;

use alloc::vec::Vec;

pub use crate::lanes::Backend;
pub(crate) use crate::lanes::Machine;
pub(crate) use body::{SolverBody, turn_of};
use body_list::BodyList;
pub use colour::SolverColour;
use colour::{Colouring, Node};
use contact::{ContactSet, Pass, Sweep, Task};
pub(crate) use contact::{Surface, WarmStarts};
use integrate::{Mover, integrate_displacements, integrate_velocities};
use joint::JointSet;
pub use joint::{
    Distance, Drive, Joint, JointDef, JointFrame, JointKind, Limit, LinearDrive, Motor, Prismatic, Pull,
    Revolute, Soft, Spring, Threshold, ThresholdAction, Weld, Wheel,
};
use limits::Faults;
pub(crate) use limits::IMPULSE_MAX;
use push::Pushes;
pub(crate) use settings::Tuning;
pub use settings::{ContactTuning, DISTANCE_MAX, SolverSettings};

use crate::body::{Arena, Body, BodyId, JointId};
use crate::collision::{Contact, Manifold, Pair};
use crate::math::{Fx, Vec2};
use crate::threads::Threads;

/// How many times as often everything is solved in a tick in which most contact points are new: without impulses of
/// the tick before, one round in a sub-step leaves piles restless (the 20 x 20 pyramids of 55 boxes at 0.27 m/s and
/// 5.8 mm deep in their first ticks, instead of 0.05 m/s and 1.5 mm).
const COLD_ROUNDS: u32 = 4;
/// With fewer points than this nothing rests on much else, and a few new ones are a landing, not a pile.
const COLD_POINTS: u32 = 256;

/// The working memory of the solver. Nothing in it outlives a tick, but its allocations do.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solver {
    list: BodyList,
    movers: Vec<Mover>,
    joints: JointSet,
    /// One joint at a time, when its reaction is asked for.
    reaction: JointSet,
    contacts: ContactSet,
    pushes: Pushes,
    /// For each contact in the state, whether its shapes have pushed each other in this tick.
    pub(crate) pushed: Vec<bool>,
    nodes: Vec<Node>,
    colouring: Colouring,
    pub(crate) machine: Machine,
    pub(crate) threads: Threads,
    pub(crate) warm_starts: WarmStarts,
    pub(crate) faults: Faults,
}

/// A contact to solve: where it is in the state and its manifold among those of the tick, the slots of its shapes and
/// of their bodies, and their common surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TouchingPair {
    pub(crate) contact: u32,
    pub(crate) manifold: u32,
    pub(crate) shapes: Pair,
    pub(crate) bodies: (u32, u32),
    pub(crate) surface: Surface,
}

impl Solver {
    /// A solver that computes in the same way and has done nothing yet.
    pub(crate) fn emptied(&self) -> Self {
        Solver { machine: self.machine, threads: self.threads.clone(), ..Solver::default() }
    }

    /// Copies what the kernels need of the bodies in the given slots out of the state.
    pub(crate) fn prepare_bodies(&mut self, bodies: &Arena<Body, BodyId>, slots: &[u32], tuning: &Tuning) {
        self.faults = 0;
        self.warm_starts = WarmStarts::default();
        self.list.begin(bodies.slot_count());
        self.movers.clear();
        // Bodies are large: each is read once.
        for &slot in slots {
            let body = bodies.at(slot);
            self.list.add(slot, body);
            self.movers.extend(Mover::prepare(self.list.index_of(slot), body, tuning));
        }
    }

    /// The body of a slot, as the tick has left it.
    pub(crate) fn body(&self, slot: u32) -> &SolverBody {
        self.list.body(slot)
    }

    /// Makes a constraint of each of the joints in the given slots, in the order in which they are solved.
    pub(crate) fn prepare_joints(
        &mut self,
        joints: &Arena<Joint, JointId>,
        slots: &[u32],
        bodies: &Arena<Body, BodyId>,
        tuning: &Tuning,
    ) {
        let Solver { list, nodes, colouring, .. } = self;
        self.joints.prepare((joints, slots), (bodies, list), tuning, nodes, colouring);
        self.joints.refresh(self.machine, &self.list.bodies, tuning);
    }

    /// [`Joint::reaction`] without memory of its own, once the joints of the tick have been solved.
    pub(crate) fn reaction(
        &mut self,
        joint: &Joint,
        bodies: (&Body, &Body),
        tuning: &Tuning,
    ) -> (Vec2<Fx>, Fx) {
        self.reaction.reaction(joint, bodies, tuning)
    }

    /// Makes a constraint of every touching pair, in the order in which they are solved.
    pub(crate) fn prepare_contacts(
        &mut self,
        pairs: &[TouchingPair],
        manifolds: &[Manifold],
        contacts: &[Contact],
    ) {
        let Solver { list, movers, joints, nodes, colouring, contacts: set, machine, warm_starts, .. } = self;
        let source = (manifolds, contacts);
        set.prepare(pairs, source, list, (nodes, colouring), *machine, warm_starts);
        let touched = movers.iter().filter(|mover| colouring.holds(mover.index()));
        let is_shared = |mover: &Mover| mover.is_special() || joints.holds(mover.index());
        self.pushes.begin(touched.map(|mover| (mover.index(), is_shared(mover))));
    }

    /// Where the contact of a touching pair was in the last tick.
    pub(crate) fn contact_colour(&self, pair: usize) -> Option<SolverColour> {
        self.colouring.colour_of(pair)
    }

    /// One sub-step: aim joints, integrate velocities, warm start, solve with bias, integrate displacements, refresh
    /// joints, relax without bias. `index` counts the sub-steps since the world was made.
    pub(crate) fn sub_step(&mut self, index: u64, tuning: &Tuning) {
        self.joints.aim(&self.list.bodies, tuning);
        self.push(push::Task::Measure);
        let bodies = SolverBody::cells(&mut self.list.bodies);
        integrate_velocities(&self.movers, bodies, self.machine, tuning);
        self.warm_start(tuning);
        let iterations = tuning.iterations * if self.is_cold() { COLD_ROUNDS } else { 1 };
        for iteration in 0..iterations {
            self.solve(Pass::Bias, Sweep::of(index, iteration), tuning);
        }
        self.push(push::Task::Suspend);
        let bodies = SolverBody::cells(&mut self.list.bodies);
        integrate_displacements(&self.movers, bodies, self.machine, tuning, &mut self.faults);
        self.push(push::Task::Resume);
        self.joints.refresh(self.machine, &self.list.bodies, tuning);
        if tuning.relax {
            for iteration in 0..iterations {
                self.solve(Pass::Relax, Sweep::of(index, iteration), tuning);
            }
        } else {
            self.perform_coloured(Task::Measure, tuning);
            self.perform_serial(Task::Measure, tuning);
        }
    }

    /// Whether most contact points have no impulses to start from.
    fn is_cold(&self) -> bool {
        let WarmStarts { points, kept, .. } = self.warm_starts;
        points >= COLD_POINTS && kept < points / 2
    }

    fn warm_start(&mut self, tuning: &Tuning) {
        self.perform_serial(Task::Observe, tuning);
        self.perform_coloured(Task::Observe, tuning);
        self.joints.warm_start(self.machine, tuning, &mut self.list.bodies, &mut self.faults);
        let are_known = self.pushes.are_known();
        self.push(push::Task::Apply);
        if !are_known {
            self.perform_serial(Task::WarmStart, tuning);
            self.perform_coloured(Task::WarmStart, tuning);
        }
    }

    /// Keeps account of what contacts change of velocities.
    fn push(&mut self, task: push::Task) {
        let bodies = SolverBody::cells(&mut self.list.bodies);
        self.pushes.perform(task, self.machine, bodies, &mut self.faults);
    }

    fn solve(&mut self, pass: Pass, sweep: Sweep, tuning: &Tuning) {
        let task = Task::Solve(pass, sweep);
        self.perform_serial(task, tuning);
        self.push(push::Task::Suspend);
        self.joints.solve(pass, self.machine, tuning, &mut self.list.bodies, &mut self.faults);
        self.push(push::Task::Resume);
        self.perform_coloured(task, tuning);
    }

    fn perform_serial(&mut self, task: Task, tuning: &Tuning) {
        self.contacts.perform_serial(
            task,
            tuning,
            SolverBody::cells(&mut self.list.bodies),
            &mut self.faults,
        );
    }

    fn perform_coloured(&mut self, task: Task, tuning: &Tuning) {
        let Solver { contacts, machine, threads, list, faults, .. } = self;
        contacts.perform_coloured(
            task,
            (*machine, threads),
            tuning,
            SolverBody::cells(&mut list.bodies),
            faults,
        );
    }

    pub(crate) fn apply_restitution(&mut self, tuning: &Tuning) {
        self.perform_serial(Task::Restitution, tuning);
        self.perform_coloured(Task::Restitution, tuning);
    }

    /// Keeps the impulses for the next tick.
    pub(crate) fn store_impulses(&mut self, contacts: &mut [Contact], joints: &mut Arena<Joint, JointId>) {
        self.joints.store(joints);
        self.contacts.store(self.machine, contacts, &mut self.pushed);
    }
}
