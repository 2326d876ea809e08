//! Returning to a snapshot: the state, and of the caches what is not as it was.

use alloc::vec::Vec;

use super::{Packed, PackedBodies, Rest, Snapshot, bodies, constraints};
use crate::body::{Body, BodyKind, Handle};
use crate::math::{Aabb, Fx, Vec2};
use crate::world::World;
use crate::world::joint_links::JointLinks;
use crate::world::scratch::{Poses, Scratch};
use crate::world::state::State;

/// Slots of which the caches know something else than the state has, in any order and more than once.
#[derive(Default)]
pub(super) struct Stale {
    /// Bodies that are turned another way.
    turned: Vec<u32>,
    /// The others that are elsewhere, and by how much.
    shifted: Vec<(u32, Vec2<Fx>)>,
    /// Shapes with other boxes, and these.
    boxes: Vec<(u32, Aabb)>,
    /// Bodies, shapes or joints that are other ones or gone.
    redefined_bodies: Vec<u32>,
    redefined_shapes: Vec<u32>,
    any_joint: bool,
}

impl World {
    /// Returns to a saved state, also of another world. What follows is bit-identical to what followed the save, except
    /// that [`World::contacts`] and [`World::events`] are empty until the next tick.
    ///
    /// Costs a fraction of a tick: what every tick changes is copied, and only shapes that have moved since are posed
    /// anew. What has been defined, spawned or removed since the save is copied in pages of 32.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        let World { state, scratch, phases: _ } = self;
        let state = &mut **state;
        let mut stale = Stale { boxes: core::mem::take(&mut scratch.refitted), ..Stale::default() };
        stale.boxes.clear();
        restore_state(state, snapshot, &mut stale);
        refresh(state, scratch, stale);
        scratch.reset_results();
        scratch.changes.resume(&snapshot.changes, &scratch.broad_phase, state.shapes.slot_count());
    }
}

pub(super) fn restore_state(state: &mut State, snapshot: &Snapshot, stale: &mut Stale) {
    let Snapshot { rest, bodies, shapes, joints, islands, resting, packed, digest: _, changes: _ } = snapshot;
    let Rest { config, tick, faults, pairs_left_out, removed_contacts, rng } = rest;
    let Packed { bodies: moving, joints: turns, contacts: heads, impulses } = packed;
    let PackedBodies { bodies: motions, boxes } = moving;
    (state.config, state.tick, state.faults) = (*config, *tick, *faults);
    state.pairs_left_out = *pairs_left_out;
    state.removed_contacts.clone_from(removed_contacts);
    state.rng.clone_from(rng);
    state.bodies.restore(bodies, |slot| stale.redefined_bodies.push(slot));
    state.shapes.restore(shapes, |slot| stale.redefined_shapes.push(slot));
    state.joints.restore(joints, |_| stale.any_joint = true);
    state.islands.restore(islands, |_| {});
    bodies::unpack_bodies(&mut state.bodies, motions, |slot, by| match by {
        Some(by) => stale.shifted.push((slot, by)),
        None => stale.turned.push(slot),
    });
    bodies::unpack_boxes(&mut state.shapes, &state.bodies, boxes, |slot, fat| stale.boxes.push((slot, fat)));
    constraints::unpack_joints(&mut state.joints, turns);
    constraints::unpack_contacts(&mut state.contacts, heads, impulses);
    state.resting.restore(resting);
}

/// Brings the caches of places in line with the state.
fn refresh(state: &State, scratch: &mut Scratch, stale: Stale) {
    let Stale { turned, shifted, boxes, redefined_bodies, redefined_shapes, any_joint } = stale;
    if !redefined_bodies.is_empty() {
        scratch.kinematic = state.bodies.iter().any(|(_, body)| body.kind() == BodyKind::Kinematic);
    }
    let posed = |poses: &Poses, body: &Body| body.shapes().iter().all(|id| poses.has(id.slot()));
    for body in turned.into_iter().map(|slot| state.bodies.at(slot)) {
        if posed(&scratch.poses, body) {
            scratch.poses.move_body(state, body);
        }
    }
    for (body, by) in shifted.into_iter().map(|(slot, by)| (state.bodies.at(slot), by)) {
        if posed(&scratch.poses, body) {
            scratch.poses.shift_body(body, by);
        }
    }
    let of_shapes = redefined_shapes.iter().filter_map(|&slot| state.shapes.get_slot(slot));
    let mut bodies: Vec<u32> = of_shapes.map(|shape| shape.body().slot()).collect();
    let occupied = |&slot: &u32| state.bodies.get_slot(slot);
    // A body that has been disabled or enabled has its boxes where they were.
    let of_bodies = redefined_bodies.iter().filter_map(occupied).flat_map(|body| body.shapes());
    let redefined_boxes: Vec<u32> =
        of_bodies.map(|id| id.slot()).chain(redefined_shapes.iter().copied()).collect();
    bodies.extend(&redefined_bodies);
    if !(redefined_bodies.is_empty() && redefined_shapes.is_empty()) {
        bodies.sort_unstable();
        bodies.dedup();
    }
    for slot in bodies.into_iter().filter(|slot| occupied(slot).is_some()) {
        scratch.poses.pose_body(state, slot);
    }
    scratch.refitted = boxes;
    scratch.set_boxes(state, &redefined_boxes);
    if any_joint {
        scratch.joined_stale = true;
        scratch.links = JointLinks::new(state);
    }
    scratch.roster.invalidate();
}
