//! Shapes: geometry attached to a body, with material and filter.

use alloc::boxed::Box;

use serde::{Deserialize, Serialize};

use super::arena::BodyId;
use super::error::WorldError;
use super::event_switches::EventSwitches;
use super::filter::Filter;
use super::geometry::Geometry;
use super::material::Material;
use crate::fx;
use crate::math::{Aabb, Angle, Fx, Vec2};

/// Coordinates in the world stay within ± this many metres, so that sums of a few of them cannot overflow.
pub const WORLD_EXTENT_MAX: Fx = fx!(1073741824);

/// How far a shape of a body that can move, and an anchor of a joint, may be from the body's origin on each axis of
/// its frame, in metres. The centre of mass is among them, so lever arms are at most 363 m long however the body is
/// turned, and fit `Length`.
pub const REACH_MAX: Fx = fx!(128);

/// Most shapes of one body: changes to a body cost time for each of its shapes.
pub const SHAPES_PER_BODY_MAX: u32 = 4096;

/// The largest density in kg/m².
pub const DENSITY_MAX: Fx = fx!(1048576);

/// What to attach to a body.
///
/// ```
/// use lockstep2d::{body::{Geometry, ShapeDef}, fx};
/// let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?).density(fx!(2)).friction(fx!(0.3));
/// # Ok::<(), lockstep2d::body::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShapeDef {
    /// What it looks like.
    pub geometry: Geometry,
    /// The shape's centre, in metres from the body's origin, in the body's frame.
    pub offset: Vec2<Fx>,
    /// Mass for each area, in kg/m².
    pub density: Fx,
    /// Friction and restitution.
    pub material: Material,
    /// What it collides with.
    pub filter: Filter,
    /// Lets things pass through in one direction: the direction in the body's frame, 90 degrees for up. `None` for an
    /// ordinary shape.
    ///
    /// What touches the shape is stopped if the contact's normal, from this shape to the other, is within 60 degrees
    /// of the direction, and passes otherwise: from above it is a floor, from below and from the sides it is not
    /// there. What passes goes on passing until it is apart or has come through but for a quarter of the world's
    /// speculative distance, so what turns round half-way falls back. A pair that passes does not touch.
    pub one_way: Option<Angle>,
    /// Whether it only notices what it overlaps, and touches nothing. Sensors do not notice each other, and sensors
    /// of fixed bodies do not notice fixed bodies.
    pub sensor: bool,
    /// Which events it takes part in.
    pub events: EventSwitches,
    /// Not used by the engine, but part of the state and its hash.
    pub user_data: u64,
}

impl ShapeDef {
    /// A shape at the body's origin with density 1 and the default material and filter.
    #[must_use]
    pub fn new(geometry: impl Into<Geometry>) -> Self {
        ShapeDef {
            geometry: geometry.into(),
            offset: Vec2::ZERO,
            density: Fx::ONE,
            material: Material::default(),
            filter: Filter::default(),
            one_way: None,
            sensor: false,
            events: EventSwitches::default(),
            user_data: 0,
        }
    }

    /// Sets the centre in the body's frame, in metres.
    #[must_use]
    pub fn offset(mut self, offset: impl Into<Vec2<Fx>>) -> Self {
        self.offset = offset.into();
        self
    }

    /// Sets the density in kg/m², 0 to 2^20.
    #[must_use]
    pub fn density(mut self, density: Fx) -> Self {
        self.density = density;
        self
    }

    /// Sets the friction coefficient, 0 to 16.
    #[must_use]
    pub fn friction(mut self, friction: Fx) -> Self {
        self.material.friction = friction;
        self
    }

    /// Sets the restitution, 0 to 1.
    #[must_use]
    pub fn restitution(mut self, restitution: Fx) -> Self {
        self.material.restitution = restitution;
        self
    }

    /// Sets the rolling resistance, 0 to 1: see [`Material::rolling_resistance`].
    #[must_use]
    pub fn rolling_resistance(mut self, resistance: Fx) -> Self {
        self.material.rolling_resistance = resistance;
        self
    }

    /// Sets how fast the surface runs, clockwise, in m/s: see [`Material::surface_speed`].
    #[must_use]
    pub fn surface_speed(mut self, speed: Fx) -> Self {
        self.material.surface_speed = speed;
        self
    }

    /// Sets the filter.
    #[must_use]
    pub fn filter(mut self, filter: Filter) -> Self {
        self.filter = filter;
        self
    }

    /// Lets things pass through in one direction, given in the body's frame: see [`one_way`](Self::one_way).
    #[must_use]
    pub fn one_way(mut self, direction: Angle) -> Self {
        self.one_way = Some(direction);
        self
    }

    /// Makes it notice what overlaps it without pushing.
    #[must_use]
    pub fn sensor(mut self) -> Self {
        self.sensor = true;
        self
    }

    /// Sets which events it takes part in.
    #[must_use]
    pub fn events(mut self, events: EventSwitches) -> Self {
        self.events = events;
        self
    }

    /// Sets the user data.
    #[must_use]
    pub fn user_data(mut self, user_data: u64) -> Self {
        self.user_data = user_data;
        self
    }

    /// Checks everything that does not depend on the body. `reach_max` does: see [`REACH_MAX`].
    pub(crate) fn validate(&self, reach_max: Fx) -> Result<(), WorldError> {
        let ShapeDef {
            geometry,
            offset,
            density,
            material,
            filter: _,
            one_way: _,
            sensor: _,
            events: _,
            user_data: _,
        } = self;
        geometry.validate()?;
        check_reach(geometry, *offset, reach_max)?;
        if !(Fx::ZERO..=DENSITY_MAX).contains(density) {
            return Err(WorldError::DensityOutOfRange { value: *density });
        }
        if !material.is_valid() {
            return Err(WorldError::MaterialOutOfRange);
        }
        Ok(())
    }
}

/// Checks that a shape is within `reach_max` of the body's origin on each axis.
fn check_reach(geometry: &Geometry, offset: Vec2<Fx>, reach_max: Fx) -> Result<(), WorldError> {
    let bounds = geometry.local_bounds().translated(offset);
    let corners = [offset.x, offset.y, bounds.lower.x, bounds.lower.y, bounds.upper.x, bounds.upper.y];
    match corners.into_iter().find(|corner| !(-reach_max..=reach_max).contains(corner)) {
        Some(value) => Err(WorldError::OffsetOutOfRange { value }),
        None => Ok(()),
    }
}

/// A shape in the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    pub(crate) body: BodyId,
    /// Elsewhere, so that what steps change lies close together: saving it is a matter of memory.
    pub(crate) def: Box<ShapeDef>,
    /// The box that the broad phase sees: it contains the shape and where it may get within the tick, with a
    /// margin so that it seldom changes. It decides which pairs exist, so it is state.
    pub(crate) fat: Aabb,
}

impl Shape {
    /// The body it is attached to.
    #[must_use]
    pub const fn body(&self) -> BodyId {
        self.body
    }

    /// What it was defined as, with all later changes.
    #[must_use]
    pub const fn def(&self) -> &ShapeDef {
        &self.def
    }

    /// Its geometry about its own centre.
    #[must_use]
    pub const fn geometry(&self) -> &Geometry {
        &self.def.geometry
    }

    /// Its centre in the body's frame, in metres.
    #[must_use]
    pub const fn offset(&self) -> Vec2<Fx> {
        self.def.offset
    }

    /// Its density in kg/m².
    #[must_use]
    pub const fn density(&self) -> Fx {
        self.def.density
    }

    /// Its surface.
    #[must_use]
    pub const fn material(&self) -> &Material {
        &self.def.material
    }

    /// What it collides with.
    #[must_use]
    pub const fn filter(&self) -> &Filter {
        &self.def.filter
    }

    /// The direction in the body's frame into which things pass through, of a one-way shape.
    #[must_use]
    pub const fn one_way(&self) -> Option<Angle> {
        self.def.one_way
    }

    /// Whether it only notices what overlaps it.
    #[must_use]
    pub const fn is_sensor(&self) -> bool {
        self.def.sensor
    }

    /// The game's own number.
    #[must_use]
    pub const fn user_data(&self) -> u64 {
        self.def.user_data
    }

    /// The box that the broad phase sees, in world coordinates.
    #[must_use]
    pub const fn fat_aabb(&self) -> Aabb {
        self.fat
    }
}
