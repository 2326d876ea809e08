//! Working memory: whatever a tick may throw away. Clearing it before any tick changes no hash.

use alloc::vec::Vec;

use super::continuous::Swept;
use super::events::Events;
use super::islands::{Roster, UnionFind};
use super::state::State;
use super::stats::StepStats;
use crate::body::{Body, BodyKind, Handle, Pose};
use crate::collision::{
    AxisHint, BroadPhase, BroadPhaseKind, Contact, Manifold, Pair, PosedShape, SatCounters,
};
use crate::solver::{Solver, TouchingPair};

/// Caches, buffers and results of the last tick.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    pub(crate) broad_phase: BroadPhase,
    pub(crate) poses: Poses,
    /// What has changed since the last look at the pairs.
    pub(crate) changes: Changes,
    pub(crate) roster: Roster,
    /// Whether there may be kinematic bodies.
    pub(crate) kinematic: bool,
    pub(crate) union: UnionFind,
    /// Where the bodies of the roster were at the start of the tick.
    pub(crate) starts: Vec<Pose>,
    /// The fast bodies of the tick.
    pub(crate) swept: Vec<Swept>,
    pub(crate) pairs: Vec<Pair>,
    /// Pairs of body slots whose joint keeps them from colliding, sorted; and whether joints have changed since.
    pub(crate) joined: Vec<Pair>,
    pub(crate) joined_stale: bool,
    pub(crate) fresh: Vec<Contact>,
    pub(crate) merged: Vec<Contact>,
    pub(crate) ended: Vec<Contact>,
    /// For each contact, the axis that separated it in the last tick.
    pub(crate) hints: Vec<AxisHint>,
    pub(crate) old_hints: Vec<(Pair, AxisHint)>,
    /// For each contact, its manifold in the last tick.
    pub(crate) manifolds: Vec<Manifold>,
    pub(crate) touching: Vec<TouchingPair>,
    /// Approaches that become hits if the shapes push each other in this tick.
    pub(crate) approaches: Vec<Approaching>,
    pub(crate) sat: SatCounters,
    pub(crate) solver: Solver,
    pub(crate) events: Events,
    pub(crate) stats: StepStats,
}

/// A contact that approaches fast enough to be a hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approaching {
    pub(crate) contact: u32,
    pub(crate) event: super::events::HitEvent,
}

/// Where pairs may have come or gone since the last look at them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes {
    /// Anywhere: the caches are new.
    pub(crate) everything: bool,
    /// Resting contacts may have an active body again, or may have ended.
    pub(crate) resting: bool,
    /// Pairs that might touch may not do so any more.
    pub(crate) rules: bool,
    /// Slots of shapes with another fat box, or whose body has begun or ceased to be active.
    pub(crate) shapes: Vec<u32>,
}

impl Changes {
    pub(crate) fn any(&self) -> bool {
        self.everything || self.resting || self.rules || !self.shapes.is_empty()
    }

    pub(crate) fn clear(&mut self) {
        let Changes { everything, resting, rules, shapes } = self;
        (*everything, *resting, *rules) = (false, false, false);
        shapes.clear();
    }

    /// The shapes of a body have another fat box, or another reason to have other pairs.
    pub(crate) fn body(&mut self, body: &Body) {
        self.shapes.extend(body.shapes().iter().map(|id| id.slot()));
    }
}

impl Scratch {
    /// The caches of a state.
    pub(crate) fn new(kind: BroadPhaseKind, state: &State) -> Self {
        let mut scratch = Scratch {
            broad_phase: BroadPhase::new(kind),
            poses: Poses::default(),
            changes: Changes { everything: true, ..Changes::default() },
            roster: Roster::default(),
            kinematic: state.bodies.iter().any(|(_, body)| body.kind() == BodyKind::Kinematic),
            union: UnionFind::default(),
            starts: Vec::new(),
            swept: Vec::new(),
            pairs: Vec::new(),
            joined: Vec::new(),
            joined_stale: true,
            fresh: Vec::new(),
            merged: Vec::new(),
            ended: Vec::new(),
            hints: Vec::new(),
            old_hints: Vec::new(),
            manifolds: Vec::new(),
            touching: Vec::new(),
            approaches: Vec::new(),
            sat: SatCounters::default(),
            solver: Solver::default(),
            events: Events::default(),
            stats: StepStats::default(),
        };
        for (_, body) in state.bodies.iter() {
            scratch.poses.pose_body(state, body);
        }
        let enabled = state.shapes.iter().filter(|(_, shape)| state.bodies.at(shape.body().slot()).enabled);
        scratch.broad_phase.refill(enabled.map(|(id, shape)| (id.slot(), shape.fat)));
        scratch
    }

    /// Brings the broad phase in line with shapes in some slots: that have another box, or that have come or gone.
    pub(crate) fn set_boxes(&mut self, state: &State, slots: &[u32]) {
        let there = |slot: u32| {
            let shape = state.shapes.get_slot(slot)?;
            state.bodies.at(shape.body().slot()).enabled.then_some((slot, shape.fat))
        };
        let gone = slots.iter().filter(|&&slot| there(slot).is_none());
        gone.for_each(|&slot| self.broad_phase.remove(slot));
        let boxes = slots.iter().filter_map(|&slot| there(slot));
        // To look at every inner box of a tree is worth setting one box in eight.
        if slots.len() > state.shapes.len() / 8 {
            self.broad_phase.set_many(boxes);
        } else {
            boxes.for_each(|(slot, fat)| self.broad_phase.set(slot, fat));
        }
    }

    /// Drops what is known of the last tick only: the state is now that of another one.
    pub(crate) fn reset_results(&mut self) {
        self.forget_contacts();
        self.ended.clear();
        self.events.clear();
        self.stats = StepStats::default();
    }

    /// Brings the caches in line with the place of a body's shapes.
    pub(crate) fn place(&mut self, state: &State, body: &Body) {
        self.poses.pose_body(state, body);
        if body.enabled {
            for id in body.shapes() {
                self.broad_phase.set(id.slot(), state.shapes.at(id.slot()).fat);
            }
        }
    }

    /// Drops what is found by a contact's place in the state, because places have changed.
    pub(crate) fn forget_contacts(&mut self) {
        self.manifolds.clear();
        self.hints.clear();
        self.touching.clear();
    }
}

/// Shapes in world axes, by slot.
#[derive(Clone, Debug, Default)]
pub(crate) struct Poses {
    shapes: Vec<Option<PosedShape>>,
}

impl Poses {
    /// Poses the shapes of a body anew, after it has been moved or has got another shape.
    pub(crate) fn pose_body(&mut self, state: &State, body: &Body) {
        if self.shapes.len() < state.shapes.slot_count() {
            self.shapes.resize_with(state.shapes.slot_count(), || None);
        }
        let rotation = body.rotation();
        for &id in body.shapes() {
            let shape = state.shapes.at(id.slot());
            self.shapes[id.slot() as usize] = Some(PosedShape::new(&shape.def, body, rotation));
        }
    }

    /// The shape in an occupied slot.
    pub(crate) fn at(&self, slot: u32) -> &PosedShape {
        self.shapes[slot as usize].as_ref().expect("every shape is posed when it is placed")
    }
}
