//! Body settings.

use serde::{Deserialize, Serialize};

use super::error::WorldError;
use crate::fx;
use crate::math::Fx;

/// Locked degrees of freedom of a body.
///
/// Contacts and joints treat a body with locked rotation as unable to rotate. They do not take a locked x or y axis
/// into account: instead, every sub-step clears the velocity along that axis after contacts and joints have acted. A
/// body that is pushed both along and across the locked axis therefore takes a few ticks to settle.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, BodySettings, MotionLocks, Polygon, ShapeDef}, fx, math::Vec2, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// // A counterweight in its shaft moves up and down only.
/// let locks = MotionLocks { x: true, rotation: true, y: false };
/// let settings = BodySettings { locks, ..BodySettings::default() };
/// let weight = world.spawn(&BodyDef { settings, ..BodyDef::dynamic() }, &[square])?;
/// world.apply_impulse(weight, Vec2::new(fx!(3), fx!(0)), Vec2::new(fx!(0), fx!(0.5)))?;
/// (0..30).for_each(|_| world.step());
/// let body = world.body(weight).expect("still there");
/// assert_eq!((body.position().x, body.angular_velocity()), (fx!(0), fx!(0)));
/// assert!(body.position().y < fx!(-1));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct MotionLocks {
    /// Locks motion along the world's x axis.
    pub x: bool,
    /// Locks motion along the world's y axis.
    pub y: bool,
    /// Locks rotation.
    pub rotation: bool,
}

/// Kinds of bodies against which a body is swept, so that it does not tunnel through them.
///
/// ```
/// use lockstep2d::body::{BodyDef, Continuous, Polygon, ShapeDef};
/// use lockstep2d::{fx, math::Vec2, world::{Config, World}};
/// let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() })?;
/// let plate = ShapeDef::new(Polygon::rectangle(fx!(0.01), fx!(2))?).density(fx!(50));
/// world.spawn(&BodyDef::dynamic().position((fx!(5), fx!(0))), &[plate])?;
/// // A shot of 300 m/s, 5 m in a tick, meets a plate that is 2 cm thick and free to move.
/// let shot = BodyDef::dynamic().velocity((fx!(300), fx!(0))).continuous(Continuous::Bullet);
/// let shot = world.spawn(&shot, &[ShapeDef::new(Polygon::square(fx!(0.05))?)])?;
/// (0..10).for_each(|_| world.step());
/// assert!(world.body(shot).is_some_and(|shot| shot.velocity().x < fx!(150)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Continuous {
    /// No bodies. This is the cheapest choice, for debris.
    Off,
    /// Fixed bodies.
    #[default]
    Fixed,
    /// Bodies of all kinds, except bullets.
    Bullet,
    /// Fixed bodies, and kinematic bodies relative to which this body is fast. A platform that carries the body does
    /// not count, because it is slow relative to the body. A sleeping body wakes if a kinematic body would pass through
    /// it. The check has a small cost in every tick of a world with kinematic bodies.
    Kinematic,
}

/// Settings of a body: see [`crate::world::World::set_body`].
///
/// ```
/// # use lockstep2d::{body::{BodyDef, BodySettings, Polygon, ShapeDef}, fx, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// let bird = world.spawn(&BodyDef::dynamic(), &[square])?;
/// // The bird learns to fly: one setting of a copy changes, the others stay.
/// let flying = BodySettings { gravity_scale: fx!(0), ..*world.body(bird).expect("just created").settings() };
/// world.set_body(bird, &flying)?;
/// (0..60).for_each(|_| world.step());
/// assert_eq!(world.body(bird).map(|bird| bird.position().y), Some(fx!(0)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BodySettings {
    /// Decay rate of the velocity, per second, 0 to 1000.
    pub linear_damping: Fx,
    /// Decay rate of the angular velocity, per second, 0 to 1000.
    pub angular_damping: Fx,
    /// Factor on the world's gravity, ±1000.
    pub gravity_scale: Fx,
    /// Locked degrees of freedom.
    pub locks: MotionLocks,
    /// Bodies that this body is swept against.
    pub continuous: Continuous,
    /// Whether the body falls asleep by itself. [`World::sleep`](crate::world::World::sleep) ignores this setting.
    pub may_sleep: bool,
    /// Speed in m/s below which the body becomes ready to sleep, 0 to 400. The limit also applies to twice the angular
    /// velocity times the radius of gyration, which is about the speed of the outline. A body falls asleep when it and
    /// the dynamic bodies connected to it have been slower than their limits for half a second.
    pub sleep_speed: Fx,
}

impl Default for BodySettings {
    /// No damping, a gravity scale of 1, no locks, swept against fixed bodies, sleeps below 0.05 m/s.
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
            return Err(WorldError::SleepSpeedOutOfRange { value: sleep_speed });
        }
        Ok(())
    }
}
