use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::config::Config;
use super::events::ContactEvent;
use super::snapshot::SleepingContacts;
use crate::body::{Arena, Body, BodyId, Handle, IslandId, JointId, Shape, ShapeId};
use crate::collision::{Contact, Pair};
use crate::fx;
use crate::math::{Fx, Rng, fx_div};
use crate::solver::Joint;

/// Bodies that fell asleep together and wake together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Island {
    /// Slots of the bodies, sorted.
    pub(crate) bodies: Vec<u32>,
}

/// A pair of shapes, in the form in which events report it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct Reported {
    pub(crate) shapes: ContactEvent,
    /// Which shapes are sensors: see [`State::sensor_of`].
    pub(crate) sensor: Option<Side>,
}

/// The shape of a pair that is a sensor, or both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum Side {
    A,
    B,
    Both,
}

/// All state that influences later ticks, and the names and numbers that games store with objects. The code of
/// snapshots and hashes destructures `State` without `..`, so a new field causes compile errors until it is saved and
/// hashed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    pub(crate) config: Config,
    pub(crate) tick: u64,
    pub(crate) faults: u64,
    pub(crate) bodies: Arena<Body, BodyId>,
    pub(crate) shapes: Arena<Shape, ShapeId>,
    pub(crate) joints: Arena<Joint, JointId>,
    pub(crate) islands: Arena<Island, IslandId>,
    /// Contacts with an active body, sorted by pair.
    pub(crate) contacts: Vec<Contact>,
    /// Contacts without an active body, sorted by pair. A tick does not process them.
    pub(crate) sleeping_contacts: SleepingContacts,
    /// Whether there were more pairs than [`Config::pair_limit`] at the last pair update.
    pub(crate) pairs_left_out: bool,
    /// Contacts that edits since the last tick have ended or whose events they have switched, for the events of the next
    /// tick. A pair of solid shapes that is listed twice, because it was switched off and on, has no event.
    pub(crate) edited_contacts: Vec<Reported>,
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
            sleeping_contacts: SleepingContacts::default(),
            pairs_left_out: false,
            edited_contacts: Vec::new(),
            rng: Rng::new(0),
        }
    }

    /// Gives the page caches the size of the arenas. Must be called once for each new or decoded state.
    pub(crate) fn keep_pages(&mut self) {
        self.bodies.keep_pages();
        self.shapes.keep_pages();
        self.joints.keep_pages();
        self.islands.keep_pages();
    }

    /// The bodies of the shapes in two slots, which must be occupied.
    pub(crate) fn bodies_of(&self, (a, b): Pair) -> (&Body, &Body) {
        (self.body_of(a), self.body_of(b))
    }

    /// Drops the kept manifolds of a body's contacts, because its shapes, its pose or its centre of mass change.
    pub(crate) fn end_manifolds(&mut self, body: u32) {
        let shapes = &self.shapes;
        let is_own = |shape: u32| shapes.get_slot(shape).is_some_and(|shape| shape.body().slot() == body);
        let has_own = |contact: &Contact| is_own(contact.shapes.0) || is_own(contact.shapes.1);
        let end = |contacts: &mut [Contact]| {
            contacts.iter_mut().filter(|contact| has_own(contact)).for_each(|contact| contact.kept.end());
        };
        end(&mut self.contacts);
        // Contacts of bodies that were woken since the last tick are still in `sleeping_contacts`. The list is searched
        // before it is borrowed mutably, because a mutable borrow drops its packed form.
        if self.sleeping_contacts.iter().any(has_own) {
            end(&mut self.sleeping_contacts);
        }
    }

    /// The reduced mass of the bodies of a pair in kg: `mA mB / (mA + mB)`. A body without mass counts as infinitely
    /// heavy. 0 if neither body has mass.
    pub(crate) fn reduced_mass(&self, shapes: Pair) -> Fx {
        let (a, b) = self.bodies_of(shapes);
        match (a.has_mass(), b.has_mass()) {
            (true, true) => {
                let (light, heavy) = (a.mass().min(b.mass()), a.mass().max(b.mass()));
                let ratio = fx_div(light, heavy).unwrap_or_default();
                fx_div(light, ratio + fx!(1)).unwrap_or_default()
            }
            (true, false) => a.mass(),
            (false, true) => b.mass(),
            (false, false) => Fx::ZERO,
        }
    }

    /// The body of the shape in a slot, which must be occupied.
    pub(crate) fn body_of(&self, shape: u32) -> &Body {
        self.bodies.at(self.shapes.at(shape).body().slot())
    }

    /// Which shapes of a pair are sensors; `None` if both are solid. If both are sensors, the result is those that
    /// detect the other. The pair must be allowed to have a contact, so that at least one does.
    pub(crate) fn sensor_of(&self, (a, b): Pair) -> Option<Side> {
        let (a, b) = (self.shapes.at(a), self.shapes.at(b));
        match (a.is_sensor(), b.is_sensor()) {
            (true, false) => Some(Side::A),
            (false, true) => Some(Side::B),
            (false, false) => None,
            (true, true) => match (a.detects(b), b.detects(a)) {
                (true, true) => Some(Side::Both),
                (false, true) => Some(Side::B),
                (_, false) => Some(Side::A),
            },
        }
    }

    /// Whether one shape of a pair is an area that acts on the other.
    pub(crate) fn has_area(&self, (a, b): Pair) -> bool {
        let (a, b) = (self.shapes.at(a), self.shapes.at(b));
        a.acts_on(b) || b.acts_on(a)
    }

    /// Whether a pair may exert forces on its bodies: both shapes are solid, or one is an area that acts on the other.
    pub(crate) fn supports(&self, pair: Pair) -> bool {
        self.sensor_of(pair).is_none() || self.has_area(pair)
    }

    /// The pair in the form in which events report it; `None` if no shape of it is a sensor or has contact events.
    pub(crate) fn reported(&self, contact: &Contact) -> Option<Reported> {
        let (a, b) = contact.shapes;
        let sensor = self.sensor_of(contact.shapes);
        let has_events =
            sensor.is_some() || self.shapes.at(a).def.events.contact || self.shapes.at(b).def.events.contact;
        has_events.then(|| Reported { shapes: self.contact_event(contact), sensor })
    }

    pub(crate) fn contact_event(&self, contact: &Contact) -> ContactEvent {
        let (a, b) = contact.shapes;
        ContactEvent { shape_a: self.shapes.handle_at(a), shape_b: self.shapes.handle_at(b) }
    }
}
