use alloc::vec::Vec;

use super::bodies::{self, PackedBodies};
use super::constraints;
use super::rollback::{Packed, Rest, Snapshot};
use crate::body::Handle;
use crate::math::{Aabb, Fx, Vec2};
use crate::world::World;
use crate::world::cache::{JointLinks, Scratch};
use crate::world::state::State;

/// Slots whose cached data (in [`Scratch`]) is outdated after a restore. The lists are unsorted and may repeat slots.
#[derive(Default)]
pub(super) struct Stale {
    /// Bodies whose rotation has changed.
    rotated: Vec<u32>,
    /// Bodies whose position has changed but whose rotation has not, each with its displacement in metres.
    shifted: Vec<(u32, Vec2<Fx>)>,
    /// Shapes whose fat box has changed, with the new box.
    boxes: Vec<(u32, Aabb)>,
    /// All bodies in pages that the restore has replaced.
    redefined_bodies: Vec<u32>,
    /// All shapes in pages that the restore has replaced.
    redefined_shapes: Vec<u32>,
    /// Whether the restore has replaced a page of joints.
    any_joint: bool,
}

impl World {
    /// Replaces the state by a saved state of this or another world. If the game then makes the same edits as after the
    /// save, all following ticks have bit-identical results. [`World::contacts`], [`World::events`] and
    /// [`World::stats`] are empty until the next tick.
    #[doc(alias = "rollback")]
    #[doc(alias = "load")]
    pub fn restore(&mut self, snapshot: &Snapshot) {
        let World { state, scratch, phases: _ } = self;
        let state = &mut **state;
        let mut stale = Stale { boxes: scratch.shapes.take_refits(), ..Stale::default() };
        restore_state(state, snapshot, &mut stale);
        refresh(state, scratch, stale);
        scratch.clear_results();
        let Scratch { pairs, shapes, .. } = scratch;
        pairs.changes.restore(&snapshot.changes, shapes.broad_phase(), state.shapes.slot_count());
    }
}

/// Replaces a state by the state of a snapshot, and adds to `stale` the slots whose cached data is outdated.
pub(super) fn restore_state(state: &mut State, snapshot: &Snapshot, stale: &mut Stale) {
    let Snapshot { rest, bodies, shapes, joints, islands, sleeping_contacts, packed, digest: _, changes: _ } =
        snapshot;
    let Rest { config, tick, faults, pairs_left_out, edited_contacts, rng } = rest;
    let Packed { bodies: packed_bodies, joints: packed_joints, contacts: heads, impulses } = packed;
    let PackedBodies { bodies: motions, boxes } = packed_bodies;
    (state.config, state.tick, state.faults) = (*config, *tick, *faults);
    state.pairs_left_out = *pairs_left_out;
    state.edited_contacts.clone_from(edited_contacts);
    state.rng.clone_from(rng);
    state.bodies.restore(bodies, |slot| stale.redefined_bodies.push(slot));
    state.shapes.restore(shapes, |slot| stale.redefined_shapes.push(slot));
    state.joints.restore(joints, |_| stale.any_joint = true);
    state.islands.restore(islands, |_| {});
    bodies::unpack_bodies(&mut state.bodies, motions, |slot, by| match by {
        Some(by) => stale.shifted.push((slot, by)),
        None => stale.rotated.push(slot),
    });
    bodies::unpack_boxes(&mut state.shapes, &state.bodies, boxes, |slot, fat| stale.boxes.push((slot, fat)));
    constraints::unpack_joints(&mut state.joints, packed_joints);
    constraints::unpack_contacts(&mut state.contacts, heads, impulses);
    state.sleeping_contacts.restore(sleeping_contacts);
}

fn refresh(state: &State, scratch: &mut Scratch, stale: Stale) {
    let Stale { rotated, shifted, boxes, redefined_bodies, redefined_shapes, any_joint } = stale;
    if !redefined_bodies.is_empty() {
        scratch.awake.look_for_kinematic(state);
    }
    let of_shapes = redefined_shapes.iter().filter_map(|&slot| state.shapes.get_slot(slot));
    let mut bodies: Vec<u32> = of_shapes.map(|shape| shape.body().slot()).collect();
    bodies.extend(&redefined_bodies);
    if !bodies.is_empty() {
        bodies.sort_unstable();
        bodies.dedup();
    }
    scratch.shapes.restore_poses(state, &shifted, &rotated, &bodies);
    // The restore may have enabled or disabled these bodies, so their boxes may have to enter or leave the broad phase.
    let occupied = redefined_bodies.iter().filter_map(|&slot| state.bodies.get_slot(slot));
    let of_bodies = occupied.flat_map(|body| body.shapes()).map(|id| id.slot());
    let redefined_boxes: Vec<u32> = of_bodies.chain(redefined_shapes.iter().copied()).collect();
    scratch.shapes.restore_boxes(state, boxes, &redefined_boxes);
    if any_joint {
        scratch.pairs.non_colliding.invalidate();
        scratch.joint_links = JointLinks::new(state);
    }
    scratch.awake.invalidate();
}
