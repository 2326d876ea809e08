//! Seams: casts along a floor of many shapes do not stop where two shapes meet.
//!
//! A body at rest sinks slightly into the floor, so that a cast along the floor would meet the side of the next tile or
//! chain link. If a cast starts in contact, a second cast therefore confirms its hit. The second cast starts where the
//! shape just rests on the touched surfaces. An obstacle that the second cast does not meet is a seam.
//!
//! For the second cast, the shape is lifted off the surfaces that the first cast leaves or slides along. It is not
//! lifted off a surface that the first cast moves into, so that this surface stops the cast. Between a floor and a
//! ceiling the shape cannot be lifted off both. If several surfaces are touched, there is therefore one more cast for
//! each of them, for which the shape is lifted off that surface alone.
//!
//! Two rules keep a lift from carrying the shape over a real obstacle:
//!
//! - The second cast starts at the hit, and the shape is lifted only as far as it is still behind the touched surfaces.
//!   A surface that the shape has left by then does not matter.
//! - A lift that moves the shape straight away from the obstacle's surface, so that the normal remains the same, shows
//!   no seam. Such a lift is limited: it leaves the shape where it just rests on the obstacle.

use smallvec::SmallVec;

use super::mover_planes::{MoverPlane, solve_planes};
use super::{Probe, QueryFilter};
use crate::body::ShapeId;
use crate::collision::{
    Distance, SKIN, SKIN_TOLERANCE, ShapeHit, SupportShape, cast_shape, distance, goes_against, to_grid,
};
use crate::fx;
use crate::math::{Fx, Unit, Vec2};
use crate::world::World;

/// Tolerances of the position in which a shape rests.
#[derive(Clone, Copy)]
pub(super) struct Rest {
    /// Largest distance in metres at which a surface counts as touched.
    touching: Fx,
    /// Distance in metres from the surfaces at which the second cast starts. It exceeds the gap at which the first cast
    /// stops by 5 µm, so that ledges of up to 5 µm count as seams.
    gap: Fx,
    /// A cast that comes closer to a touched surface by more than this distance, in metres, moves into the surface and
    /// does not slide along it. Short casts have a smaller limit (see [`Rest::approach`]).
    approach_max: Fx,
}

impl Rest {
    pub(super) const CAST: Rest =
        Rest { touching: Self::SKIN_MAX, gap: fx!(0.000105), approach_max: fx!(0.001) };

    /// For casts that turn, which stop up to 0.15 mm before a surface.
    pub(super) const TURNING: Rest =
        Rest { touching: fx!(0.000155), gap: fx!(0.000155), approach_max: fx!(0.001) };

    /// For characters. Their casts must not come closer to a surface that they slide along, because a character makes
    /// many casts and would come closer with each.
    pub(super) const CHARACTER: Rest =
        Rest { touching: Self::SKIN_MAX, gap: fx!(0.000105), approach_max: Fx::ZERO };

    const SKIN_MAX: Fx = SKIN.saturating_add(SKIN_TOLERANCE);

    /// Whether a surface at a distance in metres counts as touched.
    fn touches(self, distance: Fx) -> bool {
        (-DEPTH_MAX..=self.touching).contains(&distance)
    }

    /// Distance in metres by which a cast along a translation approaches a surface, or `None` if it moves into the
    /// surface. A cast that slides along a surface may approach it by half a millimetre per metre, because the bodies
    /// of a pile are parallel only to within 0.1 mm per metre. The result includes a margin of 1 µm per metre for the
    /// sides of rotated tiles, which are parallel only to within 0.5 µm per metre.
    fn approach(self, normal: Vec2<Unit>, translation: Vec2<Fx>) -> Option<Fx> {
        let length = translation.length();
        let approach = normal.widen().dot(translation).saturating_neg().max(Fx::ZERO);
        let limit = tilt(length).min(self.approach_max);
        let slides = approach <= limit || !goes_against(normal, translation);
        slides.then(|| approach.min(limit) + (length >> 20_u32).min(self.approach_max))
    }
}

/// Distance in metres by which surfaces that count as parallel may diverge along a cast of a length in metres.
fn tilt(length: Fx) -> Fx {
    (length >> 11_u32).min(fx!(0.001))
}

/// Depth in metres up to which an overlap counts as a contact.
const DEPTH_MAX: Fx = fx!(0.02);

/// Largest difference of the components of two normals that count as equal.
const NORMAL_ROUNDING: Unit = Unit::from_bits(16);

/// Surfaces that a probe touches at the start of a cast: see the description of the module.
pub(super) struct Resting {
    rest: Rest,
    /// The shape at the start of the first cast, relative to the position of the probe.
    moving: SupportShape,
    /// Surfaces that the first cast leaves or slides along. A shape that just rests on a surface has a separation
    /// of 0.
    planes: SmallVec<[MoverPlane; 4]>,
    translation: Vec2<Fx>,
}

type Lifts = SmallVec<[Vec2<Fx>; 4]>;

impl Resting {
    /// Confirms a hit; `None` if it is a seam. Takes the normal and the point from a second cast, because the first
    /// cast may have met a corner below the surface.
    pub(super) fn confirm(&self, other: &SupportShape, hit: ShapeHit) -> Option<ShapeHit> {
        let there = self.moving.moved(to_grid(hit.travelled));
        let found = distance(other, &there);
        let (lifts, way) = self.second_casts(hit.travelled, [other, &there], &found);
        let mut confirmed = None;
        for lift in lifts {
            let again = cast_shape(other, &there.moved(to_grid(lift)), way)?;
            confirmed.get_or_insert(again);
        }
        let ShapeHit { normal, point, .. } = confirmed.unwrap_or(hit);
        Some(ShapeHit { normal, point, ..hit })
    }

    /// Whether a surface at a distance in metres from the shape counts as touched.
    pub(super) fn touches(&self, distance: Fx) -> bool {
        self.rest.touches(distance)
    }

    /// Displacements in metres from a hit to the places where the second casts start, and their translation. `found` is
    /// the distance of the shapes, which limits the lifts straight off the surface of the first shape.
    pub(super) fn second_casts(
        &self,
        travelled: Vec2<Fx>,
        shapes: [&SupportShape; 2],
        found: &Distance,
    ) -> (Lifts, Vec2<Fx>) {
        let mut lifts = self.lifts(travelled);
        // A lifted shape may have a longer way to an obstacle than the shape at its own place. The second casts are
        // therefore longer by twice the longest lift.
        let forwards = self.translation.normalized().unwrap_or(Vec2::ZERO).widen();
        let furthest = lifts.iter().map(|lift| lift.length()).max().unwrap_or(Fx::ZERO);
        let way = self.translation - travelled + forwards.scale(furthest * 2);
        let approach = self.rest.approach(found.normal, self.translation).unwrap_or(Fx::ZERO);
        let room = self.rest.gap - found.distance + approach;
        for lift in &mut lifts {
            *lift = limited(*lift, shapes, found.normal, room);
        }
        (lifts, way)
    }

    /// Displacements in metres to resting positions after a part of the translation. In the first, the shape rests on
    /// all touched surfaces. If there are several surfaces, there is one more displacement for each surface that the
    /// shape has to move away from. Empty if the shape has left all surfaces.
    fn lifts(&self, travelled: Vec2<Fx>) -> Lifts {
        let tilt = tilt(travelled.length());
        let mut planes = self.planes.clone();
        for plane in &mut planes {
            let left = plane.normal.widen().dot(travelled) - tilt;
            plane.separation += left.max(Fx::ZERO);
        }
        let overlapping = planes.iter().filter(|plane| plane.separation < Fx::ZERO);
        let mut lifts: Lifts =
            overlapping.map(|plane| plane.normal.widen().scale(-plane.separation)).collect();
        if lifts.len() > 1 {
            lifts.insert(0, solve_planes(Vec2::ZERO, &mut planes));
        }
        lifts
    }
}

/// Limits a lift along the normal of a hit, unless the lifted shape has another normal.
fn limited(lift: Vec2<Fx>, [other, moving]: [&SupportShape; 2], normal: Vec2<Unit>, room: Fx) -> Vec2<Fx> {
    let excess = normal.widen().dot(lift) - room;
    let is_straight = || {
        let lifted = distance(other, &moving.moved(to_grid(lift))).normal;
        let is_near = |a: Unit, b: Unit| a.abs_diff(b) <= NORMAL_ROUNDING;
        is_near(lifted.x, normal.x) && is_near(lifted.y, normal.y)
    };
    if excess > Fx::ZERO && is_straight() { lift - normal.widen().scale(excess) } else { lift }
}

impl World {
    /// The surfaces that a probe touches. `None` if the probe touches no shape.
    pub(super) fn resting(
        &self,
        probe: &Probe,
        translation: Vec2<Fx>,
        filter: QueryFilter,
        rest: Rest,
        accept: impl Fn(ShapeId, Vec2<Unit>, [&SupportShape; 2]) -> bool,
    ) -> Option<Resting> {
        let posed = probe.posed();
        let origin = probe.position();
        let moving = SupportShape::of(&posed, origin);
        let middle = origin + moving.middle();
        let mut planes: SmallVec<[MoverPlane; 4]> = SmallVec::new();
        self.each_overlapping(posed.bounds.expanded(SKIN + SKIN), filter, |shape, other| {
            if !other.is_solid_from(middle) {
                return;
            }
            let other = SupportShape::of(other, origin);
            let start = distance(&other, &moving);
            if !rest.touches(start.distance) {
                return;
            }
            if let Some(approach) = rest.approach(start.normal, translation)
                && accept(shape, start.normal, [&other, &moving])
            {
                let separation = start.distance - rest.gap - approach;
                planes.push(self.mover_plane(shape, start.normal, separation, origin));
            }
        });
        // The broad phase finds shapes in no defined order.
        planes.sort_unstable_by_key(|plane| plane.shape);
        (!planes.is_empty()).then_some(Resting { rest, moving, planes, translation })
    }
}
