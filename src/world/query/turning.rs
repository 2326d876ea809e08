//! Casts that turn: translation and rotation at once, by conservative advancement.

use super::cast::CastHit;
use super::overlap::proximity;
use super::seam::{Rest, Resting};
use super::{InitialOverlap, Probe, QueryFilter};
use crate::body::{Handle, ShapeId};
use crate::collision::{
    PosedShape, SKIN, StartPolicy, SupportShape, Sweep, TimeOfImpact, distance, first_impact, to_grid,
};
use crate::math::{Aabb, Fx, Unit, Vec2, saturate, saturate_wide};
use crate::world::World;

struct Turning {
    support: SupportShape,
    sweep: Sweep,
}

impl World {
    /// Returns the first shape that a probe meets as it moves along a translation in metres while it turns about its
    /// position, both at constant speed. The rotation is in turns, counter-clockwise, and may exceed a turn.
    ///
    /// The probe stops 0.1 to 0.15 mm before it touches. If it touches a shape at the start, it may move up to 0.1 mm
    /// deeper into the shape before it stops. Hits may be reported too early for 163 turns or more, and for a probe
    /// that reaches further than 1024 m from its position.
    ///
    /// ```
    /// use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, math::Vec2, world::{Probe, World}};
    /// let mut world = World::default();
    /// let wall = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(9))?);
    /// world.spawn(&BodyDef::fixed().position((fx!(3), fx!(0))), &[wall])?;
    /// // An upright plank of 5 m that turns clockwise about its middle by a quarter of a turn.
    /// let plank = Probe::new(Polygon::rectangle(fx!(0.1), fx!(2.5))?, Vec2::new(fx!(0), fx!(0)))?;
    /// let hit = world.cast_turning(&plank, Vec2::new(fx!(0), fx!(0)), fx!(-0.25), Default::default());
    /// assert!(hit.is_some_and(|hit| hit.fraction > fx!(0.5) && hit.fraction < fx!(0.6)));
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    #[must_use]
    #[doc(alias = "nonlinear shape cast")]
    #[doc(alias = "swept rotation")]
    pub fn cast_turning(
        &self,
        probe: &Probe,
        translation: impl Into<Vec2<Fx>>,
        turns: Fx,
        filter: QueryFilter,
    ) -> Option<CastHit> {
        let translation = translation.into();
        let origin = probe.position();
        let support = SupportShape::of(&probe.posed(), origin);
        let middle = origin + support.middle();
        let sweep = Sweep { start: origin, end: origin + translation, turn: turns.to_bits() };
        let turning = Turning { support, sweep };
        let resting = self.resting(probe, translation, filter, Rest::TURNING, |_, _, _| true);
        let reach = support.reach_with_radius().saturating_add(SKIN + SKIN);
        let area = Aabb::new(origin, origin).expanded(reach);
        let mut closest: Option<(Fx, ShapeId)> = None;
        let mut interest = Unit::ONE;
        self.scratch.shapes.broad_phase().each_along(area, translation, |slot| {
            let posed = self.scratch.shapes.poses().at(slot);
            let Some(shape) = self.seen(slot, filter).filter(|_| posed.may_stop(middle)) else {
                return interest;
            };
            if let Some(fraction) = turning.first_touch(posed, resting.as_ref(), filter.initial_overlap) {
                // A search that gives up may report a shape too early. The lower bound `entry` ensures that the first
                // shape does not depend on the order of visits even then.
                let found = (fraction.max(entry(area, translation, posed.bounds)), shape);
                let best = closest.map_or(found, |best| best.min(found));
                closest = Some(best);
                interest = Unit::from_bits(saturate((best.0.to_bits() >> 2) + 1)).min(Unit::ONE);
            }
            interest
        });
        closest.map(|(fraction, shape)| {
            turning.hit(self.scratch.shapes.poses().at(shape.slot()), shape, fraction)
        })
    }
}

impl Turning {
    /// Fraction at which the probe first touches a shape. `None` if it does not, or if the shape is only a seam.
    fn first_touch(
        &self,
        other: &PosedShape,
        resting: Option<&Resting>,
        overlap: InitialOverlap,
    ) -> Option<Fx> {
        let a = SupportShape::of(other, other.centre);
        if overlap != InitialOverlap::Resist {
            let origin = self.sweep.start;
            let start = distance(&SupportShape::of(other, origin), &self.support);
            if start.distance < Fx::ZERO {
                return (overlap == InitialOverlap::Report).then_some(Fx::ZERO);
            }
        }
        let fraction = self.touch(&a, other.centre, StartPolicy::Resist)?;
        let (travelled, turned) = self.sweep.at(fraction);
        let (start, middle) = (self.sweep.start, self.support.rotated(turned).middle());
        let is_stopped = other.stops(start + self.support.middle(), start + travelled + middle)
            && resting.is_none_or(|resting| self.confirms(resting, other, fraction));
        is_stopped.then_some(fraction)
    }

    /// Whether a touch is not only a seam.
    fn confirms(&self, resting: &Resting, other: &PosedShape, fraction: Fx) -> bool {
        let origin = self.sweep.start;
        let (travelled, turned) = self.sweep.at(fraction);
        let support = self.support.rotated(turned);
        let there = support.moved(to_grid(travelled));
        let a = SupportShape::of(other, origin);
        // The search finds a shape that the probe touches at the start only where the probe has come closer to it. How
        // far a lift may move the probe off such a shape therefore depends on the start.
        let start = distance(&a, &self.support);
        let (met, found) = if resting.touches(start.distance) {
            (self.support, start)
        } else {
            (there, distance(&a, &there))
        };
        let (lifts, way) = resting.second_casts(travelled, [&a, &met], &found);
        let turn = self.sweep.turn - self.sweep.turned(fraction);
        let a = SupportShape::of(other, other.centre);
        lifts.iter().all(|&lift| {
            let start = origin + travelled + lift;
            let again = Turning { support, sweep: Sweep { start, end: start + way, turn } };
            again.touch(&a, other.centre, StartPolicy::Report).is_some()
        })
    }

    /// Fraction of the first touch. If the search gives up, the fraction that it has reached counts as a hit. Otherwise
    /// the probe might pass through a shape.
    fn touch(&self, other: &SupportShape, centre: Vec2<Fx>, policy: StartPolicy) -> Option<Fx> {
        let still = Sweep::fixed(centre);
        match first_impact((other, &still), (&self.support, &self.sweep), SKIN, policy) {
            TimeOfImpact::Separated => None,
            TimeOfImpact::Hit { fraction } | TimeOfImpact::Failed { fraction } => Some(fraction),
            TimeOfImpact::Overlapped => Some(Fx::ZERO),
        }
    }

    fn hit(&self, other: &PosedShape, shape: ShapeId, fraction: Fx) -> CastHit {
        let origin = self.sweep.start;
        let start = distance(&SupportShape::of(other, origin), &self.support);
        let (travelled, turned) = self.sweep.at(fraction);
        let there = self.support.rotated(turned).moved(to_grid(travelled));
        let touch = proximity(&SupportShape::of(other, origin), &there, origin);
        let starts_inside = start.distance < Fx::ZERO;
        CastHit { shape, fraction, travelled, point: touch.point_a, normal: touch.normal, starts_inside }
    }
}

/// Fraction of a translation up to which an area does not reach a box, rounded down.
fn entry(area: Aabb, translation: Vec2<Fx>, aabb: Aabb) -> Fx {
    let on_axis = |[lower, upper]: [Fx; 2], [box_lower, box_upper]: [Fx; 2], way: Fx| {
        let bits = |at: Fx| i128::from(at.to_bits());
        let gap = if way < Fx::ZERO { bits(lower) - bits(box_upper) } else { bits(box_lower) - bits(upper) };
        if gap > 0 { (gap << Fx::FRAC_NBITS).checked_div(bits(way).abs()).unwrap_or_default() } else { 0 }
    };
    let x = on_axis([area.lower.x, area.upper.x], [aabb.lower.x, aabb.upper.x], translation.x);
    let y = on_axis([area.lower.y, area.upper.y], [aabb.lower.y, aabb.upper.y], translation.y);
    Fx::from_bits(saturate_wide(x.max(y))).min(Fx::ONE)
}
