//! The state: everything that influences the future, and nothing else.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::config::Config;
use super::events::ContactEvent;
use super::rollback::Resting;
use crate::body::{Arena, Body, BodyId, Handle, IslandId, JointId, Shape, ShapeId};
use crate::collision::{Contact, Pair};
use crate::math::Rng;
use crate::solver::Joint;

/// Bodies that fell asleep together and wake together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Island {
    /// Body slots, sorted.
    pub(crate) bodies: Vec<u32>,
}

/// A pair of shapes as events name it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reported {
    pub(crate) shapes: ContactEvent,
    /// Which of its shapes is a sensor.
    pub(crate) sensor: Option<Side>,
}

/// One of the two shapes of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Side {
    A,
    B,
}

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
    /// What sleeps, and together with what.
    pub(crate) islands: Arena<Island, IslandId>,
    /// Near pairs of which a body is active, sorted by pair.
    pub(crate) contacts: Vec<Contact>,
    /// Contacts that a tick does not look at, because their bodies sleep or nothing moves them, sorted by pair.
    pub(crate) resting: Resting,
    /// Whether there are more pairs than [`Config::pair_limit`].
    pub(crate) pairs_left_out: bool,
    /// Contacts that ended because a shape was removed since the last tick, for the events of the next one.
    pub(crate) removed_contacts: Vec<Reported>,
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
            islands: Arena::default(),
            contacts: Vec::new(),
            resting: Resting::default(),
            pairs_left_out: false,
            removed_contacts: Vec::new(),
            rng: Rng::new(0),
        }
    }

    /// Makes room for the copies that snapshots share, after it has been decoded.
    pub(crate) fn keep_pages(&mut self) {
        self.bodies.keep_pages();
        self.shapes.keep_pages();
        self.joints.keep_pages();
        self.islands.keep_pages();
    }

    /// The bodies of a pair of shapes.
    pub(crate) fn bodies_of(&self, (a, b): Pair) -> (&Body, &Body) {
        (self.body_of(a), self.body_of(b))
    }

    /// The body of an occupied shape slot.
    pub(crate) fn body_of(&self, shape: u32) -> &Body {
        self.bodies.at(self.shapes.at(shape).body().slot())
    }

    /// Which shape of a pair is a sensor, if any.
    pub(crate) fn sensor_of(&self, (a, b): Pair) -> Option<Side> {
        match (self.shapes.at(a).is_sensor(), self.shapes.at(b).is_sensor()) {
            (true, _) => Some(Side::A),
            (false, true) => Some(Side::B),
            (false, false) => None,
        }
    }

    /// A contact as events name it, if its shapes take part in them.
    pub(crate) fn reported(&self, contact: &Contact) -> Option<Reported> {
        let (a, b) = contact.shapes;
        let sensor = self.sensor_of(contact.shapes);
        let wanted =
            sensor.is_some() || self.shapes.at(a).def.events.contact || self.shapes.at(b).def.events.contact;
        wanted.then(|| Reported { shapes: self.contact_event(contact), sensor })
    }

    /// The event of a contact between two occupied shape slots.
    pub(crate) fn contact_event(&self, contact: &Contact) -> ContactEvent {
        let (a, b) = contact.shapes;
        ContactEvent { shape_a: self.shapes.handle_at(a), shape_b: self.shapes.handle_at(b) }
    }
}
