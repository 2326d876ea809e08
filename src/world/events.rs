//! What happened in a tick. Events are not part of the state, but simulating a tick again gives them again.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::body::ShapeId;

/// Two shapes that began or ceased to touch. `shape_a` is the one in the smaller slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ContactEvent {
    /// One shape. It may be gone, if the contact ended by its removal.
    pub shape_a: ShapeId,
    /// The other shape.
    pub shape_b: ShapeId,
}

/// The events of the last tick. Each list is sorted by the handles of its shapes, A first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Pairs that came within [`super::Config::touching_distance`], or pushed each other since the last tick.
    pub contact_begin: Vec<ContactEvent>,
    /// Pairs that moved further apart than [`super::Config::speculative_distance`], or lost a shape. At the time of the event
    /// a removed shape's handle does not resolve any more.
    pub contact_end: Vec<ContactEvent>,
}

impl Events {
    pub(crate) fn clear(&mut self) {
        self.contact_begin.clear();
        self.contact_end.clear();
    }
}
