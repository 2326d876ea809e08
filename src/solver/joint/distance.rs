//! The distance joint: rows along the line between the anchors, `J v = n.(v_b - v_a) + (r_b x n) w_b - (r_a x n) w_a`.

use serde::{Deserialize, Serialize};

use super::options::{
    Drive, JointLimit, SIZE_MAX, Spring, check, check_options, check_strength, option_builders,
};
use super::parts::{Direction, Parts, slot};
use crate::body::WorldError;
use crate::fx;
use crate::math::Fx;

/// A distance joint: a rod, a rope, a spring, or a spring with limits.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let a = world.spawn(&BodyDef::fixed(), &[])?;
/// # let b = world.spawn(&BodyDef::dynamic().position((fx!(2), fx!(0))), &[square])?;
/// use lockstep2d::solver::{Distance, JointDef};
/// // A rope of 2 m; `Distance::rod` also pushes, and `Distance::new().spring(..)` is elastic.
/// world.add_joint(&JointDef::new(a, b, Distance::rope(fx!(2))))?;
/// (0..60).for_each(|_| world.step());
/// assert!(world.body(b).is_some_and(|body| body.position().length() < fx!(2.01)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "rope")]
#[doc(alias = "rod")]
#[doc(alias = "DistanceJoint")]
#[doc(alias = "RopeJoint")]
pub struct Distance {
    /// Length in metres that is held rigidly, 0.001 to 2^20.
    pub rod: Option<Fx>,
    /// Range of the length in metres, 0 or more.
    pub limit: Option<JointLimit>,
    /// Motor along the line: speed in m/s, positive if the anchors move apart, and largest force in N. The motor does
    /// not drive beyond `rod` or `limit`.
    pub motor: Option<Drive>,
    /// Spring whose target is a length in metres, 0 or more.
    pub spring: Option<Spring>,
    /// Smallest force of the spring in N, 0 or less, and largest, 0 or more. Positive forces push the anchors apart.
    pub spring_force: Option<JointLimit>,
}

/// Shortest rod in metres, because shorter rods have no well-defined direction.
const ROD_MIN: Fx = fx!(0.001);

impl Distance {
    /// A joint that allows any length.
    #[must_use]
    pub const fn new() -> Self {
        Distance { rod: None, limit: None, motor: None, spring: None, spring_force: None }
    }

    /// Holds a length in metres rigidly.
    #[must_use]
    pub const fn rod(length: Fx) -> Self {
        Distance { rod: Some(length), ..Self::new() }
    }

    /// Limits the length to `length` metres.
    #[must_use]
    pub const fn rope(length: Fx) -> Self {
        Self::new().limit(Fx::ZERO, length)
    }

    option_builders! {
        /// Sets the range of the length in metres.
        limit(lower, upper) => JointLimit { lower, upper };
        /// Sets the speed in m/s at which the anchors move apart, and the largest force in N.
        motor(speed, max_force) => Drive { speed, max: max_force };
        /// Sets a spring: frequency in Hz, length in metres.
        spring(hertz, damping_ratio, length) => Spring { hertz, damping_ratio, target: length };
        /// Sets the smallest and the largest force of the spring in N. Positive forces push the anchors apart.
        spring_force(lower, upper) => JointLimit { lower, upper };
    }

    /// The allowed length in metres nearest to `length`.
    pub(crate) fn nearest_allowed(&self, length: Fx) -> Fx {
        match (self.rod, self.limit) {
            (Some(rod), _) => rod,
            (None, Some(limit)) => length.max(limit.lower).min(limit.upper),
            (None, None) => length,
        }
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        if let Some(length) = self.rod {
            check("rod length in m", length, ROD_MIN, SIZE_MAX)?;
        }
        if let Some(limit) = self.limit {
            check("lower limit in m", limit.lower, Fx::ZERO, SIZE_MAX)?;
            check("upper limit in m", limit.upper, Fx::ZERO, Fx::MAX)?;
        }
        if let Some(spring) = self.spring {
            check("spring length in m", spring.target, Fx::ZERO, SIZE_MAX)?;
        }
        check_options(self.limit, self.motor, self.spring)?;
        let Some(JointLimit { lower, upper }) = self.spring_force else { return Ok(()) };
        check("smallest spring force in N", lower, Fx::MIN, Fx::ZERO)?;
        check_strength("largest spring force in N", upper)
    }

    pub(super) fn prepare(&self, parts: &mut Parts<'_>) {
        let force = self.spring_force.unwrap_or(JointLimit { lower: Fx::MIN, upper: Fx::MAX });
        parts.spring_within(Direction::Apart, self.spring, force);
        let held = self.rod.map(|length| JointLimit { lower: length, upper: length });
        parts.drive_within(Direction::Apart, self.motor, held.or(self.limit));
        parts.limit(Direction::Apart, self.limit);
        if let Some(length) = self.rod {
            parts.hold(slot::HOLD, Direction::Apart, length);
        }
    }
}
