use alloc::vec::Vec;

use super::meter::WorkMeter;
use super::motion::MotionCache;
use super::pose_range::PoseRange;
use super::poses::{Extents, Poses};
use crate::body::{Body, BodyKind, Handle, Shape, ShapeId};
use crate::collision::{BroadPhase, BroadPhaseKind, Moved, Pair};
use crate::math::{Aabb, Fx, Vec2};
use crate::world::state::State;

/// Broad phase and poses of all shapes. One owner updates both, so that they stay consistent.
#[derive(Clone, Debug)]
pub(crate) struct ShapeCache {
    /// Fat boxes of the shapes of enabled bodies.
    broad_phase: BroadPhase,
    poses: Poses,
    /// Fat boxes that wait for [`ShapeCache::apply_refits`].
    refits: Vec<(u32, Aabb)>,
}

impl ShapeCache {
    pub(crate) fn new(kind: BroadPhaseKind, state: &State) -> Self {
        let mut cache =
            ShapeCache { broad_phase: BroadPhase::new(kind), poses: Poses::default(), refits: Vec::new() };
        for (id, _) in state.bodies.iter() {
            cache.poses.pose_body(state, id.slot());
        }
        let body_of = |shape: &Shape| state.bodies.at(shape.body().slot());
        let enabled = || state.shapes.iter().filter(|(_, shape)| body_of(shape).enabled);
        let is_fixed = |shape: &Shape| body_of(shape).kind() == BodyKind::Fixed;
        let boxes = |(id, shape): (ShapeId, &Shape)| (id.slot(), shape.fat, is_fixed(shape));
        cache.broad_phase.refill(enabled().map(boxes));
        for (id, shape) in enabled() {
            cache.broad_phase.set_collision_class(id.slot(), shape.filter().collision_class());
        }
        cache
    }

    #[inline]
    pub(crate) fn broad_phase(&self) -> &BroadPhase {
        &self.broad_phase
    }

    #[inline]
    pub(crate) fn poses(&self) -> &Poses {
        &self.poses
    }

    #[inline]
    pub(crate) fn motion(&self) -> &MotionCache {
        self.poses.motion()
    }

    /// Finds pairs as [`BroadPhase::pairs`] does, but at most `known` pairs plus the number of new pairs that the
    /// budget of work units covers. Returns whether pairs were left out. If the search itself exhausts the budget,
    /// finds no pairs and returns false.
    pub(crate) fn find_pairs(
        &mut self,
        moved: Moved<'_>,
        accept: impl Fn(Pair) -> bool,
        limit: usize,
        pairs: &mut Vec<Pair>,
        known: usize,
        meter: &mut WorkMeter,
    ) -> bool {
        pairs.clear();
        let affordable = meter.spend_search(self.broad_phase.comparisons(moved)).saturating_add(known);
        if meter.is_exhausted() {
            return false;
        }
        let left_out = self.broad_phase.pairs(moved, accept, limit.min(affordable), pairs);
        if left_out && affordable < limit {
            meter.exhaust();
        }
        left_out
    }

    /// Resets predicted motion to rest, and drops queued fat boxes. `last_moving` lists the shapes that moved in the
    /// last tick.
    pub(crate) fn begin_prediction(&mut self, body_slots: usize, last_moving: impl Iterator<Item = u32>) {
        self.refits.clear();
        self.poses.motion_mut().begin(body_slots, last_moving);
    }

    pub(crate) fn prediction(&mut self) -> (&mut MotionCache, &[Extents], &BroadPhase) {
        let (motion, extents) = self.poses.motion_and_extents();
        (motion, extents, &self.broad_phase)
    }

    /// See [`MotionCache::bodies_move`].
    pub(crate) fn bodies_move(&mut self, bodies: &[u32]) {
        self.poses.motion_mut().bodies_move(bodies);
    }

    /// See [`Poses::split`].
    pub(crate) fn split(
        &mut self,
        ends: impl Iterator<Item = u32> + Clone,
    ) -> (impl Iterator<Item = PoseRange<'_>>, &[Extents], &BroadPhase) {
        let (parts, extents) = self.poses.split(ends);
        (parts, extents, &self.broad_phase)
    }

    #[inline]
    pub(crate) fn queue_refit(&mut self, shape: u32, fat: Aabb) {
        self.refits.push((shape, fat));
    }

    pub(crate) fn apply_refits(&mut self) {
        self.broad_phase.set_many(&self.refits);
    }

    pub(crate) fn refit(&mut self, shape: u32, fat: Aabb) {
        self.broad_phase.set(shape, fat);
    }

    pub(crate) fn whole(&mut self) -> PoseRange<'_> {
        self.poses.whole()
    }

    /// Poses the shapes of a body after an edit, and puts their fat boxes into the broad phase.
    pub(crate) fn update_body(&mut self, state: &State, slot: u32) {
        self.poses.pose_body(state, slot);
        let body = state.bodies.at(slot);
        for id in body.shapes().iter().filter(|_| body.enabled) {
            let shape = state.shapes.at(id.slot());
            self.broad_phase.put(id.slot(), shape.fat, body.kind() == BodyKind::Fixed);
            self.broad_phase.set_collision_class(id.slot(), shape.filter().collision_class());
        }
    }

    pub(crate) fn remove(&mut self, shape: u32) {
        self.broad_phase.remove(shape);
    }

    /// Empties the queue of fat boxes and takes it, so that a restore can reuse its memory.
    pub(crate) fn take_refits(&mut self) -> Vec<(u32, Aabb)> {
        let mut refits = core::mem::take(&mut self.refits);
        refits.clear();
        refits
    }

    /// Updates poses after a restore. `shifted` lists bodies that were only translated, `moved` lists bodies that were
    /// rotated, and `redefined` lists bodies that may have been added, removed or changed otherwise.
    pub(crate) fn restore_poses(
        &mut self,
        state: &State,
        shifted: &[(u32, Vec2<Fx>)],
        moved: &[u32],
        redefined: &[u32],
    ) {
        let is_posed = |poses: &Poses, body: &Body| body.shapes().iter().all(|id| poses.has(id.slot()));
        for body in moved.iter().map(|&slot| state.bodies.at(slot)) {
            if is_posed(&self.poses, body) {
                self.poses.whole().renew_body(&state.shapes, body);
            }
        }
        for &(slot, by) in shifted {
            let body = state.bodies.at(slot);
            if is_posed(&self.poses, body) {
                self.poses.whole().shift_body(body, by);
            }
        }
        for &slot in redefined {
            if state.bodies.get_slot(slot).is_some() {
                self.poses.pose_body(state, slot);
            }
        }
    }

    /// Updates the broad phase after a restore. `changed` lists fat boxes that differ. `redefined` lists shapes that
    /// may have been added or removed, or whose bodies were redefined.
    pub(crate) fn restore_boxes(&mut self, state: &State, changed: Vec<(u32, Aabb)>, redefined: &[u32]) {
        self.refits = changed;
        let ShapeCache { broad_phase, refits, .. } = self;
        for &slot in redefined {
            match state.shapes.get_slot(slot).filter(|_| state.body_of(slot).enabled) {
                Some(shape) => {
                    let is_fixed = state.body_of(slot).kind() == BodyKind::Fixed;
                    if broad_phase.fat(slot) == Aabb::NOWHERE || broad_phase.is_fixed(slot) != is_fixed {
                        broad_phase.put(slot, shape.fat, is_fixed);
                    } else {
                        refits.push((slot, shape.fat));
                    }
                    broad_phase.set_collision_class(slot, shape.filter().collision_class());
                }
                None => broad_phase.remove(slot),
            }
        }
        // The list may contain fat boxes of disabled bodies, which are not in the broad phase.
        refits.retain(|&(slot, _)| broad_phase.fat(slot) != Aabb::NOWHERE);
        broad_phase.set_many(refits);
    }
}
