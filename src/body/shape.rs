//! Shapes: geometry attached to a body, with material and filter.

use alloc::boxed::Box;

use serde::{Deserialize, Serialize};

use super::area::Area;
use super::arena::BodyId;
use super::error::WorldError;
use super::event_switches::EventSwitches;
use super::filter::Filter;
use super::geometry::Geometry;
use super::material::Material;
use super::shape_fields::ShapeFields;
use crate::fx;
use crate::math::{Aabb, Angle, Fx, Vec2};

/// Largest world coordinate in metres: half of the range of [`Fx`], so that adding a smaller length cannot overflow.
pub const WORLD_EXTENT_MAX: Fx = fx!(1073741824);

/// Largest distance in metres of a shape, joint anchor or centre of mass from the origin of a movable body, on each
/// axis of its frame. Lever arms are then at most 363 m long and fit `Length`.
pub const REACH_MAX: Fx = fx!(128);

/// Largest number of shapes of one body. The cost of a change to a body grows with its shapes.
pub const SHAPES_PER_BODY_MAX: u32 = 4096;

/// Largest density in kg/m².
pub const DENSITY_MAX: Fx = fx!(1048576);

/// Definition of a shape to attach to a body.
///
/// ```
/// use lockstep2d::{body::{Geometry, ShapeDef}, fx};
/// let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?).density(fx!(2)).friction(fx!(0.3));
/// # Ok::<(), lockstep2d::body::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "ShapeFields", from = "ShapeFields")]
#[doc(alias = "Collider")]
#[doc(alias = "ColliderBuilder")]
#[doc(alias = "ColliderDesc")]
#[doc(alias = "FixtureDef")]
pub struct ShapeDef {
    /// Geometry about the shape's centre.
    pub geometry: Geometry,
    /// Shape's centre in the body's frame, in metres.
    pub offset: Vec2<Fx>,
    /// Mass per area in kg/m², 0 to 2^20.
    pub density: Fx,
    /// Friction, restitution, rolling resistance and surface speed.
    pub material: Material,
    /// Collision filter.
    pub filter: Filter,
    /// Makes the shape a one-way platform. Other shapes pass through the platform in this direction. The angle is in
    /// the body's frame: 90 degrees for up.
    ///
    /// The platform is solid if the contact normal, from the platform to the other shape, is within 60 degrees of the
    /// direction. Otherwise the other shape passes, and the pair does not touch. A shape that passes continues to pass
    /// while the overlap along the direction exceeds a limit: a quarter of the world's speculative distance or, for
    /// small shapes, a 32nd of the longer side of the smaller shape.
    pub one_way: Option<Angle>,
    /// Whether the shape is a sensor, which does not collide but detects shapes that overlap or cross it: see
    /// [`SensorEvent`](crate::world::SensorEvent). It detects other sensors only if [`EventSwitches::detect_sensors`]
    /// is on. Sensors of fixed bodies do not detect fixed bodies. A sensor has mass like any other shape, unless its
    /// density is 0.
    #[doc(alias = "trigger")]
    #[doc(alias = "is_trigger")]
    pub sensor: bool,
    /// Effect of the sensor on the bodies inside it.
    pub area: Option<Area>,
    /// Events in which the shape takes part.
    pub events: EventSwitches,
    /// Number for the game's own use. It is part of the state and its hash.
    pub user_data: u64,
}

impl ShapeDef {
    /// Creates a shape at the body's origin with density 1 and the default material and filter.
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
            area: None,
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

    /// Sets the density in kg/m², 0 to 2^20. A body whose mass is computed from shapes of density 0 has no mass: see
    /// [`MassSource::Shapes`](super::MassSource::Shapes).
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

    /// Sets the restitution, 0 to 1.5: see [`Material::restitution`].
    #[must_use]
    pub fn restitution(mut self, restitution: Fx) -> Self {
        self.material.restitution = restitution;
        self
    }

    /// Sets the approach speed in m/s below which the shape does not bounce: see [`Material::restitution_threshold`].
    #[must_use]
    pub fn restitution_threshold(mut self, speed: Fx) -> Self {
        self.material.restitution_threshold = Some(speed);
        self
    }

    /// Sets the rolling resistance, 0 to 1: see [`Material::rolling_resistance`].
    #[must_use]
    pub fn rolling_resistance(mut self, resistance: Fx) -> Self {
        self.material.rolling_resistance = resistance;
        self
    }

    /// Sets the surface speed in m/s, clockwise: see [`Material::surface_speed`].
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

    /// Makes the shape a one-way platform: see [`one_way`](field@Self::one_way).
    #[must_use]
    pub fn one_way(mut self, direction: Angle) -> Self {
        self.one_way = Some(direction);
        self
    }

    /// Makes the shape a sensor: see [`sensor`](field@Self::sensor).
    #[must_use]
    #[doc(alias = "trigger")]
    #[doc(alias = "is_trigger")]
    pub fn sensor(mut self) -> Self {
        self.sensor = true;
        self
    }

    /// Makes the shape a sensor that also detects sensors: see [`EventSwitches::detect_sensors`].
    #[must_use]
    pub fn sensor_of_sensors(mut self) -> Self {
        self.sensor = true;
        self.events.detect_sensors = true;
        self
    }

    /// Makes the shape a sensor that acts on the bodies inside it.
    #[must_use]
    pub fn area(mut self, area: Area) -> Self {
        self.sensor = true;
        self.area = Some(area);
        self
    }

    /// Sets the events in which the shape takes part.
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

    /// `reach_max` depends on the kind of the body: see [`REACH_MAX`].
    pub(crate) fn validate(&self, reach_max: Fx) -> Result<(), WorldError> {
        let ShapeDef {
            geometry,
            offset,
            density,
            material,
            filter: _,
            one_way: _,
            sensor,
            area,
            events: _,
            user_data: _,
        } = self;
        geometry.validate()?;
        check_reach(geometry, *offset, reach_max)?;
        if !(Fx::ZERO..=DENSITY_MAX).contains(density) {
            return Err(WorldError::DensityOutOfRange { value: *density });
        }
        material.validate()?;
        match area {
            Some(_) if !sensor => Err(WorldError::AreaNotSensor),
            Some(area) => area.validate(geometry),
            None => Ok(()),
        }
    }
}

fn check_reach(geometry: &Geometry, offset: Vec2<Fx>, reach_max: Fx) -> Result<(), WorldError> {
    let bounds = geometry.local_bounds().translated(offset);
    let corners = [offset.x, offset.y, bounds.lower.x, bounds.lower.y, bounds.upper.x, bounds.upper.y];
    match corners.into_iter().find(|corner| !(-reach_max..=reach_max).contains(corner)) {
        Some(value) => Err(WorldError::OffsetOutOfRange { value, max: reach_max }),
        None => Ok(()),
    }
}

/// A shape in the world.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, Shape, ShapeDef}, fx, math::Vec2, world::World};
/// # let mut world = World::default();
/// const HEAD: u64 = 1;
/// let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// let parts = [square, square.offset((fx!(0), fx!(1))).user_data(HEAD)];
/// let robot = world.spawn(&BodyDef::dynamic(), &parts)?;
/// // Finds the body that a ray hits, and the part of the body.
/// let (origin, translation) = (Vec2::new(fx!(-5), fx!(1)), Vec2::new(fx!(10), fx!(0)));
/// let hit = world.cast_ray(origin, translation, Default::default()).expect("the head is in the way");
/// let shape: &Shape = world.shape(hit.shape).expect("just hit");
/// assert_eq!((shape.body(), shape.user_data()), (robot, HEAD));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[doc(alias = "Collider")]
#[doc(alias = "Fixture")]
pub struct Shape {
    pub(crate) body: BodyId,
    /// Boxed, so that the fields that steps change lie close together.
    pub(crate) def: Box<ShapeDef>,
    /// AABB, expanded by a margin and by the predicted motion of one tick. Shapes of fixed bodies have no margin. The
    /// box decides which pairs exist, so it is part of the state.
    pub(crate) fat: Aabb,
}

impl Shape {
    /// Body that the shape is attached to.
    #[must_use]
    pub const fn body(&self) -> BodyId {
        self.body
    }

    /// Current definition of the shape, which includes changes since its creation.
    #[must_use]
    pub const fn def(&self) -> &ShapeDef {
        &self.def
    }

    /// Geometry about the shape's centre.
    #[must_use]
    pub const fn geometry(&self) -> &Geometry {
        &self.def.geometry
    }

    /// Centre of the shape in the body's frame, in metres.
    #[must_use]
    pub const fn offset(&self) -> Vec2<Fx> {
        self.def.offset
    }

    /// Density in kg/m².
    #[must_use]
    pub const fn density(&self) -> Fx {
        self.def.density
    }

    /// Surface material.
    #[must_use]
    pub const fn material(&self) -> &Material {
        &self.def.material
    }

    /// Collision filter.
    #[must_use]
    pub const fn filter(&self) -> &Filter {
        &self.def.filter
    }

    /// Direction in the body's frame in which other shapes pass through a one-way platform.
    #[must_use]
    pub const fn one_way(&self) -> Option<Angle> {
        self.def.one_way
    }

    /// Whether the shape is a sensor.
    #[must_use]
    #[doc(alias = "trigger")]
    #[doc(alias = "is_trigger")]
    pub const fn is_sensor(&self) -> bool {
        self.def.sensor
    }

    /// Effect of the sensor on the bodies inside it.
    #[must_use]
    pub const fn area(&self) -> Option<&Area> {
        self.def.area.as_ref()
    }

    /// Whether the shape is an area that acts on the other shape, provided that the other shape's body is dynamic.
    pub(crate) fn acts_on(&self, other: &Shape) -> bool {
        self.def.area.is_some() && !other.is_sensor() && self.detects(other)
    }

    /// Whether the shape is a sensor that detects the other shape, according to the event switches of both.
    pub(crate) fn detects(&self, other: &Shape) -> bool {
        let (own, seen) = (&*self.def, &*other.def);
        own.sensor && seen.events.sensor && (!seen.sensor || own.events.detect_sensors)
    }

    /// User data, set by the game.
    #[must_use]
    pub const fn user_data(&self) -> u64 {
        self.def.user_data
    }

    /// AABB of the broad phase, in world coordinates, with a margin.
    #[must_use]
    pub const fn fat_aabb(&self) -> Aabb {
        self.fat
    }
}
