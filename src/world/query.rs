//! What is where: questions about the shapes of a world, between ticks. They change nothing, see every enabled body as
//! it is at the moment, and allocate nothing but lists of results.
//!
//! The order of results is part of the contract: along a ray or a cast by the fraction before it is rounded (so that the
//! nearer of two comes first on a ray of any length), and where two are equal by slot; everywhere else in slot order.

use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::World;
use super::probe::Probe;
use crate::body::{BodyId, Handle, ShapeId};
use crate::collision::{Core, Fraction, PosedShape, ShapeHit};
use crate::collision::{cast_ray, cast_shape, contains_point, distance, overlap};
use crate::math::{Aabb, Fx, Unit, Vec2};

/// How far outside of a box its shape may be found, in metres, by the rounding of the grid that queries calculate on.
const SLACK: Fx = crate::fx!(0.000001);

/// Which shapes a query sees: those whose filter and the query's accept each other.
///
/// ```
/// use lockstep2d::world::QueryFilter;
/// let solid = QueryFilter::default();
/// let walls_only = QueryFilter { mask: 0b10, ..QueryFilter::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QueryFilter {
    /// The categories that the query belongs to.
    pub category: u64,
    /// The categories that it sees.
    pub mask: u64,
    /// Whether it sees sensors too.
    pub sensors: bool,
    /// A body that it does not see: usually the one that asks.
    pub except: Option<BodyId>,
}

impl Default for QueryFilter {
    /// Everything but sensors.
    fn default() -> Self {
        QueryFilter { category: u64::MAX, mask: u64::MAX, sensors: false, except: None }
    }
}

impl QueryFilter {
    /// The same, without a body.
    #[must_use]
    pub const fn except(mut self, body: BodyId) -> Self {
        self.except = Some(body);
        self
    }
}

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayHit {
    /// The shape.
    pub shape: ShapeId,
    /// How far along the ray, 0 to 1.
    pub fraction: Fx,
    /// Where in the world, in metres.
    pub point: Vec2<Fx>,
    /// Out of the surface. Zero if the ray starts inside the shape.
    pub normal: Vec2<Unit>,
}

/// Where a moving shape meets another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CastHit {
    /// The shape that it meets.
    pub shape: ShapeId,
    /// How far along the translation, 0 to 1.
    pub fraction: Fx,
    /// The movement up to there, in metres.
    pub travelled: Vec2<Fx>,
    /// Where on the surface that it meets, in the world, in metres.
    pub point: Vec2<Fx>,
    /// Out of that surface.
    pub normal: Vec2<Unit>,
}

/// The nearest points of two shapes, or of a shape and a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Proximity {
    /// Distance in metres between the surfaces; negative where they overlap: how far they have to move apart.
    pub distance: Fx,
    /// On the first surface, in the world, in metres.
    pub point_a: Vec2<Fx>,
    /// On the second.
    pub point_b: Vec2<Fx>,
    /// From the first to the second.
    pub normal: Vec2<Unit>,
}

impl World {
    /// The first shape that a ray meets from a point along a translation, in metres. Links that are solid from one side
    /// let rays from the other side through; one-way shapes let none.
    ///
    /// ```
    /// use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, math::Vec2, world::World};
    /// let mut world = World::default();
    /// let wall = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(1))?);
    /// world.spawn(&BodyDef::fixed().position((fx!(5), fx!(0))), &[wall])?;
    /// let (eye, sight) = (Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(8), fx!(0)));
    /// let hit = world.cast_ray(eye, sight, Default::default()).expect("a wall");
    /// assert_eq!((hit.fraction, hit.point.x), (fx!(0.5), fx!(4)));
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    #[must_use]
    pub fn cast_ray(&self, origin: Vec2<Fx>, translation: Vec2<Fx>, filter: QueryFilter) -> Option<RayHit> {
        let mut closest: Option<Ordered<RayHit>> = None;
        self.each_hit(origin, translation, filter, |found| {
            let best = earlier(closest, found, found.hit.shape, |best| best.shape);
            closest = Some(best);
            rounded_up(best.hit.fraction)
        });
        closest.map(|found| found.hit)
    }

    /// Every shape that a ray meets, in the order of the ray.
    #[must_use]
    pub fn cast_ray_all(&self, origin: Vec2<Fx>, translation: Vec2<Fx>, filter: QueryFilter) -> Vec<RayHit> {
        let mut hits = Vec::new();
        self.each_hit(origin, translation, filter, |hit| {
            hits.push(hit);
            Unit::ONE
        });
        hits.sort_unstable_by_key(|found: &Ordered<RayHit>| (found.order, found.hit.shape));
        hits.into_iter().map(|found| found.hit).collect()
    }

    /// Whether a ray meets anything: for lines of sight.
    #[must_use]
    pub fn cast_ray_any(&self, origin: Vec2<Fx>, translation: Vec2<Fx>, filter: QueryFilter) -> bool {
        let mut any = false;
        self.each_hit(origin, translation, filter, |_| {
            any = true;
            Unit::ZERO
        });
        any
    }

    /// The first shape that a probe meets as it moves along a translation without turning. It stops a tenth of a
    /// millimetre before it touches; what it touches already stops it only if it moves into it. Links that are solid from
    /// one side are met from there: by probes whose middle is on it.
    #[must_use]
    pub fn cast_shape(&self, probe: &Probe, translation: Vec2<Fx>, filter: QueryFilter) -> Option<CastHit> {
        self.first_along(probe, translation, filter, |_, _, _| true)
    }

    /// The first shape that a probe meets among those that `accept`, which gets the normal there, and where they start
    /// as cores about the probe's position, the other shape's first.
    pub(super) fn first_along(
        &self,
        probe: &Probe,
        translation: Vec2<Fx>,
        filter: QueryFilter,
        accept: impl Fn(ShapeId, Vec2<Unit>, [&Core; 2]) -> bool,
    ) -> Option<CastHit> {
        let posed = probe.posed();
        let origin = probe.position();
        let moving = Core::of(&posed, origin);
        let middle = origin + moving.middle();
        let area = posed.bounds.expanded(crate::fx!(0.001));
        let mut closest: Option<Ordered<CastHit>> = None;
        let mut interest = Unit::ONE;
        self.scratch.broad_phase.each_along(area, translation, |slot| {
            let posed = self.scratch.poses.at(slot);
            let Some(shape) = self.seen(slot, filter).filter(|_| posed.is_solid_from(middle)) else {
                return interest;
            };
            let other = Core::of(posed, origin);
            let found = cast_shape(&other, &moving, translation)
                .filter(|hit| accept(shape, hit.normal, [&other, &moving]));
            if let Some(ShapeHit { fraction, order, travelled, point, normal }) = found {
                let hit = CastHit { shape, fraction, travelled, point: origin + point, normal };
                let best = earlier(closest, Ordered { order, hit }, shape, |best| best.shape);
                closest = Some(best);
                interest = rounded_up(best.hit.fraction);
            }
            interest
        });
        closest.map(|found| found.hit)
    }

    /// Every shape that overlaps a box, borders included; none if the box is not valid.
    #[must_use]
    pub fn overlap_box(&self, area: Aabb, filter: QueryFilter) -> Vec<ShapeId> {
        if !area.is_valid() {
            return Vec::new();
        }
        let origin = area.centre();
        let (lower, upper) = (area.lower - origin, area.upper - origin);
        let corners = [lower, Vec2::new(upper.x, lower.y), upper, Vec2::new(lower.x, upper.y)];
        let core = Core::from_points(corners, Fx::ZERO);
        self.overlapping(area, filter, |posed| overlap(&Core::of(posed, origin), &core))
    }

    /// Every shape that overlaps a probe, borders included.
    #[must_use]
    pub fn overlap_shape(&self, probe: &Probe, filter: QueryFilter) -> Vec<ShapeId> {
        let posed = probe.posed();
        let origin = probe.position();
        let core = Core::of(&posed, origin);
        self.overlapping(posed.bounds, filter, |other| overlap(&Core::of(other, origin), &core))
    }

    /// Every shape that a point is in, borders included.
    #[must_use]
    pub fn overlap_point(&self, point: Vec2<Fx>, filter: QueryFilter) -> Vec<ShapeId> {
        self.overlapping(Aabb::new(point, point), filter, |posed| {
            contains_point(&Core::of(posed, point), Vec2::ZERO)
        })
    }

    /// The shape nearest to a point within a distance in metres, and where: the point first. A point inside a shape
    /// has a negative distance from it. Nothing is within a negative distance, and everything within the largest.
    #[must_use]
    pub fn closest(&self, point: Vec2<Fx>, within: Fx, filter: QueryFilter) -> Option<(ShapeId, Proximity)> {
        if within < Fx::ZERO {
            return None;
        }
        let here = Core::point(Vec2::ZERO);
        let mut closest: Option<(ShapeId, Proximity)> = None;
        self.scratch.broad_phase.each_near(point, within.saturating_add(SLACK), |slot| {
            if let Some(shape) = self.seen(slot, filter) {
                let found = proximity(&here, &Core::of(self.scratch.poses.at(slot), point), point);
                let nearer =
                    |best: &(ShapeId, Proximity)| (found.distance, shape) < (best.1.distance, best.0);
                if found.distance <= within && closest.as_ref().is_none_or(nearer) {
                    closest = Some((shape, found));
                }
            }
            // A shape that the point is inside of is not the last word: it may be deeper inside another.
            closest.map_or(within, |(_, best)| best.distance.max(Fx::ZERO)).saturating_add(SLACK)
        });
        closest
    }

    /// The distance of two shapes, and where they are nearest; `None` if one is gone or disabled.
    #[must_use]
    pub fn distance(&self, a: ShapeId, b: ShapeId) -> Option<Proximity> {
        (self.is_there(a) && self.is_there(b)).then_some(())?;
        let (posed_a, posed_b) = (self.scratch.poses.at(a.slot()), self.scratch.poses.at(b.slot()));
        let origin = posed_a.centre;
        Some(proximity(&Core::of(posed_a, origin), &Core::of(posed_b, origin), origin))
    }

    /// The distance of a probe from a shape, and where they are nearest, the probe's point first; `None` if the shape
    /// is gone or disabled.
    #[must_use]
    pub fn probe_distance(&self, probe: &Probe, shape: ShapeId) -> Option<Proximity> {
        self.is_there(shape).then_some(())?;
        let origin = probe.position();
        let other = Core::of(self.scratch.poses.at(shape.slot()), origin);
        Some(proximity(&Core::of(&probe.posed(), origin), &other, origin))
    }

    fn each_hit(
        &self,
        origin: Vec2<Fx>,
        translation: Vec2<Fx>,
        filter: QueryFilter,
        mut visit: impl FnMut(Ordered<RayHit>) -> Unit,
    ) {
        let mut interest = Unit::ONE;
        let area = Aabb::new(origin, origin).expanded(SLACK);
        self.scratch.broad_phase.each_along(area, translation, |slot| {
            let posed = self.scratch.poses.at(slot);
            if let Some(shape) = self.seen(slot, filter).filter(|_| posed.is_solid_from(origin)) {
                let core = Core::of(posed, origin);
                if let Some(hit) = cast_ray(&core, Vec2::ZERO, translation) {
                    let (fraction, point, normal) = (hit.fraction, origin + hit.point, hit.normal);
                    let (order, hit) = (hit.order, RayHit { shape, fraction, point, normal });
                    interest = visit(Ordered { order, hit });
                }
            }
            interest
        });
    }

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

    /// Calls `visit` with every shape whose box overlaps an area, and perhaps with some more, in no order.
    pub(super) fn each_overlapping(
        &self,
        area: Aabb,
        filter: QueryFilter,
        mut visit: impl FnMut(ShapeId, &PosedShape),
    ) {
        self.scratch.broad_phase.each_overlap(area.expanded(SLACK), |slot| {
            if let Some(shape) = self.seen(slot, filter) {
                visit(shape, self.scratch.poses.at(slot));
            }
            ControlFlow::Continue(())
        });
    }

    /// Whether a shape is in the world, on an enabled body.
    fn is_there(&self, id: ShapeId) -> bool {
        self.state.shapes.get(id).is_some() && self.state.body_of(id.slot()).enabled
    }

    /// The handle of a shape, if a query sees it.
    fn seen(&self, slot: u32, filter: QueryFilter) -> Option<ShapeId> {
        let shape = self.state.shapes.at(slot);
        let accepted =
            shape.filter().mask & filter.category != 0 && shape.filter().category & filter.mask != 0;
        let wanted = (filter.sensors || !shape.is_sensor()) && filter.except != Some(shape.body());
        (accepted && wanted).then(|| self.state.shapes.handle_at(slot))
    }
}

/// A hit and when it comes, to more digits than its fraction has.
#[derive(Clone, Copy)]
struct Ordered<H> {
    order: Fraction,
    hit: H,
}

/// The earlier hit; of equal ones that on the smaller slot.
fn earlier<H: Copy>(
    best: Option<Ordered<H>>,
    found: Ordered<H>,
    shape: ShapeId,
    shape_of: impl Fn(&H) -> ShapeId,
) -> Ordered<H> {
    best.filter(|best| (best.order, shape_of(&best.hit)) <= (found.order, shape)).unwrap_or(found)
}

/// The distance of two cores about an origin, in the world.
pub(super) fn proximity(a: &Core, b: &Core, origin: Vec2<Fx>) -> Proximity {
    let found = distance(a, b);
    Proximity {
        distance: found.distance,
        point_a: origin + found.point_a,
        point_b: origin + found.point_b,
        normal: found.normal,
    }
}

/// A fraction in the format of the broad phase: not less than it was, so that nothing equal is missed.
fn rounded_up(fraction: Fx) -> Unit {
    Unit::from_bits(crate::math::saturate((fraction.to_bits() >> 2) + 1)).min(Unit::ONE)
}
