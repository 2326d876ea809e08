//! Working memory: whatever a tick may throw away. Clearing it before any tick changes no hash.

use alloc::vec::Vec;

use super::events::Events;
use super::state::State;
use super::stats::StepStats;
use crate::body::{Body, Handle};
use crate::collision::{
    AxisHint, BroadPhase, BroadPhaseKind, Contact, Manifold, Pair, PosedShape, SatCounters,
};
use crate::solver::{Solver, TouchingPair};

/// Caches, buffers and results of the last tick.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    pub(crate) broad_phase_kind: BroadPhaseKind,
    pub(crate) broad_phase: BroadPhase,
    pub(crate) poses: Poses,
    /// Whether the pairs may have changed for another reason than a fat box.
    pub(crate) pairs_changed: bool,
    pub(crate) pairs: Vec<Pair>,
    /// Pairs of body slots whose joint keeps them from colliding, sorted.
    pub(crate) joined: Vec<Pair>,
    pub(crate) merged: Vec<Contact>,
    pub(crate) ended: Vec<Contact>,
    /// For each contact, the axis that separated it in the last tick.
    pub(crate) hints: Vec<AxisHint>,
    pub(crate) old_hints: Vec<AxisHint>,
    /// For each contact, where it was in the last tick; `u32::MAX` if it is new.
    pub(crate) sources: Vec<u32>,
    /// For each contact, its manifold in the last tick.
    pub(crate) manifolds: Vec<Manifold>,
    pub(crate) touching: Vec<TouchingPair>,
    pub(crate) sat: SatCounters,
    pub(crate) solver: Solver,
    pub(crate) events: Events,
    pub(crate) stats: StepStats,
}

impl Scratch {
    pub(crate) fn new(kind: BroadPhaseKind) -> Self {
        Scratch {
            broad_phase_kind: kind,
            broad_phase: BroadPhase::new(kind),
            poses: Poses::default(),
            pairs_changed: true,
            pairs: Vec::new(),
            joined: Vec::new(),
            merged: Vec::new(),
            ended: Vec::new(),
            hints: Vec::new(),
            old_hints: Vec::new(),
            sources: Vec::new(),
            manifolds: Vec::new(),
            touching: Vec::new(),
            sat: SatCounters::default(),
            solver: Solver::default(),
            events: Events::default(),
            stats: StepStats::default(),
        }
    }

    /// Drops what is found by a contact's place in the state, because places have changed.
    pub(crate) fn forget_contacts(&mut self) {
        self.manifolds.clear();
        self.hints.clear();
        self.touching.clear();
        self.pairs_changed = true;
    }
}

/// Shapes in world axes, by slot. Either all shapes are there, or none are and [`Poses::ensure`] has to be called.
#[derive(Clone, Debug, Default)]
pub(crate) struct Poses {
    shapes: Vec<Option<PosedShape>>,
    complete: bool,
}

impl Poses {
    /// Poses every shape, if that has not been done since the caches were dropped.
    pub(crate) fn ensure(&mut self, state: &State) {
        if self.complete {
            return;
        }
        self.complete = true;
        for (_, body) in state.bodies.iter() {
            self.pose_body(state, body);
        }
    }

    /// Poses the shapes of a body anew, after it has been moved or has got another shape.
    pub(crate) fn pose_body(&mut self, state: &State, body: &Body) {
        if !self.complete {
            return;
        }
        self.shapes.resize_with(state.shapes.slot_count(), || None);
        let rotation = body.rotation();
        for &id in body.shapes() {
            let shape = state.shapes.at(id.slot());
            self.shapes[id.slot() as usize] = Some(PosedShape::new(&shape.def, body, rotation));
        }
    }

    /// The shape in an occupied slot.
    pub(crate) fn at(&self, slot: u32) -> &PosedShape {
        self.shapes[slot as usize].as_ref().expect("every shape is posed before the tick")
    }
}
