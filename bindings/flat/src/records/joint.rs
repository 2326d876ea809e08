//! Joints: one struct for all kinds, with flags for optional parts.

use lockstep2d::math::Fx;
use lockstep2d::solver::{JointDef, JointFrame, Soft, Threshold, ThresholdAction};

use super::{check_size, flag, has, size};
use crate::describe::{constants, records};
use crate::numbers::{NO_ID, RawAngle, RawBody, RawFx, RawVec2};
use crate::status::{Outcome, value};

constants! {
    /// Kind of a joint: a hinge.
    REVOLUTE = 0, "LS2D_REVOLUTE";
    /// Kind of a joint: B slides along the x axis of the joint's frame on A, and does not turn.
    PRISMATIC = 1, "LS2D_PRISMATIC";
    /// Kind of a joint: a rod, a rope or a spring between the anchors.
    DISTANCE = 2, "LS2D_DISTANCE";
    /// Kind of a joint: B keeps its pose relative to A, rigidly or by springs.
    WELD = 3, "LS2D_WELD";
    /// Kind of a joint: B slides along the x axis of the joint's frame on A, and turns.
    WHEEL = 4, "LS2D_WHEEL";
    /// Kind of a joint: B is driven relative to A with limited force.
    MOTOR = 5, "LS2D_MOTOR";
    /// Kind of a joint: only keeps the bodies from colliding with each other.
    FILTER = 6, "LS2D_FILTER";
    /// Kind of a joint: the wheels about the anchors turn in a fixed ratio, as gears.
    GEAR = 7, "LS2D_GEAR";
    /// Kind of a joint: the wheel about A's anchor rolls along the x axis of the joint's frame on B.
    RACK = 8, "LS2D_RACK";
    /// Kind of a joint: a rope over two wheels that are fixed in the world.
    PULLEY = 9, "LS2D_PULLEY";
    /// Flag of a joint: its bodies collide with each other.
    JOINT_COLLIDE = 1, "LS2D_JOINT_COLLIDE";
    /// Flag of a joint: enabled.
    JOINT_ENABLED = 2, "LS2D_JOINT_ENABLED";
    /// Flag of a joint: has `limit_lower` and `limit_upper` (revolute, prismatic, distance, wheel).
    JOINT_LIMIT = 4, "LS2D_JOINT_LIMIT";
    /// Flag of a joint: has `motor_speed` and `motor_max` (revolute, prismatic, distance, wheel, and for the angle of a
    /// motor joint).
    JOINT_MOTOR = 8, "LS2D_JOINT_MOTOR";
    /// Flag of a joint: has `spring_hertz`, `spring_damping_ratio`, `spring_target` (revolute, prismatic, distance,
    /// wheel).
    JOINT_SPRING = 16, "LS2D_JOINT_SPRING";
    /// Flag of a joint: has `spring_force_lower` and `spring_force_upper` (distance).
    JOINT_SPRING_FORCE = 32, "LS2D_JOINT_SPRING_FORCE";
    /// Flag of a joint: holds `length` rigidly (distance).
    JOINT_ROD = 64, "LS2D_JOINT_ROD";
    /// Flag of a joint: has its own `hertz` and `damping_ratio`.
    JOINT_SOFTNESS = 128, "LS2D_JOINT_SOFTNESS";
    /// Flag of a joint: has `threshold_force`.
    JOINT_THRESHOLD_FORCE = 256, "LS2D_JOINT_THRESHOLD_FORCE";
    /// Flag of a joint: has `threshold_torque`.
    JOINT_THRESHOLD_TORQUE = 512, "LS2D_JOINT_THRESHOLD_TORQUE";
    /// Flag of a joint: breaks beyond a threshold.
    JOINT_BREAKS = 1024, "LS2D_JOINT_BREAKS";
    /// Flag of a joint: has `linear_velocity` and `linear_motor_max` (motor).
    JOINT_LINEAR_MOTOR = 2048, "LS2D_JOINT_LINEAR_MOTOR";
    /// Flag of a joint: has `linear_hertz`, `linear_damping_ratio` and, for a motor, `linear_max` (weld, motor).
    JOINT_LINEAR_SPRING = 4096, "LS2D_JOINT_LINEAR_SPRING";
    /// Flag of a joint: has `angular_hertz`, `angular_damping_ratio` and, for a motor, `angular_max` (weld, motor).
    JOINT_ANGULAR_SPRING = 8192, "LS2D_JOINT_ANGULAR_SPRING";
}

records! {
    /// Definition of a joint. `ls2d_joint_def_init` sets the defaults. If the comment of a flag names a field, the
    /// field is read only with this flag. There is one exception: a pulley always reads `length`.
    struct RawJointDef = "ls2d_joint_def" {
        /// Size of this struct in bytes.
        size: u32,
        /// `LS2D_REVOLUTE` and so on.
        kind: u32,
        /// `LS2D_JOINT_` flags.
        flags: u32,
        /// Number of teeth of a gear's wheel on body A: 1 to 1000, or -1 to -1000 for a ring around the other wheel.
        teeth_a: i32,
        /// Number of teeth of a gear's wheel on body B, in the same range.
        teeth_b: i32,
        /// Angle of the joint's frame on A, in the frame of body A.
        angle_a: RawAngle,
        /// Angle of the joint's frame on B, in the frame of body B.
        angle_b: RawAngle,
        /// Reserved: 0.
        reserved: u32,
        /// Body A.
        body_a: RawBody,
        /// Body B.
        body_b: RawBody,
        /// Anchor in the frame of body A, in metres.
        anchor_a: RawVec2,
        /// Anchor in the frame of body B, in metres.
        anchor_b: RawVec2,
        /// Lower limit of the angle in rad (revolute), of the translation in m (prismatic, wheel) or of the length in m
        /// (distance).
        limit_lower: RawFx,
        /// Upper limit, in the unit of the lower one.
        limit_upper: RawFx,
        /// Target speed of the motor: in rad/s (revolute, wheel, motor), or m/s (prismatic, distance).
        motor_speed: RawFx,
        /// Largest torque of the motor in N m (revolute, wheel, motor), or largest force in N (prismatic, distance).
        motor_max: RawFx,
        /// Frequency of the spring in Hz.
        spring_hertz: RawFx,
        /// Damping ratio of the spring.
        spring_damping_ratio: RawFx,
        /// Rest position of the spring, in rad (revolute) or in m (prismatic, distance, wheel).
        spring_target: RawFx,
        /// Smallest force of the spring in N, 0 or less. Positive forces push the anchors apart.
        spring_force_lower: RawFx,
        /// Largest force of the spring in N, 0 or more.
        spring_force_upper: RawFx,
        /// Length in metres that a rod holds (distance), or of the rope (pulley).
        length: RawFx,
        /// Stiffness in Hz of the rigid constraints of the joint.
        hertz: RawFx,
        /// Damping ratio of the rigid constraints of the joint.
        damping_ratio: RawFx,
        /// Force in N beyond which the joint is reported or breaks.
        threshold_force: RawFx,
        /// Torque in N m beyond which the joint is reported or breaks.
        threshold_torque: RawFx,
        /// Target velocity of B's anchor relative to A along the axes of the world, in m/s (motor joint).
        linear_velocity: RawVec2,
        /// Largest force in N for `linear_velocity` (motor joint).
        linear_motor_max: RawFx,
        /// Frequency in Hz of the spring between the anchors.
        linear_hertz: RawFx,
        /// Damping ratio of the spring between the anchors.
        linear_damping_ratio: RawFx,
        /// Largest force of the spring between the anchors in N (motor joint).
        linear_max: RawFx,
        /// Frequency in Hz of the spring on the angle.
        angular_hertz: RawFx,
        /// Damping ratio of the spring on the angle.
        angular_damping_ratio: RawFx,
        /// Largest torque of the spring on the angle in N m (motor joint).
        angular_max: RawFx,
        /// Radius of the wheel of a rack in metres.
        radius: RawFx,
        /// Position of a pulley's wheel on A's side, in the world, in metres.
        wheel_a: RawVec2,
        /// Position of a pulley's wheel on B's side, in the world, in metres.
        wheel_b: RawVec2,
        /// Ratio of a pulley: the length on A's side plus `ratio` times the length on B's side is at most `length`.
        ratio: RawFx,
        /// A number that the game may choose freely.
        user_data: u64,
    }
}

impl RawJointDef {
    fn empty() -> Self {
        let (zero, origin) = (RawFx(0), RawVec2::ZERO);
        RawJointDef {
            size: size::<Self>(),
            kind: FILTER,
            flags: 0,
            teeth_a: 0,
            teeth_b: 0,
            angle_a: RawAngle(0),
            angle_b: RawAngle(0),
            reserved: 0,
            body_a: RawBody(NO_ID),
            body_b: RawBody(NO_ID),
            anchor_a: origin,
            anchor_b: origin,
            limit_lower: zero,
            limit_upper: zero,
            motor_speed: zero,
            motor_max: zero,
            spring_hertz: zero,
            spring_damping_ratio: zero,
            spring_target: zero,
            spring_force_lower: zero,
            spring_force_upper: zero,
            length: zero,
            hertz: zero,
            damping_ratio: zero,
            threshold_force: zero,
            threshold_torque: zero,
            linear_velocity: origin,
            linear_motor_max: zero,
            linear_hertz: zero,
            linear_damping_ratio: zero,
            linear_max: zero,
            angular_hertz: zero,
            angular_damping_ratio: zero,
            angular_max: zero,
            radius: zero,
            wheel_a: origin,
            wheel_b: origin,
            ratio: RawFx::of(Fx::ONE),
            user_data: 0,
        }
    }

    pub(crate) fn of_kind(kind: u32) -> Outcome<Self> {
        if kind > PULLEY {
            return Err(value("the kind of a joint", kind));
        }
        Ok(RawJointDef { kind, flags: JOINT_ENABLED, teeth_a: 1, teeth_b: 1, ..Self::empty() })
    }

    pub(crate) fn of(def: &JointDef) -> Self {
        let JointDef {
            body_a,
            body_b,
            frame_a,
            frame_b,
            collide_connected,
            enabled,
            kind,
            softness,
            threshold,
            user_data,
        } = *def;
        let mut raw = Self::empty();
        (raw.body_a, raw.body_b) = (RawBody::of(body_a), RawBody::of(body_b));
        (raw.anchor_a, raw.angle_a) = (RawVec2::of(frame_a.anchor), RawAngle::of(frame_a.angle));
        (raw.anchor_b, raw.angle_b) = (RawVec2::of(frame_b.anchor), RawAngle::of(frame_b.angle));
        raw.flags = flag(collide_connected, JOINT_COLLIDE)
            | flag(enabled, JOINT_ENABLED)
            | flag(softness.is_some(), JOINT_SOFTNESS)
            | flag(threshold.force.is_some(), JOINT_THRESHOLD_FORCE)
            | flag(threshold.torque.is_some(), JOINT_THRESHOLD_TORQUE)
            | flag(threshold.action == ThresholdAction::Break, JOINT_BREAKS);
        if let Some(soft) = softness {
            (raw.hertz, raw.damping_ratio) = (RawFx::of(soft.hertz), RawFx::of(soft.damping_ratio));
        }
        raw.threshold_force = RawFx::of(threshold.force.unwrap_or_default());
        raw.threshold_torque = RawFx::of(threshold.torque.unwrap_or_default());
        raw.user_data = user_data;
        raw.put_kind(kind);
        raw
    }

    pub(crate) fn def(&self) -> Outcome<JointDef> {
        check_size::<Self>(self.size)?;
        super::check_reserved(self.reserved)?;
        let softness = Soft { hertz: self.hertz.fx(), damping_ratio: self.damping_ratio.fx() };
        let action =
            if has(self.flags, JOINT_BREAKS) { ThresholdAction::Break } else { ThresholdAction::Event };
        Ok(JointDef {
            kind: self.joint_kind()?,
            body_a: self.body_a.id()?,
            body_b: self.body_b.id()?,
            frame_a: JointFrame { anchor: self.anchor_a.vec(), angle: self.angle_a.angle() },
            frame_b: JointFrame { anchor: self.anchor_b.vec(), angle: self.angle_b.angle() },
            collide_connected: has(self.flags, JOINT_COLLIDE),
            enabled: has(self.flags, JOINT_ENABLED),
            softness: self.if_has(JOINT_SOFTNESS, || softness),
            threshold: Threshold {
                force: self.if_has(JOINT_THRESHOLD_FORCE, || self.threshold_force.fx()),
                torque: self.if_has(JOINT_THRESHOLD_TORQUE, || self.threshold_torque.fx()),
                action,
            },
            user_data: self.user_data,
        })
    }
}
