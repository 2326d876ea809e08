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
    if scratch.hints.len() != state.contacts.len() {
        scratch.hints.clear();
        scratch.hints.resize(state.contacts.len(), AxisHint::default());
    }
    refresh_joined(state, scratch);
    wake_resting(state, scratch);
    drop_parted(state, scratch);
    find_new(state, scratch);
    scratch.surfaces_stale |= scratch.changes.everything || scratch.changes.rules;
    scratch.changes.clear();
}

/// Contacts of bodies that have woken, or have begun to move, are looked at again, and so are those that end
/// although nothing is active: a sensor's, of a kinematic body that was moved by hand.
fn wake_resting(state: &mut State, scratch: &mut Scratch) {
    if state.resting.is_empty() || !(scratch.changes.everything || scratch.changes.resting) {
        return;
    }
    let mut resting = core::mem::take(&mut state.resting);
    let Scratch { fresh: woken, joined, hints, .. } = scratch;
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
    insert(&mut state.contacts, hints, woken);
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
    let Scratch { ended, fresh, changes, changed, joined, hints, .. } = scratch;
    fresh.clear();
    let any = changes.everything || changes.rules;
    changed.resize(state.shapes.slot_count(), false);
    changes.shapes.iter().for_each(|&slot| changed[slot as usize] = true);
    let mut kept = 0;
    for index in 0..contacts.len() {
        let contact = contacts[index];
        let (a, b) = contact.shapes;
        if any || changed[a as usize] || changed[b as usize] {
            let near = state.shapes.at(a).fat.overlaps(state.shapes.at(b).fat)
                && (!any || may_touch(state, joined, contact.shapes));
            let (body_a, body_b) = state.bodies_of(contact.shapes);
            if !near {
                ended.push(contact);
                continue;
            }
            if !(body_a.is_active() || body_b.is_active()) {
                fresh.push(contact);
                continue;
            }
        }
        if kept < index {
            contacts[kept] = contact;
            hints[kept] = hints[index];
        }
        kept += 1;
    }
    contacts.truncate(kept);
    hints.truncate(kept);
    changes.shapes.iter().for_each(|&slot| changed[slot as usize] = false);
    state.contacts = contacts;
    merge(&mut state.resting, fresh, |_, _| {});
}

/// Adds a contact for every new pair.
fn find_new(state: &mut State, scratch: &mut Scratch) {
    let limit = state.config.pair_limit as usize;
    let Scratch { broad_phase, changes, pairs, joined, fresh, hints, .. } = scratch;
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
    insert(&mut state.contacts, hints, fresh);
    if state.contacts.len() > limit {
        scratch.ended.extend(state.contacts.drain(limit..));
        hints.truncate(limit);
        left_out = true;
    }
    state.pairs_left_out = left_out;
}

/// Merges contacts into a list that has hints.
fn insert(contacts: &mut Vec<Contact>, hints: &mut Vec<AxisHint>, new: &[Contact]) {
    hints.resize(contacts.len() + new.len(), AxisHint::default());
    merge(contacts, new, |to, from| hints[to] = from.map_or(AxisHint::default(), |from| hints[from]));
}

/// Merges contacts into a list, both sorted by pair and without a pair in common, from the back: what comes before the
/// first of them stays. `placed` is told which place has been taken, and from where in the old list unless it is a new
/// contact's.
pub(super) fn merge(
    contacts: &mut Vec<Contact>,
    new: &[Contact],
    mut placed: impl FnMut(usize, Option<usize>),
) {
    let mut from = contacts.len();
    contacts.extend_from_slice(new);
    let mut to = contacts.len();
    for contact in new.iter().rev() {
        while from > 0 && contacts[from - 1].shapes > contact.shapes {
            (from, to) = (from - 1, to - 1);
            contacts[to] = contacts[from];
            placed(to, Some(from));
        }
        to -= 1;
        contacts[to] = *contact;
        placed(to, None);
    }
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
