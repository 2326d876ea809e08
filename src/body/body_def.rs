//! Body definitions.

use serde::{Deserialize, Serialize};

use super::error::WorldError;
use super::mass::MassSource;
use super::name::Name;
use super::settings::{BodySettings, Continuous};
use super::shape::WORLD_EXTENT_MAX;
use crate::math::{Angle, Fx, Vec2};

/// Kind of motion of a body.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, BodyKind, Polygon, ShapeDef}, fx, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// let lift = world.spawn(&BodyDef::kinematic().velocity((fx!(0), fx!(1))), &[square])?;
/// world.step();
/// // The rope of the lift breaks.
/// world.set_kind(lift, BodyKind::Dynamic)?;
/// (0..60).for_each(|_| world.step());
/// assert!(world.body(lift).is_some_and(|lift| lift.velocity().y < fx!(0)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[doc(alias = "BodyType")]
#[doc(alias = "RigidBodyType")]
pub enum BodyKind {
    /// Does not move: ground and walls.
    #[doc(alias = "static")]
    #[doc(alias = "StaticBody")]
    Fixed,
    /// Moves with its velocity, which forces, contacts and joints do not change: lifts and doors.
    Kinematic,
    /// Moves with a velocity that forces, contacts and joints change.
    Dynamic,
}

/// Definition of a body to spawn.
///
/// ```
/// use lockstep2d::{body::BodyDef, fx};
/// let ball = BodyDef::dynamic().position((fx!(0), fx!(10))).velocity((fx!(2), fx!(0)));
/// let ground = BodyDef::fixed();
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "RigidBody")]
#[doc(alias = "RigidBodyBuilder")]
#[doc(alias = "RigidBodyDesc")]
#[doc(alias = "rigid_body")]
pub struct BodyDef {
    /// Kind of motion.
    pub kind: BodyKind,
    /// Origin in the world, in metres.
    pub position: Vec2<Fx>,
    /// Rotation.
    pub angle: Angle,
    /// Velocity of the centre of mass in m/s.
    pub velocity: Vec2<Fx>,
    /// Angular velocity in rad/s, counter-clockwise.
    pub angular_velocity: Fx,
    /// Source of the mass of a dynamic body.
    pub mass: MassSource,
    /// Other settings.
    pub settings: BodySettings,
    /// Whether the body takes part in the simulation. A disabled body keeps its pose and collides with nothing.
    pub enabled: bool,
    /// Whether the body starts asleep. This has an effect only on a dynamic, enabled body in a world with sleeping on.
    pub asleep: bool,
    /// Number for the game's own use. It is part of the state and its hash.
    pub user_data: u64,
    /// Name in reports.
    pub name: Option<Name>,
}

impl BodyDef {
    /// Creates a definition of a body at rest at the origin.
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
            name: None,
        }
    }

    /// Creates a definition of a fixed body.
    #[must_use]
    #[doc(alias = "static")]
    #[doc(alias = "StaticBody")]
    #[doc(alias = "static_body")]
    pub const fn fixed() -> Self {
        Self::new(BodyKind::Fixed)
    }

    /// Creates a definition of a kinematic body.
    #[must_use]
    pub const fn kinematic() -> Self {
        Self::new(BodyKind::Kinematic)
    }

    /// Creates a definition of a dynamic body. Its mass is that of its shapes unless [`BodyDef::mass`] sets it.
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

    /// Sets the source of the mass.
    #[must_use]
    pub const fn mass(mut self, mass: MassSource) -> Self {
        self.mass = mass;
        self
    }

    /// Sets the decay rate of the velocity, per second.
    #[must_use]
    pub const fn linear_damping(mut self, rate: Fx) -> Self {
        self.settings.linear_damping = rate;
        self
    }

    /// Sets the decay rate of the angular velocity, per second.
    #[must_use]
    pub const fn angular_damping(mut self, rate: Fx) -> Self {
        self.settings.angular_damping = rate;
        self
    }

    /// Sets the factor on the world's gravity.
    #[must_use]
    pub const fn gravity_scale(mut self, scale: Fx) -> Self {
        self.settings.gravity_scale = scale;
        self
    }

    /// Locks rotation.
    #[must_use]
    pub const fn lock_rotation(mut self) -> Self {
        self.settings.locks.rotation = true;
        self
    }

    /// Locks motion along the world's x axis.
    #[must_use]
    pub const fn lock_x(mut self) -> Self {
        self.settings.locks.x = true;
        self
    }

    /// Locks motion along the world's y axis.
    #[must_use]
    pub const fn lock_y(mut self) -> Self {
        self.settings.locks.y = true;
        self
    }

    /// Sets the kinds of bodies against which this body is swept: see [`Continuous`].
    #[must_use]
    pub const fn continuous(mut self, continuous: Continuous) -> Self {
        self.settings.continuous = continuous;
        self
    }

    /// Makes the body a bullet: see [`Continuous::Bullet`].
    #[must_use]
    pub const fn bullet(self) -> Self {
        self.continuous(Continuous::Bullet)
    }

    /// Sweeps the body against fixed and kinematic bodies: see [`Continuous::Kinematic`].
    #[must_use]
    pub const fn swept_against_kinematic(self) -> Self {
        self.continuous(Continuous::Kinematic)
    }

    /// Keeps the body from falling asleep by itself: see [`BodySettings::may_sleep`].
    #[must_use]
    pub const fn never_sleeps(mut self) -> Self {
        self.settings.may_sleep = false;
        self
    }

    /// Sets the speed in m/s below which the body becomes ready to sleep: see [`BodySettings::sleep_speed`].
    #[must_use]
    pub const fn sleep_speed(mut self, speed: Fx) -> Self {
        self.settings.sleep_speed = speed;
        self
    }

    /// Starts the body asleep and at rest. Until the body wakes, a sensor that existed before and is at rest does not
    /// detect it.
    #[must_use]
    pub const fn asleep(mut self) -> Self {
        self.asleep = true;
        self
    }

    /// Starts the body disabled.
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

    /// Sets the name.
    #[must_use]
    pub const fn name(mut self, name: Name) -> Self {
        self.name = Some(name);
        self
    }

    /// Validates everything except mass and speed, which depend on the shapes and on the world.
    pub(crate) fn validate(&self) -> Result<(), WorldError> {
        check_position(self.position)?;
        self.settings.validate()?;
        self.name.map_or(Ok(()), |name| name.validate())
    }
}

pub(crate) fn check_position(position: Vec2<Fx>) -> Result<(), WorldError> {
    for value in [position.x, position.y] {
        if !(-WORLD_EXTENT_MAX..=WORLD_EXTENT_MAX).contains(&value) {
            return Err(WorldError::PositionOutOfRange { value });
        }
    }
    Ok(())
}
