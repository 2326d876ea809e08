//! The wheel: a slider that may turn. Motor on the angle; spring and limits along the axis; one row across it.

use serde::{Deserialize, Serialize};

use super::options::{Drive, Limit, Spring};
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

    /// Sets the range of the translation in metres.
    #[must_use]
    pub const fn limit(mut self, lower: Fx, upper: Fx) -> Self {
        self.limit = Some(Limit { lower, upper });
        self
    }

    /// Sets an angular velocity in rad/s to go for, and the largest torque in N m.
    #[must_use]
    pub const fn motor(mut self, speed: Fx, max_torque: Fx) -> Self {
        self.motor = Some(Drive { speed, max: max_torque });
        self
    }

    /// Sets a translation in metres to swing about, with a frequency in Hz.
    #[must_use]
    pub const fn spring(mut self, hertz: Fx, damping_ratio: Fx, target: Fx) -> Self {
        self.spring = Some(Spring { hertz, damping_ratio, target });
        self
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        Limit::check(self.limit)?;
        Drive::check(self.motor)?;
        Spring::check(self.spring)
    }

    pub(super) fn prepare(&self, parts: &mut Parts<'_>) {
        parts.drive(Direction::Angle, self.motor);
        parts.spring(Direction::Along, self.spring);
        parts.limit(Direction::Along, self.limit);
        parts.hold(slot::HOLD, Direction::Across, Fx::ZERO);
    }
}
