//! Narrow phase: dispatch over pairs of outlines.

mod box_box;
mod circle_circle;
mod circle_hull;
mod ghost_collision;
mod hull_hull;
mod link;
mod one_way;
pub(in crate::collision) mod segment;

pub(crate) use box_box::{BoxPairs, SmallBoxes, SmallBoxesRange};
pub(crate) use ghost_collision::{GhostFilter, is_ghost};
pub(crate) use hull_hull::{CachedAxis, SatCounters};
pub(crate) use one_way::{OneWay, is_open, pass_direction};

use crate::collision::manifold::Manifold;
use crate::collision::shape::posed::{Hull, Outline, PosedShape};
use crate::fx;
use crate::math::{Aabb, Fx, Length, Vec2, convert, widen};
use fixed::FixedI32;
use fixed::types::extra::LeEqU32;
use link::Facing;

/// Slack of the early reject in metres. It covers the rounding of vertices, and the 0.5 mm by which nearly parallel
/// edges may count as nearer than they are.
const REJECT_SLACK: Fx = fx!(0.001);

/// Largest speculative margin in metres. It is below 16 m, the largest separation that `Step` can hold.
const MARGIN_MAX: Length = Length::lit("15");

/// Speculative margin of a pair in metres: the sum of `speculative`, which all pairs have, and of `closing`, the
/// distance by which the shapes may approach in the tick. At most [`MARGIN_MAX`].
#[inline]
pub(crate) fn margin_for<A: LeEqU32>(speculative: Length, closing: FixedI32<A>) -> Length {
    speculative.saturating_add(convert(closing)).min(MARGIN_MAX)
}

/// Whether shapes in two boxes may be at most `margin` metres apart.
#[inline]
pub(crate) fn may_meet(a: Aabb, b: Aabb, margin: Length) -> bool {
    a.expanded(widen(margin) + REJECT_SLACK).overlaps(b)
}

/// [`collide_near`] with an early reject by bounding boxes.
pub(crate) fn collide(
    a: &PosedShape,
    b: &PosedShape,
    margin: Length,
    cached_axis: &mut CachedAxis,
    counters: &mut SatCounters,
) -> Manifold {
    if may_meet(a.bounds, b.bounds, margin) {
        collide_near(a, b, margin, cached_axis, counters)
    } else {
        Manifold::NONE
    }
}

/// Contact manifold, without points if the surfaces are more than `margin` metres apart.
pub(crate) fn collide_near(
    a: &PosedShape,
    b: &PosedShape,
    margin: Length,
    cached_axis: &mut CachedAxis,
    counters: &mut SatCounters,
) -> Manifold {
    use Outline::{Circle, Link, Polygon, Segment};
    let d: Vec2<Length> = (b.centre - a.centre).narrow();
    // Anchors are relative to the centre of A, with two exceptions: in a pair of a circle and a polygon, to the centre
    // of the polygon, and in a pair with a segment or link, to the centre of the other shape.
    let mut origin = a.centre;
    let mut manifold = match (&a.outline, &b.outline) {
        (Circle { radius: radius_a }, Circle { radius: radius_b }) => {
            circle_circle::collide(*radius_a, *radius_b, d, margin)
        }
        (Polygon(hull), Circle { radius }) => circle_hull::collide(hull, *radius, d, margin),
        (Circle { radius }, Polygon(hull)) => {
            origin = b.centre;
            circle_hull::collide(hull, *radius, -d, margin).swapped()
        }
        (Polygon(hull_a), Polygon(hull_b)) => {
            hull_hull::collide(hull_a, hull_b, d, margin, cached_axis, counters)
        }
        (Segment { .. }, Circle { radius }) => {
            origin = b.centre;
            let Some(hull) = segment_about(a, b) else { return Manifold::NONE };
            circle_hull::collide(&hull, *radius, Vec2::ZERO, margin)
        }
        (Circle { radius }, Segment { .. }) => {
            let Some(hull) = segment_about(b, a) else { return Manifold::NONE };
            circle_hull::collide(&hull, *radius, Vec2::ZERO, margin).swapped()
        }
        (Segment { .. }, Polygon(hull_b)) => {
            origin = b.centre;
            let Some(hull_a) = segment_about(a, b) else { return Manifold::NONE };
            hull_hull::collide(&hull_a, hull_b, Vec2::ZERO, margin, cached_axis, counters)
        }
        (Polygon(hull_a), Segment { .. }) => {
            let Some(hull_b) = segment_about(b, a) else { return Manifold::NONE };
            hull_hull::collide(hull_a, &hull_b, Vec2::ZERO, margin, cached_axis, counters)
        }
        (Link(_), Circle { radius }) => {
            origin = b.centre;
            let Some(facing) = link_facing(a, b, Vec2::ZERO) else { return Manifold::NONE };
            facing.collide_circle(*radius, margin)
        }
        (Circle { radius }, Link(_)) => {
            let Some(facing) = link_facing(b, a, Vec2::ZERO) else { return Manifold::NONE };
            facing.collide_circle(*radius, margin).swapped()
        }
        (Link(_), Polygon(hull_b)) => {
            origin = b.centre;
            let Some(facing) = link_facing(a, b, hull_b.middle()) else { return Manifold::NONE };
            facing.collide_hull(hull_b, margin)
        }
        (Polygon(hull_a), Link(_)) => {
            let Some(facing) = link_facing(b, a, hull_a.middle()) else { return Manifold::NONE };
            facing.collide_hull(hull_a, margin).swapped()
        }
        // Two lines do not collide, because neither has an inside from which it could push the other out.
        (Segment { .. } | Link(_), Segment { .. } | Link(_)) => Manifold::NONE,
    };
    manifold.origin = origin;
    manifold
}

/// A segment as a hull relative to the centre of the other shape.
fn segment_about(segment: &PosedShape, other: &PosedShape) -> Option<Hull> {
    let Outline::Segment { a, b } = segment.outline else { return None };
    segment::near_hull(a, b, other.centre - segment.centre)
}

/// A link relative to the centre of the other shape, oriented towards the point `place` in the other shape.
fn link_facing(link: &PosedShape, other: &PosedShape, place: Vec2<Fx>) -> Option<Facing> {
    let Outline::Link(posed) = link.outline else { return None };
    Facing::new(&posed, other.centre - link.centre, place)
}

#[cfg(test)]
mod tests;
