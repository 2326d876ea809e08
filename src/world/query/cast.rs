use core::cell::LazyCell;

use alloc::vec::Vec;

use super::seam::{Rest, Resting};
use super::{InitialOverlap, Probe, QueryFilter, SLACK};
use crate::body::ShapeId;
use crate::collision::{Fraction, ShapeHit, SupportShape, cast_ray, cast_shape, distance};
use crate::fx;
use crate::math::{Aabb, Fx, Unit, Vec2, saturate};
use crate::world::World;

/// Hit of a ray on a shape.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, world::World};
/// use lockstep2d::{fx, math::Vec2, world::RayHit};
/// # let mut world = World::default();
/// # world.spawn(&BodyDef::fixed().position((fx!(5), fx!(0))), &[ShapeDef::new(Polygon::square(fx!(1))?)])?;
/// // A laser, 20 m long at most, and the mark that it burns.
/// let hit = world.cast_ray(Vec2::ZERO, Vec2::new(fx!(20), fx!(0)), Default::default());
/// let RayHit { point, normal, fraction, .. } = hit.expect("a wall at 4 m");
/// assert_eq!((point.x, fraction), (fx!(4), fx!(0.2)));
/// assert_eq!(normal, -Vec2::X, "towards the laser");
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayHit {
    /// The shape.
    pub shape: ShapeId,
    /// Fraction of the ray's translation, 0 to 1.
    pub fraction: Fx,
    /// Point at which the ray meets the shape, in the world, in metres.
    pub point: Vec2<Fx>,
    /// Outward normal of the surface. Zero if the ray starts inside the shape.
    pub normal: Vec2<Unit>,
    /// Whether the ray starts inside the shape.
    pub starts_inside: bool,
}

/// Hit of a moving shape on another shape.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, world::World};
/// use lockstep2d::{fx, math::Vec2, world::{CastHit, Probe}};
/// # let mut world = World::default();
/// # world.spawn(&BodyDef::fixed().position((fx!(5), fx!(0))), &[ShapeDef::new(Polygon::square(fx!(1))?)])?;
/// // A camera with a radius of 0.5 m moves back by up to 10 m, but not into a wall.
/// let camera = Probe::new(Geometry::circle(fx!(0.5))?, Vec2::ZERO)?;
/// let hit: Option<CastHit> = world.cast_shape(&camera, Vec2::new(fx!(10), fx!(0)), Default::default());
/// let travelled = hit.expect("a wall at 4 m").travelled.x;
/// assert!(travelled < fx!(3.5) && travelled > fx!(3.499));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CastHit {
    /// The shape that the probe meets.
    pub shape: ShapeId,
    /// Fraction of the translation, 0 to 1.
    pub fraction: Fx,
    /// Displacement up to the hit, in metres.
    pub travelled: Vec2<Fx>,
    /// Point on the surface that is met, in the world, in metres.
    pub point: Vec2<Fx>,
    /// Outward normal of that surface.
    pub normal: Vec2<Unit>,
    /// Whether the probe overlaps the shape at the start.
    pub starts_inside: bool,
}

impl World {
    /// Returns the first shape that a ray meets, from a point along a translation in metres. A chain link that is solid
    /// from one side lets rays pass that start on the other side of the line through the link.
    ///
    /// ```
    /// use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, math::Vec2, world::World};
    /// let mut world = World::default();
    /// let wall = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(1))?);
    /// world.spawn(&BodyDef::fixed().position((fx!(5), fx!(0))), &[wall])?;
    /// let (eye, view) = (Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(8), fx!(0)));
    /// let hit = world.cast_ray(eye, view, Default::default()).expect("a wall");
    /// assert_eq!((hit.fraction, hit.point.x), (fx!(0.5), fx!(4)));
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    #[must_use]
    #[doc(alias = "raycast")]
    #[doc(alias = "ray_cast_closest")]
    pub fn cast_ray(
        &self,
        origin: impl Into<Vec2<Fx>>,
        translation: impl Into<Vec2<Fx>>,
        filter: QueryFilter,
    ) -> Option<RayHit> {
        let (origin, translation) = (origin.into(), translation.into());
        let mut closest: Option<Ordered<RayHit>> = None;
        self.each_hit(origin, translation, filter, |found| {
            let best = earlier(closest, found, found.hit.shape, |best| best.shape);
            closest = Some(best);
            rounded_up(best.hit.fraction)
        });
        closest.map(|found| found.hit)
    }

    /// Returns the shapes that a ray meets, in order along the ray.
    #[must_use]
    #[doc(alias = "raycast")]
    pub fn cast_ray_all(
        &self,
        origin: impl Into<Vec2<Fx>>,
        translation: impl Into<Vec2<Fx>>,
        filter: QueryFilter,
    ) -> Vec<RayHit> {
        let (origin, translation) = (origin.into(), translation.into());
        let mut hits = Vec::new();
        self.each_hit(origin, translation, filter, |hit| {
            hits.push(hit);
            Unit::ONE
        });
        hits.sort_unstable_by_key(|found: &Ordered<RayHit>| (found.order, found.hit.shape));
        hits.into_iter().map(|found| found.hit).collect()
    }

    /// Whether a ray meets any shape. Cheaper than [`World::cast_ray`].
    #[must_use]
    #[doc(alias = "raycast")]
    #[doc(alias = "line_of_sight")]
    pub fn cast_ray_any(
        &self,
        origin: impl Into<Vec2<Fx>>,
        translation: impl Into<Vec2<Fx>>,
        filter: QueryFilter,
    ) -> bool {
        let (origin, translation) = (origin.into(), translation.into());
        let mut any = false;
        self.each_hit(origin, translation, filter, |_| {
            any = true;
            Unit::ZERO
        });
        any
    }

    /// Returns the first shape that a probe meets as it moves along a translation in metres without rotation. The probe
    /// stops 0.1 mm before it touches.
    ///
    /// A shape that the probe touches at the start stops the probe only if the probe moves into that shape, so that
    /// probes slide along chains and flush tiles. [`QueryFilter::initial_overlap`] selects another treatment of
    /// overlaps at the start. A chain link that is solid from one side is met only by probes whose middle is on that
    /// side.
    #[must_use]
    #[doc(alias = "shapecast")]
    #[doc(alias = "sweep test")]
    pub fn cast_shape(
        &self,
        probe: &Probe,
        translation: impl Into<Vec2<Fx>>,
        filter: QueryFilter,
    ) -> Option<CastHit> {
        let translation = translation.into();
        self.first_along(probe, translation, filter, Rest::CAST, |_, _, _| true)
    }

    /// First hit of a moving probe on a shape for which `accept` holds. `accept` gets the shape, the normal of the hit,
    /// and the support shapes of the shape and of the probe at the start, relative to the probe's position.
    pub(super) fn first_along(
        &self,
        probe: &Probe,
        translation: Vec2<Fx>,
        filter: QueryFilter,
        rest: Rest,
        accept: impl Fn(ShapeId, Vec2<Unit>, [&SupportShape; 2]) -> bool,
    ) -> Option<CastHit> {
        let posed = probe.posed();
        let origin = probe.position();
        let moving = SupportShape::of(&posed, origin);
        let middle = origin + moving.middle();
        let area = posed.bounds.expanded(fx!(0.001));
        // Lazy, because most casts meet nothing.
        let resting = LazyCell::new(|| self.resting(probe, translation, filter, rest, &accept));
        let mut closest: Option<Ordered<CastHit>> = None;
        let mut interest = Unit::ONE;
        self.scratch.shapes.broad_phase().each_along(area, translation, |slot| {
            let posed = self.scratch.shapes.poses().at(slot);
            let Some(shape) = self.seen(slot, filter).filter(|_| posed.may_stop(middle)) else {
                return interest;
            };
            let other = SupportShape::of(posed, origin);
            let found =
                first_touch([&other, &moving], || resting.as_ref(), translation, filter.initial_overlap)
                    .filter(|hit| posed.stops(middle, middle + hit.travelled))
                    .filter(|hit| accept(shape, hit.normal, [&other, &moving]));
            if let Some(ShapeHit { fraction, order, travelled, point, normal }) = found {
                let starts_inside = fraction == Fx::ZERO && distance(&other, &moving).distance < Fx::ZERO;
                let point = origin + point;
                let hit = CastHit { shape, fraction, travelled, point, normal, starts_inside };
                let best = earlier(closest, Ordered { order, hit }, shape, |best| best.shape);
                closest = Some(best);
                interest = rounded_up(best.hit.fraction);
            }
            interest
        });
        closest.map(|found| found.hit)
    }

    /// Visits hits in no defined order. `visit` returns the fraction up to which further hits are of interest.
    fn each_hit(
        &self,
        origin: Vec2<Fx>,
        translation: Vec2<Fx>,
        filter: QueryFilter,
        mut visit: impl FnMut(Ordered<RayHit>) -> Unit,
    ) {
        let mut interest = Unit::ONE;
        let area = Aabb::new(origin, origin).expanded(SLACK);
        self.scratch.shapes.broad_phase().each_along(area, translation, |slot| {
            let posed = self.scratch.shapes.poses().at(slot);
            if let Some(shape) = self.seen(slot, filter).filter(|_| posed.is_facing(origin)) {
                let support = SupportShape::of(posed, origin);
                if let Some(hit) = cast_ray(&support, Vec2::ZERO, translation) {
                    let (fraction, point, normal) = (hit.fraction, origin + hit.point, hit.normal);
                    let starts_inside = normal == Vec2::ZERO;
                    if starts_inside && filter.initial_overlap == InitialOverlap::Ignore {
                        return interest;
                    }
                    let (order, hit) = (hit.order, RayHit { shape, fraction, point, normal, starts_inside });
                    interest = visit(Ordered { order, hit });
                }
            }
            interest
        });
    }
}

/// First touch of a moving shape B with a shape A. `None` if they do not touch, or if A is only a seam: see `seam.rs`.
fn first_touch<'r>(
    [a, b]: [&SupportShape; 2],
    resting: impl FnOnce() -> Option<&'r Resting>,
    translation: Vec2<Fx>,
    overlap: InitialOverlap,
) -> Option<ShapeHit> {
    if overlap != InitialOverlap::Resist {
        let start = distance(a, b);
        if start.distance < Fx::ZERO {
            return (overlap == InitialOverlap::Report).then(|| ShapeHit::at_start(&start));
        }
    }
    let hit = cast_shape(a, b, translation)?;
    match resting() {
        Some(resting) => resting.confirm(a, hit),
        None => Some(hit),
    }
}

/// A hit with its fraction before rounding.
#[derive(Clone, Copy)]
struct Ordered<H> {
    order: Fraction,
    hit: H,
}

/// The earlier of two hits. If both have the same fraction, the hit on the shape in the smaller slot.
fn earlier<H: Copy>(
    best: Option<Ordered<H>>,
    found: Ordered<H>,
    shape: ShapeId,
    shape_of: impl Fn(&H) -> ShapeId,
) -> Ordered<H> {
    best.filter(|best| (best.order, shape_of(&best.hit)) <= (found.order, shape)).unwrap_or(found)
}

/// The fraction rounded up, so that no hit at the same fraction is missed.
fn rounded_up(fraction: Fx) -> Unit {
    Unit::from_bits(saturate((fraction.to_bits() >> 2) + 1)).min(Unit::ONE)
}
