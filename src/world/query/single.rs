//! Queries of one or two shapes without a world.

use super::Probe;
use super::overlap::{ClosestPoints, proximity};
use crate::body::{Handle, ShapeId};
use crate::collision::{
    CachedAxis, Manifold, SKIN, SatCounters, StartPolicy, SupportShape, Sweep, TimeOfImpact as Impact,
    cast_ray, cast_shape, collide, contains_point, distance, first_impact, margin_for, overlap,
};
use crate::math::{Fx, Length, Unit, Vec2, narrow};
use crate::world::World;

/// Hit of a ray or of a moving shape on a single shape.
///
/// ```
/// use lockstep2d::{body::Geometry, fx, math::Vec2, world::{Probe, ProbeHit}};
/// // A target outside of any world, such as one in a menu.
/// let target = Probe::new(Geometry::circle(fx!(1))?, Vec2::new(fx!(6), fx!(0)))?;
/// let hit: Option<ProbeHit> = target.cast_ray(Vec2::ZERO, Vec2::new(fx!(10), fx!(0)));
/// assert_eq!(hit.map(|hit| (hit.fraction, hit.starts_inside)), Some((fx!(0.5), false)));
/// # Ok::<(), lockstep2d::body::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeHit {
    /// Fraction of the translation, 0 to 1.
    pub fraction: Fx,
    /// Point on the surface, in the world, in metres.
    pub point: Vec2<Fx>,
    /// Outward normal of the surface. Zero if a ray starts inside the shape.
    pub normal: Vec2<Unit>,
    /// Whether the ray or the moving shape starts inside the shape.
    pub starts_inside: bool,
}

/// Motion of a shape for [`Probe::time_of_impact`]: a translation and a rotation at constant speed.
///
/// ```
/// use lockstep2d::{body::{Geometry, Polygon}, fx, math::Vec2};
/// use lockstep2d::world::{Displacement, Probe, TimeOfImpact};
/// // A bat that reaches 2 m from its middle turns by half a turn in one swing. A ball lies still 1.5 m above the
/// // middle.
/// let bat = Probe::new(Polygon::rectangle(fx!(2), fx!(0.1))?, Vec2::ZERO)?;
/// let ball = Probe::new(Geometry::circle(fx!(0.1))?, Vec2::new(fx!(0), fx!(1.5)))?;
/// let swing = Displacement { turns: fx!(0.5), ..Displacement::default() };
/// match bat.time_of_impact(swing, &ball, Displacement::default()) {
///     // The bat meets the ball shortly before a quarter of a turn, which is the fraction 0.5.
///     TimeOfImpact::Hit { fraction } => assert!(fraction > fx!(0.45) && fraction < fx!(0.5)),
///     other => panic!("{other:?}"),
/// }
/// # Ok::<(), lockstep2d::body::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Displacement {
    /// Translation of the probe's position in metres.
    pub translation: Vec2<Fx>,
    /// Rotation about the probe's position in turns, counter-clockwise. May exceed a turn.
    pub turns: Fx,
}

/// Result of [`Probe::time_of_impact`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeOfImpact {
    /// The shapes do not touch.
    Separated,
    /// The shapes first come within 0.15 mm of each other at this fraction of their displacements, 0 if they touch at
    /// the start without overlapping.
    Hit {
        /// Fraction, 0 to 1.
        fraction: Fx,
    },
    /// The shapes overlap at the start.
    Overlapped,
    /// The search gave up. The shapes do not touch before this fraction.
    Failed {
        /// Fraction, 0 to 1.
        fraction: Fx,
    },
}

impl World {
    /// Returns a shape of the world as a probe at its current pose. `None` if the shape was removed or its body is
    /// disabled.
    ///
    /// ```
    /// use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
    /// use lockstep2d::{fx, math::Vec2, world::{Probe, World}};
    /// let mut world = World::default();
    /// let wall = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(1))?);
    /// let body = world.spawn(&BodyDef::fixed().position((fx!(5), fx!(0))), &[wall])?;
    /// let wall = world.probe_of(world.body(body).expect("there").shapes()[0]).expect("there");
    /// let hit = wall.cast_ray(Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(8), fx!(0))).expect("a wall");
    /// assert_eq!((hit.fraction, hit.point.x), (fx!(0.5), fx!(4)));
    /// let ball = Probe::new(Geometry::circle(fx!(0.5))?, Vec2::new(fx!(3), fx!(0)))?;
    /// assert_eq!(ball.distance(&wall).distance, fx!(0.5));
    /// assert_eq!(ball.at((fx!(3.5), fx!(0))).manifold(&wall, fx!(0.01)).points().len(), 1);
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    #[must_use]
    pub fn probe_of(&self, shape: ShapeId) -> Option<Probe> {
        self.is_present(shape).then_some(())?;
        let posed = self.scratch.shapes.poses().at(shape.slot());
        let geometry = *self.state.shapes.at(shape.slot()).geometry();
        Some(Probe::posed_at(geometry, posed.centre, self.state.body_of(shape.slot()).rotation()))
    }
}

impl Probe {
    /// Whether the shape contains a point in the world, in metres, border included.
    #[must_use]
    #[doc(alias = "point test")]
    pub fn contains_point(&self, point: impl Into<Vec2<Fx>>) -> bool {
        let point = point.into();
        contains_point(&self.support(point), Vec2::ZERO)
    }

    /// Returns where a ray from a point in the world along a translation, in metres, meets the shape. A chain link that
    /// is solid from one side lets rays pass that start on the other side of the line through the link.
    #[must_use]
    #[doc(alias = "raycast")]
    pub fn cast_ray(
        &self,
        origin: impl Into<Vec2<Fx>>,
        translation: impl Into<Vec2<Fx>>,
    ) -> Option<ProbeHit> {
        let (origin, translation) = (origin.into(), translation.into());
        if !self.posed().is_facing(origin) {
            return None;
        }
        let hit = cast_ray(&self.support(origin), Vec2::ZERO, translation)?;
        let starts_inside = hit.normal == Vec2::ZERO;
        Some(ProbeHit {
            fraction: hit.fraction,
            point: origin + hit.point,
            normal: hit.normal,
            starts_inside,
        })
    }

    /// Returns where this shape meets another as it moves along a translation in metres: see [`World::cast_shape`].
    #[must_use]
    #[doc(alias = "shapecast")]
    pub fn cast(&self, translation: impl Into<Vec2<Fx>>, other: &Probe) -> Option<ProbeHit> {
        let translation = translation.into();
        let origin = self.position();
        let own = self.support(origin);
        let (posed, middle) = (other.posed(), origin + own.middle());
        let other = other.support(origin);
        let hit = cast_shape(&other, &own, translation)?;
        if !posed.stops(middle, middle + hit.travelled) {
            return None;
        }
        let starts_inside = hit.fraction == Fx::ZERO && distance(&other, &own).distance < Fx::ZERO;
        Some(ProbeHit {
            fraction: hit.fraction,
            point: origin + hit.point,
            normal: hit.normal,
            starts_inside,
        })
    }

    /// Returns the distance from another shape and the nearest points, A on this shape and B on the other.
    #[must_use]
    #[doc(alias = "gjk")]
    pub fn distance(&self, other: &Probe) -> ClosestPoints {
        let origin = self.position();
        proximity(&self.support(origin), &other.support(origin), origin)
    }

    /// Whether the shapes share a point, borders included.
    #[must_use]
    pub fn overlaps(&self, other: &Probe) -> bool {
        let origin = self.position();
        overlap(&self.support(origin), &other.support(origin))
    }

    /// Returns the contact manifold with another shape, as the solver gets it for shapes at rest. Empty if the surfaces
    /// are more than `margin` metres apart, or if both shapes are segments or links. `margin` is clamped to the range 0
    /// to 15.
    #[must_use]
    #[doc(alias = "collide")]
    pub fn manifold(&self, other: &Probe, margin: Fx) -> Manifold {
        let margin = margin_for(narrow(margin.max(Fx::ZERO)), Length::ZERO);
        let (mut axis, mut counters) = (CachedAxis::default(), SatCounters::default());
        collide(&self.posed(), &other.posed(), margin, &mut axis, &mut counters)
    }

    /// Returns when this shape and another first touch, as both move and turn. A chain link that is solid from one side
    /// counts from both sides, as in [`Probe::distance`] and [`Probe::overlaps`], and unlike in [`Probe::cast`].
    ///
    /// ```
    /// use lockstep2d::{body::Geometry, fx, math::Vec2};
    /// use lockstep2d::world::{Displacement, Probe, TimeOfImpact};
    /// let ball = Probe::new(Geometry::circle(fx!(0.5))?, Vec2::new(fx!(0), fx!(0)))?;
    /// let other = ball.at(Vec2::new(fx!(5), fx!(0)));
    /// let right = Displacement { translation: Vec2::new(fx!(4), fx!(0)), turns: fx!(0) };
    /// let left = Displacement { translation: Vec2::new(fx!(-4), fx!(0)), turns: fx!(3) };
    /// let TimeOfImpact::Hit { fraction } = ball.time_of_impact(right, &other, left) else { panic!("a hit") };
    /// assert!((fraction - fx!(0.5)).abs() < fx!(0.0001));
    /// assert_eq!(ball.time_of_impact(left, &other, left), TimeOfImpact::Separated);
    /// # Ok::<(), lockstep2d::body::GeometryError>(())
    /// ```
    #[must_use]
    pub fn time_of_impact(&self, own: Displacement, other: &Probe, theirs: Displacement) -> TimeOfImpact {
        let sweep = |probe: &Probe, by: Displacement| {
            let start = probe.position();
            Sweep { start, end: start + by.translation, turn: by.turns.to_bits() }
        };
        let (a, b) = (other.support(other.position()), self.support(self.position()));
        let (sweep_a, sweep_b) = (sweep(other, theirs), sweep(self, own));
        match first_impact((&a, &sweep_a), (&b, &sweep_b), SKIN, StartPolicy::Report) {
            Impact::Separated => TimeOfImpact::Separated,
            Impact::Hit { fraction } => TimeOfImpact::Hit { fraction },
            Impact::Overlapped => TimeOfImpact::Overlapped,
            Impact::Failed { fraction } => TimeOfImpact::Failed { fraction },
        }
    }

    fn support(&self, origin: Vec2<Fx>) -> SupportShape {
        SupportShape::of(&self.posed(), origin)
    }
}
