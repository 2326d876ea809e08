//! Areas: wind, water and other effects of a sensor on the bodies inside it.
//!
//! An area fills its shape with a medium. `A` is the size in m² of the part of a body's solid shapes that lies inside
//! this shape, `c` the centre of that part, and `s` the ratio of `A` to the size of all solid shapes of the body. For a
//! body of lines, `A` is 0 and `s` is the ratio of the lengths. `M` is the body's mass.
//! ```text
//! dv/dt = s acceleration + s attraction + A force / M - s linear_drag (v - u) - A density field / M
//! dw/dt = A cross(c - p, force - density field) / (M k^2) - s angular_drag (w - w_medium)
//! ```
//!
//! `p` is the body's centre of mass, `k` its radius of gyration, `v` its velocity and `w` its angular velocity. `field`
//! is the world's gravity plus `s (acceleration + attraction)` of each area that acts on the body. `u` is `flow` plus
//! the velocity of the area's body at `p`, and `w_medium` is the angular velocity of the area's body. The effects of
//! several areas add up.

use serde::{Deserialize, Serialize};

use super::error::WorldError;
use super::geometry::Geometry;
use super::shape::DENSITY_MAX;
use crate::fx;
use crate::math::{Fx, Vec2};

/// Largest acceleration in m/s².
const ACCELERATION_MAX: Fx = fx!(10000);
/// Largest force in N/m².
const FORCE_MAX: Fx = fx!(1048576);
/// Largest component of the flow in m/s.
const FLOW_MAX: Fx = fx!(400);
/// Largest drag: a decay rate per second.
const DRAG_MAX: Fx = fx!(1000);
/// Range of an attraction's radius in metres.
const RADIUS: (Fx, Fx) = (fx!(0.01), fx!(1048576));

/// Effect of a sensor on the bodies inside it, such as wind, water or a field of gravity.
///
/// The area acts on dynamic bodies with mass. It acts through the solid shapes that the sensor detects, in proportion
/// to the part of each shape that is inside. Segments and links count only if the body has no other solid shapes.
/// Rounded outlines are measured as polygons of 32 sides, with an error of up to 0.4 % of the radius for circles, and
/// 1.7 % for other rounded outlines. The area's body feels no reaction.
///
/// ```
/// use lockstep2d::{body::{Area, BodyDef, Polygon, ShapeDef}, fx, world::World};
/// let mut world = World::default();
/// let water = Area::fluid(fx!(1)).drag(fx!(2), fx!(2));
/// let pool = ShapeDef::new(Polygon::rectangle(fx!(5), fx!(2))?).area(water);
/// world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-2))), &[pool])?;
/// let cork = ShapeDef::new(Polygon::square(fx!(0.5))?).density(fx!(0.25));
/// let cork = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(1))), &[cork])?;
/// for _ in 0..600 {
///     world.step();
/// }
/// // A quarter of the cork is under water.
/// let height = world.body(cork).expect("still there").position().y;
/// assert!((height - fx!(0.25)).abs() < fx!(0.01));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "Area2D")]
#[doc(alias = "effector")]
#[doc(alias = "buoyancy")]
#[doc(alias = "wind")]
pub struct Area {
    /// Acceleration in m/s², along the axes of the area's body, within ±10 000. It does not depend on the mass of the
    /// bodies inside.
    pub acceleration: Vec2<Fx>,
    /// Acceleration towards the centre of the shape.
    pub attraction: Option<Attraction>,
    /// Force in N per m² of a body's part that is inside, along the axes of the area's body, within ±2^20. Acts as
    /// wind.
    pub force: Vec2<Fx>,
    /// Velocity of the medium in m/s relative to the area's body and along that body's axes, within ±400. It acts only
    /// through drag.
    pub flow: Vec2<Fx>,
    /// Decay rate per second, 0 to 1000, of the velocity relative to the medium.
    pub linear_drag: Fx,
    /// Decay rate per second, 0 to 1000, of the angular velocity relative to the area's body.
    pub angular_drag: Fx,
    /// Mass per area of the medium in kg/m², 0 to 2^20. Buoyancy acts at the centre of the part that is inside, against
    /// gravity and the accelerations of areas.
    pub density: Fx,
}

/// Acceleration towards a point, or away from it.
///
/// ```
/// use lockstep2d::body::{Area, Attraction, BodyDef, Falloff, Geometry, ShapeDef};
/// use lockstep2d::{fx, math::Vec2, world::{Config, World}};
/// let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() })?;
/// // A planet with a radius of 10 m, felt up to 40 m from its centre.
/// let pull = Attraction { acceleration: fx!(5), radius: fx!(10), falloff: Falloff::InverseSquare };
/// let field = ShapeDef::new(Geometry::circle(fx!(40))?).area(Area { attraction: Some(pull), ..Area::new() });
/// world.spawn(&BodyDef::fixed(), &[field])?;
/// let moon = ShapeDef::new(Geometry::circle(fx!(0.5))?);
/// let moon = world.spawn(&BodyDef::dynamic().position((fx!(20), fx!(0))), &[moon])?;
/// world.step();
/// // The pull at twice the radius is 5/4 m/s², and a tick lasts 1/60 s.
/// let speed = world.body(moon).expect("still there").velocity().x * 60;
/// assert!((speed + fx!(1.25)).abs() < fx!(0.01));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "radial gravity")]
#[doc(alias = "planet")]
pub struct Attraction {
    /// Acceleration in m/s² at the distance `radius`, within ±10 000. Negative values repel.
    pub acceleration: Fx,
    /// Distance in metres, 0.01 to 2^20. Within this distance, the acceleration decreases linearly to 0 at the centre.
    pub radius: Fx,
    /// Falloff of the acceleration beyond `radius`.
    pub falloff: Falloff,
}

/// Falloff of an attraction beyond its radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Falloff {
    /// Constant acceleration.
    Constant,
    /// Proportional to `1 / distance`.
    Inverse,
    /// Proportional to `1 / distance²`, as in Newton's law.
    InverseSquare,
}

impl Area {
    /// Creates an area without any effect.
    #[must_use]
    pub fn new() -> Self {
        Area::default()
    }

    /// Creates a fluid with a density in kg/m² and no drag.
    #[must_use]
    pub fn fluid(density: Fx) -> Self {
        Area { density, ..Area::default() }
    }

    /// Sets the acceleration in m/s².
    #[must_use]
    pub fn acceleration(mut self, acceleration: impl Into<Vec2<Fx>>) -> Self {
        self.acceleration = acceleration.into();
        self
    }

    /// Sets an attraction: see [`Attraction`].
    #[must_use]
    pub fn attraction(mut self, acceleration: Fx, radius: Fx, falloff: Falloff) -> Self {
        self.attraction = Some(Attraction { acceleration, radius, falloff });
        self
    }

    /// Sets the force in N/m².
    #[must_use]
    pub fn force(mut self, force: impl Into<Vec2<Fx>>) -> Self {
        self.force = force.into();
        self
    }

    /// Sets the velocity of the medium in m/s.
    #[must_use]
    pub fn flow(mut self, flow: impl Into<Vec2<Fx>>) -> Self {
        self.flow = flow.into();
        self
    }

    /// Sets the decay rates of the velocity and of the angular velocity, per second.
    #[must_use]
    pub fn drag(mut self, linear: Fx, angular: Fx) -> Self {
        (self.linear_drag, self.angular_drag) = (linear, angular);
        self
    }

    /// Sets the density of the medium in kg/m².
    #[must_use]
    pub fn density(mut self, density: Fx) -> Self {
        self.density = density;
        self
    }

    pub(crate) fn validate(&self, geometry: &Geometry) -> Result<(), WorldError> {
        let Area { acceleration, attraction, force, flow, linear_drag, angular_drag, density } = *self;
        match geometry {
            Geometry::Circle { .. } | Geometry::Polygon(_) | Geometry::Capsule { .. } => {}
            Geometry::Segment { .. } | Geometry::Link { .. } => return Err(WorldError::AreaOfLine),
        }
        let check = |what: &'static str, value: Fx, (min, max): (Fx, Fx)| {
            let is_valid = (min..=max).contains(&value);
            is_valid.then_some(()).ok_or(WorldError::AreaOutOfRange { what, value, min, max })
        };
        let vectors = [
            ("acceleration", acceleration, ACCELERATION_MAX),
            ("force", force, FORCE_MAX),
            ("flow", flow, FLOW_MAX),
        ];
        for (what, vector, max) in vectors {
            check(what, vector.x, (-max, max))?;
            check(what, vector.y, (-max, max))?;
        }
        check("linear drag", linear_drag, (Fx::ZERO, DRAG_MAX))?;
        check("angular drag", angular_drag, (Fx::ZERO, DRAG_MAX))?;
        check("density", density, (Fx::ZERO, DENSITY_MAX))?;
        if let Some(Attraction { acceleration, radius, falloff: _ }) = attraction {
            check("attraction", acceleration, (-ACCELERATION_MAX, ACCELERATION_MAX))?;
            check("radius of attraction", radius, RADIUS)?;
        }
        Ok(())
    }
}
