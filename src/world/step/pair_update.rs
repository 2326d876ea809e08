//! Pair update: adds and removes contacts so that they match the overlaps of fat boxes.
//!
//! A pair of shapes has a contact if their fat boxes overlap and [`NonCollidingPairs::may_touch`] accepts the pair. If
//! at least one of the two bodies is active, the contact is in `State::contacts`, whose length is at most the pair
//! limit. Otherwise it is in `State::sleeping_contacts`. The result depends only on the state.
//! [`Changes`](crate::world::cache::Changes) does not affect it: it only tells where contacts may have to be added or
//! removed.

use crate::collision::{Contact, Moved, Pair};
use crate::world::cache::{Changes, MergedContacts, NonCollidingPairs, Scratch, ShapeCache, merge_sorted};
use crate::world::state::State;

pub(super) fn update_pairs(state: &mut State, scratch: &mut Scratch) {
    // Needed even if there are no changes, because a restore may have replaced the joints.
    scratch.pairs.non_colliding.refresh(state);
    // If pairs were left out at the limit, the update runs even without changes: there may be room for them now.
    if !(scratch.pairs.changes.any() || state.pairs_left_out) {
        return;
    }
    activate_sleeping_contacts(state, scratch);
    let left_out = find_new(state, scratch);
    merge_contacts(state, scratch);
    keep_to_limit(state, scratch, left_out);
    let Scratch { pairs, contacts, shapes, .. } = scratch;
    if pairs.changes.concerns_rules() {
        contacts.invalidate_surfaces();
    }
    pairs.changes.clear(shapes.broad_phase(), state.shapes.slot_count());
}

/// Moves sleeping contacts whose pair now has an active body to the fresh contacts. Ends sleeping contacts whose shapes
/// may no longer collide or overlap, for example after an edit has moved a kinematic body with a sensor.
fn activate_sleeping_contacts(state: &mut State, scratch: &mut Scratch) {
    let pairs = &mut scratch.pairs;
    pairs.buffers.fresh.clear();
    if state.sleeping_contacts.is_empty() || !pairs.changes.affects_sleeping_contacts() {
        return;
    }
    scratch.meter.spend_visit(&state.sleeping_contacts);
    let mut sleeping_contacts = core::mem::take(&mut state.sleeping_contacts);
    sleeping_contacts.retain(|contact| {
        let (a, b) = contact.shapes;
        let (body_a, body_b) = state.bodies_of(contact.shapes);
        let overlaps = state.shapes.at(a).fat.overlaps(state.shapes.at(b).fat);
        let is_near = overlaps && pairs.non_colliding.may_touch(state, contact.shapes);
        let is_active = body_a.is_active() || body_b.is_active();
        if !is_near {
            pairs.ended.push(*contact);
        } else if is_active {
            pairs.buffers.fresh.push(*contact);
        }
        is_near && !is_active
    });
    state.sleeping_contacts = sleeping_contacts;
}

/// Adds a contact to the fresh contacts for each pair that may be new. Returns whether the limit left pairs out.
fn find_new(state: &State, scratch: &mut Scratch) -> bool {
    let limit = state.config.pair_limit as usize;
    let Scratch { shapes, pairs: cache, meter, .. } = scratch;
    let (changes, non_colliding) = (&cache.changes, &cache.non_colliding);
    let (pairs, fresh) = (&mut cache.buffers.pairs, &mut cache.buffers.fresh);
    let everything = changes.all() || state.pairs_left_out;
    let moved = if everything { Moved::All } else { Moved::Slots(changes.shapes()) };
    let accept = |pair: Pair| {
        if !everything && changes.overlapped_before(pair) {
            return false;
        }
        let (a, b) = state.bodies_of(pair);
        (a.is_active() || b.is_active()) && non_colliding.may_touch(state, pair)
    };
    let activated = fresh.len();
    let known = state.contacts.len() + activated;
    let left_out = shapes.find_pairs(moved, accept, limit, pairs, known, meter);
    for &pair in pairs.iter() {
        if fresh[..activated].binary_search_by_key(&pair, |contact| contact.shapes).is_err() {
            fresh.push(Contact::new(pair));
        }
    }
    fresh.sort_unstable_by_key(|contact| contact.shapes);
    left_out
}

enum PairChange {
    Stays,
    /// The fat boxes of the pair do not overlap, or its shapes may not collide.
    Ends,
    /// Neither body of the pair is active.
    Rests,
}

impl PairChange {
    fn of(
        pair: Pair,
        state: &State,
        shapes: &ShapeCache,
        changes: &Changes,
        non_colliding: &NonCollidingPairs,
    ) -> Self {
        let (a, b) = pair;
        let boxes = shapes.broad_phase();
        let rules = changes.concerns_rules();
        let anywhere = rules || changes.affects_sleeping_contacts() || state.pairs_left_out;
        if !(anywhere || boxes.has_moved(a) || boxes.has_moved(b)) {
            return PairChange::Stays;
        }
        if !boxes.fat(a).overlaps(boxes.fat(b)) || (rules && !non_colliding.may_touch(state, pair)) {
            return PairChange::Ends;
        }
        if !(anywhere || changes.is_new(a) || changes.is_new(b)) {
            return PairChange::Stays;
        }
        let (body_a, body_b) = state.bodies_of(pair);
        if body_a.is_active() || body_b.is_active() { PairChange::Stays } else { PairChange::Rests }
    }
}

/// Adds the fresh contacts, and removes contacts that end or fall asleep. Copies the contacts between two changes as
/// one block, with their cached axes.
fn merge_contacts(state: &mut State, scratch: &mut Scratch) {
    let Scratch { shapes, pairs, contacts: cache, .. } = scratch;
    let axes = cache.axes(state.contacts.len());
    let (changes, non_colliding, ended) = (&pairs.changes, &pairs.non_colliding, &mut pairs.ended);
    let (merged, sleeping_contacts) = (&mut pairs.buffers.merged, &mut pairs.buffers.sleeping_contacts);
    merged.clear();
    sleeping_contacts.clear();
    let contacts = &state.contacts;
    let mut fresh = pairs.buffers.fresh.iter().peekable();
    let mut copied = 0;
    let mut copy = |merged: &mut MergedContacts, end: usize, next: usize| {
        merged.contacts.extend_from_slice(&contacts[copied..end]);
        merged.axes.extend_from_slice(&axes[copied..end]);
        copied = next;
    };
    for (index, contact) in contacts.iter().enumerate() {
        if fresh.peek().is_some_and(|fresh| fresh.shapes <= contact.shapes) {
            copy(merged, index, index);
            while let Some(fresh) = fresh.next_if(|fresh| fresh.shapes < contact.shapes) {
                merged.push(*fresh);
            }
            let _exists_already = fresh.next_if(|fresh| fresh.shapes == contact.shapes);
        }
        let removed = match PairChange::of(contact.shapes, state, shapes, changes, non_colliding) {
            PairChange::Stays => continue,
            PairChange::Ends => &mut *ended,
            PairChange::Rests => &mut *sleeping_contacts,
        };
        removed.push(*contact);
        copy(merged, index, index + 1);
    }
    copy(merged, contacts.len(), contacts.len());
    fresh.for_each(|fresh| merged.push(*fresh));
    core::mem::swap(&mut state.contacts, &mut merged.contacts);
    core::mem::swap(axes, &mut merged.axes);
    if !sleeping_contacts.is_empty() {
        merge_sorted(&mut state.sleeping_contacts, sleeping_contacts, &mut merged.contacts);
    }
}

/// Ends the contacts beyond the limit. Contacts are sorted by the slots of their shapes, so those with the largest
/// slots end.
fn keep_to_limit(state: &mut State, scratch: &mut Scratch, left_out: bool) {
    let limit = state.config.pair_limit as usize;
    state.pairs_left_out = left_out || state.contacts.len() > limit;
    if state.contacts.len() > limit {
        scratch.pairs.ended.extend(state.contacts.drain(limit..));
    }
}
