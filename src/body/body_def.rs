//! What to spawn: a body's definition, as a builder.

use serde::{Deserialize, Serialize};

use super::error::WorldError;
use super::mass::MassSource;
use super::settings::{BodySettings, Continuous};
use super::shape::WORLD_EXTENT_MAX;
use crate::math::{Angle, Fx, Vec2};

/// What moves a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum BodyKind {
    /// Nothing: ground and walls.
    Fixed,
    /// Its velocity alone: lifts and doors. It pushes dynamic bodies and nothing pushes it.
    Kinematic,
    /// Forces, contacts and joints.
    Dynamic,
}

/// What to spawn.
///
/// ```
/// use lockstep2d::{body::BodyDef, fx};
/// let ball = BodyDef::dynamic().position((fx!(0), fx!(10))).velocity((fx!(2), fx!(0)));
/// let ground = BodyDef::fixed();
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BodyDef {
    /// What moves it.
    pub kind: BodyKind,
    /// Its origin in the world, in metres.
    pub position: Vec2<Fx>,
    /// Its rotation.
    pub angle: Angle,
    /// Velocity of its centre of mass in m/s.
    pub velocity: Vec2<Fx>,
    /// Angular velocity in rad/s, counter-clockwise.
    pub angular_velocity: Fx,
    /// Where its mass comes from, if it is dynamic.
    pub mass: MassSource,
    /// How it takes part in the simulation.
    pub settings: BodySettings,
    /// Whether it takes part at all: a disabled body keeps its place, and nothing touches it.
    pub enabled: bool,
    /// Whether it starts asleep. Only dynamic bodies sleep.
    pub asleep: bool,
    /// Not used by the engine, but part of the state and its hash.
    pub user_data: u64,
}

impl BodyDef {
    /// A body of some kind at rest at the origin.
    #[must_use]
    pub const fn new(kind: BodyKind) -> Self {
        BodyDef {
            kind,
            position: Vec2::new(Fx::ZERO, Fx::ZERO),
            angle: Angle::ZERO,
            velocity: Vec2::new(Fx::ZERO, Fx::ZERO),
            angular_velocity: Fx::ZERO,
            mass: MassSource::Shapes,
            settings: BodySettings::new(),
            enabled: true,
            asleep: false,
            user_data: 0,
        }
    }

    /// A body that does not move.
    #[must_use]
    pub const fn fixed() -> Self {
        Self::new(BodyKind::Fixed)
    }

    /// A body that only its velocity moves.
    #[must_use]
    pub const fn kinematic() -> Self {
        Self::new(BodyKind::Kinematic)
    }

    /// A body that forces, contacts and joints move.
    #[must_use]
    pub const fn dynamic() -> Self {
        Self::new(BodyKind::Dynamic)
    }

    /// Sets the origin in the world, in metres.
    #[must_use]
    pub fn position(mut self, position: impl Into<Vec2<Fx>>) -> Self {
        self.position = position.into();
        self
    }

    /// Sets the rotation.
    #[must_use]
    pub const fn angle(mut self, angle: Angle) -> Self {
        self.angle = angle;
        self
    }

    /// Sets the velocity of the centre of mass, in m/s.
    #[must_use]
    pub fn velocity(mut self, velocity: impl Into<Vec2<Fx>>) -> Self {
        self.velocity = velocity.into();
        self
    }

    /// Sets the angular velocity in rad/s, counter-clockwise.
    #[must_use]
    pub const fn angular_velocity(mut self, omega: Fx) -> Self {
        self.angular_velocity = omega;
        self
    }

    /// Sets where the mass comes from.
    #[must_use]
    pub const fn mass(mut self, mass: MassSource) -> Self {
        self.mass = mass;
        self
    }

    /// Sets how fast the velocity decays, per second.
    #[must_use]
    pub const fn linear_damping(mut self, rate: Fx) -> Self {
        self.settings.linear_damping = rate;
        self
    }

    /// Sets how fast the angular velocity decays, per second.
    #[must_use]
    pub const fn angular_damping(mut self, rate: Fx) -> Self {
        self.settings.angular_damping = rate;
        self
    }

    /// Sets how much of the world's gravity it feels.
    #[must_use]
    pub const fn gravity_scale(mut self, scale: Fx) -> Self {
        self.settings.gravity_scale = scale;
        self
    }

    /// Keeps it from turning.
    #[must_use]
    pub const fn lock_rotation(mut self) -> Self {
        self.settings.locks.rotation = true;
        self
    }

    /// Keeps it from moving along the world's x axis.
    #[must_use]
    pub const fn lock_x(mut self) -> Self {
        self.settings.locks.x = true;
        self
    }

    /// Keeps it from moving along the world's y axis.
    #[must_use]
    pub const fn lock_y(mut self) -> Self {
        self.settings.locks.y = true;
        self
    }

    /// Sets what it is swept against.
    #[must_use]
    pub const fn continuous(mut self, continuous: Continuous) -> Self {
        self.settings.continuous = continuous;
        self
    }

    /// Sweeps it against all other bodies, so that it passes through none of them.
    #[must_use]
    pub const fn bullet(self) -> Self {
        self.continuous(Continuous::Bullet)
    }

    /// Keeps it from falling asleep.
    #[must_use]
    pub const fn never_sleeps(mut self) -> Self {
        self.settings.may_sleep = false;
        self
    }

    /// Sets the speed below which it grows sleepy, in m/s.
    #[must_use]
    pub const fn sleep_speed(mut self, speed: Fx) -> Self {
        self.settings.sleep_speed = speed;
        self
    }

    /// Starts it asleep: it costs nothing until something touches it.
    #[must_use]
    pub const fn asleep(mut self) -> Self {
        self.asleep = true;
        self
    }

    /// Starts it disabled.
    #[must_use]
    pub const fn disabled(mut self) -> Self {
        self.enabled = false;
        self
    }

    /// Sets the user data.
    #[must_use]
    pub const fn user_data(mut self, user_data: u64) -> Self {
        self.user_data = user_data;
        self
    }

    /// Checks everything but mass and speed, which depend on shapes and on the world.
    pub(crate) fn validate(&self) -> Result<(), WorldError> {
        check_position(self.position)?;
        self.settings.validate()
    }
}

/// Checks that a position is inside the world.
pub(crate) fn check_position(position: Vec2<Fx>) -> Result<(), WorldError> {
    for value in [position.x, position.y] {
        if !(-WORLD_EXTENT_MAX..=WORLD_EXTENT_MAX).contains(&value) {
            return Err(WorldError::PositionOutOfRange { value });
        }
    }
    Ok(())
}
