//! Definitions of joints.

use serde::{Deserialize, Serialize};

use super::options::{Drive, JointLimit, Soft, Spring, check_strength};
use super::{Distance, Gear, Motor, Prismatic, Pulley, Rack, Revolute, Weld, Wheel};
use crate::body::{Body, BodyId, BodyKind, Pose, REACH_MAX, WORLD_EXTENT_MAX, WorldError};
use crate::math::{Angle, Fx, Vec2};

/// A joint between two bodies, with a frame on each. Its kind defines how B's frame may move relative to A's.
///
/// ```
/// use lockstep2d::{body::BodyDef, fx, solver::{JointDef, Revolute}, world::World};
/// # use lockstep2d::body::{Polygon, ShapeDef};
/// let mut world = World::default();
/// let post = world.spawn(&BodyDef::fixed(), &[])?;
/// let plank = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.1))?);
/// let gate = world.spawn(&BodyDef::dynamic().position((fx!(1), fx!(0))), &[plank])?;
/// let hinge = Revolute::new().limit(fx!(-0.5), fx!(1.5)).motor(fx!(2), fx!(40));
/// world.add_joint(&JointDef::new(post, gate, hinge).anchor_b((fx!(-1), fx!(0))))?;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JointDef {
    /// The first body, A.
    pub body_a: BodyId,
    /// The second body, B.
    pub body_b: BodyId,
    /// The joint's frame on A.
    pub frame_a: JointFrame,
    /// The joint's frame on B.
    pub frame_b: JointFrame,
    /// Whether the two bodies collide with each other.
    pub collide_connected: bool,
    /// Whether the joint acts. A disabled joint keeps its handle. Its bodies collide and sleep as if it were absent.
    pub enabled: bool,
    /// The motion that the joint allows.
    pub kind: JointKind,
    /// Stiffness of the rigid parts of the joint and of its limits. A load that gives its body the acceleration `g`
    /// stretches the joint by `g / w^2`, with the frequency `w` in rad/s. The joint approaches this length without
    /// vibration, with the time constant `1 / (h w^2)`, where `h` is the sub-step in seconds. For suspensions use the
    /// springs of the joints.
    ///
    /// `None` uses the values in [`SolverSettings`](crate::solver::SolverSettings). The frequency is limited to a
    /// quarter of the sub-step rate.
    pub softness: Option<Soft>,
    /// The load beyond which the joint is reported or breaks.
    pub threshold: Threshold,
    /// A number for the game. It is part of the state and of the state hash.
    pub user_data: u64,
}

/// The frame of a joint on a body.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, world::World};
/// use lockstep2d::solver::{JointDef, JointFrame, Prismatic};
/// use lockstep2d::{fx, math::{Angle, Vec2}};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// let shaft = world.spawn(&BodyDef::fixed(), &[])?;
/// let cabin = world.spawn(&BodyDef::dynamic(), &[square])?;
/// // Along the y axis of both bodies, from a place 10 m up in the shaft.
/// let top = JointFrame { anchor: Vec2::new(fx!(0), fx!(10)), angle: Angle::QUARTER };
/// let bottom = JointFrame { angle: Angle::QUARTER, ..JointFrame::ORIGIN };
/// let slider = JointDef { frame_a: top, frame_b: bottom, ..JointDef::new(shaft, cabin, Prismatic::new()) };
/// let slider = world.add_joint(&slider)?;
/// assert_eq!(world.joint_translation(slider).map(|at| at.x), Some(fx!(-10)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JointFrame {
    /// Origin in the body's frame, in metres: within ±128 on each axis, or ±2^30 on a fixed body.
    pub anchor: Vec2<Fx>,
    /// Rotation in the body's frame. Sliding joints slide along the x axis of A's frame.
    pub angle: Angle,
}

/// The relative motion of two frames that a joint allows.
///
/// ```
/// # use lockstep2d::{body::BodyDef, fx, world::World};
/// use lockstep2d::solver::{Distance, JointDef, JointKind, Revolute};
/// # let mut world = World::default();
/// # let a = world.spawn(&BodyDef::fixed(), &[])?;
/// # let b = world.spawn(&BodyDef::dynamic(), &[])?;
/// # world.add_joint(&JointDef::new(a, b, Revolute::new()))?;
/// # world.add_joint(&JointDef::new(a, b, Distance::rope(fx!(3))))?;
/// // A saw cuts ropes, and nothing else.
/// let is_rope = |kind: JointKind| matches!(kind, JointKind::Distance(Distance { rod: None, limit: Some(_), .. }));
/// let ropes: Vec<_> = world.joints_of(b).into_iter()
///     .filter(|&joint| world.joint(joint).is_some_and(|joint| is_rope(joint.def().kind)))
///     .collect();
/// ropes.into_iter().try_for_each(|rope| world.remove_joint(rope))?;
/// assert_eq!(world.joint_count(), 1);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum JointKind {
    /// The frames share their origin: a hinge.
    Revolute(Revolute),
    /// B slides along the x axis of A's frame without turning: a lift, a drawer.
    Prismatic(Prismatic),
    /// The distance between the origins is held, limited or sprung: a rod, a rope, a spring.
    Distance(Distance),
    /// The frames coincide: glue, rigid or soft.
    Weld(Weld),
    /// B slides along the x axis of A's frame and turns: a wheel on its suspension.
    Wheel(Wheel),
    /// The joint drives the frames with limited force: top-down friction, dragging with a pointer.
    Motor(Motor),
    /// The frames are free. The bodies do not collide, unless [`JointDef::collide_connected`] is set.
    Filter,
    /// Two wheels, each about an anchor, turn in a fixed ratio.
    Gear(Gear),
    /// The wheel about A's anchor rolls along the x axis of B's frame.
    Rack(Rack),
    /// A rope from anchor to anchor over two wheels that are fixed in the world.
    Pulley(Pulley),
}

/// The load beyond which a joint is reported or breaks.
///
/// Each tick compares the threshold with the load in its last sub-step. A shock that ends in an earlier sub-step is
/// missed: to break joints by impacts, use [`HitEvent::impulse`](crate::world::HitEvent). In a joint's first
/// tick, the solver has no impulses for the warm start, and may overestimate the load by a third.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let a = world.spawn(&BodyDef::fixed(), &[])?;
/// # let b = world.spawn(&BodyDef::dynamic().position((fx!(2), fx!(0))), &[square])?;
/// use lockstep2d::solver::{JointDef, Revolute, Threshold, ThresholdAction};
/// // A hinge that breaks at 5 N: the square that hangs on it weighs 10 N.
/// let weak = Threshold { force: Some(fx!(5)), torque: None, action: ThresholdAction::Break };
/// let hinge = JointDef { threshold: weak, ..JointDef::new(a, b, Revolute::new()).anchor_a((fx!(2), fx!(0))) };
/// world.add_joint(&hinge)?;
/// (0..10).for_each(|_| world.step());
/// assert_eq!(world.joint_count(), 0);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Threshold {
    /// Largest force in N, 0 or more; `None` for no limit.
    pub force: Option<Fx>,
    /// Largest torque in N m, 0 or more; `None` for no limit.
    pub torque: Option<Fx>,
    /// The action beyond the threshold.
    pub action: ThresholdAction,
}

/// The action on a joint above its [`Threshold`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThresholdAction {
    /// Reports the joint.
    Event,
    /// Reports the joint and removes it.
    Break,
}

impl Threshold {
    /// No limit.
    pub const NONE: Self = Threshold { force: None, torque: None, action: ThresholdAction::Event };

    pub(crate) const fn is_set(&self) -> bool {
        self.force.is_some() || self.torque.is_some()
    }
}

impl JointFrame {
    /// The frame of the body itself.
    pub const ORIGIN: Self = JointFrame { anchor: Vec2::new(Fx::ZERO, Fx::ZERO), angle: Angle::ZERO };
}

impl JointFrame {
    fn validate(&self, kind: BodyKind) -> Result<(), WorldError> {
        let max = if kind == BodyKind::Fixed { WORLD_EXTENT_MAX } else { REACH_MAX };
        let outside = |value: &Fx| !(-max..=max).contains(value);
        match [self.anchor.x, self.anchor.y].into_iter().find(outside) {
            Some(value) => Err(WorldError::OffsetOutOfRange { value, max }),
            None => Ok(()),
        }
    }

    /// Whether the anchor is farther from the body's origin than lever arms can be. Only fixed bodies may have such an
    /// anchor.
    pub(super) fn is_far(&self) -> bool {
        let Vec2 { x, y } = self.anchor;
        x.saturating_abs().max(y.saturating_abs()) > REACH_MAX
    }

    /// The centre of mass in the world, and the vector from it to the anchor in the frame of the body. With a far
    /// anchor, the anchor serves as the centre, because the centre of a fixed body is arbitrary.
    pub(super) fn centre_and_arm(&self, body: &Body) -> (Vec2<Fx>, Vec2<Fx>) {
        if self.is_far() {
            (self.far_pose(body).centre, Vec2::ZERO)
        } else {
            (body.centre_of_mass(), self.anchor - body.local_centre_of_mass())
        }
    }

    /// The pose of a fixed body with its far anchor as the centre, clamped to the range of positions.
    pub(super) fn far_pose(&self, body: &Body) -> Pose {
        let place = body.transform().apply(self.anchor);
        let within = |x: Fx| x.clamp(-WORLD_EXTENT_MAX, WORLD_EXTENT_MAX);
        Pose { centre: Vec2::new(within(place.x), within(place.y)), angle: body.angle() }
    }
}

impl JointDef {
    /// A joint between the origins of two bodies. The bodies do not collide with each other.
    #[must_use]
    pub fn new(body_a: BodyId, body_b: BodyId, kind: impl Into<JointKind>) -> Self {
        JointDef {
            body_a,
            body_b,
            frame_a: JointFrame::ORIGIN,
            frame_b: JointFrame::ORIGIN,
            collide_connected: false,
            enabled: true,
            kind: kind.into(),
            softness: None,
            threshold: Threshold::NONE,
            user_data: 0,
        }
    }

    /// Sets the anchor on A, in metres in A's frame.
    #[must_use]
    pub fn anchor_a(mut self, anchor: impl Into<Vec2<Fx>>) -> Self {
        self.frame_a.anchor = anchor.into();
        self
    }

    /// Sets the anchor on B, in metres in B's frame.
    #[must_use]
    pub fn anchor_b(mut self, anchor: impl Into<Vec2<Fx>>) -> Self {
        self.frame_b.anchor = anchor.into();
        self
    }

    /// Sets the angle of the joint's frame on A. Sliding joints slide along its x axis.
    #[must_use]
    pub const fn angle_a(mut self, angle: Angle) -> Self {
        self.frame_a.angle = angle;
        self
    }

    /// Sets the angle of the joint's frame on B.
    #[must_use]
    pub const fn angle_b(mut self, angle: Angle) -> Self {
        self.frame_b.angle = angle;
        self
    }

    /// Lets the two bodies collide with each other.
    #[must_use]
    pub const fn colliding(mut self) -> Self {
        self.collide_connected = true;
        self
    }

    /// Sets the softness of the rigid parts of the joint: the frequency in Hz (above 0, at most 1000) and the damping
    /// ratio (0 to 100). Under gravity such a joint yields by `g / (2 pi hertz)^2`, but approaches this length at only
    /// about `g h` (4 cm/s at 240 sub-steps per second). A body that may sleep therefore falls asleep before.
    #[must_use]
    pub const fn softness(mut self, hertz: Fx, damping_ratio: Fx) -> Self {
        self.softness = Some(Soft { hertz, damping_ratio });
        self
    }

    /// Disables the joint until [`World::enable_joint`](crate::world::World::enable_joint).
    #[must_use]
    pub const fn disabled(mut self) -> Self {
        self.enabled = false;
        self
    }

    /// Sets the load beyond which the joint is reported or breaks.
    #[must_use]
    pub const fn threshold(mut self, threshold: Threshold) -> Self {
        self.threshold = threshold;
        self
    }

    /// Sets a number for the game.
    #[must_use]
    pub const fn user_data(mut self, user_data: u64) -> Self {
        self.user_data = user_data;
        self
    }

    /// This definition with two other bodies.
    #[must_use]
    pub const fn between(mut self, a: BodyId, b: BodyId) -> Self {
        (self.body_a, self.body_b) = (a, b);
        self
    }

    /// The two bodies, A first.
    #[must_use]
    pub const fn bodies(&self) -> (BodyId, BodyId) {
        (self.body_a, self.body_b)
    }

    pub(crate) fn rest_angle(&self) -> Angle {
        self.frame_b.angle - self.frame_a.angle
    }

    pub(crate) fn validate(&self, kinds: [BodyKind; 2]) -> Result<(), WorldError> {
        if self.body_a == self.body_b {
            return Err(WorldError::JointToItself(self.body_a));
        }
        for (frame, kind) in [self.frame_a, self.frame_b].iter().zip(kinds) {
            frame.validate(kind)?;
        }
        Soft::check(self.softness, ["softness frequency in Hz", "softness damping ratio"])?;
        let Threshold { force, torque, action: _ } = self.threshold;
        force.map_or(Ok(()), |most| check_strength("force threshold in N", most))?;
        torque.map_or(Ok(()), |most| check_strength("torque threshold in N m", most))?;
        match &self.kind {
            JointKind::Revolute(kind) => kind.validate(),
            JointKind::Prismatic(kind) => kind.validate(),
            JointKind::Distance(kind) => kind.validate(),
            JointKind::Weld(kind) => kind.validate(),
            JointKind::Wheel(kind) => kind.validate(),
            JointKind::Motor(kind) => kind.validate(),
            JointKind::Filter => Ok(()),
            JointKind::Gear(kind) => kind.validate(),
            JointKind::Rack(kind) => kind.validate(),
            JointKind::Pulley(kind) => kind.validate(),
        }
    }
}

impl JointKind {
    /// The motor along or about the axis. In a motor joint, the angular motor.
    pub(crate) fn motor_mut(&mut self) -> Option<&mut Drive> {
        match self {
            JointKind::Revolute(Revolute { motor, .. })
            | JointKind::Prismatic(Prismatic { motor, .. })
            | JointKind::Distance(Distance { motor, .. })
            | JointKind::Wheel(Wheel { motor, .. })
            | JointKind::Motor(Motor { angular: motor, .. }) => motor.as_mut(),
            JointKind::Weld(_)
            | JointKind::Filter
            | JointKind::Gear(_)
            | JointKind::Rack(_)
            | JointKind::Pulley(_) => None,
        }
    }

    /// The spring, if its target can be set.
    pub(crate) fn spring_mut(&mut self) -> Option<&mut Spring> {
        match self {
            JointKind::Revolute(Revolute { spring, .. })
            | JointKind::Prismatic(Prismatic { spring, .. })
            | JointKind::Distance(Distance { spring, .. })
            | JointKind::Wheel(Wheel { spring, .. }) => spring.as_mut(),
            JointKind::Weld(_)
            | JointKind::Motor(_)
            | JointKind::Filter
            | JointKind::Gear(_)
            | JointKind::Rack(_)
            | JointKind::Pulley(_) => None,
        }
    }

    /// The limit, if the kind can have one.
    pub(crate) fn limit_mut(&mut self) -> Option<&mut Option<JointLimit>> {
        match self {
            JointKind::Revolute(Revolute { limit, .. })
            | JointKind::Prismatic(Prismatic { limit, .. })
            | JointKind::Distance(Distance { limit, .. })
            | JointKind::Wheel(Wheel { limit, .. }) => Some(limit),
            JointKind::Weld(_)
            | JointKind::Motor(_)
            | JointKind::Filter
            | JointKind::Gear(_)
            | JointKind::Rack(_)
            | JointKind::Pulley(_) => None,
        }
    }
}

macro_rules! into_kind {
    ($($name:ident)*) => {
        $(impl From<$name> for JointKind {
            fn from(kind: $name) -> Self {
                JointKind::$name(kind)
            }
        })*
    };
}

into_kind!(Revolute Prismatic Distance Weld Wheel Motor Gear Rack Pulley);
