//! Geometry of shapes.

use serde::{Deserialize, Serialize};

use super::error::GeometryError;
use super::polygon::{Polygon, SHAPE_EXTENT_MAX};
use super::shape::WORLD_EXTENT_MAX;
use crate::fx;
use crate::math::{Aabb, Fx, Vec2};

/// Smallest radius of circles and capsules, and smallest distance between the ends of lines and capsules, in metres.
const SIZE_MIN: Fx = fx!(0.002);

/// Geometry of a shape, relative to the shape's centre.
///
/// ```
/// use lockstep2d::{body::{Geometry, Polygon}, fx, math::Vec2};
/// let ball = Geometry::circle(fx!(0.5))?;
/// let pill = Geometry::capsule(Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(0), fx!(1)), fx!(0.3))?;
/// let plate = Geometry::from(Polygon::rectangle(fx!(2), fx!(0.1))?);
/// assert!(Geometry::circle(fx!(0)).is_err());
/// # let _ = (ball, pill, plate);
/// # Ok::<(), lockstep2d::body::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Geometry {
    /// A disc about the shape's centre.
    Circle {
        /// Radius in metres, 0.002 to 110.
        radius: Fx,
    },
    /// A line segment, solid from both sides, without mass. It does not collide with segments and links. On a fixed
    /// body, it may be as long as the world.
    Segment {
        /// First end, in metres from the shape's centre.
        a: Vec2<Fx>,
        /// Second end.
        b: Vec2<Fx>,
    },
    /// A convex polygon, optionally rounded.
    Polygon(Polygon),
    /// All points within a radius of a line segment.
    Capsule {
        /// Centre of the first round end, in metres from the shape's centre.
        a: Vec2<Fx>,
        /// Centre of the second round end, at least 2 mm from `a`.
        b: Vec2<Fx>,
        /// Radius in metres, at least 0.002. The capsule extends at most 110 m from the shape's centre on each axis.
        radius: Fx,
    },
    /// A segment of a [`Chain`](super::Chain). At an end with a neighbour, a contact normal is the normal of one of the
    /// two links or, at a convex corner, a direction between these normals.
    Link {
        /// First end, in metres from the shape's centre.
        a: Vec2<Fx>,
        /// Second end.
        b: Vec2<Fx>,
        /// Far end of the neighbour that ends at `a`.
        before: Option<Vec2<Fx>>,
        /// Far end of the neighbour that starts at `b`.
        after: Option<Vec2<Fx>>,
        /// Sides from which the link is solid.
        sides: Sides,
    },
}

/// Sides from which a link is solid.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Chain, Geometry, Polygon, ShapeDef, Sides}, fx, math::Vec2, world::World};
/// # let mut world = World::default();
/// // A thin platform that is solid from above, because its points run from right to left.
/// let ends = [Vec2::new(fx!(5), fx!(0)), Vec2::new(fx!(-5), fx!(0))];
/// let platform = Chain::new(&ends).one_sided().links()?;
/// assert!(matches!(platform[0].geometry, Geometry::Link { sides: Sides::Right, .. }));
/// world.spawn(&BodyDef::fixed(), &platform)?;
/// let jumper = ShapeDef::new(Polygon::square(fx!(0.25))?);
/// let below = BodyDef::dynamic().position((fx!(0), fx!(-1))).velocity((fx!(0), fx!(7)));
/// let jumper = world.spawn(&below, &[jumper])?;
/// (0..180).for_each(|_| world.step());
/// assert!(world.body(jumper).is_some_and(|body| body.position().y > fx!(0.2)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Sides {
    /// Both sides.
    #[default]
    Both,
    /// The right side, looking from `a` to `b`. A shape passes through if the mean of its vertices is on the left. The
    /// links next to a corner decide together which side a place beside the corner is on.
    Right,
}

impl From<Polygon> for Geometry {
    fn from(polygon: Polygon) -> Self {
        Geometry::Polygon(polygon)
    }
}

impl Geometry {
    /// Creates a circle from its radius in metres.
    ///
    /// # Errors
    /// If the radius is not within 0.002 to 110 m.
    pub fn circle(radius: Fx) -> Result<Self, GeometryError> {
        let circle = Geometry::Circle { radius };
        circle.validate().map(|()| circle)
    }

    /// Creates a segment from its ends, in metres from the shape's centre.
    ///
    /// # Errors
    /// If the segment is shorter than 2 mm, or a coordinate of an end is not within ±2^30 m.
    pub fn segment(a: impl Into<Vec2<Fx>>, b: impl Into<Vec2<Fx>>) -> Result<Self, GeometryError> {
        let segment = Geometry::Segment { a: a.into(), b: b.into() };
        segment.validate().map(|()| segment)
    }

    /// Creates a capsule from the centres of its round ends, in metres from the shape's centre, and its radius.
    ///
    /// # Errors
    /// If the centres are closer than 2 mm, the radius is below 2 mm, or the capsule leaves the range of ±110 m.
    pub fn capsule(
        a: impl Into<Vec2<Fx>>,
        b: impl Into<Vec2<Fx>>,
        radius: Fx,
    ) -> Result<Self, GeometryError> {
        let capsule = Geometry::Capsule { a: a.into(), b: b.into(), radius };
        capsule.validate().map(|()| capsule)
    }

    /// Checks sizes and coordinates. A [`Polygon`] needs no check, because it is valid by construction.
    pub(crate) fn validate(&self) -> Result<(), GeometryError> {
        match *self {
            Geometry::Circle { radius } => {
                check_size("radius of a circle", radius, SIZE_MIN, SHAPE_EXTENT_MAX)?;
            }
            Geometry::Segment { a, b } => {
                check_within("coordinate of a segment's end", &[a, b], WORLD_EXTENT_MAX)?;
                check_length("length of a segment", a, b)?;
            }
            Geometry::Polygon(_) => {}
            Geometry::Capsule { a, b, radius } => {
                check_size("radius of a capsule", radius, SIZE_MIN, SHAPE_EXTENT_MAX)?;
                check_within("coordinate of a capsule's end", &[a, b], SHAPE_EXTENT_MAX - radius)?;
                check_length("distance between a capsule's ends", a, b)?;
            }
            Geometry::Link { a, b, before, after, sides: _ } => {
                let (first, last) = (before.unwrap_or(a), after.unwrap_or(b));
                check_within("coordinate of a link's end", &[first, a, b, last], WORLD_EXTENT_MAX)?;
                let check_link = |a, b| check_length("length of a link", a, b);
                check_link(a, b)?;
                before.map_or(Ok(()), |before| check_link(before, a))?;
                after.map_or(Ok(()), |after| check_link(b, after))?;
            }
        }
        Ok(())
    }

    /// Bounding box about the shape's centre, without rotation.
    pub(crate) fn local_bounds(&self) -> Aabb {
        match self {
            Geometry::Circle { radius } => Aabb::new(Vec2::ZERO, Vec2::ZERO).expanded(*radius),
            Geometry::Segment { a, b } | Geometry::Link { a, b, .. } => Aabb::new(a.min(*b), a.max(*b)),
            Geometry::Polygon(polygon) => {
                let points = polygon.vertices().iter().map(|vertex| vertex.widen());
                let bounds = Aabb::from_points(points).unwrap_or(Aabb::new(Vec2::ZERO, Vec2::ZERO));
                bounds.expanded(polygon.radius().into())
            }
            Geometry::Capsule { a, b, radius } => Aabb::new(a.min(*b), a.max(*b)).expanded(*radius),
        }
    }
}

pub(super) fn check_size(what: &'static str, value: Fx, min: Fx, max: Fx) -> Result<(), GeometryError> {
    let in_range = (min..=max).contains(&value);
    if in_range { Ok(()) } else { Err(GeometryError::SizeOutOfRange { what, value, min, max }) }
}

fn check_within(what: &'static str, points: &[Vec2<Fx>], extent: Fx) -> Result<(), GeometryError> {
    let mut coordinates = points.iter().flat_map(|point| [point.x, point.y]);
    coordinates.try_for_each(|value| check_size(what, value, -extent, extent))
}

fn check_length(what: &'static str, a: Vec2<Fx>, b: Vec2<Fx>) -> Result<(), GeometryError> {
    check_size(what, a.distance(b), SIZE_MIN, Fx::MAX)
}
