//! Explosions: pushes on whatever is near a point.
//!
//! ```text
//! P = I(d) w n      w  the width of a shape as seen from the centre, across n
//!                   I  impulse for each metre: full up to the radius, from there on fading to nothing
//! ```
//!
//! as Box2D's `b2World_Explode` does: a shape at distance `d` is pushed at its nearest point, away from the centre. For
//! the impulse to be a pressure that has spread on a circle it would have to fade as `1 / d`; the radius and the linear
//! fading are what games ask for.

use alloc::vec::Vec;

use super::World;
use crate::body::{BodyId, Shape, WorldError, check_position};
use crate::collision::{Core, contains_point, distance};
use crate::fx;
use crate::math::{Fx, Unit, Vec2, fx_div, fx_mul};

/// More than the rounding of distances, in metres: the search for boxes must not leave out what is just in reach.
const SLACK: Fx = fx!(0.000001);

impl World {
    /// Pushes every dynamic body near a point away from it, shape by shape in slot order, and wakes it. Sensors and
    /// disabled bodies are not pushed; speeds stay in their range.
    ///
    /// # Errors
    /// [`WorldError::Setting`] when a value of the explosion is out of range, [`WorldError::PositionOutOfRange`] when
    /// its centre is.
    pub fn explode(&mut self, explosion: &Explosion) -> Result<(), WorldError> {
        explosion.validate()?;
        let mut slots = Vec::new();
        let reach = explosion.radius + explosion.falloff + SLACK;
        self.scratch.broad_phase.each_near(explosion.centre, reach, |slot| {
            slots.push(slot);
            reach
        });
        slots.sort_unstable();
        for slot in slots {
            self.push_shape(slot, explosion)?;
        }
        Ok(())
    }

    fn push_shape(&mut self, slot: u32, explosion: &Explosion) -> Result<(), WorldError> {
        let shape = self.state.shapes.at(slot);
        let body = shape.body();
        if !explosion.pushes(shape) || !self.body(body).is_some_and(|body| body.is_dynamic() && body.enabled)
        {
            return Ok(());
        }
        let core = Core::of(self.scratch.poses.at(slot), explosion.centre);
        match explosion.on(&core) {
            Some(Push { impulse, point }) => self.push_body(body, impulse, point),
            None => Ok(()),
        }
    }

    fn push_body(&mut self, body: BodyId, impulse: Vec2<Fx>, point: Vec2<Fx>) -> Result<(), WorldError> {
        self.dynamic_body(body)?.apply_impulse(impulse, point);
        Ok(())
    }
}

/// What an explosion does to a shape.
struct Push {
    /// In N s.
    impulse: Vec2<Fx>,
    /// Where, in the world.
    point: Vec2<Fx>,
}

/// A push away from a point, on every dynamic body near it.
///
/// ```
/// use lockstep2d::{fx, math::Vec2, world::{Explosion, World}};
/// let mut world = World::default();
/// let at = Vec2::new(fx!(0), fx!(1));
/// world.explode(&Explosion { radius: fx!(3), ..Explosion::new(at, fx!(10)) })?;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Explosion {
    /// Where, in the world, in metres.
    pub centre: Vec2<Fx>,
    /// Distance in metres up to which it has its full strength, 0 to 1000.
    pub radius: Fx,
    /// Distance in metres beyond the radius within which it fades to nothing, 0 to 1000.
    pub falloff: Fx,
    /// Impulse in N s for each metre of a shape that faces the centre, ±2^20; a negative one pulls.
    pub impulse_per_length: Fx,
    /// Categories of shapes that it pushes.
    pub mask: u64,
}

impl Explosion {
    /// An explosion of 1 m radius that fades over another metre and pushes everything.
    #[must_use]
    pub const fn new(centre: Vec2<Fx>, impulse_per_length: Fx) -> Self {
        Explosion { centre, radius: Fx::ONE, falloff: Fx::ONE, impulse_per_length, mask: u64::MAX }
    }

    fn validate(&self) -> Result<(), WorldError> {
        check_position(self.centre)?;
        let distance = Fx::ZERO..=fx!(1000);
        let strength = fx!(-1048576)..=fx!(1048576);
        let valid = distance.contains(&self.radius)
            && distance.contains(&self.falloff)
            && strength.contains(&self.impulse_per_length);
        if valid { Ok(()) } else { Err(WorldError::Setting { name: "explosion" }) }
    }

    fn pushes(&self, shape: &Shape) -> bool {
        !shape.is_sensor() && shape.filter().category & self.mask != 0
    }

    /// The push on a shape that is given about the centre; `None` if it is out of reach.
    fn on(&self, shape: &Core) -> Option<Push> {
        let found = distance(shape, &Core::point(Vec2::ZERO));
        let strength = self.at_distance(found.distance);
        if strength == Fx::ZERO {
            return None;
        }
        // From within, the nearest point of the surface is in no way where the push goes.
        let inside = contains_point(shape, Vec2::ZERO);
        let point = if inside { shape.middle() } else { found.point_a };
        let away = if inside { point.normalized() } else { Some(-found.normal) };
        let away: Vec2<Unit> = away.unwrap_or(Vec2::X);
        let impulse = away.widen().scale(fx_mul(strength, shape.extent(away.perp())));
        Some(Push { impulse, point: self.centre + point })
    }

    /// The impulse for each metre at a distance from the centre.
    fn at_distance(&self, distance: Fx) -> Fx {
        let beyond = distance - self.radius;
        if beyond <= Fx::ZERO {
            return self.impulse_per_length;
        }
        if beyond >= self.falloff {
            return Fx::ZERO;
        }
        let left = fx_div(self.falloff - beyond, self.falloff).unwrap_or(Fx::ZERO);
        fx_mul(self.impulse_per_length, left)
    }
}
