//! Record of the places where pairs may have begun or ended since the last pair update.

use alloc::vec::Vec;

use crate::body::{Body, Handle};
use crate::collision::{BroadPhase, Pair};
use crate::math::Aabb;

/// Record of what may have changed the set of pairs since the last pair update.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes {
    /// The caches are new: every pair may have changed.
    everything: bool,
    /// A sleeping contact may have an active body again, or may have ended.
    sleeping_contacts: bool,
    /// Filters, sensors, kinds, masses or joints have changed: all pairs have to be checked again for permission to
    /// collide.
    rules: bool,
    /// Slots of shapes that may have new pairs: their fat box is new, their body was edited or has become active or
    /// inactive, or the joints of their body have changed. A slot may be listed twice.
    shapes: Vec<u32>,
    /// Fat box of each shape at the last pair update. Two shapes whose boxes overlapped then are not a new pair.
    /// [`Aabb::NOWHERE`] if the shape may have new pairs for a reason other than a new fat box, or if its box at that
    /// time is not known.
    last_boxes: Vec<Aabb>,
}

impl Changes {
    /// Record for new caches: every pair has to be found.
    pub(crate) fn everything() -> Self {
        Changes { everything: true, ..Changes::default() }
    }

    /// Whether anything is recorded.
    pub(crate) fn any(&self) -> bool {
        self.everything || self.sleeping_contacts || self.rules || !self.shapes.is_empty()
    }

    /// Whether the caches are new.
    pub(crate) fn all(&self) -> bool {
        self.everything
    }

    /// Whether sleeping contacts have to be checked.
    pub(crate) fn affects_sleeping_contacts(&self) -> bool {
        self.everything || self.sleeping_contacts
    }

    /// Whether all pairs have to be checked again for permission to collide.
    pub(crate) fn concerns_rules(&self) -> bool {
        self.everything || self.rules
    }

    /// Slots of shapes that may have new pairs: their fat box is new, their body was edited or has become active or
    /// inactive, or the joints of their body have changed. A slot may be listed twice.
    pub(crate) fn shapes(&self) -> &[u32] {
        &self.shapes
    }

    /// Size in bytes of the list of shapes, the only memory of a saved record outside of its struct.
    pub(crate) fn list_bytes(&self) -> usize {
        size_of_val(&*self.shapes)
    }

    /// Records that sleeping contacts may have ended or may have an active body again.
    pub(crate) fn sleeping_contacts_changed(&mut self) {
        self.sleeping_contacts = true;
    }

    /// Records that filters, sensors, kinds, masses or joints have changed.
    pub(crate) fn rules_changed(&mut self) {
        self.rules = true;
    }

    /// Records a new fat box.
    pub(crate) fn box_changed(&mut self, shape: u32) {
        self.shapes.push(shape);
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

    /// Whether a shape may have new pairs for a reason other than a new fat box.
    pub(crate) fn is_new(&self, shape: u32) -> bool {
        self.last_boxes.get(shape as usize).is_none_or(|last| *last == Aabb::NOWHERE)
    }

    /// Whether the fat boxes of two shapes overlapped at the last pair update.
    pub(crate) fn overlapped_before(&self, (a, b): Pair) -> bool {
        match (self.last_boxes.get(a as usize), self.last_boxes.get(b as usize)) {
            (Some(a), Some(b)) => a.overlaps(*b),
            _ => false,
        }
    }

    /// Empties the record after a pair update.
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

    /// Copies the record into a snapshot, without the boxes of the last pair update.
    pub(crate) fn save_into(&self, saved: &mut Self) {
        let Changes { everything, sleeping_contacts, rules, shapes, last_boxes: _ } = self;
        (saved.everything, saved.sleeping_contacts, saved.rules) = (*everything, *sleeping_contacts, *rules);
        saved.shapes.clone_from(shapes);
    }

    /// Restores the record from a snapshot whose state has just been restored.
    pub(crate) fn restore(&mut self, saved: &Self, boxes: &BroadPhase, slot_count: usize) {
        let Changes { everything, sleeping_contacts, rules, shapes, last_boxes } = self;
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
