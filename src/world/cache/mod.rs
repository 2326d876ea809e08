//! Working memory of a world: caches, buffers and the results of the last tick. Dropping it changes no hash.
//!
//! An owner of content that can become invalid keeps its fields private, so that only its own methods invalidate the
//! content.
//!
//! | owner | content | invalid when |
//! |---|---|---|
//! | [`ShapeCache`] | broad phase, poses, predicted motion | never: updated with every body and shape |
//! | [`AwakeSet`] | slots of awake bodies and of their joints | something wakes, sleeps, is added, changed or removed |
//! | [`JointLinks`] | joints of each body | never: updated with every joint |
//! | [`PairCache`] | which pairs may have changed, pairs of bodies that joints keep from colliding | see [`Changes`] |
//! | [`ContactCache`] | manifolds, surfaces, cached separating axes | contacts are reordered, shapes redefined |
//! | [`Solver`] | constraints of the last tick | the next tick begins |

mod awake;
mod changes;
mod contacts;
mod joint_links;
mod meter;
mod motion;
mod pairs;
mod pose_range;
mod poses;
mod results;
mod shapes;
mod union_find;

pub(crate) use awake::{AwakeSet, SlotShare, is_awake};
pub(crate) use changes::Changes;
pub(crate) use contacts::{
    ContactCache, ImpactOrder, NarrowPhaseBuffers, NarrowPhaseOutput, Passing, PendingHit, PendingImpact,
    Recycled,
};
pub(crate) use joint_links::JointLinks;
pub(crate) use meter::{NARROW_PHASE_WORK, NEW_PAIR_WORK, WorkMeter, pair_work, search_work, visit_work};
pub(crate) use motion::{
    ClosingBound, GHOST_TRAVEL_MIN, Margins, MotionCache, MotionRange, PredictedMotion, ShapeMotion, Travel,
};
pub(crate) use pairs::{MergedContacts, NonCollidingPairs, PairCache, merge_sorted};
pub(crate) use pose_range::PoseRange;
pub(crate) use poses::{Extents, Poses};
pub(crate) use results::{Finalised, Outgrown, Predicted, Sweeps, SweptBody, TickResults};
pub(crate) use shapes::ShapeCache;
pub(crate) use union_find::UnionFind;

use alloc::vec::Vec;

use super::state::State;
use crate::collision::BroadPhaseKind;
use crate::solver::Solver;

#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    pub(crate) shapes: ShapeCache,
    pub(crate) awake: AwakeSet,
    pub(crate) joint_links: JointLinks,
    pub(crate) pairs: PairCache,
    pub(crate) contacts: ContactCache,
    pub(crate) union: UnionFind,
    /// Shapes inside areas: slots of a body, an area, and the shape of the body that the area acts on.
    pub(crate) area_visitors: Vec<[u32; 3]>,
    pub(crate) predicted: Vec<Predicted>,
    pub(crate) finalised: Vec<Finalised>,
    pub(crate) sweeps: Sweeps,
    pub(crate) solver: Solver,
    pub(crate) results: TickResults,
    pub(crate) meter: WorkMeter,
}

impl Scratch {
    pub(crate) fn new(kind: BroadPhaseKind, state: &State) -> Self {
        Scratch {
            shapes: ShapeCache::new(kind, state),
            awake: AwakeSet::new(state),
            joint_links: JointLinks::new(state),
            pairs: PairCache::new(),
            contacts: ContactCache::new(),
            union: UnionFind::default(),
            area_visitors: Vec::new(),
            predicted: Vec::new(),
            finalised: Vec::new(),
            sweeps: Sweeps::default(),
            solver: Solver::default(),
            results: TickResults::default(),
            meter: WorkMeter::default(),
        }
    }

    /// Rebuilds all caches. Keeps the solver's backend and threads, and the meter.
    pub(crate) fn rebuild(&mut self, kind: BroadPhaseKind, state: &State) {
        let solver = self.solver.emptied();
        *self = Scratch { solver, meter: self.meter, ..Scratch::new(kind, state) };
    }

    /// Drops the results of the last tick after the state was replaced.
    pub(crate) fn clear_results(&mut self) {
        self.contacts.invalidate();
        self.contacts.invalidate_surfaces();
        self.pairs.ended.clear();
        self.results.clear();
    }

    /// Updates the caches after an edit has added, enabled, redefined or moved a body.
    pub(crate) fn update_body(&mut self, state: &State, slot: u32) {
        let body = state.bodies.at(slot);
        self.shapes.update_body(state, slot);
        self.pairs.changes.compact();
        self.pairs.changes.body_changed(body);
        self.awake.body_changed(body);
    }
}
