//! Ghost-collision filter: finds a direction in which two shapes stay apart while they move past each other.
//!
//! A contact is a plane that is fixed for a tick. At a seam of a flush floor, the corner of the next block also gives a
//! plane, which would stop a shape that slides over the seam. Let two shapes that do not rotate have the relative
//! velocity `v`. Their separation along a fixed axis `m` is
//!
//! ```text
//! s(t) = s(0) + m.v t
//! ```
//!
//! so an axis that separates the shapes at both ends of a tick separates them throughout (D. Eberly, "Intersection of
//! Convex Objects: The Method of Separating Axes", 2001). The filter tries the face normals of both shapes.

use super::circle_hull::{distance_along, step_bits};
use super::hull_hull::{FACE_BITS, face_separation};
use super::segment;
use crate::collision::shape::posed::{Hull, Outline, PosedShape};
use crate::math::{Fx, Length, Step, Unit, Vec2, round_shift};

/// If the cosine between a face normal and the contact normal exceeds this value, the contact is on that face.
const SAME: Unit = Unit::lit("0.999999");
/// If the contact is on a face, the filter does not test faces whose cosine to the contact normal exceeds this value
/// (26 degrees).
const OWN: Unit = Unit::lit("0.9");

#[derive(Clone, Copy, Debug)]
pub(crate) struct GhostFilter {
    /// Displacement of B relative to A, in metres.
    pub(crate) shift: Vec2<Length>,
    /// Largest displacement, in metres, of a point of either shape by rotation.
    pub(crate) turn: Length,
    /// Overlap in metres that the filter tolerates and leaves to the next tick.
    pub(crate) slack: Length,
    /// Largest approach towards a face in metres, along its normal. A shape that approaches more falls onto the face
    /// and does not pass it.
    pub(crate) approach: Length,
    /// Contact normal. Its sign does not matter.
    pub(crate) normal: Vec2<Unit>,
    /// The filter tests only faces whose cosine to the contact normal is at most this value. At other faces, the shapes
    /// touch and do not pass by.
    own: Unit,
}

impl GhostFilter {
    pub(crate) fn new(
        shift: Vec2<Length>,
        turn: Length,
        slack: Length,
        approach: Length,
        normal: Vec2<Unit>,
    ) -> Self {
        GhostFilter { shift, turn, slack, approach, normal, own: Unit::ONE }
    }
}

/// Absolute value of the cosine.
fn cosine(a: Vec2<Unit>, b: Vec2<Unit>) -> Unit {
    let cosine: Unit = a.dot(b);
    cosine.saturating_abs()
}

/// Whether a face of one of the shapes separates them throughout the motion, up to the slack.
pub(crate) fn is_ghost(a: &PosedShape, b: &PosedShape, filter: &GhostFilter) -> bool {
    let (mut room_a, mut room_b) = (None, None);
    let (Some(hull_a), Some(hull_b)) = (hull_about(a, b, &mut room_a), hull_about(b, a, &mut room_b)) else {
        return false;
    };
    let mut faces = [hull_a, hull_b].into_iter().flat_map(|hull| &hull.normals()[..hull.faces()]);
    let on_face = faces.any(|face| cosine(*face, filter.normal) > SAME);
    let filter = &GhostFilter { own: if on_face { OWN } else { Unit::ONE }, ..*filter };
    let d = (origin(b, a) - origin(a, b)).narrow();
    let back = GhostFilter { shift: -filter.shift, ..*filter };
    some_face_parts(hull_a, hull_b, d, filter) || some_face_parts(hull_b, hull_a, -d, &back)
}

/// Origin of a shape's coordinates. For a segment it is the centre of the other shape, because the segment's own centre
/// may be far away.
fn origin(shape: &PosedShape, other: &PosedShape) -> Vec2<Fx> {
    match shape.outline {
        Outline::Circle { .. } | Outline::Polygon(_) => shape.centre,
        Outline::Segment { .. } | Outline::Link(_) => other.centre,
    }
}

/// Outline of a shape as a hull. `room` provides storage if the outline is not a hull already.
fn hull_about<'a>(shape: &'a PosedShape, other: &PosedShape, room: &'a mut Option<Hull>) -> Option<&'a Hull> {
    let centre = other.centre - shape.centre;
    *room = match &shape.outline {
        Outline::Polygon(hull) => return Some(hull),
        Outline::Circle { radius } => Some(Hull::point(*radius)),
        Outline::Segment { a, b } => segment::near_hull(*a, *b, centre),
        Outline::Link(link) => segment::near_hull(link.a, link.b, centre),
    };
    room.as_ref()
}

/// Whether a face of `a` separates the hulls throughout the motion, up to the slack. `d` is the vector from the origin
/// of `a` to that of `b`.
fn some_face_parts(a: &Hull, b: &Hull, d: Vec2<Length>, filter: &GhostFilter) -> bool {
    let radii = step_bits(a.radius) + step_bits(b.radius);
    (0..a.faces()).any(|edge| {
        let normal = a.normals()[edge];
        let moved = distance_along(normal, filter.shift);
        if -moved > step_bits(filter.approach) || cosine(normal, filter.normal) > filter.own {
            return false;
        }
        let before = round_shift(face_separation(a, edge, b, d), FACE_BITS - Step::FRAC_NBITS) - radii;
        let after = before + moved - step_bits(filter.turn);
        let nearest = before.min(after);
        if nearest < -step_bits(filter.slack) {
            return false;
        }
        // For a thin outline, the slack is at most a quarter of the outline's width.
        let widths = [a, b].map(|hull| width(hull, normal) / 4).into_iter().filter(|&width| width > 0);
        nearest >= -widths.fold(step_bits(filter.slack), i64::min)
    })
}

/// Width of a hull along an axis in units of `Step`. 0 for a line perpendicular to the axis.
fn width(hull: &Hull, n: Vec2<Unit>) -> i64 {
    let along = |&vertex: &Vec2<Length>| distance_along(n, vertex);
    let (lower, upper) = hull
        .vertices()
        .iter()
        .map(along)
        .fold((i64::MAX, i64::MIN), |(lower, upper), at| (lower.min(at), upper.max(at)));
    upper - lower + 2 * step_bits(hull.radius)
}
