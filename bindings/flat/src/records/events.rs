//! Events of a tick.

use lockstep2d::world::{ContactEvent, HitEvent, JointEvent, SensorEvent};

use crate::describe::records;
use crate::numbers::{RawFx, RawJoint, RawShape, RawVec2};

records! {
    /// Two shapes that began or ceased to touch. A handle is stale if its shape was removed.
    struct RawContactEvent = "ls2d_contact_event" {
        /// The shape in the smaller slot.
        shape_a: RawShape,
        /// The shape in the larger slot.
        shape_b: RawShape,
    }

    /// Two shapes that hit each other.
    struct RawHitEvent = "ls2d_hit_event" {
        /// The shape in the smaller slot.
        shape_a: RawShape,
        /// The shape in the larger slot.
        shape_b: RawShape,
        /// Contact point in the world, in metres.
        point: RawVec2,
        /// Unit vector from A to B.
        normal: RawVec2,
        /// Approach speed in m/s.
        approach_speed: RawFx,
        /// Impulse along the normal over the whole tick, in N s.
        impulse: RawFx,
    }

    /// A sensor and a shape that began or ceased to overlap. A handle is stale if its shape was removed.
    struct RawSensorEvent = "ls2d_sensor_event" {
        /// The sensor.
        sensor: RawShape,
        /// The shape that overlaps the sensor.
        visitor: RawShape,
        /// Time at which the overlap began or ceased, as a fraction of the tick from 0 to 1.
        fraction: RawFx,
    }

    /// A joint whose force or torque exceeded its threshold.
    struct RawJointEvent = "ls2d_joint_event" {
        /// The joint. The handle is stale if the joint broke.
        joint: RawJoint,
        /// Force on body B in N.
        force: RawVec2,
        /// Torque in N m on body B about B's anchor.
        torque: RawFx,
        /// 1 if the joint broke, otherwise 0.
        broke: u64,
    }
}

impl RawContactEvent {
    pub(crate) fn of(event: &ContactEvent) -> Self {
        RawContactEvent { shape_a: RawShape::of(event.shape_a), shape_b: RawShape::of(event.shape_b) }
    }
}

impl RawHitEvent {
    pub(crate) fn of(event: &HitEvent) -> Self {
        RawHitEvent {
            shape_a: RawShape::of(event.shape_a),
            shape_b: RawShape::of(event.shape_b),
            point: RawVec2::of(event.point),
            normal: RawVec2::of_units(event.normal),
            approach_speed: RawFx::of(event.approach_speed),
            impulse: RawFx::of(event.impulse),
        }
    }
}

impl RawSensorEvent {
    pub(crate) fn of(event: &SensorEvent) -> Self {
        RawSensorEvent {
            sensor: RawShape::of(event.sensor),
            visitor: RawShape::of(event.visitor),
            fraction: RawFx::of(event.fraction),
        }
    }
}

impl RawJointEvent {
    pub(crate) fn of(event: &JointEvent) -> Self {
        RawJointEvent {
            joint: RawJoint::of(event.joint),
            force: RawVec2::of(event.force),
            torque: RawFx::of(event.torque),
            broke: event.broke.into(),
        }
    }
}
