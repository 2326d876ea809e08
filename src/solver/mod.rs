//! The solver: sequential impulses over rows and point blocks, in sub-steps, in a fixed order.
//!
//! One kernel (`row`) solves whatever acts along a direction, another (`point_block`) what pins two points
//! together. Contacts and joints only prepare them, so that a wide kernel can take the place of a scalar one
//! without touching a constraint.

mod body;
mod colour;
mod contact;
mod integrate;
mod joint;
mod limits;
mod point_block;
mod revolute;
mod row;
mod settings;
mod softness;

use alloc::vec::Vec;

use body::turned;
pub(crate) use body::{SolverBody, turn_of};
use colour::{Colouring, Node};
use contact::{ContactConstraint, Pass, Sweep};
pub(crate) use contact::{Surface, WarmStarts};
use integrate::Mover;
pub use joint::{Joint, JointDef, RevoluteDef};
use limits::Faults;
pub(crate) use limits::IMPULSE_MAX;
use revolute::RevoluteConstraint;
pub(crate) use settings::Tuning;
pub use settings::{ContactTuning, DISTANCE_MAX, SolverSettings};

use crate::body::{Arena, Body, BodyId, JointId};
use crate::collision::{Contact, Manifold};
use crate::math::{Angle, Reciprocal, Rot};

/// The index of the body that stands for all those that nothing moves. Their mass fraction is 0, so that it never
/// changes.
const GROUND: u32 = 0;

/// The working memory of the solver. Nothing in it outlives a tick, but its allocations do.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solver {
    /// The ground, which stands for all bodies that nothing moves, and then the bodies of the tick.
    bodies: Vec<SolverBody>,
    /// For each body slot, where its body is in `bodies`: 0 if nothing moves it.
    indices: Vec<u32>,
    /// The slots of the bodies of the tick.
    slots: Vec<u32>,
    movers: Vec<Mover>,
    /// For each body, whether it is in `jointed`.
    has_joint: Vec<bool>,
    jointed: Vec<JointedBody>,
    rotations: Vec<Rot>,
    joints: Vec<RevoluteConstraint>,
    contacts: Vec<ContactConstraint>,
    /// For each constraint in `contacts`, the index of its contact in the state.
    contact_indices: Vec<u32>,
    /// For each contact in the state, whether its shapes have pushed each other in this tick.
    pub(crate) pushed: Vec<bool>,
    nodes: Vec<Node>,
    colouring: Colouring,
    pub(crate) warm_starts: WarmStarts,
    pub(crate) faults: Faults,
}

/// A body with joints, whose rotation is needed at every refresh.
#[derive(Clone, Copy, Debug)]
struct JointedBody {
    index: u32,
    angle: Angle,
    inverse_gyration: Reciprocal,
}

/// A contact to solve: where it is in the state, the slots of its bodies, and their common surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TouchingPair {
    pub(crate) contact: u32,
    pub(crate) bodies: (u32, u32),
    pub(crate) surface: Surface,
}

impl Solver {
    /// Copies what the kernels need of the bodies in the given slots out of the state.
    pub(crate) fn prepare_bodies(&mut self, bodies: &Arena<Body, BodyId>, slots: &[u32], tuning: &Tuning) {
        self.faults = 0;
        self.warm_starts = WarmStarts::default();
        for &slot in &self.slots {
            self.indices[slot as usize] = GROUND;
        }
        self.indices.resize(bodies.slot_count(), GROUND);
        self.slots.clear();
        self.slots.extend_from_slice(slots);
        self.movers.clear();
        self.bodies.clear();
        self.bodies.push(SolverBody::default());
        for (&slot, index) in slots.iter().zip(1u32..) {
            let body = bodies.at(slot);
            self.indices[slot as usize] = index;
            self.bodies.push(SolverBody::of(body));
            self.movers.extend(Mover::prepare(index, body, tuning));
        }
    }

    /// Where the body of a slot is among the bodies of the tick, from 1; 0 if nothing moves it.
    pub(crate) fn index_of(&self, slot: u32) -> u32 {
        self.indices[slot as usize]
    }

    /// The same for a body with a joint: it does not share the ground's place, because joints see how it is turned.
    fn own_index_of(&mut self, slot: u32) -> u32 {
        if self.indices[slot as usize] == GROUND {
            self.indices[slot as usize] = u32::try_from(self.bodies.len()).expect("fewer than 2^32 bodies");
            self.slots.push(slot);
            self.bodies.push(SolverBody::default());
            self.has_joint.push(false);
        }
        self.indices[slot as usize]
    }

    /// The body of a slot, as the tick has left it.
    pub(crate) fn body(&self, slot: u32) -> &SolverBody {
        &self.bodies[self.index_of(slot) as usize]
    }

    /// Makes a constraint of every joint, in the order in which they are solved.
    pub(crate) fn prepare_joints(
        &mut self,
        joints: &Arena<Joint, JointId>,
        slots: &[u32],
        bodies: &Arena<Body, BodyId>,
    ) {
        self.joints.clear();
        self.jointed.clear();
        self.nodes.clear();
        self.has_joint.clear();
        self.has_joint.resize(self.bodies.len(), false);
        for &joint in slots {
            let (a, b) = joints.at(joint).def.bodies();
            for slot in [a.index(), b.index()] {
                let (index, body) = (self.own_index_of(slot), bodies.at(slot));
                if !core::mem::replace(&mut self.has_joint[index as usize], true) {
                    let inverse_gyration = body.mass.inverse_gyration;
                    self.jointed.push(JointedBody { index, angle: body.angle(), inverse_gyration });
                }
            }
            self.nodes.push(self.node(joint.into(), bodies, a.index(), b.index()));
        }
        self.rotations.resize(self.bodies.len(), Rot::IDENTITY);
        for &index in self.colouring.order(&self.nodes, self.bodies.len()) {
            let id = joints.handle_at(slots[index as usize]);
            let joint = joints.at(id.index());
            let (a, b) = joint.def.bodies();
            let (a, b) = (a.index(), b.index());
            let ends = (self.indices[a as usize], self.indices[b as usize]);
            self.joints.push(RevoluteConstraint::prepare(
                id,
                joint,
                (ends.0, bodies.at(a)),
                (ends.1, bodies.at(b)),
            ));
        }
        self.refresh_joints();
    }

    /// Makes a constraint of every touching pair, in the order in which they are solved.
    pub(crate) fn prepare_contacts(
        &mut self,
        pairs: &[TouchingPair],
        manifolds: &[Manifold],
        contacts: &[Contact],
        bodies: &Arena<Body, BodyId>,
        tuning: &Tuning,
    ) {
        self.nodes.clear();
        for pair in pairs {
            let shapes = contacts[pair.contact as usize].shapes;
            let key = u64::from(shapes.0) << 32 | u64::from(shapes.1);
            self.nodes.push(self.node(key, bodies, pair.bodies.0, pair.bodies.1));
        }
        self.contacts.clear();
        self.contact_indices.clear();
        for &index in self.colouring.order(&self.nodes, self.bodies.len()) {
            let TouchingPair { contact, bodies: (a, b), surface } = pairs[index as usize];
            self.contact_indices.push(contact);
            self.contacts.push(ContactConstraint::prepare(
                &manifolds[contact as usize],
                &contacts[contact as usize],
                surface,
                (self.indices[a as usize], bodies.at(a)),
                (self.indices[b as usize], bodies.at(b)),
                tuning,
                &mut self.warm_starts,
                &mut self.faults,
            ));
        }
    }

    /// One sub-step: aim joints, integrate velocities, warm start, solve with bias, integrate displacements,
    /// refresh joints, relax without bias. `index` counts the sub-steps since the world was made.
    pub(crate) fn sub_step(&mut self, index: u64, tuning: &Tuning) {
        let h = Reciprocal::of_integer(tuning.rate);
        for joint in &mut self.joints {
            joint.aim(&self.bodies, h, tuning);
        }
        for mover in &self.movers {
            mover.integrate_velocity(&mut self.bodies, tuning.speed_max);
        }
        for contact in &mut self.contacts {
            contact.observe_approach(&self.bodies, &mut self.faults);
        }
        self.warm_start();
        for iteration in 0..tuning.iterations {
            self.solve(Pass::Bias, Sweep::of(index, iteration), tuning);
        }
        for mover in &self.movers {
            mover.integrate_displacement(&mut self.bodies, tuning.rate, &mut self.faults);
        }
        self.refresh_joints();
        if tuning.relax {
            for iteration in 0..tuning.iterations {
                self.solve(Pass::Relax, Sweep::of(index, iteration), tuning);
            }
        }
    }

    fn refresh_joints(&mut self) {
        for body in &self.jointed {
            let turn = self.bodies[body.index as usize].turn;
            self.rotations[body.index as usize] =
                Rot::from_angle(turned(body.angle, turn, body.inverse_gyration));
        }
        for joint in &mut self.joints {
            joint.refresh(&self.bodies, &self.rotations);
        }
    }

    fn warm_start(&mut self) {
        for joint in &mut self.joints {
            joint.warm_start(&mut self.bodies, &mut self.faults);
        }
        for contact in &mut self.contacts {
            contact.warm_start(&mut self.bodies, &mut self.faults);
        }
    }

    fn solve(&mut self, pass: Pass, sweep: Sweep, tuning: &Tuning) {
        for joint in &mut self.joints {
            joint.solve(pass, tuning, &mut self.bodies, &mut self.faults);
        }
        for contact in &mut self.contacts {
            contact.solve(pass, sweep, tuning, &mut self.bodies, &mut self.faults);
        }
    }

    pub(crate) fn apply_restitution(&mut self, tuning: &Tuning) {
        for contact in &mut self.contacts {
            contact.apply_restitution(tuning, &mut self.bodies, &mut self.faults);
        }
    }

    /// Keeps the impulses for the next tick.
    pub(crate) fn store_impulses(&mut self, contacts: &mut [Contact], joints: &mut Arena<Joint, JointId>) {
        for constraint in &self.joints {
            constraint.store(joints.at_mut(constraint.joint.index()));
        }
        self.pushed.clear();
        self.pushed.resize(contacts.len(), false);
        for (constraint, &index) in self.contacts.iter().zip(&self.contact_indices) {
            constraint.store(&mut contacts[index as usize]);
            self.pushed[index as usize] = constraint.has_pushed();
        }
    }

    fn node(&self, key: u64, bodies: &Arena<Body, BodyId>, a: u32, b: u32) -> Node {
        let dynamic = |slot: u32| bodies.at(slot).is_dynamic().then(|| self.index_of(slot));
        Node { key, body_a: dynamic(a), body_b: dynamic(b) }
    }
}
