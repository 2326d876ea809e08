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
mod rolling;
mod row;
mod settings;
mod softness;

use alloc::vec::Vec;

pub(crate) use body::{SolverBody, turned};
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

/// The working memory of the solver. Nothing in it outlives a tick, but its allocations do.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solver {
    pub(crate) bodies: Vec<SolverBody>,
    movers: Vec<Mover>,
    joint_ids: Vec<JointId>,
    /// For each body slot, whether the body is in `jointed`.
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
    slot: u32,
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
    /// Copies what the kernels need out of the state.
    pub(crate) fn prepare_bodies(&mut self, bodies: &Arena<Body, BodyId>, tuning: &Tuning) {
        self.faults = 0;
        self.warm_starts = WarmStarts::default();
        self.bodies.clear();
        self.bodies.resize(bodies.slot_count(), SolverBody::default());
        self.movers.clear();
        for (id, body) in bodies.iter() {
            self.bodies[id.index() as usize] = SolverBody::of(body);
            self.movers.extend(Mover::prepare(id.index(), body, tuning));
        }
    }

    /// Makes a constraint of every joint, in the order in which they are solved.
    pub(crate) fn prepare_joints(&mut self, joints: &Arena<Joint, JointId>, bodies: &Arena<Body, BodyId>) {
        self.joints.clear();
        self.jointed.clear();
        self.rotations.clear();
        self.nodes.clear();
        if joints.len() == 0 {
            return;
        }
        self.joint_ids.clear();
        self.joint_ids.extend(joints.iter().map(|(id, _)| id));
        self.rotations.resize(bodies.slot_count(), Rot::IDENTITY);
        self.has_joint.clear();
        self.has_joint.resize(bodies.slot_count(), false);
        for (id, joint) in joints.iter() {
            let (a, b) = joint.def.bodies();
            for slot in [a.index(), b.index()] {
                if !core::mem::replace(&mut self.has_joint[slot as usize], true) {
                    let body = bodies.at(slot);
                    let inverse_gyration = body.mass.inverse_gyration;
                    self.jointed.push(JointedBody { slot, angle: body.angle(), inverse_gyration });
                }
            }
            self.nodes.push(node(id.index().into(), bodies, a.index(), b.index()));
        }
        for &index in self.colouring.order(&self.nodes, bodies.slot_count()) {
            let id = self.joint_ids[index as usize];
            let joint = joints.at(id.index());
            let (a, b) = joint.def.bodies();
            let (a, b) = (a.index(), b.index());
            self.joints.push(RevoluteConstraint::prepare(id, joint, (a, bodies.at(a)), (b, bodies.at(b))));
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
        self.nodes.extend(pairs.iter().map(|pair| {
            let shapes = contacts[pair.contact as usize].shapes;
            node(u64::from(shapes.0) << 32 | u64::from(shapes.1), bodies, pair.bodies.0, pair.bodies.1)
        }));
        self.contacts.clear();
        self.contact_indices.clear();
        for &index in self.colouring.order(&self.nodes, bodies.slot_count()) {
            let TouchingPair { contact, bodies: (a, b), surface } = pairs[index as usize];
            self.contact_indices.push(contact);
            self.contacts.push(ContactConstraint::prepare(
                &manifolds[contact as usize],
                &contacts[contact as usize],
                surface,
                (a, bodies.at(a)),
                (b, bodies.at(b)),
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
            let turn = self.bodies[body.slot as usize].turn;
            self.rotations[body.slot as usize] =
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
}

fn node(key: u64, bodies: &Arena<Body, BodyId>, a: u32, b: u32) -> Node {
    let dynamic = |slot: u32| bodies.at(slot).is_dynamic().then_some(slot);
    Node { key, body_a: dynamic(a), body_b: dynamic(b) }
}
