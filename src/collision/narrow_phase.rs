//! The narrow phase: every pair of outlines, listed.

use super::hull_hull::{AxisHint, SatCounters};
use super::manifold::Manifold;
use super::pose::{Hull, Outline, PosedShape};
use super::{circle_circle, circle_hull, hull_hull, segment};
use crate::fx;
use crate::math::{Fx, Length, Vec2, narrow, widen};

/// Boxes further apart than the margin by more than this, in metres, are rejected without a closer look. The
/// slack covers the rounding of vertices, so that the reject never decides what the closer look would not.
const REJECT_SLACK: Fx = fx!(0.0001);

/// Largest distance in metres that contacts look ahead: what a separation can hold.
const MARGIN_MAX: Length = Length::lit("15");

/// The margin for two shapes that may approach each other by `closing` metres in the tick.
pub(crate) fn margin_for(speculative: Length, closing: Fx) -> Length {
    speculative.saturating_add(narrow(closing)).min(MARGIN_MAX)
}

/// The contact of two posed shapes whose surfaces are at most `margin` metres apart.
pub(crate) fn collide(
    a: &PosedShape,
    b: &PosedShape,
    margin: Length,
    hint: &mut AxisHint,
    counters: &mut SatCounters,
) -> Manifold {
    if !a.bounds.expanded(widen(margin).saturating_add(REJECT_SLACK)).overlaps(b.bounds) {
        return Manifold::NONE;
    }
    collide_outlines(a, b, margin, hint, counters)
}

/// [`collide`] without the reject: its oracle.
pub(crate) fn collide_outlines(
    a: &PosedShape,
    b: &PosedShape,
    margin: Length,
    hint: &mut AxisHint,
    counters: &mut SatCounters,
) -> Manifold {
    use Outline::{Circle, Polygon, Segment};
    let d: Vec2<Length> = (b.centre - a.centre).narrow();
    // Each manifold is found about the centre of one shape: A's, unless only B has a centre near the contact.
    match (&a.outline, &b.outline) {
        (Circle { radius: radius_a }, Circle { radius: radius_b }) => {
            circle_circle::collide(*radius_a, *radius_b, d, margin).about(a.centre)
        }
        (Polygon(hull), Circle { radius }) => circle_hull::collide(hull, *radius, d, margin).about(a.centre),
        (Circle { radius }, Polygon(hull)) => {
            circle_hull::collide(hull, *radius, -d, margin).swapped().about(b.centre)
        }
        (Polygon(hull_a), Polygon(hull_b)) => {
            hull_hull::collide(hull_a, hull_b, d, margin, hint, counters).about(a.centre)
        }
        (Segment { .. }, Circle { radius }) => {
            let Some(hull) = segment_about(a, b) else { return Manifold::NONE };
            circle_hull::collide(&hull, *radius, Vec2::ZERO, margin).about(b.centre)
        }
        (Circle { radius }, Segment { .. }) => {
            let Some(hull) = segment_about(b, a) else { return Manifold::NONE };
            circle_hull::collide(&hull, *radius, Vec2::ZERO, margin).swapped().about(a.centre)
        }
        (Segment { .. }, Polygon(hull_b)) => {
            let Some(hull_a) = segment_about(a, b) else { return Manifold::NONE };
            hull_hull::collide(&hull_a, hull_b, Vec2::ZERO, margin, hint, counters).about(b.centre)
        }
        (Polygon(hull_a), Segment { .. }) => {
            let Some(hull_b) = segment_about(b, a) else { return Manifold::NONE };
            hull_hull::collide(hull_a, &hull_b, Vec2::ZERO, margin, hint, counters).about(a.centre)
        }
        // Two lines have no inside: nothing tells on which side one should be.
        (Segment { .. }, Segment { .. }) => Manifold::NONE,
    }
}

/// The segment's outline about the centre of the other shape.
fn segment_about(segment: &PosedShape, other: &PosedShape) -> Option<Hull> {
    let Outline::Segment { a, b } = segment.outline else { return None };
    let from_other = segment.centre - other.centre;
    segment::near_hull(from_other + a, from_other + b)
}
