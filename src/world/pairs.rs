//! Which pairs of shapes a tick looks at: those whose fat boxes overlap, that may touch at all, and of which at
//! least one body is active. Everything else about a pair that is still near waits in `State::resting`.
//!
//! The contacts are a function of the state; what has moved only says where to look for changes.

use alloc::vec::Vec;

use super::scratch::{Changes, Scratch};
use super::state::State;
use crate::body::{BodyKind, Handle};
use crate::collision::{AxisHint, BroadPhase, Contact, Moved, Pair};

/// Brings the contacts in line with the fat boxes. Contacts of pairs that have parted go to `scratch.ended`.
pub(super) fn update(state: &mut State, scratch: &mut Scratch) {
    // Pairs that were left out come in as soon as there is room, whatever has made it.
    if !(scratch.changes.any() || state.pairs_left_out) {
        return;
    }
    refresh_joined(state, scratch);
    wake_resting(state, scratch);
    let left_out = find_new(state, scratch);
    exchange(state, scratch);
    keep_to_limit(state, scratch, left_out);
    scratch.surfaces_stale |= scratch.changes.everything || scratch.changes.rules;
    scratch.changes.settle(&scratch.broad_phase, state.shapes.slot_count());
}

/// Lists the contacts of bodies that have woken, or have begun to move, as fresh ones. Those that have parted although
/// nothing is active end: a sensor's, of a kinematic body that was moved by hand.
fn wake_resting(state: &mut State, scratch: &mut Scratch) {
    let Scratch { fresh, joined, ended, changes, .. } = scratch;
    fresh.clear();
    if state.resting.is_empty() || !(changes.everything || changes.resting) {
        return;
    }
    let mut resting = core::mem::take(&mut state.resting);
    resting.retain(|contact| {
        let (a, b) = state.bodies_of(contact.shapes);
        let near = is_near(state, joined, contact.shapes);
        let active = a.is_active() || b.is_active();
        if !near {
            ended.push(*contact);
        } else if active {
            fresh.push(*contact);
        }
        near && !active
    });
    state.resting = resting;
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

/// Lists a contact for every pair that may be new. Says whether any were left out.
fn find_new(state: &State, scratch: &mut Scratch) -> bool {
    let limit = state.config.pair_limit as usize;
    let Scratch { broad_phase, changes, pairs, joined, fresh, .. } = scratch;
    let everything = changes.everything || state.pairs_left_out;
    let moved = if everything { Moved::All } else { Moved::Slots(&changes.shapes) };
    let wanted = |pair: Pair| {
        if !everything && changes.has_seen(pair) {
            return false;
        }
        let (a, b) = state.bodies_of(pair);
        (a.is_active() || b.is_active()) && may_touch(state, joined, pair)
    };
    let left_out = broad_phase.pairs(moved, wanted, limit, pairs);
    let woken = fresh.len();
    for &pair in pairs.iter() {
        if fresh[..woken].binary_search_by_key(&pair, |contact| contact.shapes).is_err() {
            fresh.push(Contact::new(pair));
        }
    }
    fresh.sort_unstable_by_key(|contact| contact.shapes);
    left_out
}

/// What becomes of a contact.
enum Fate {
    Stays,
    /// Its boxes have parted, or its shapes may not touch any more.
    Ends,
    /// Nothing moves its bodies any more.
    Rests,
}

fn fate(state: &State, (boxes, changes, joined): (&BroadPhase, &Changes, &[Pair]), (a, b): Pair) -> Fate {
    let rules = changes.everything || changes.rules;
    let anywhere = rules || changes.resting || state.pairs_left_out;
    if !(anywhere || boxes.has_moved(a) || boxes.has_moved(b)) {
        return Fate::Stays;
    }
    if !boxes.fat(a).overlaps(boxes.fat(b)) || (rules && !may_touch(state, joined, (a, b))) {
        return Fate::Ends;
    }
    if !(anywhere || changes.is_new(a) || changes.is_new(b)) {
        // Only a box is another one.
        return Fate::Stays;
    }
    let (body_a, body_b) = state.bodies_of((a, b));
    if body_a.is_active() || body_b.is_active() { Fate::Stays } else { Fate::Rests }
}

/// Contacts with their hints, while places change.
#[derive(Clone, Debug, Default)]
pub(crate) struct Merged {
    pub(super) contacts: Vec<Contact>,
    hints: Vec<AxisHint>,
}

impl Merged {
    fn clear(&mut self) {
        self.contacts.clear();
        self.hints.clear();
    }

    fn push(&mut self, contact: Contact) {
        self.contacts.push(contact);
        self.hints.push(AxisHint::default());
    }
}

/// Puts the fresh contacts among the others, and takes out those that end or rest. What stays between two such places
/// is copied in one piece, with its hints.
fn exchange(state: &mut State, scratch: &mut Scratch) {
    scratch.hints.resize(state.contacts.len(), AxisHint::default());
    let Scratch { broad_phase, changes, joined, ended, fresh, merged, parked, hints, .. } = scratch;
    merged.clear();
    parked.clear();
    let contacts = &state.contacts;
    let mut fresh = fresh.iter().peekable();
    let mut copied = 0;
    let mut copy = |merged: &mut Merged, end: usize, next: usize| {
        merged.contacts.extend_from_slice(&contacts[copied..end]);
        merged.hints.extend_from_slice(&hints[copied..end]);
        copied = next;
    };
    for (index, contact) in contacts.iter().enumerate() {
        if fresh.peek().is_some_and(|fresh| fresh.shapes <= contact.shapes) {
            copy(merged, index, index);
            while let Some(fresh) = fresh.next_if(|fresh| fresh.shapes < contact.shapes) {
                merged.push(*fresh);
            }
            let _known_already = fresh.next_if(|fresh| fresh.shapes == contact.shapes);
        }
        let leaves = match fate(state, (broad_phase, changes, joined), contact.shapes) {
            Fate::Stays => continue,
            Fate::Ends => &mut *ended,
            Fate::Rests => &mut *parked,
        };
        leaves.push(*contact);
        copy(merged, index, index + 1);
    }
    copy(merged, contacts.len(), contacts.len());
    fresh.for_each(|fresh| merged.push(*fresh));
    core::mem::swap(&mut state.contacts, &mut merged.contacts);
    core::mem::swap(hints, &mut merged.hints);
    merge(&mut state.resting, parked, &mut merged.contacts);
}

/// Ends the contacts that are too many: those in the largest slots.
fn keep_to_limit(state: &mut State, scratch: &mut Scratch, left_out: bool) {
    let limit = state.config.pair_limit as usize;
    state.pairs_left_out = left_out || state.contacts.len() > limit;
    if state.contacts.len() > limit {
        scratch.ended.extend(state.contacts.drain(limit..));
        scratch.hints.truncate(limit);
    }
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
