//! The solver: sequential impulses in sub-steps, in a fixed order.
//!
//! `sub_step` lists the stages of a sub-step, which follow E. Catto's soft step (Solver2D, `solve_soft_step.c`).
//! `integrate` moves bodies, `contact` solves contacts, and `contact_velocity` warm-starts them. `joint/hinge` solves
//! hinges, `joint/list` other joints, and `joint/block` the joints for which iterations do not converge.
//!
//! A row removes velocity along one direction (`row`). A point block pins two points together (`point_block`). Contacts
//! and hinges are solved in batches (`batches`), one constraint in each lane of the vector instructions (`simd`).

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
mod sub_step;

use alloc::vec::Vec;

pub use crate::simd::Backend;
pub(crate) use crate::simd::Machine;
pub(crate) use body::{SolverBody, turn_of};
use body_list::BodyList;
use colour::Colouring;
pub use colour::SolverColour;
pub(crate) use contact::{ActiveContact, ContactResults, Surface, SurfaceSide, WarmStarts};
use contact::{ContactSet, ContactSource, ContactStore};
use contact_velocity::{ContactVelocities, PushedBody};
use context::StepContext;
use integrate::MovingBody;
pub(crate) use integrate::{AreaEffect, limit_speed};
pub use joint::{
    Distance, Drive, Gear, Joint, JointDef, JointFrame, JointKind, JointLimit, JointPart, LinearDrive, Motor,
    Prismatic, Pull, Pulley, Rack, Revolute, Soft, Spring, Threshold, ThresholdAction, Weld, Wheel,
};
use joint::{JointSet, JointSource};
pub(crate) use limits::Faults;
pub(crate) use limits::IMPULSE_MAX;
pub use settings::{ContactTuning, DISTANCE_MAX, SolverSettings};
pub(crate) use settings::{RATE_MAX, SUB_STEPS_MAX, Tuning, check_count, check_setting};

use crate::body::{Arena, Body, BodyId, JointId};
use crate::collision::{Contact, Manifold};
use crate::math::{Fx, Vec2};
use crate::simd::{Shared, WIDTH};
use crate::threads::{Threads, part_of};
use sub_step::SolverShare;

/// Factor on the number of iterations of cold contacts ([`ContactSet`]). With a factor of 1 instead of 8, the boxes in
/// a grid of 20 x 20 pyramids of 55 boxes each move at 0.27 m/s instead of 0.05 m/s in the first ticks, and overlap by
/// 5.8 mm instead of 1.5 mm.
const COLD_ROUNDS: u32 = 8;

/// The working memory of the solver. It is not part of the state, and its earlier contents never change a result.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solver {
    list: BodyList,
    moving: Vec<MovingBody>,
    joints: JointSet,
    /// Working memory for the reaction of a single joint.
    reaction: JointSet,
    contacts: ContactSet,
    /// For each thread, the velocity changes that contacts cause to the bodies that the thread integrates.
    contact_velocities: Vec<ContactVelocities>,
    pub(crate) results: ContactResults,
    colouring: Colouring,
    pub(crate) machine: Machine,
    pub(crate) threads: Threads,
    pub(crate) parts: usize,
    pub(crate) warm_starts: WarmStarts,
    pub(crate) faults: Faults,
}

impl Solver {
    /// A new solver with the same backend and threads.
    pub(crate) fn emptied(&self) -> Self {
        Solver { machine: self.machine, threads: self.threads.clone(), ..Solver::default() }
    }

    pub(crate) fn prepare_bodies(&mut self, bodies: &Arena<Body, BodyId>, slots: &[u32], tuning: &Tuning) {
        self.faults = 0;
        self.warm_starts = WarmStarts::default();
        self.list.begin(bodies.slot_count());
        self.moving.clear();
        // Bodies are large, so one loop reads each body for both lists.
        for &slot in slots {
            let body = bodies.at(slot);
            self.list.add(slot, body, tuning.mean_time);
            self.moving.extend(MovingBody::prepare(self.list.index_of(slot), body, tuning));
        }
    }

    /// Applies the effect of areas to the dynamic body in a slot.
    pub(crate) fn apply_areas(&mut self, slot: u32, body: &Body, effect: &AreaEffect, tuning: &Tuning) {
        let index = self.list.index_of(slot);
        if let Ok(at) = self.moving.binary_search_by_key(&index, MovingBody::index) {
            self.moving[at] = MovingBody::in_areas(index, body, effect, tuning);
        }
    }

    pub(crate) fn body(&self, slot: u32) -> &SolverBody {
        self.list.body(slot)
    }

    /// Makes the constraints of the joints in the given slots. [`Self::prepare_blocks`] then makes those of joints in
    /// blocks.
    pub(crate) fn prepare_joints(
        &mut self,
        joints: &Arena<Joint, JointId>,
        slots: &[u32],
        bodies: &Arena<Body, BodyId>,
        tuning: &Tuning,
    ) {
        let parts = self.parts;
        let Solver { list, joints: set, colouring, machine, .. } = self;
        set.prepare(&JointSource { joints, slots, bodies, tuning }, list, colouring, parts, *machine);
    }

    pub(crate) fn blocked_joint_count(&self) -> usize {
        self.joints.blocked_count()
    }

    /// Prepares the joints in blocks, and computes the arms of all joints except hinges. Call this only if the work
    /// budget covers [`Self::blocked_joint_count`], because blocks take much time and memory.
    pub(crate) fn prepare_blocks(&mut self, tuning: &Tuning) {
        let Solver { list, joints: set, machine, faults, .. } = self;
        set.prepare_blocks();
        set.refresh(&StepContext::new(*machine, tuning, &mut list.bodies, faults));
    }

    /// Like [`Joint::reaction`], but reuses working memory.
    pub(crate) fn reaction(
        &mut self,
        joint: &Joint,
        bodies: (&Body, &Body),
        tuning: &Tuning,
    ) -> (Vec2<Fx>, Fx) {
        self.reaction.reaction(joint, bodies, tuning)
    }

    pub(crate) fn prepare_contacts(
        &mut self,
        pairs: &[ActiveContact],
        manifolds: &[Manifold],
        contacts: &[Contact],
        tuning: &Tuning,
    ) {
        let parts = self.parts;
        let Solver { list, moving, joints, colouring, contacts: set, machine, threads, .. } = self;
        let source = ContactSource { pairs, manifolds, contacts, list, mean_time: tuning.mean_time };
        set.sort(&source, colouring, parts);
        self.warm_starts = set.fill(&source, colouring, threads, parts, *machine);
        self.contact_velocities.resize_with(parts, ContactVelocities::default);
        for (part, velocities) in self.contact_velocities.iter_mut().enumerate() {
            let moving = &moving[part_of(moving.len(), WIDTH, part, parts)];
            let touched = moving.iter().filter(|moving| colouring.holds(moving.index()));
            let pushed = touched.map(|moving| PushedBody {
                index: moving.index(),
                shared: set.bounces(moving.index()) || moving.has_extras() || joints.holds(moving.index()),
            });
            velocities.begin(*machine, pushed);
        }
        let is_shared = self.contact_velocities.iter().any(|velocities| velocities.shared);
        self.contact_velocities.iter_mut().for_each(|velocities| velocities.shared = is_shared);
    }

    /// The colour that the contact of a touching pair had in the last tick.
    pub(crate) fn contact_colour(&self, pair: usize) -> Option<SolverColour> {
        self.colouring.colour_of(pair)
    }

    /// Performs `count` sub-steps, and stores the impulses of contacts. `first` is the number of the first sub-step:
    /// the tick number times the sub-steps in a tick.
    pub(crate) fn sub_steps(&mut self, first: u64, count: u32, tuning: &Tuning, contacts: &mut [Contact]) {
        let Solver { list, moving, joints, contacts: set, contact_velocities, machine, threads, .. } = self;
        let (machine, parts) = (*machine, contact_velocities.len());
        let bodies = Shared::new(&mut list.bodies);
        let store = ContactStore::new(contacts, &mut self.results, set.has_hits());
        let mut joints = joints.split();
        let moving = (0..parts).map(|part| &moving[part_of(moving.len(), WIDTH, part, parts)]);
        let shares = moving.zip(set.shares()).zip(contact_velocities).zip(joints.shares());
        let shares = shares.map(|(((moving, contacts), velocities), joints)| SolverShare {
            moving,
            contacts,
            velocities,
            joints,
        });
        self.faults += threads.run_team(shares, |mut share, member| {
            let mut faults = 0;
            let context = StepContext::of_member(machine, member, tuning, bodies.cells(), &mut faults);
            for index in 0..count {
                share.sub_step(first.wrapping_add(index.into()), index == 0, &context);
            }
            share.contacts.store(store);
            faults
        });
    }

    pub(crate) fn store_joints(&mut self, joints: &mut Arena<Joint, JointId>) {
        self.joints.store(joints);
    }
}
