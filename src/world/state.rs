//! The state: everything that influences the future, and nothing else.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::config::Config;
use super::events::ContactEvent;
use crate::body::{Arena, Body, BodyId, JointId, Shape, ShapeId};
use crate::collision::Contact;
use crate::math::Rng;
use crate::solver::Joint;

/// Everything that influences the future. It derives its encoding, so that a new field is in the hash, in
/// snapshots and in files without anyone having to remember it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    pub(crate) config: Config,
    /// Ticks since the world was made.
    pub(crate) tick: u64,
    /// How often a clamp has changed a result; see [`super::World::faults`].
    pub(crate) faults: u64,
    pub(crate) bodies: Arena<Body, BodyId>,
    pub(crate) shapes: Arena<Shape, ShapeId>,
    pub(crate) joints: Arena<Joint, JointId>,
    /// Sorted by pair.
    pub(crate) contacts: Vec<Contact>,
    /// Whether there are more pairs than [`Config::pair_limit`].
    pub(crate) pairs_left_out: bool,
    /// Contacts that ended because a shape was removed since the last tick, for the events of the next one.
    pub(crate) removed_contacts: Vec<ContactEvent>,
    pub(crate) rng: Rng,
}

impl State {
    pub(crate) fn new(config: Config) -> Self {
        State {
            config,
            tick: 0,
            faults: 0,
            bodies: Arena::default(),
            shapes: Arena::default(),
            joints: Arena::default(),
            contacts: Vec::new(),
            pairs_left_out: false,
            removed_contacts: Vec::new(),
            rng: Rng::new(0),
        }
    }

    /// The event of a contact between two occupied shape slots.
    pub(crate) fn contact_event(&self, contact: &Contact) -> ContactEvent {
        let (a, b) = contact.shapes;
        ContactEvent { shape_a: self.shapes.handle_at(a), shape_b: self.shapes.handle_at(b) }
    }
}
