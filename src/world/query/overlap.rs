use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::{Probe, QueryFilter, SLACK};
use crate::body::{Handle, ShapeId};
use crate::collision::{PosedShape, SupportShape, contains_point, distance, overlap};
use crate::math::{Aabb, Fx, Unit, Vec2};
use crate::world::World;

/// The nearest points of two shapes, or of a shape and a point.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, world::World};
/// use lockstep2d::{fx, math::Vec2, world::ClosestPoints};
/// # let mut world = World::default();
/// # let ball = ShapeDef::new(Geometry::circle(fx!(1))?);
/// # let ball = world.spawn(&BodyDef::fixed().position((fx!(4), fx!(0))), &[ball])?;
/// // The nearest thing within 10 m, for a homing missile.
/// let (target, ClosestPoints { distance, point_b, .. }) =
///     world.closest(Vec2::ZERO, fx!(10), Default::default()).expect("the ball");
/// assert_eq!((target, distance, point_b.x), (world.shapes_of(ball)[0], fx!(3), fx!(3)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClosestPoints {
    /// Distance between the surfaces in metres; for overlapping shapes, the negated length of the shortest separating
    /// displacement.
    pub distance: Fx,
    /// Point on the first surface, in the world, in metres.
    pub point_a: Vec2<Fx>,
    /// Point on the second surface, in the world, in metres.
    pub point_b: Vec2<Fx>,
    /// Unit vector from the first shape to the second.
    pub normal: Vec2<Unit>,
}

impl World {
    /// Returns the shapes that overlap a box, borders included. Empty if the box is not valid.
    #[must_use]
    #[doc(alias = "overlap_aabb")]
    pub fn overlap_box(&self, area: Aabb, filter: QueryFilter) -> Vec<ShapeId> {
        if !area.is_valid() {
            return Vec::new();
        }
        let origin = area.centre();
        let (lower, upper) = (area.lower - origin, area.upper - origin);
        let corners = [lower, Vec2::new(upper.x, lower.y), upper, Vec2::new(lower.x, upper.y)];
        let support = SupportShape::from_points(corners, Fx::ZERO);
        self.overlapping(area, filter, |posed| overlap(&SupportShape::of(posed, origin), &support))
    }

    /// Returns the shapes that overlap a probe, borders included.
    #[must_use]
    pub fn overlap_shape(&self, probe: &Probe, filter: QueryFilter) -> Vec<ShapeId> {
        let posed = probe.posed();
        let origin = probe.position();
        let support = SupportShape::of(&posed, origin);
        self.overlapping(posed.bounds, filter, |other| overlap(&SupportShape::of(other, origin), &support))
    }

    /// Returns the shapes that contain a point in the world, in metres, borders included.
    #[must_use]
    #[doc(alias = "point test")]
    #[doc(alias = "pick")]
    pub fn overlap_point(&self, point: impl Into<Vec2<Fx>>, filter: QueryFilter) -> Vec<ShapeId> {
        let point = point.into();
        self.overlapping(Aabb::new(point, point), filter, |posed| {
            contains_point(&SupportShape::of(posed, point), Vec2::ZERO)
        })
    }

    /// Returns the shape nearest to a point, at most `within` metres away, and the nearest points: A is the point of
    /// the query, B is on the shape. A point inside a shape has a negative distance.
    #[must_use]
    #[doc(alias = "nearest")]
    pub fn closest(
        &self,
        point: impl Into<Vec2<Fx>>,
        within: Fx,
        filter: QueryFilter,
    ) -> Option<(ShapeId, ClosestPoints)> {
        let point = point.into();
        if within < Fx::ZERO {
            return None;
        }
        let here = SupportShape::point(Vec2::ZERO);
        let mut closest: Option<(ShapeId, ClosestPoints)> = None;
        self.scratch.shapes.broad_phase().each_near(point, within.saturating_add(SLACK), |slot| {
            if let Some(shape) = self.seen(slot, filter) {
                let other = SupportShape::of(self.scratch.shapes.poses().at(slot), point);
                let found = proximity(&here, &other, point);
                let is_nearer =
                    |best: &(ShapeId, ClosestPoints)| (found.distance, shape) < (best.1.distance, best.0);
                if found.distance <= within && closest.as_ref().is_none_or(is_nearer) {
                    closest = Some((shape, found));
                }
            }
            // After a negative distance the search goes on: the point may be deeper inside another shape.
            closest.map_or(within, |(_, best)| best.distance.max(Fx::ZERO)).saturating_add(SLACK)
        });
        closest
    }

    /// Returns the distance between two shapes and their nearest points. `None` if one was removed or disabled.
    #[must_use]
    pub fn distance(&self, a: ShapeId, b: ShapeId) -> Option<ClosestPoints> {
        (self.is_present(a) && self.is_present(b)).then_some(())?;
        let poses = self.scratch.shapes.poses();
        let (posed_a, posed_b) = (poses.at(a.slot()), poses.at(b.slot()));
        let origin = posed_a.centre;
        Some(proximity(&SupportShape::of(posed_a, origin), &SupportShape::of(posed_b, origin), origin))
    }

    /// Returns the distance between a probe and a shape and their nearest points, A on the probe and B on the shape.
    /// `None` if the shape was removed or disabled.
    #[must_use]
    pub fn probe_distance(&self, probe: &Probe, shape: ShapeId) -> Option<ClosestPoints> {
        self.is_present(shape).then_some(())?;
        let origin = probe.position();
        let other = SupportShape::of(self.scratch.shapes.poses().at(shape.slot()), origin);
        Some(proximity(&SupportShape::of(&probe.posed(), origin), &other, origin))
    }

    /// Returns the shapes near an area for which `overlaps` holds, in slot order.
    fn overlapping(
        &self,
        area: Aabb,
        filter: QueryFilter,
        overlaps: impl Fn(&PosedShape) -> bool,
    ) -> Vec<ShapeId> {
        let mut found = Vec::new();
        self.each_overlapping(area, filter, |shape, posed| {
            if overlaps(posed) {
                found.push(shape);
            }
        });
        found.sort_unstable();
        found
    }

    /// Visits the shapes whose boxes overlap an area, and possibly others, in no defined order.
    pub(super) fn each_overlapping(
        &self,
        area: Aabb,
        filter: QueryFilter,
        mut visit: impl FnMut(ShapeId, &PosedShape),
    ) {
        self.scratch.shapes.broad_phase().each_overlap(area.expanded(SLACK), |slot| {
            if let Some(shape) = self.seen(slot, filter) {
                visit(shape, self.scratch.shapes.poses().at(slot));
            }
            ControlFlow::Continue(())
        });
    }
}

/// The nearest points, in the world, of two shapes that are given relative to an origin.
pub(super) fn proximity(a: &SupportShape, b: &SupportShape, origin: Vec2<Fx>) -> ClosestPoints {
    let found = distance(a, b);
    ClosestPoints {
        distance: found.distance,
        point_a: origin + found.point_a,
        point_b: origin + found.point_b,
        normal: found.normal,
    }
}
