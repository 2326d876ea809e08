//! Which pairs of shapes a tick looks at: those whose fat boxes overlap, that may touch at all, and of which at
//! least one body is active. Everything else about a pair that is still near waits in `State::resting`.
//!
//! The contacts are a function of the state; what has moved only says where to look for changes.

use alloc::vec::Vec;

use super::scratch::Scratch;
use super::state::State;
use crate::body::{BodyKind, Handle};
use crate::collision::{AxisHint, Contact, Moved, Pair};

/// Brings the contacts in line with the fat boxes. Contacts of pairs that have parted go to `scratch.ended`.
pub(super) fn update(state: &mut State, scratch: &mut Scratch) {
    // Pairs that were left out come in as soon as there is room, whatever has made it.
    if !(scratch.changes.any() || state.pairs_left_out) {
        return;
    }
    remember_hints(state, scratch);
    refresh_joined(state, scratch);
    wake_resting(state, scratch);
    drop_parted(state, scratch);
    find_new(state, scratch);
    recall_hints(state, scratch);
    scratch.changes.clear();
}

/// Contacts of bodies that have woken, or have begun to move, are looked at again, and so are those that end
/// although nothing is active: a sensor's, of a kinematic body that was moved by hand.
fn wake_resting(state: &mut State, scratch: &mut Scratch) {
    if state.resting.is_empty() || !(scratch.changes.everything || scratch.changes.resting) {
        return;
    }
    let mut resting = core::mem::take(&mut state.resting);
    let Scratch { fresh: woken, joined, merged, .. } = scratch;
    woken.clear();
    resting.retain(|contact| {
        let (a, b) = state.bodies_of(contact.shapes);
        let wakes = a.is_active() || b.is_active() || !is_near(state, joined, contact.shapes);
        if wakes {
            woken.push(*contact);
        }
        !wakes
    });
    state.resting = resting;
    merge(&mut state.contacts, woken, merged);
}

fn is_near(state: &State, joined: &[Pair], (a, b): Pair) -> bool {
    state.shapes.at(a).fat.overlaps(state.shapes.at(b).fat) && may_touch(state, joined, (a, b))
}

/// Finds the pairs of a sleeping body and one that is not, of which one of these shapes is an end, and that may push
/// each other.
pub(super) fn find_sleepers(state: &State, scratch: &mut Scratch, first_change: usize) {
    let Scratch { broad_phase, changes, pairs, joined, .. } = scratch;
    let moved = Moved::Slots(&changes.shapes[first_change..]);
    let wanted = |pair: Pair| {
        let (a, b) = state.bodies_of(pair);
        a.is_asleep() != b.is_asleep() && state.sensor_of(pair).is_none() && may_touch(state, joined, pair)
    };
    broad_phase.pairs(moved, wanted, state.config.pair_limit as usize, pairs);
}

/// Takes out the contacts whose boxes have parted, and those that nothing moves any more.
fn drop_parted(state: &mut State, scratch: &mut Scratch) {
    let mut contacts = core::mem::take(&mut state.contacts);
    let Scratch { ended, fresh, changes, joined, .. } = scratch;
    fresh.clear();
    contacts.retain(|contact| {
        let (a, b) = contact.shapes;
        let near = state.shapes.at(a).fat.overlaps(state.shapes.at(b).fat)
            && (!(changes.everything || changes.rules) || may_touch(state, joined, contact.shapes));
        let (body_a, body_b) = state.bodies_of(contact.shapes);
        let active = body_a.is_active() || body_b.is_active();
        match (near, active) {
            (false, _) => ended.push(*contact),
            (true, false) => fresh.push(*contact),
            (true, true) => {}
        }
        near && active
    });
    state.contacts = contacts;
    if !fresh.is_empty() {
        merge(&mut state.resting, fresh, &mut scratch.merged);
    }
}

/// Adds a contact for every new pair.
fn find_new(state: &mut State, scratch: &mut Scratch) {
    let limit = state.config.pair_limit as usize;
    let Scratch { broad_phase, changes, pairs, joined, fresh, .. } = scratch;
    let everything = changes.everything || state.pairs_left_out;
    let moved = if everything { Moved::All } else { Moved::Slots(&changes.shapes) };
    let wanted = |pair: Pair| {
        let (a, b) = state.bodies_of(pair);
        (a.is_active() || b.is_active()) && may_touch(state, joined, pair)
    };
    let mut left_out = broad_phase.pairs(moved, wanted, limit, pairs);
    let mut known = state.contacts.iter().map(|contact| contact.shapes).peekable();
    fresh.clear();
    for &pair in pairs.iter() {
        while known.next_if(|&shapes| shapes < pair).is_some() {}
        if known.peek() != Some(&pair) {
            fresh.push(Contact::new(pair));
        }
    }
    drop(known);
    merge(&mut state.contacts, fresh, &mut scratch.merged);
    if state.contacts.len() > limit {
        scratch.ended.extend(state.contacts.drain(limit..));
        left_out = true;
    }
    state.pairs_left_out = left_out;
}

/// Merges contacts into a list, both sorted by pair and without a pair in common.
pub(super) fn merge(contacts: &mut Vec<Contact>, new: &[Contact], merged: &mut Vec<Contact>) {
    if new.is_empty() {
        return;
    }
    merged.clear();
    merged.reserve(contacts.len() + new.len());
    let mut old = contacts.iter().copied().peekable();
    for contact in new {
        while let Some(before) = old.next_if(|old| old.shapes < contact.shapes) {
            merged.push(before);
        }
        merged.push(*contact);
    }
    merged.extend(old);
    core::mem::swap(contacts, merged);
}

/// Pairs of bodies that a joint keeps from colliding.
fn refresh_joined(state: &State, scratch: &mut Scratch) {
    if !core::mem::take(&mut scratch.joined_stale) {
        return;
    }
    let keeping_apart = state.joints.iter().filter(|(_, joint)| !joint.def().collide_connected);
    scratch.joined.clear();
    scratch.joined.extend(keeping_apart.map(|(_, joint)| {
        let (a, b) = joint.def().bodies();
        (a.slot().min(b.slot()), a.slot().max(b.slot()))
    }));
    scratch.joined.sort_unstable();
}

/// Whether two shapes may ever have a contact: they are of different, enabled bodies whose filters accept each
/// other, and either one is a sensor that may notice the other, or one is dynamic and no joint keeps them apart.
pub(super) fn may_touch(state: &State, joined: &[Pair], (a, b): Pair) -> bool {
    let (shape_a, shape_b) = (state.shapes.at(a), state.shapes.at(b));
    let (slot_a, slot_b) = (shape_a.body().slot(), shape_b.body().slot());
    if slot_a == slot_b || !shape_a.filter().accepts(shape_b.filter()) {
        return false;
    }
    let (body_a, body_b) = (state.bodies.at(slot_a), state.bodies.at(slot_b));
    if !(body_a.enabled && body_b.enabled) {
        return false;
    }
    match (shape_a.is_sensor(), shape_b.is_sensor()) {
        (true, true) => false,
        (true, false) => shape_b.def.events.sensor && !both_fixed(body_a.kind, body_b.kind),
        (false, true) => shape_a.def.events.sensor && !both_fixed(body_a.kind, body_b.kind),
        (false, false) => {
            let moved = body_a.is_dynamic() || body_b.is_dynamic();
            moved && joined.binary_search(&(slot_a.min(slot_b), slot_a.max(slot_b))).is_err()
        }
    }
}

fn both_fixed(a: BodyKind, b: BodyKind) -> bool {
    a == BodyKind::Fixed && b == BodyKind::Fixed
}

/// Hints are found by the place of their contact, which is about to change.
pub(super) fn remember_hints(state: &State, scratch: &mut Scratch) {
    scratch.old_hints.clear();
    if scratch.hints.len() == state.contacts.len() {
        let pairs = state.contacts.iter().map(|contact| contact.shapes);
        scratch.old_hints.extend(pairs.zip(scratch.hints.iter().copied()));
    }
}

pub(super) fn recall_hints(state: &State, scratch: &mut Scratch) {
    let mut old = scratch.old_hints.iter().peekable();
    scratch.hints.clear();
    scratch.hints.extend(state.contacts.iter().map(|contact| {
        while old.next_if(|(pair, _)| *pair < contact.shapes).is_some() {}
        old.next_if(|(pair, _)| *pair == contact.shapes).map_or(AxisHint::default(), |(_, hint)| *hint)
    }));
}
