//! The wheel: a slider that may turn. Motor on the angle; spring and limits along the axis; one row across it.

use serde::{Deserialize, Serialize};

use super::options::{Drive, Limit, Spring, check_options, option_builders};
use super::parts::{Direction, Parts, slot};
use crate::body::WorldError;
use crate::math::Fx;

/// A wheel on its suspension: B's anchor stays on the x axis of A's frame, and B turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wheel {
    /// Range of the translation in metres.
    pub limit: Option<Limit>,
    /// Goes for an angular velocity in rad/s with up to a torque in N m.
    pub motor: Option<Drive>,
    /// The suspension: goes for a translation in metres.
    pub spring: Option<Spring>,
}

impl Wheel {
    /// A wheel that turns freely on an axis without suspension.
    #[must_use]
    pub const fn new() -> Self {
        Wheel { limit: None, motor: None, spring: None }
    }

    option_builders! {
        /// Sets the range of the translation in metres.
        limit(lower, upper) => Limit { lower, upper };
        /// Sets an angular velocity in rad/s to go for, and the largest torque in N m.
        motor(speed, max_torque) => Drive { speed, max: max_torque };
        /// Sets a translation in metres to swing about, with a frequency in Hz.
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
