//! The hinge: a point block that is refreshed after every displacement, arms and gains together.
//!
//! Gains older than their arms over-correct and explode at long arms, and arms kept for the tick blow a grid of
//! joints up (`docs/DESIGN.md` has the figures). Spring, motor and limits are rows on the angle, with the Jacobian
//! `w_b - w_a`.

use serde::{Deserialize, Serialize};

use super::hinge::AngleParts;
use super::options::{Drive, Limit, Spring, check_options, option_builders};
use crate::body::WorldError;
use crate::math::Fx;

/// A hinge: pins A's anchor to B's.
///
/// Under a steady pull that would accelerate a body by `a`, the anchors of a hinge at rest come apart by `a / (2 pi f)^2`, where
/// `f` is [`SolverSettings::joint_hertz`](crate::solver::SolverSettings::joint_hertz), or twice that for a body that has no other
/// joint on one that is not dynamic: at 60 Hz its weight opens a rotor's hinge by 18 µm, and one with another joint by 70 µm.
///
/// The angle of the joint is that of B's frame in A's, in radians, counter-clockwise. It counts turns, so a limit may be
/// wider than one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Revolute {
    /// Range of the angle in radians.
    pub limit: Option<Limit>,
    /// Goes for an angular velocity in rad/s with up to a torque in N m.
    pub motor: Option<Drive>,
    /// Goes for an angle in radians.
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
        limit(lower, upper) => Limit { lower, upper };
        /// Sets an angular velocity in rad/s to go for, and the largest torque in N m.
        motor(speed, max_torque) => Drive { speed, max: max_torque };
        /// Sets an angle in radians to swing about, with a frequency in Hz.
        spring(hertz, damping_ratio, target) => Spring { hertz, damping_ratio, target };
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        check_options(self.limit, self.motor, self.spring)
    }

    /// Its rows on the angle.
    pub(super) fn angle_parts(&self) -> AngleParts {
        AngleParts { spring: self.spring, held: false, drive: self.motor, limit: self.limit }
    }
}
