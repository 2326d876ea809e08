//! The motor joint: motors and springs with limited force on the angle and on the anchors.
//!
//! A force limit of the motor joint is isotropic: it bounds the length of the impulse `p = G L` of a point block.

use serde::{Deserialize, Serialize};

use super::options::{Drive, JointLimit, Soft, check_sane, check_strength, option_builders};
use super::parts::{Direction, Parts, slot};
use crate::body::WorldError;
use crate::math::{Fx, Vec2};

/// A motor joint: moves B's frame relative to A's with limited force and torque.
///
/// At speed 0 it acts as friction, as on a table seen from above. With springs it pulls the frames onto each other: a
/// body A that follows a pointer drags B.
///
/// Forces act on both bodies at B's anchor, so that a sideways force on B also turns A. If both bodies are dynamic, B's
/// anchor may be too far from A's centre of mass: more than 88 of A's radii of gyration along an axis. Forces then act
/// at a nearer point, or along the line between the centres of mass.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let a = world.spawn(&BodyDef::fixed(), &[])?;
/// # let b = world.spawn(&BodyDef::dynamic().position((fx!(2), fx!(0))), &[square])?;
/// use lockstep2d::solver::{JointDef, Motor};
/// // Drags `b` after the point `a` like a mouse: 5 Hz, at most 200 N.
/// world.add_joint(&JointDef::new(a, b, Motor::new().linear_spring(fx!(5), fx!(1), fx!(200))))?;
/// (0..120).for_each(|_| world.step());
/// assert!(world.body(b).is_some_and(|body| body.position().length() < fx!(0.1)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "mouse joint")]
#[doc(alias = "MouseJoint")]
#[doc(alias = "target joint")]
#[doc(alias = "MotorJoint")]
pub struct Motor {
    /// Drives B's anchor to a velocity relative to A's frame
    /// ([`World::joint_velocity`](crate::world::World::joint_velocity)). If A rotates, the motor drives B around with
    /// A.
    pub linear: Option<LinearDrive>,
    /// Drives B to an angular velocity relative to A in rad/s, with limited torque in N m.
    pub angular: Option<Drive>,
    /// Pulls the anchors onto each other, with limited force in N and isotropic stiffness ([`Soft`]). The damping also
    /// acts perpendicular to the spring.
    pub linear_spring: Option<Pull>,
    /// Rotates the frames towards the same angle, with limited torque in N m.
    pub angular_spring: Option<Pull>,
}

/// A linear motor, which acts along both axes.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, world::World};
/// use lockstep2d::solver::{JointDef, LinearDrive, Motor};
/// use lockstep2d::{fx, math::Vec2};
/// # let mut world = World::default();
/// # world.set_gravity(Vec2::ZERO)?;
/// # let table = world.spawn(&BodyDef::fixed(), &[])?;
/// let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// let puck = world.spawn(&BodyDef::dynamic().velocity((fx!(3), fx!(0))), &[square])?;
/// // Seen from above: friction with the table, 2 N at most, brakes a puck of 1 kg. It loses 2 m/s in each second.
/// let friction = LinearDrive { velocity: Vec2::ZERO, max_force: fx!(2) };
/// let friction = Motor { linear: Some(friction), ..Motor::new() };
/// world.add_joint(&JointDef::new(table, puck, friction))?;
/// (0..60).for_each(|_| world.step());
/// assert!(world.body(puck).is_some_and(|puck| (puck.velocity().x - fx!(1)).abs() < fx!(0.01)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinearDrive {
    /// Target velocity of B's anchor relative to A's frame, in m/s along the world's axes, within ±2^20.
    pub velocity: Vec2<Fx>,
    /// Largest force in N, 0 or more; [`Fx::MAX`] is unlimited.
    pub max_force: Fx,
}

/// A spring with limited force or torque.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, world::World};
/// use lockstep2d::solver::{JointDef, Motor, Pull, Soft};
/// use lockstep2d::{fx, math::Angle};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let pilot = world.spawn(&BodyDef::kinematic().angle(Angle::QUARTER), &[])?;
/// # let ship = world.spawn(&BodyDef::dynamic(), &[square])?;
/// // A ship turns to where its pilot looks, with limited torque.
/// let soft = Soft { hertz: fx!(2), damping_ratio: fx!(1) };
/// let turn = Motor { angular_spring: Some(Pull { soft, max: fx!(50) }), ..Motor::new() };
/// world.add_joint(&JointDef::new(pilot, ship, turn))?;
/// (0..120).for_each(|_| world.step());
/// let angle = world.body(ship).expect("still there").angle();
/// assert!((angle - Angle::QUARTER).to_degrees().abs() < fx!(0.1));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pull {
    /// Frequency and damping.
    pub soft: Soft,
    /// Largest force in N or torque in N m, 0 or more; [`Fx::MAX`] is unlimited.
    pub max: Fx,
}

impl Motor {
    /// A joint without motors and springs.
    #[must_use]
    pub const fn new() -> Self {
        Motor { linear: None, angular: None, linear_spring: None, angular_spring: None }
    }

    /// Sets the target velocity in m/s along the world's axes, and the largest force in N.
    #[must_use]
    pub fn linear(mut self, velocity: impl Into<Vec2<Fx>>, max_force: Fx) -> Self {
        self.linear = Some(LinearDrive { velocity: velocity.into(), max_force });
        self
    }

    option_builders! {
        /// Sets the target speed in rad/s and the largest torque in N m.
        angular(speed, max_torque) => Drive { speed, max: max_torque };
        /// Sets a spring between the anchors: the frequency in Hz with which two point masses would swing, and the
        /// largest force in N.
        linear_spring(hertz, damping_ratio, max_force) =>
            Pull { soft: Soft { hertz, damping_ratio }, max: max_force };
        /// Sets a spring between the angles: frequency in Hz, largest torque in N m.
        angular_spring(hertz, damping_ratio, max_torque) =>
            Pull { soft: Soft { hertz, damping_ratio }, max: max_torque };
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        if let Some(LinearDrive { velocity, max_force }) = self.linear {
            check_sane("linear motor velocity in m/s", velocity.x)?;
            check_sane("linear motor velocity in m/s", velocity.y)?;
            check_strength("largest linear motor force in N", max_force)?;
        }
        Drive::check(self.angular)?;
        if let Some(Pull { soft, max }) = self.linear_spring {
            Soft::check(Some(soft), ["linear spring frequency in Hz", "linear spring damping ratio"])?;
            check_strength("largest linear spring force in N", max)?;
        }
        if let Some(Pull { soft, max }) = self.angular_spring {
            Soft::check(Some(soft), ["angular spring frequency in Hz", "angular spring damping ratio"])?;
            check_strength("largest angular spring torque in N m", max)?;
        }
        Ok(())
    }

    pub(super) fn prepare(&self, parts: &mut Parts<'_>) {
        if let Some(Pull { soft, max }) = self.angular_spring {
            // `Fx::MIN` and `Fx::MAX` stand for no bound.
            let lower = if max == Fx::MAX { Fx::MIN } else { -max };
            let range = JointLimit { lower, upper: max };
            parts.spring_within(Direction::Angle, Some(soft.towards(Fx::ZERO)), range);
        }
        parts.drive(Direction::Angle, self.angular);
        if let Some(Pull { soft, max }) = self.linear_spring {
            parts.pull(slot::LIMIT, soft, max);
        }
        if let Some(LinearDrive { velocity, max_force }) = self.linear {
            parts.push(velocity, max_force);
        }
    }
}
