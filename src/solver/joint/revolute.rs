//! The revolute joint: a point block, and spring, motor and limits on the angle.
//!
//! Arms and gains are both updated after every displacement. If only the arms were updated, joints with long arms would
//! over-correct and explode. If neither were updated within a tick, a grid of joints would explode.

use serde::{Deserialize, Serialize};

use super::hinge::AngleParts;
use super::options::{Drive, JointLimit, Spring, check_options, option_builders};
use crate::body::WorldError;
use crate::math::Fx;

/// A revolute joint, or hinge: pins A's anchor to B's.
///
/// A steady acceleration `a` of a body separates the anchors by `a / (2 pi f)^2`. Here `f` is the frequency of
/// [`JointDef::softness`](crate::solver::JointDef::softness), or else of
/// [`SolverSettings::joint_hertz`](crate::solver::SolverSettings::joint_hertz). `joint_hertz` is doubled if one of the
/// bodies has no other joint and the other body is not dynamic. With the default of 60 Hz, gravity separates the
/// anchors of a rotor on a fixed body by 18 µm, or by 70 µm if the rotor has another joint.
///
/// The angle of the joint is the angle of B's frame relative to A's frame, in radians, counter-clockwise. It includes
/// whole turns.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let a = world.spawn(&BodyDef::fixed(), &[])?;
/// # let b = world.spawn(&BodyDef::dynamic().position((fx!(2), fx!(0))), &[square])?;
/// use lockstep2d::solver::{JointDef, Revolute};
/// // A door that opens by up to 1.5 rad and is pulled shut.
/// let door = Revolute::new().limit(fx!(0), fx!(1.5)).spring(fx!(1), fx!(1), fx!(0));
/// let door = world.add_joint(&JointDef::new(a, b, door).anchor_b((fx!(-2), fx!(0))))?;
/// world.step();
/// assert!(world.joint_angle(door).is_some_and(|angle| angle.abs() < fx!(0.01)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "hinge")]
#[doc(alias = "pin joint")]
#[doc(alias = "HingeJoint")]
#[doc(alias = "RevoluteJoint")]
pub struct Revolute {
    /// Range of the angle in radians.
    pub limit: Option<JointLimit>,
    /// Motor on the angle: angular velocity in rad/s, largest torque in N m.
    pub motor: Option<Drive>,
    /// Spring with a target angle in radians.
    pub spring: Option<Spring>,
}

impl Revolute {
    /// A hinge that turns freely.
    #[must_use]
    pub const fn new() -> Self {
        Revolute { limit: None, motor: None, spring: None }
    }

    option_builders! {
        /// Sets the range of the angle in radians.
        limit(lower, upper) => JointLimit { lower, upper };
        /// Sets the target speed in rad/s and the largest torque in N m.
        motor(speed, max_torque) => Drive { speed, max: max_torque };
        /// Sets a spring: frequency in Hz, target in radians.
        spring(hertz, damping_ratio, target) => Spring { hertz, damping_ratio, target };
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        check_options(self.limit, self.motor, self.spring)
    }

    pub(super) fn angle_parts(&self) -> AngleParts {
        AngleParts { spring: self.spring, held: false, drive: self.motor, limit: self.limit }
    }
}
