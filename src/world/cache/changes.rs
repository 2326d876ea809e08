use alloc::vec::Vec;

use crate::body::{Body, Handle};
use crate::collision::{BroadPhase, Pair};
use crate::math::Aabb;

/// Repeated slots are tolerated while the list of changed shapes is shorter than this.
const COMPACT_MIN: usize = 4096;

/// Changes since the last pair update that may affect the set of pairs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes {
    /// Whether every pair may have changed, because the caches are new.
    everything: bool,
    /// Whether a sleeping contact may have ended, or one of its bodies may have become active.
    sleeping_contacts: bool,
    /// Whether all pairs have to be checked again, because filters, sensors, kinds, masses or joints have changed.
    rules: bool,
    /// Slots of shapes that may have new pairs, because their fat box, their body or its activity has changed. A slot
    /// may be listed twice.
    shapes: Vec<u32>,
    /// Length of `shapes` at which repeated slots are removed.
    compact_at: usize,
    /// Fat boxes at the last pair update, by shape slot. If the last boxes of two shapes overlap, the shapes are not a
    /// new pair. [`Aabb::NOWHERE`] marks a shape whose last box is unknown, or that may have new pairs although its box
    /// has not changed.
    last_boxes: Vec<Aabb>,
}

impl Changes {
    pub(crate) fn everything() -> Self {
        Changes { everything: true, ..Changes::default() }
    }

    pub(crate) fn any(&self) -> bool {
        self.everything || self.sleeping_contacts || self.rules || !self.shapes.is_empty()
    }

    pub(crate) fn all(&self) -> bool {
        self.everything
    }

    pub(crate) fn affects_sleeping_contacts(&self) -> bool {
        self.everything || self.sleeping_contacts
    }

    pub(crate) fn concerns_rules(&self) -> bool {
        self.everything || self.rules
    }

    pub(crate) fn shapes(&self) -> &[u32] {
        &self.shapes
    }

    /// Size in bytes of the list of shapes.
    pub(crate) fn list_bytes(&self) -> usize {
        size_of_val(&*self.shapes)
    }

    pub(crate) fn sleeping_contacts_changed(&mut self) {
        self.sleeping_contacts = true;
    }

    pub(crate) fn rules_changed(&mut self) {
        self.rules = true;
    }

    pub(crate) fn box_changed(&mut self, shape: u32) {
        self.shapes.push(shape);
    }

    /// Removes repeated slots if the list is long. Without this, edits between two ticks could lengthen the list
    /// without limit. Must not be called while a tick wakes islands by contact: `wake_touched` keeps an index into the
    /// list.
    pub(crate) fn compact(&mut self) {
        if self.shapes.len() >= self.compact_at.max(COMPACT_MIN) {
            self.shapes.sort_unstable();
            self.shapes.dedup();
            self.compact_at = 2 * self.shapes.len();
        }
    }

    /// Records that the shapes of a body may have new pairs even if their fat boxes have not changed.
    pub(crate) fn body_changed(&mut self, body: &Body) {
        for id in body.shapes() {
            self.shapes.push(id.slot());
            if let Some(last) = self.last_boxes.get_mut(id.slot() as usize) {
                *last = Aabb::NOWHERE;
            }
        }
    }

    pub(crate) fn is_new(&self, shape: u32) -> bool {
        self.last_boxes.get(shape as usize).is_none_or(|last| *last == Aabb::NOWHERE)
    }

    pub(crate) fn overlapped_before(&self, (a, b): Pair) -> bool {
        match (self.last_boxes.get(a as usize), self.last_boxes.get(b as usize)) {
            (Some(a), Some(b)) => a.overlaps(*b),
            _ => false,
        }
    }

    pub(crate) fn clear(&mut self, boxes: &BroadPhase, slot_count: usize) {
        self.last_boxes.resize(slot_count, Aabb::NOWHERE);
        if self.everything {
            self.last_boxes.iter_mut().zip(0..).for_each(|(last, slot)| *last = boxes.fat(slot));
        }
        for &slot in &self.shapes {
            self.last_boxes[slot as usize] = boxes.fat(slot);
        }
        (self.everything, self.sleeping_contacts, self.rules) = (false, false, false);
        self.shapes.clear();
    }

    /// Copies the recorded changes into `saved`, without the boxes of the last pair update.
    pub(crate) fn save_into(&self, saved: &mut Self) {
        let Changes { everything, sleeping_contacts, rules, shapes, compact_at: _, last_boxes: _ } = self;
        (saved.everything, saved.sleeping_contacts, saved.rules) = (*everything, *sleeping_contacts, *rules);
        saved.shapes.clone_from(shapes);
    }

    /// Restores the changes that a snapshot recorded. The state and the fat boxes of the snapshot must already be
    /// restored.
    pub(crate) fn restore(&mut self, saved: &Self, boxes: &BroadPhase, slot_count: usize) {
        let Changes { everything, sleeping_contacts, rules, shapes, compact_at: _, last_boxes } = self;
        (*everything, *sleeping_contacts, *rules) = (saved.everything, saved.sleeping_contacts, saved.rules);
        shapes.clone_from(&saved.shapes);
        last_boxes.clear();
        last_boxes.extend((0u32..).take(slot_count).map(|slot| boxes.fat(slot)));
        for &slot in shapes.iter() {
            if let Some(last) = last_boxes.get_mut(slot as usize) {
                *last = Aabb::NOWHERE;
            }
        }
    }
}
