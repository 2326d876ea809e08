//! Events of a tick. They are not part of the state: simulating a tick again gives the same events again.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::body::{BodyId, JointId, ShapeId};
use crate::math::{Angle, Fx, Unit, Vec2};

/// Two shapes that began or ceased to touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ContactEvent {
    /// The shape in the smaller slot. Its handle is stale if the contact ended by its removal.
    pub shape_a: ShapeId,
    /// The shape in the larger slot. Its handle is stale if the contact ended by its removal.
    pub shape_b: ShapeId,
}

/// Two shapes that hit each other: see [`super::Config::hit_speed`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HitEvent {
    /// The shape in the smaller slot.
    pub shape_a: ShapeId,
    /// The shape in the larger slot.
    pub shape_b: ShapeId,
    /// Contact point in the world, in metres.
    pub point: Vec2<Fx>,
    /// Unit vector from A to B.
    pub normal: Vec2<Unit>,
    /// Approach speed along the normal at the start of the tick, in m/s.
    pub approach_speed: Fx,
}

/// A sensor that began or ceased to overlap a shape.
#[doc(alias = "trigger")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct SensorEvent {
    /// The sensor. Its handle may be stale in an end event.
    pub sensor: ShapeId,
    /// The other shape. Its handle may be stale in an end event.
    pub visitor: ShapeId,
}

/// A body that moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MoveEvent {
    /// The body.
    pub body: BodyId,
    /// Position of its origin after the tick, in metres.
    pub position: Vec2<Fx>,
    /// Rotation after the tick.
    pub angle: Angle,
    /// Whether it fell asleep. It then does not move until something wakes it.
    pub fell_asleep: bool,
}

/// A joint whose force or torque exceeded its threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointEvent {
    /// The joint. Its handle is stale if it broke.
    pub joint: JointId,
    /// Force on body B in N.
    pub force: Vec2<Fx>,
    /// Torque on body B about its anchor in N m.
    pub torque: Fx,
    /// Whether the joint broke and was removed.
    pub broke: bool,
}

/// The events of a tick, one list for each kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Events {
    /// Bodies that moved within the tick or fell asleep, in slot order. Bodies that were moved by hand are not listed.
    pub moved: Vec<MoveEvent>,
    /// Pairs that came within [`super::Config::touching_distance`] or pushed each other in the tick. Sorted by shape A,
    /// then by shape B, like all lists of pairs.
    pub contact_begin: Vec<ContactEvent>,
    /// Pairs that moved further apart than [`super::Config::speculative_distance`], and pairs of which a shape was
    /// removed or disabled.
    pub contact_end: Vec<ContactEvent>,
    /// Pairs that pushed each other after an approach at [`super::Config::hit_speed`] or faster.
    pub hits: Vec<HitEvent>,
    /// Shapes that began to overlap a sensor. Sorted by sensor, then by visitor.
    pub sensor_begin: Vec<SensorEvent>,
    /// Shapes that ceased to overlap a sensor, and pairs of which the sensor or the shape was removed or disabled.
    /// Sorted by sensor, then by visitor.
    pub sensor_end: Vec<SensorEvent>,
    /// Joints above their threshold, in slot order.
    pub joints: Vec<JointEvent>,
}

impl Events {
    /// Empties all lists and keeps their memory.
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
