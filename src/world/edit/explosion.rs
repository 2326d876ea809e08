//! Explosions: impulses on the dynamic bodies near a point.
//!
//! ```text
//! P = I(d) w n      P  impulse on a shape at distance d
//!                   I  impulse per metre: constant up to the radius, then falling linearly to 0 over the falloff
//!                   w  width of the shape across n
//!                   n  unit vector away from the centre of the explosion
//! ```
//!
//! The formula comes from Box2D's `b2World_Explode`. The impulse acts at the point of the shape nearest to the centre,
//! or at the middle of a shape that contains the centre.

use alloc::vec::Vec;

use crate::body::{BodyId, Shape, WorldError, check_position};
use crate::collision::{SupportShape, contains_point, distance};
use crate::fx;
use crate::math::{Fx, Unit, Vec2, fx_div, fx_mul};
use crate::world::World;

/// Margin in metres on the search radius. It is larger than the rounding errors of distances.
const SLACK: Fx = fx!(0.000001);

/// Work units for each shape in reach.
const SHAPE_WORK: u64 = 2;

impl World {
    /// Applies an impulse away from the explosion's centre to the dynamic bodies in reach, shape by shape in slot
    /// order, and wakes them. Leaves out sensors, shapes outside of the mask and disabled bodies.
    ///
    /// # Errors
    /// [`WorldError::ExplosionOutOfRange`] or [`WorldError::PositionOutOfRange`] if a value is out of range.
    #[doc(alias = "blast")]
    pub fn explode(&mut self, explosion: &Explosion) -> Result<(), WorldError> {
        explosion.validate()?;
        let mut slots = Vec::new();
        let reach = explosion.radius + explosion.falloff + SLACK;
        self.scratch.shapes.broad_phase().each_near(explosion.centre, reach, |slot| {
            slots.push(slot);
            reach
        });
        slots.sort_unstable();
        for slot in slots {
            if !self.scratch.meter.spend(SHAPE_WORK) {
                break;
            }
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
        let support = SupportShape::of(self.scratch.shapes.poses().at(slot), explosion.centre);
        match explosion.on(&support) {
            Some(Push { impulse, point }) => self.push_body(body, impulse, point),
            None => Ok(()),
        }
    }

    fn push_body(&mut self, body: BodyId, impulse: Vec2<Fx>, point: Vec2<Fx>) -> Result<(), WorldError> {
        self.dynamic_body(body)?.apply_impulse(impulse, point);
        Ok(())
    }
}

struct Push {
    /// Impulse in N s.
    impulse: Vec2<Fx>,
    /// Point in the world, in metres.
    point: Vec2<Fx>,
}

/// An explosion; see [`World::explode`].
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
    /// Centre in the world, in metres.
    pub centre: Vec2<Fx>,
    /// Distance from the centre in metres up to which the impulse is constant, 0 to 1000.
    pub radius: Fx,
    /// Distance in metres, 0 to 1000, over which the impulse falls to 0 beyond the radius.
    pub falloff: Fx,
    /// Impulse in N s per metre of a shape's width, ±2^20. A negative impulse pulls.
    pub impulse_per_length: Fx,
    /// Categories of the shapes that the explosion acts on.
    pub mask: u64,
}

impl Explosion {
    /// An explosion with a radius of 1 m and a falloff of 1 m that acts on all categories.
    #[must_use]
    pub const fn new(centre: Vec2<Fx>, impulse_per_length: Fx) -> Self {
        Explosion { centre, radius: Fx::ONE, falloff: Fx::ONE, impulse_per_length, mask: u64::MAX }
    }

    fn validate(&self) -> Result<(), WorldError> {
        check_position(self.centre)?;
        let check = |what, value, min, max| match (min..=max).contains(&value) {
            true => Ok(()),
            false => Err(WorldError::ExplosionOutOfRange { what, value, min, max }),
        };
        check("radius in m", self.radius, Fx::ZERO, fx!(1000))?;
        check("falloff in m", self.falloff, Fx::ZERO, fx!(1000))?;
        check("impulse in N s per metre", self.impulse_per_length, fx!(-1048576), fx!(1048576))
    }

    fn pushes(&self, shape: &Shape) -> bool {
        !shape.is_sensor() && shape.filter().category & self.mask != 0
    }

    /// The impulse on a shape, which is given relative to the explosion's centre. `None` if the shape is out of reach.
    fn on(&self, shape: &SupportShape) -> Option<Push> {
        let found = distance(shape, &SupportShape::point(Vec2::ZERO));
        let strength = self.at_distance(found.distance);
        if strength == Fx::ZERO {
            return None;
        }
        // If the centre is inside the shape, the nearest surface point gives no direction. The middle of the shape is
        // used instead.
        let inside = contains_point(shape, Vec2::ZERO);
        let point = if inside { shape.middle() } else { found.point_a };
        let away = if inside { point.normalized() } else { Some(-found.normal) };
        let away: Vec2<Unit> = away.unwrap_or(Vec2::X);
        let impulse = away.widen().scale(fx_mul(strength, shape.extent(away.perp())));
        Some(Push { impulse, point: self.centre + point })
    }

    /// Impulse in N s per metre of width at a distance in metres from the centre.
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
