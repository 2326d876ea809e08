//! How a body takes part in the simulation, apart from its pose, its mass and its shapes.

use serde::{Deserialize, Serialize};

use super::error::WorldError;
use crate::fx;
use crate::math::Fx;

/// Directions in which a body does not move, however it is pushed.
///
/// A locked rotation is exact: contacts and joints see a body that cannot turn. A locked axis is a velocity that is
/// taken away in every sub-step: what pushes a body both along and across a locked axis settles over a few ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct MotionLocks {
    /// Not along the world's x axis.
    pub x: bool,
    /// Not along the world's y axis.
    pub y: bool,
    /// Does not turn.
    pub rotation: bool,
}

/// What a body is swept against so that it does not pass through it within a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Continuous {
    /// Nothing: cheap, for debris.
    Off,
    /// Fixed bodies. Kinematic ones are left out: what they carry along is fast too, and must not be held back.
    #[default]
    Fixed,
    /// All bodies that are not bullets themselves.
    Bullet,
}

/// How a body takes part in the simulation. [`crate::world::World::set_body`] changes it later.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BodySettings {
    /// Rate at which its velocity decays, per second, 0 to 1000.
    pub linear_damping: Fx,
    /// Rate at which its angular velocity decays, per second, 0 to 1000.
    pub angular_damping: Fx,
    /// How much of the world's gravity it feels, ±1000.
    pub gravity_scale: Fx,
    /// In which directions it does not move.
    pub locks: MotionLocks,
    /// What it is swept against.
    pub continuous: Continuous,
    /// Whether it may fall asleep.
    pub may_sleep: bool,
    /// Speed in m/s below which it grows sleepy, 0 to 400; also of the radius of gyration times twice the angular
    /// velocity, which is about the speed of its outline.
    pub sleep_speed: Fx,
}

impl Default for BodySettings {
    /// No damping and no locks; swept against fixed bodies; sleeps below 0.05 m/s.
    fn default() -> Self {
        Self::new()
    }
}

impl BodySettings {
    pub(crate) const fn new() -> Self {
        BodySettings {
            linear_damping: Fx::ZERO,
            angular_damping: Fx::ZERO,
            gravity_scale: Fx::ONE,
            locks: MotionLocks { x: false, y: false, rotation: false },
            continuous: Continuous::Fixed,
            may_sleep: true,
            sleep_speed: fx!(0.05),
        }
    }

    pub(crate) fn validate(&self) -> Result<(), WorldError> {
        let BodySettings {
            linear_damping,
            angular_damping,
            gravity_scale,
            locks: _,
            continuous: _,
            may_sleep: _,
            sleep_speed,
        } = *self;
        for value in [linear_damping, angular_damping] {
            if !(Fx::ZERO..=fx!(1000)).contains(&value) {
                return Err(WorldError::DampingOutOfRange { value });
            }
        }
        if !(fx!(-1000)..=fx!(1000)).contains(&gravity_scale) {
            return Err(WorldError::GravityScaleOutOfRange { value: gravity_scale });
        }
        if !(Fx::ZERO..=fx!(400)).contains(&sleep_speed) {
            return Err(WorldError::SpeedOutOfRange { value: sleep_speed });
        }
        Ok(())
    }
}
