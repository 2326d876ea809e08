//! The bodies of a tick: those that something moves, and one more that stands for all others.

use alloc::vec::Vec;

use super::body::SolverBody;
use super::colour::{Node, Size};
use crate::body::{Arena, Body, BodyId};

/// The index of the body that stands for all those that nothing moves. Their mass fraction is 0, so that it never
/// changes.
pub(super) const GROUND: u32 = 0;

/// Bodies in the order of their slots, after the ground.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyList {
    pub(super) bodies: Vec<SolverBody>,
    /// For each body slot, where its body is in `bodies`: 0 if nothing moves it.
    indices: Vec<u32>,
    /// The slots that have an index.
    slots: Vec<u32>,
}

impl BodyList {
    /// Starts anew with the bodies in the given slots.
    pub(super) fn fill(&mut self, bodies: &Arena<Body, BodyId>, slots: &[u32]) {
        for &slot in &self.slots {
            self.indices[slot as usize] = GROUND;
        }
        self.indices.resize(bodies.slot_count(), GROUND);
        self.slots.clear();
        self.bodies.clear();
        self.bodies.push(SolverBody::default());
        for &slot in slots {
            self.push(slot, SolverBody::of(bodies.at(slot)));
        }
    }

    fn push(&mut self, slot: u32, body: SolverBody) {
        self.indices[slot as usize] = u32::try_from(self.bodies.len()).expect("fewer than 2^32 bodies");
        self.slots.push(slot);
        self.bodies.push(body);
    }

    pub(super) fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Where the body of a slot is, from 1; 0 if nothing moves it.
    pub(super) fn index_of(&self, slot: u32) -> u32 {
        self.indices[slot as usize]
    }

    /// The same for a body with a joint: it does not share the ground's place, because joints see how it is turned.
    pub(super) fn own_index_of(&mut self, slot: u32) -> u32 {
        if self.index_of(slot) == GROUND {
            self.push(slot, SolverBody::default());
        }
        self.index_of(slot)
    }

    /// The body of a slot.
    pub(super) fn body(&self, slot: u32) -> &SolverBody {
        &self.bodies[self.index_of(slot) as usize]
    }

    /// A constraint between the bodies of two slots, to be coloured.
    pub(super) fn node(&self, key: u64, bodies: &Arena<Body, BodyId>, (a, b): (u32, u32), size: Size) -> Node {
        let dynamic = |slot: u32| bodies.at(slot).is_dynamic().then(|| self.index_of(slot));
        Node { key, body_a: dynamic(a), body_b: dynamic(b), size }
    }
}
