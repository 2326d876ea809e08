//! The solver: sequential impulses in sub-steps, in a fixed order.
//!
//! `Solver::sub_step` lists the stages of a sub-step, those of E. Catto's soft step (Solver2D, `solve_soft_step.c`).
//! Each stage has a file of its own: `integrate` for bodies; `contact_velocity`, `contact/warm_start`, `contact/solve`,
//! `contact/relax` and `contact/restitution` for contacts; `joint/hinge` for hinges; `joint/list` for all other joints.
//!
//! A row removes velocity along one direction (`row`). A point block pins two points together (`point_block`). Contacts
//! and hinges are solved in batches of eight (`batches`), by code that is written once for any number of lanes
//! (`simd`). The rows and points of all other joints are solved one by one.

mod batches;
mod body;
mod body_list;
mod body_pair;
mod colour;
mod contact;
mod contact_velocity;
mod context;
mod integrate;
mod joint;
mod limits;
mod pair;
mod point_block;
mod row;
mod settings;
mod softness;

use alloc::vec::Vec;

pub use crate::simd::Backend;
pub(crate) use crate::simd::Machine;
pub(crate) use body::{SolverBody, turn_of};
use body_list::BodyList;
use colour::Colouring;
pub use colour::SolverColour;
pub(crate) use contact::{ActiveContact, Surface, SurfaceSide, WarmStarts};
use contact::{Constants, ContactSet, ContactSource, Measure, ObserveApproach, PointOrder};
use contact_velocity::{ContactVelocities, PushedBody};
use context::{Pass, StepContext};
pub(crate) use integrate::AreaEffect;
use integrate::{MovingBody, integrate_displacements, integrate_velocities};
pub use joint::{
    Distance, Drive, Gear, Joint, JointDef, JointFrame, JointKind, JointLimit, JointPart, LinearDrive, Motor,
    Prismatic, Pull, Pulley, Rack, Revolute, Soft, Spring, Threshold, ThresholdAction, Weld, Wheel,
};
use joint::{JointSet, JointSource};
use limits::Faults;
pub(crate) use limits::IMPULSE_MAX;
pub use settings::{ContactTuning, DISTANCE_MAX, SolverSettings};
pub(crate) use settings::{RATE_MAX, SUB_STEPS_MAX, Tuning};

use crate::body::{Arena, Body, BodyId, JointId};
use crate::collision::{Contact, Impact, Manifold};
use crate::math::{Fx, Vec2};
use crate::threads::Threads;

/// Factor on the iterations of cold contacts. New contacts have no impulse for the warm start, and one iteration in a
/// sub-step is then not enough for piles: in their first ticks the 20 x 20 pyramids of 55 boxes move at 0.27 m/s and
/// overlap by 5.8 mm, instead of 0.05 m/s and 1.5 mm.
const COLD_ROUNDS: u32 = 8;

/// The working memory of the solver. Only its allocations are reused in the next tick, not its contents.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solver {
    list: BodyList,
    moving: Vec<MovingBody>,
    joints: JointSet,
    /// Working memory for the reaction of a single joint.
    reaction: JointSet,
    contacts: ContactSet,
    contact_velocities: ContactVelocities,
    /// For each contact in the state, whether its shapes have pushed each other in this tick.
    pub(crate) pushed: Vec<bool>,
    colouring: Colouring,
    pub(crate) machine: Machine,
    pub(crate) threads: Threads,
    pub(crate) warm_starts: WarmStarts,
    pub(crate) faults: Faults,
}

impl Solver {
    /// A new solver with the same backend and threads.
    pub(crate) fn emptied(&self) -> Self {
        Solver { machine: self.machine, threads: self.threads.clone(), ..Solver::default() }
    }

    /// Copies what the solver needs of the bodies in the given slots out of the state.
    pub(crate) fn prepare_bodies(&mut self, bodies: &Arena<Body, BodyId>, slots: &[u32], tuning: &Tuning) {
        self.faults = 0;
        self.warm_starts = WarmStarts::default();
        self.list.begin(bodies.slot_count());
        self.moving.clear();
        // Each body is read only once, because bodies are large.
        for &slot in slots {
            let body = bodies.at(slot);
            self.list.add(slot, body);
            self.moving.extend(MovingBody::prepare(self.list.index_of(slot), body, tuning));
        }
    }

    /// Lets areas act on the dynamic body in a slot, one of those of the tick.
    pub(crate) fn apply_areas(&mut self, slot: u32, body: &Body, effect: &AreaEffect, tuning: &Tuning) {
        let index = self.list.index_of(slot);
        if let Ok(at) = self.moving.binary_search_by_key(&index, MovingBody::index) {
            self.moving[at] = MovingBody::in_areas(index, body, effect, tuning);
        }
    }

    /// The body of a slot at the end of the sub-steps.
    pub(crate) fn body(&self, slot: u32) -> &SolverBody {
        self.list.body(slot)
    }

    /// Makes the constraints of the joints in the given slots, in the order in which they are solved.
    pub(crate) fn prepare_joints(
        &mut self,
        joints: &Arena<Joint, JointId>,
        slots: &[u32],
        bodies: &Arena<Body, BodyId>,
        tuning: &Tuning,
    ) {
        let Solver { list, joints: set, colouring, machine, threads, faults, .. } = self;
        set.prepare(&JointSource { joints, slots, bodies, tuning }, list, colouring);
        set.refresh(&StepContext::new(*machine, threads, tuning, &mut list.bodies, faults));
    }

    /// Number of joints that are solved in blocks in this tick.
    pub(crate) fn blocked_joint_count(&self) -> usize {
        self.joints.blocked_count()
    }

    /// [`Joint::reaction`] without allocations, after the joints of the tick have been solved.
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
        pairs: &[ActiveContact],
        manifolds: &[Manifold],
        impacts: &[Impact],
        contacts: &[Contact],
    ) {
        let Solver { list, moving, joints, colouring, contacts: set, machine, warm_starts, .. } = self;
        *warm_starts =
            set.prepare(&ContactSource { pairs, manifolds, impacts, contacts, list }, colouring, *machine);
        let touched = moving.iter().filter(|moving| colouring.holds(moving.index()));
        self.contact_velocities.begin(touched.map(|moving| PushedBody {
            index: moving.index(),
            shared: set.bounces(moving.index()) || moving.has_extras() || joints.holds(moving.index()),
        }));
    }

    /// The colour of a touching pair's contact in the last tick.
    pub(crate) fn contact_colour(&self, pair: usize) -> Option<SolverColour> {
        self.colouring.colour_of(pair)
    }

    /// Performs one sub-step. `index` is the number of sub-steps since the world was created.
    pub(crate) fn sub_step(&mut self, index: u64, tuning: &Tuning) {
        let iterations = tuning.iterations;
        let cold_iterations = if self.contacts.has_cold() { iterations * COLD_ROUNDS } else { 0 };
        let constants = Constants::new(tuning);
        let Solver { list, moving, joints, contacts, contact_velocities, machine, threads, faults, .. } =
            self;
        let context = &StepContext::new(*machine, threads, tuning, &mut list.bodies, faults);

        // Integrate velocities.
        joints.predict_rotations(context);
        contact_velocities.measure(context);
        integrate_velocities(moving, context);

        // Warm start.
        if contacts.has_extras() {
            contacts.run_overflow(ObserveApproach, context);
            contacts.run_coloured(ObserveApproach, context);
        }
        joints.warm_start(context);
        if !contact_velocities.apply(context) {
            contacts.run_overflow(contact::WarmStart, context);
            contacts.run_coloured(contact::WarmStart, context);
        }

        // Solve with bias.
        for iteration in 0..iterations {
            let solve = contact::Solve { order: PointOrder::of(index, iteration), constants };
            contacts.run_overflow(solve, context);
            contact_velocities.exempt(context, || joints.solve(Pass::Bias, context));
            contacts.run_coloured(solve, context);
        }
        for iteration in iterations..cold_iterations {
            contacts.run_cold(contact::Solve { order: PointOrder::of(index, iteration), constants }, context);
        }

        // Integrate displacements.
        contact_velocities.exempt(context, || integrate_displacements(moving, context));
        joints.refresh(context);

        // Relax: solve without bias.
        let (iterations, cold_iterations) = if tuning.relax { (iterations, cold_iterations) } else { (0, 0) };
        for iteration in 0..iterations {
            let relax = contact::Relax { order: PointOrder::of(index, iteration), constants };
            contacts.run_overflow(relax, context);
            contact_velocities.exempt(context, || joints.solve(Pass::Relax, context));
            contacts.run_coloured(relax, context);
        }
        for iteration in iterations..cold_iterations {
            contacts.run_cold(contact::Relax { order: PointOrder::of(index, iteration), constants }, context);
        }
        if !tuning.relax {
            contacts.run_overflow(Measure, context);
            contacts.run_coloured(Measure, context);
        }
        if contacts.has_extras() {
            contact_velocities.exempt(context, || contacts.bounce(context));
        }
    }

    /// Stores the impulses for the next tick.
    pub(crate) fn store_impulses(&mut self, contacts: &mut [Contact], joints: &mut Arena<Joint, JointId>) {
        self.joints.store(joints);
        self.contacts.store(self.machine, contacts, &mut self.pushed);
    }
}
