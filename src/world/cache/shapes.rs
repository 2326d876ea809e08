//! Broad phase and poses of all shapes. One owner updates both, so that they cannot become inconsistent.

use alloc::vec::Vec;

use super::motion::{MotionCache, PredictedMotion};
use super::poses::Poses;
use crate::body::{Body, BodyKind, Handle, Shape, ShapeId};
use crate::collision::{BroadPhase, BroadPhaseKind, Moved, Pair};
use crate::math::{Aabb, Fx, Vec2};
use crate::world::state::State;

/// Broad phase and poses of all shapes. A cache of the state.
#[derive(Clone, Debug)]
pub(crate) struct ShapeCache {
    /// Fat boxes of the shapes of all enabled bodies.
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

    /// The fat boxes of the shapes of all enabled bodies.
    #[inline]
    pub(crate) fn broad_phase(&self) -> &BroadPhase {
        &self.broad_phase
    }

    /// The shapes in world axes.
    #[inline]
    pub(crate) fn poses(&self) -> &Poses {
        &self.poses
    }

    /// Bounds and predicted motion of shapes.
    #[inline]
    pub(crate) fn motion(&self) -> &MotionCache {
        self.poses.motion()
    }

    /// Lists the pairs of overlapping fat boxes; see [`BroadPhase::pairs`].
    pub(crate) fn find_pairs(
        &mut self,
        moved: Moved<'_>,
        accept: impl Fn(Pair) -> bool,
        limit: usize,
        pairs: &mut Vec<Pair>,
    ) -> bool {
        self.broad_phase.pairs(moved, accept, limit, pairs)
    }

    /// Starts the prediction of motion for a tick. Until its motion is set, a body does not move. Drops queued fat
    /// boxes.
    pub(crate) fn begin_prediction(&mut self, body_slots: usize) {
        self.refits.clear();
        self.poses.motion_mut().begin(body_slots);
    }

    /// Sets the predicted motion of a body.
    #[inline]
    pub(crate) fn set_body_motion(&mut self, body: u32, motion: PredictedMotion) {
        self.poses.motion_mut().set_motion(body, motion);
    }

    /// Sets the predicted motion of a shape: the translation of its body, and how far the body's rotation moves any of
    /// its points, in metres.
    #[inline]
    pub(crate) fn set_shape_motion(&mut self, shape: u32, motion: &PredictedMotion, turn: Fx) {
        self.poses.motion_mut().set_shape_motion(shape, motion.shift, turn);
    }

    /// Queues a new fat box for a shape.
    #[inline]
    pub(crate) fn queue_refit(&mut self, shape: u32, fat: Aabb) {
        self.refits.push((shape, fat));
    }

    /// Puts the queued fat boxes into the broad phase.
    pub(crate) fn apply_refits(&mut self) {
        self.broad_phase.set_many(&self.refits);
    }

    /// Puts a new fat box into the broad phase at once.
    pub(crate) fn refit(&mut self, shape: u32, fat: Aabb) {
        self.broad_phase.set(shape, fat);
    }

    /// Poses the shapes of a body again after it was translated and not rotated.
    pub(crate) fn shift_body(&mut self, body: &Body, by: Vec2<Fx>) {
        self.poses.shift_body(body, by);
    }

    /// Poses the shapes of a body again after it was moved.
    pub(crate) fn move_body(&mut self, state: &State, body: &Body) {
        self.poses.move_body(state, body);
    }

    /// Poses the shapes of a body that was added, changed or moved by hand, and takes over their fat boxes.
    pub(crate) fn update_body(&mut self, state: &State, slot: u32) {
        self.poses.pose_body(state, slot);
        let body = state.bodies.at(slot);
        for id in body.shapes().iter().filter(|_| body.enabled) {
            let shape = state.shapes.at(id.slot());
            self.broad_phase.put(id.slot(), shape.fat, body.kind() == BodyKind::Fixed);
            self.broad_phase.set_collision_class(id.slot(), shape.filter().collision_class());
        }
    }

    /// Removes a shape from the broad phase.
    pub(crate) fn remove(&mut self, shape: u32) {
        self.broad_phase.remove(shape);
    }

    /// Takes the memory of the queue, for a restore that lists fat boxes in it.
    pub(crate) fn take_refits(&mut self) -> Vec<(u32, Aabb)> {
        let mut refits = core::mem::take(&mut self.refits);
        refits.clear();
        refits
    }

    /// Updates poses after a restore: of the bodies that were only translated, of those that were also rotated, and of
    /// those that were redefined.
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
                self.poses.move_body(state, body);
            }
        }
        for &(slot, by) in shifted {
            let body = state.bodies.at(slot);
            if is_posed(&self.poses, body) {
                self.poses.shift_body(body, by);
            }
        }
        for &slot in redefined {
            if state.bodies.get_slot(slot).is_some() {
                self.poses.pose_body(state, slot);
            }
        }
    }

    /// Updates the broad phase after a restore. `changed` lists fat boxes that differ, and `redefined` the slots of
    /// shapes that may have been added or removed, or whose bodies were redefined.
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
        // The state has fat boxes of disabled bodies, which are in no broad phase.
        refits.retain(|&(slot, _)| broad_phase.fat(slot) != Aabb::NOWHERE);
        broad_phase.set_many(refits);
    }
}
