//! The prismatic joint: B slides along the x axis of A's frame and does not rotate relative to A.
//!
//! With the axis `n` fixed in A and the vector `d` from A's anchor to B's anchor, the rows along the axis have
//! `J v = n.(v_b - v_a) + (r_b x n) w_b - ((d + r_a) x n) w_a` (E. Catto, Box2D). The row across the axis acts at the
//! point at which its impulse does not rotate the bodies relative to each other. If it acted at B's anchor, it would
//! disturb the row on the angle: at a mass ratio of 100, the error of the angle would be three to ten times as large.

use serde::{Deserialize, Serialize};

use super::options::{Drive, JointLimit, Spring, check_options, option_builders};
use super::parts::{Direction, Parts, slot};
use crate::body::WorldError;
use crate::math::Fx;

/// A slider: B's anchor stays on the x axis of A's frame, and B's frame stays parallel to A's.
///
/// The translation is the position of B's anchor along this x axis, in metres. If A can turn, keep B's anchor within 88
/// radii of gyration of A from A's centre of mass: longer lever arms are clamped.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let a = world.spawn(&BodyDef::fixed(), &[])?;
/// # let b = world.spawn(&BodyDef::dynamic().position((fx!(2), fx!(0))), &[square])?;
/// use lockstep2d::{math::Angle, solver::{JointDef, Prismatic}};
/// // A lift: up and down by 3 m, driven at 1 m/s with at most 100 kN.
/// let lift = Prismatic::new().limit(fx!(0), fx!(3)).motor(fx!(1), fx!(100000));
/// let mut def = JointDef::new(a, b, lift).anchor_a((fx!(2), fx!(0)));
/// def.frame_a.angle = Angle::from_degrees(fx!(90));
/// def.frame_b.angle = Angle::from_degrees(fx!(90));
/// world.add_joint(&def)?;
/// (0..240).for_each(|_| world.step());
/// assert!(world.body(b).is_some_and(|lift| (lift.position().y - fx!(3)).abs() < fx!(0.02)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "slider")]
#[doc(alias = "SliderJoint")]
#[doc(alias = "PrismaticJoint")]
pub struct Prismatic {
    /// Range of the translation in metres.
    pub limit: Option<JointLimit>,
    /// Motor along the axis: speed in m/s, largest force in N. It does not drive beyond `limit`.
    pub motor: Option<Drive>,
    /// Spring with a target translation in metres.
    pub spring: Option<Spring>,
}

impl Prismatic {
    /// A slider that moves freely along its axis.
    #[must_use]
    pub const fn new() -> Self {
        Prismatic { limit: None, motor: None, spring: None }
    }

    option_builders! {
        /// Sets the range of the translation in metres.
        limit(lower, upper) => JointLimit { lower, upper };
        /// Sets the target speed in m/s and the largest force in N.
        motor(speed, max_force) => Drive { speed, max: max_force };
        /// Sets a spring: frequency in Hz, target in metres.
        spring(hertz, damping_ratio, target) => Spring { hertz, damping_ratio, target };
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        check_options(self.limit, self.motor, self.spring)
    }

    pub(super) fn prepare(&self, parts: &mut Parts<'_>) {
        parts.spring(Direction::Along, self.spring);
        parts.drive_within(Direction::Along, self.motor, self.limit);
        parts.limit(Direction::Along, self.limit);
        parts.hold(slot::HOLD, Direction::Angle, Fx::ZERO);
        parts.hold(slot::HOLD + 1, Direction::AcrossBalanced, Fx::ZERO);
    }
}
