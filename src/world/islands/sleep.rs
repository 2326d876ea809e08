use alloc::vec::Vec;

use crate::body::{BodyKind, Handle};
use crate::collision::Contact;
use crate::math::{Fx, Vec2};
use crate::world::cache::{AwakeSet, NARROW_PHASE_WORK, Scratch, UnionFind, is_awake, merge_sorted};
use crate::world::state::{Island, State};

/// Puts a body to sleep with the awake bodies connected to it, unless a joint connects one of these bodies to a moving
/// kinematic body.
pub(crate) fn put_to_sleep(state: &mut State, scratch: &mut Scratch, slot: u32) {
    scratch.awake.refresh(state);
    scratch.pairs.non_colliding.refresh(state);
    let Scratch { awake, union, pairs, shapes, meter, .. } = &mut *scratch;
    unite_joined(state, awake, union);
    meter.spend_visit(&state.sleeping_contacts);
    // Contacts of bodies that were woken since the last tick are still in the list of sleeping contacts.
    for contact in state.contacts.iter().chain(state.sleeping_contacts.iter()) {
        let (a, b) = state.bodies_of(contact.shapes);
        if !(connects(state, contact) && is_awake(a) && is_awake(b)) {
            continue;
        }
        meter.spend(NARROW_PHASE_WORK);
        // Edits since the last tick may have moved the bodies apart.
        let reach = if contact.count > 0 { state.config.speculative_distance } else { Fx::ZERO };
        if pairs.non_colliding.may_touch(state, contact.shapes)
            && shapes.poses().are_within(contact.shapes, reach)
        {
            unite_bodies(state, union, contact);
        }
    }
    for &joint in awake.joints() {
        let (a, b) = state.joints.at(joint).def().bodies();
        for (anchor, other) in [(a, b), (b, a)] {
            let anchor = state.bodies.at(anchor.slot());
            if anchor.kind() == BodyKind::Kinematic && anchor.is_moving() {
                union.keep_awake(other.slot());
            }
        }
    }
    let root = union.root(slot);
    for &other in awake.bodies() {
        if union.root(other) != root {
            union.keep_awake(other);
        }
    }
    put_sleepy_sets_to_sleep(state, scratch);
}

pub(crate) fn unite_connected(state: &State, scratch: &mut Scratch) {
    let Scratch { awake, union, .. } = scratch;
    unite_joined(state, awake, union);
    unite_touching(state, union, &state.contacts);
}

fn unite_joined(state: &State, awake: &AwakeSet, union: &mut UnionFind) {
    union.reset(awake.bodies(), state.bodies.slot_count());
    for &joint in awake.joints() {
        let (a, b) = state.joints.at(joint).def().bodies();
        unite(state, union, a.slot(), b.slot());
    }
}

/// Unites the two bodies of each contact that has points, and the body of each area with the bodies on which the area
/// acts.
pub(crate) fn unite_touching(state: &State, union: &mut UnionFind, contacts: &[Contact]) {
    contacts
        .iter()
        .filter(|contact| connects(state, contact))
        .for_each(|contact| unite_bodies(state, union, contact));
}

fn connects(state: &State, contact: &Contact) -> bool {
    contact.count > 0 || (contact.touching && state.has_area(contact.shapes))
}

fn unite_bodies(state: &State, union: &mut UnionFind, contact: &Contact) {
    let (a, b) = contact.shapes;
    unite(state, union, state.shapes.at(a).body().slot(), state.shapes.at(b).body().slot());
}

pub(crate) fn unite(state: &State, union: &mut UnionFind, a: u32, b: u32) {
    if is_awake(state.bodies.at(a)) && is_awake(state.bodies.at(b)) {
        union.unite(a, b);
    }
}

/// Puts to sleep every set of connected bodies that is not marked to stay awake.
pub(crate) fn put_sleepy_sets_to_sleep(state: &mut State, scratch: &mut Scratch) {
    let Scratch { awake, union, .. } = &mut *scratch;
    let mut any = false;
    for &slot in awake.bodies() {
        let root = union.root(slot);
        if union.stays_awake(root) {
            continue;
        }
        // The root is the smallest slot of its set. Slots are visited in order, so that the root gets its island first.
        let island = match state.bodies.at(root).island {
            Some(island) => island,
            None => state.islands.insert(Island { bodies: Vec::new() }),
        };
        state.islands.redefine(island.slot()).bodies.push(slot);
        let body = state.bodies.at_mut(slot);
        body.island = Some(island);
        body.rest_ticks.reset();
        body.stop();
        (body.force, body.torque) = (Vec2::ZERO, Fx::ZERO);
        any = true;
    }
    if any {
        scratch.awake.invalidate();
        // Fat boxes may have ceased to overlap since the last pair update. The next pair update must therefore check
        // the sleeping contacts.
        scratch.pairs.changes.sleeping_contacts_changed();
        put_contacts_to_sleep(state, scratch);
    }
}

/// Moves contacts without an active body to the sleeping contacts, and drops their manifolds.
fn put_contacts_to_sleep(state: &mut State, scratch: &mut Scratch) {
    scratch.meter.spend_visit(&state.sleeping_contacts);
    let buffers = &mut scratch.pairs.buffers;
    buffers.sleeping_contacts.clear();
    let mut contacts = core::mem::take(&mut state.contacts);
    scratch.contacts.split_off(&mut contacts, &mut buffers.sleeping_contacts, |contact| {
        let (a, b) = state.bodies_of(contact.shapes);
        a.is_active() || b.is_active()
    });
    state.contacts = contacts;
    merge_sorted(&mut state.sleeping_contacts, &buffers.sleeping_contacts, &mut buffers.merged.contacts);
}
