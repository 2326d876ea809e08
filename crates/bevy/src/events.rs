//! Events of the simulation as Bevy messages, and for observers.
//!
//! With rollback a tick may be played several times. A [`ConfirmedEvent`] is sent once, when its tick is final. All
//! peers have the same confirmed events in the same order. A peer that joins late starts from a received state, and
//! lacks the events of earlier ticks. A [`PredictedEvent`] is sent when an event first occurs in a played tick, for
//! sounds and particles. A [`RetractedEvent`] follows if a rollback removes the event. A local game and a replay send
//! predicted and confirmed events in the same frame.

use bevy::prelude::{Entity, EntityEvent, Message};
use lockstep2d::body::{BodyId, ShapeId};
use lockstep2d::peer::PeerEvent;
use lockstep2d::world::{ContactEvent, HitEvent, JointEvent, SensorChange, SensorEvent, World};

/// An event of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorldEvent {
    /// Two shapes began to touch.
    ContactBegin(ContactEvent),
    /// Two shapes ceased to touch.
    ContactEnd(ContactEvent),
    /// Two shapes hit each other at [`Config::hit_speed`](lockstep2d::world::Config::hit_speed) or faster.
    Hit(HitEvent),
    /// A shape entered a sensor.
    SensorBegin(SensorEvent),
    /// A shape left a sensor.
    SensorEnd(SensorEvent),
    /// A joint exceeded its threshold, or broke.
    Joint(JointEvent),
    /// A body fell asleep.
    FellAsleep(BodyId),
}

impl WorldEvent {
    /// The two shapes of a contact, a hit or a sensor: A and B, or the sensor and the visitor.
    #[must_use]
    pub const fn shapes(&self) -> Option<[ShapeId; 2]> {
        match self {
            WorldEvent::ContactBegin(contact) | WorldEvent::ContactEnd(contact) => Some(contact.shapes()),
            WorldEvent::Hit(hit) => Some(hit.shapes()),
            WorldEvent::SensorBegin(event) | WorldEvent::SensorEnd(event) => {
                Some([event.sensor, event.visitor])
            }
            WorldEvent::Joint(_) | WorldEvent::FellAsleep(_) => None,
        }
    }

    /// Whether both events have the same kind, and the same shapes, joint or body. Numbers such as a speed may differ.
    fn is_alike(&self, other: &Self) -> bool {
        match (self, other) {
            (WorldEvent::ContactBegin(a), WorldEvent::ContactBegin(b))
            | (WorldEvent::ContactEnd(a), WorldEvent::ContactEnd(b)) => a == b,
            (WorldEvent::Hit(_), WorldEvent::Hit(_))
            | (WorldEvent::SensorBegin(_), WorldEvent::SensorBegin(_))
            | (WorldEvent::SensorEnd(_), WorldEvent::SensorEnd(_)) => self.shapes() == other.shapes(),
            (WorldEvent::Joint(a), WorldEvent::Joint(b)) => a.joint == b.joint && a.broke == b.broke,
            (WorldEvent::FellAsleep(a), WorldEvent::FellAsleep(b)) => a == b,
            _ => false,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LoggedEvent {
    /// Number of ticks played, including the tick of the event.
    pub(crate) tick: u64,
    pub(crate) event: WorldEvent,
    /// Bodies of the shapes or joint, if they exist after the tick; or the body that fell asleep.
    pub(crate) bodies: [Option<BodyId>; 2],
}

impl LoggedEvent {
    pub(crate) fn is_alike(&self, other: &Self) -> bool {
        self.event.is_alike(&other.event)
    }
}

/// Calls `found` with each event of the last tick of a world: contacts, hits, sensors, joints, sleep.
pub(crate) fn each_event(world: &World, tick: u64, found: &mut impl FnMut(LoggedEvent)) {
    let events = world.events();
    let mut add = |event: WorldEvent| {
        let bodies = match event {
            WorldEvent::Joint(joint) => {
                let joint = world.joint(joint.joint);
                joint.map_or([None; 2], |joint| {
                    let (body_a, body_b) = joint.def().bodies();
                    [Some(body_a), Some(body_b)]
                })
            }
            WorldEvent::FellAsleep(body) => [Some(body), None],
            _ => event.shapes().map_or([None; 2], |shapes| shapes.map(|shape| world.body_of(shape))),
        };
        found(LoggedEvent { tick, event, bodies });
    };
    events.contact_begin.iter().for_each(|event| add(WorldEvent::ContactBegin(*event)));
    events.contact_end.iter().for_each(|event| add(WorldEvent::ContactEnd(*event)));
    events.hits.iter().for_each(|event| add(WorldEvent::Hit(*event)));
    for change in events.sensor_changes() {
        add(match change {
            SensorChange::Begin(event) => WorldEvent::SensorBegin(event),
            SensorChange::End(event) => WorldEvent::SensorEnd(event),
        });
    }
    events.joints.iter().for_each(|event| add(WorldEvent::Joint(*event)));
    let asleep = events.moved.iter().filter(|moved| moved.fell_asleep);
    asleep.for_each(|moved| add(WorldEvent::FellAsleep(moved.body)));
}

/// An event of a final tick, sent once.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConfirmedEvent {
    /// Number of ticks played, including the tick of the event.
    pub tick: u64,
    /// The event.
    pub event: WorldEvent,
    /// Views of shapes A and B, of the sensor and the visitor, of the joint's bodies, or of the body that fell asleep.
    /// `None` for a body or shape that no longer exists, and for the bodies of a joint that broke.
    pub views: [Option<Entity>; 2],
}

/// An event of a played tick. A rollback may remove the event until its tick is confirmed. If a rollback moves the
/// event by up to 16 ticks, it is not sent again.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct PredictedEvent {
    /// Number of ticks played, including the tick of the event.
    pub tick: u64,
    /// The event.
    pub event: WorldEvent,
    /// Views of the bodies, as in [`ConfirmedEvent::views`].
    pub views: [Option<Entity>; 2],
}

/// Reports that a rollback has removed a [`PredictedEvent`], whose sound can then be stopped, for example. The message
/// is sent when the game has played more than 16 ticks after the tick of the removed event, because the event may occur
/// again until then. At the end of a match, it is sent at once.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct RetractedEvent {
    /// The tick of the [`PredictedEvent`].
    pub tick: u64,
    /// The event that was predicted.
    pub event: WorldEvent,
}

/// A [`ConfirmedEvent`] for the observers of a view: `commands.entity(view).observe(|on: On<BodyEvent>| ...)`.
#[derive(EntityEvent, Clone, Copy, Debug)]
pub struct BodyEvent {
    /// The view.
    pub entity: Entity,
    /// View of the other body, if there is one.
    pub other: Option<Entity>,
    /// Number of ticks played, including the tick of the event.
    pub tick: u64,
    /// The event.
    pub event: WorldEvent,
}

/// An event of a match, such as a peer that joins or a desync.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct MatchEvent(
    /// The event.
    pub PeerEvent,
);
