use alloc::vec::Vec;

use super::changes::Changes;
use crate::body::{BodyKind, Handle};
use crate::collision::{CachedAxis, Contact, Pair};
use crate::solver::Joint;
use crate::world::state::State;

#[derive(Clone, Debug)]
pub(crate) struct PairCache {
    pub(crate) changes: Changes,
    pub(crate) non_colliding: NonCollidingPairs,
    /// Contacts that have ended since contact events were last reported.
    pub(crate) ended: Vec<Contact>,
    pub(crate) buffers: PairBuffers,
}

impl PairCache {
    pub(crate) fn new() -> Self {
        PairCache {
            changes: Changes::everything(),
            non_colliding: NonCollidingPairs::default(),
            ended: Vec::new(),
            buffers: PairBuffers::default(),
        }
    }
}

/// Lists that are filled and read within one operation.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairBuffers {
    pub(crate) pairs: Vec<Pair>,
    /// Contacts to add to the active contacts.
    pub(crate) fresh: Vec<Contact>,
    /// Contacts to add to the sleeping contacts.
    pub(crate) sleeping_contacts: Vec<Contact>,
    pub(crate) merged: MergedContacts,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct MergedContacts {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) axes: Vec<CachedAxis>,
}

impl MergedContacts {
    pub(crate) fn clear(&mut self) {
        self.contacts.clear();
        self.axes.clear();
    }

    pub(crate) fn push(&mut self, contact: Contact) {
        self.contacts.push(contact);
        self.axes.push(CachedAxis::default());
    }
}

/// Merges two lists that are sorted by pair and have no pair in common.
pub(crate) fn merge_sorted(contacts: &mut Vec<Contact>, new: &[Contact], buffer: &mut Vec<Contact>) {
    if new.is_empty() {
        return;
    }
    buffer.clear();
    buffer.reserve(contacts.len() + new.len());
    let mut old = contacts.iter().copied().peekable();
    for contact in new {
        while let Some(before) = old.next_if(|old| old.shapes < contact.shapes) {
            buffer.push(before);
        }
        buffer.push(*contact);
    }
    buffer.extend(old);
    core::mem::swap(contacts, buffer);
}

/// Pairs of bodies that a joint keeps from colliding.
#[derive(Clone, Debug, Default)]
pub(crate) struct NonCollidingPairs {
    /// Body slots, the smaller one first, sorted.
    pairs: Vec<Pair>,
    is_current: bool,
}

impl NonCollidingPairs {
    /// Called when a joint was added, removed or redefined.
    pub(crate) fn invalidate(&mut self) {
        self.is_current = false;
    }

    pub(crate) fn refresh(&mut self, state: &State) {
        if core::mem::replace(&mut self.is_current, true) {
            return;
        }
        let keeps_apart = |joint: &Joint| joint.def.enabled && !joint.def.collide_connected;
        let keeping_apart = state.joints.iter().filter(|(_, joint)| keeps_apart(joint));
        self.pairs.clear();
        self.pairs.extend(keeping_apart.map(|(_, joint)| {
            let (a, b) = joint.def().bodies();
            (a.slot().min(b.slot()), a.slot().max(b.slot()))
        }));
        self.pairs.sort_unstable();
    }

    /// Whether two shapes may have a contact. They need different, enabled bodies and filters that accept each other.
    /// If there is a sensor, one shape must detect the other, and at least one body must not be fixed. Otherwise at
    /// least one body must have mass, and no joint may keep the bodies from colliding.
    pub(crate) fn may_touch(&self, state: &State, (a, b): Pair) -> bool {
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
            (true, _) | (_, true) => {
                let detected = shape_a.detects(shape_b) || shape_b.detects(shape_a);
                detected && !both_fixed(body_a.kind, body_b.kind)
            }
            (false, false) => {
                let can_move = body_a.has_mass() || body_b.has_mass();
                can_move && self.pairs.binary_search(&(slot_a.min(slot_b), slot_a.max(slot_b))).is_err()
            }
        }
    }
}

fn both_fixed(a: BodyKind, b: BodyKind) -> bool {
    a == BodyKind::Fixed && b == BodyKind::Fixed
}
