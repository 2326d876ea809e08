//! The wheel joint: a motor on the angle, a spring and limits along the axis, and a row that holds B on the axis.

use serde::{Deserialize, Serialize};

use super::options::{Drive, JointLimit, Spring, check_options, option_builders};
use super::parts::{Direction, Parts, slot};
use crate::body::WorldError;
use crate::math::Fx;

/// A wheel on its suspension: B's anchor stays on the x axis of A's frame, and B turns freely.
///
/// ```
/// use lockstep2d::solver::Wheel;
/// use lockstep2d::fx;
/// // A soft suspension, and an engine of 40 N m at up to 50 rad/s. The suspension moves along the x axis of A's frame.
/// let wheel = Wheel::new().spring(fx!(4), fx!(0.7), fx!(0)).limit(fx!(-0.2), fx!(0.2)).motor(fx!(50), fx!(40));
/// assert!(wheel.motor.is_some_and(|motor| motor.max == fx!(40)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "suspension")]
#[doc(alias = "WheelJoint")]
pub struct Wheel {
    /// Range of the translation in metres.
    pub limit: Option<JointLimit>,
    /// Motor on the angle: angular velocity in rad/s, largest torque in N m.
    pub motor: Option<Drive>,
    /// The suspension: a spring with a target translation in metres.
    pub spring: Option<Spring>,
}

impl Wheel {
    /// A wheel that turns and slides freely along the axis.
    #[must_use]
    pub const fn new() -> Self {
        Wheel { limit: None, motor: None, spring: None }
    }

    option_builders! {
        /// Sets the range of the translation in metres.
        limit(lower, upper) => JointLimit { lower, upper };
        /// Sets the target speed in rad/s and the largest torque in N m.
        motor(speed, max_torque) => Drive { speed, max: max_torque };
        /// Sets a spring: frequency in Hz, target in metres.
        spring(hertz, damping_ratio, target) => Spring { hertz, damping_ratio, target };
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        check_options(self.limit, self.motor, self.spring)
    }

    pub(super) fn prepare(&self, parts: &mut Parts<'_>) {
        parts.drive(Direction::Angle, self.motor);
        parts.spring(Direction::Along, self.spring);
        parts.limit(Direction::Along, self.limit);
        parts.hold(slot::HOLD, Direction::Across, Fx::ZERO);
    }
}
