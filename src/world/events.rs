//! What happened in a tick. Events are not part of the state, but simulating a tick again gives them again.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::body::{BodyId, JointId, ShapeId};
use crate::math::{Angle, Fx, Unit, Vec2};

/// Two shapes that began or ceased to touch. `shape_a` is the one in the smaller slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ContactEvent {
    /// One shape. It may be gone, if the contact ended by its removal.
    pub shape_a: ShapeId,
    /// The other shape.
    pub shape_b: ShapeId,
}

/// Two shapes that met fast.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HitEvent {
    /// The shape in the smaller slot.
    pub shape_a: ShapeId,
    /// The other shape.
    pub shape_b: ShapeId,
    /// Where they met in the world, in metres.
    pub point: Vec2<Fx>,
    /// Unit vector from A to B.
    pub normal: Vec2<Unit>,
    /// How fast they approached along the normal at the start of the tick, in m/s.
    pub approach_speed: Fx,
}

/// A sensor that began or ceased to notice a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct SensorEvent {
    /// The sensor. It may be gone.
    pub sensor: ShapeId,
    /// What it noticed. It may be gone.
    pub visitor: ShapeId,
}

/// A body that moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MoveEvent {
    /// The body.
    pub body: BodyId,
    /// Its origin after the tick, in metres.
    pub position: Vec2<Fx>,
    /// Its rotation after the tick.
    pub angle: Angle,
    /// Whether it fell asleep, and will not move again before something wakes it.
    pub fell_asleep: bool,
}

/// A joint whose force or torque was above its threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointEvent {
    /// The joint. It is gone if it broke.
    pub joint: JointId,
    /// What it held body B with, in N.
    pub force: Vec2<Fx>,
    /// And the torque, in N m.
    pub torque: Fx,
    /// Whether it broke.
    pub broke: bool,
}

/// The events of the last tick, one list for each kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Events {
    /// Bodies that moved within the tick or fell asleep, in slot order; not those that were moved by hand.
    pub moved: Vec<MoveEvent>,
    /// Pairs that came within [`super::Config::touching_distance`], or pushed each other since the last tick. Sorted
    /// by their handles, A first, like all lists of pairs.
    pub contact_begin: Vec<ContactEvent>,
    /// Pairs that moved further apart than [`super::Config::speculative_distance`], or lost a shape. At the time of the event
    /// a removed shape's handle does not resolve any more.
    pub contact_end: Vec<ContactEvent>,
    /// Pairs that pushed each other, and had approached faster than [`super::Config::hit_speed`].
    pub hits: Vec<HitEvent>,
    /// Shapes that began to overlap a sensor, sorted by the sensor first.
    pub sensor_begin: Vec<SensorEvent>,
    /// Shapes that ceased to overlap a sensor, or one of them is gone.
    pub sensor_end: Vec<SensorEvent>,
    /// Joints above their threshold, in slot order.
    pub joints: Vec<JointEvent>,
}

impl Events {
    pub(crate) fn clear(&mut self) {
        let Events { moved, contact_begin, contact_end, hits, sensor_begin, sensor_end, joints } = self;
        moved.clear();
        contact_begin.clear();
        contact_end.clear();
        hits.clear();
        sensor_begin.clear();
        sensor_end.clear();
        joints.clear();
    }
}
