//! Shapes that pass by each other: in which direction they stay apart while one moves.
//!
//! A contact is a plane, fixed for a tick. The corner of the next block on a flush floor is such a plane too, and
//! leans against whatever comes along, though it would slide over the block. Along a fixed axis `m` the separation of
//! two shapes that do not turn is linear in time,
//!
//! ```text
//! s(t) = s(0) + m.v t
//! ```
//!
//! so an axis on which they are apart at the start and at the end of a tick keeps them apart all the time (D. Eberly,
//! "Intersection of Convex Objects: The Method of Separating Axes", 2001, for moving objects). The axes tried are the
//! faces of both.

use super::circle_hull::{distance_along, step_bits};
use super::hull_hull::{FACE_BITS, face_separation};
use super::pose::{Hull, Outline, PosedShape};
use super::segment;
use crate::math::{Fx, Length, Step, Unit, Vec2, round_shift};

/// The cosine beyond which a face is one that the shapes lie on: nothing but rounding.
const SAME: Unit = Unit::lit("0.999999");
/// And beyond which a face is parallel to that: 25 degrees.
const OWN: Unit = Unit::lit("0.9");

/// How two shapes move against each other within a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    /// Displacement of B from A, in metres.
    pub(crate) shift: Vec2<Length>,
    /// Largest way of a point because the shapes turn.
    pub(crate) turn: Length,
    /// Overlap that is left to the next tick.
    pub(crate) slack: Length,
    /// How much nearer they may come on the axis: what falls on a face does not pass it by.
    pub(crate) approach: Length,
    /// Of the contact, either way round.
    pub(crate) normal: Vec2<Unit>,
    /// Faces of which the normal has a larger cosine with the contact's are the contact's own. A shape does not pass by
    /// the face that it lies on, however it turns there; a corner has no face of its own.
    own: Unit,
}

impl Passage {
    /// A passage at a contact with a normal.
    pub(crate) fn new(
        shift: Vec2<Length>,
        turn: Length,
        slack: Length,
        approach: Length,
        normal: Vec2<Unit>,
    ) -> Self {
        Passage { shift, turn, slack, approach, normal, own: Unit::ONE }
    }
}

/// Without sign.
fn cosine(a: Vec2<Unit>, b: Vec2<Unit>) -> Unit {
    let cosine: Unit = a.dot(b);
    cosine.saturating_abs()
}

/// Whether a face of one of the shapes keeps them apart through the whole passage, but for the slack.
pub(crate) fn pass_by(a: &PosedShape, b: &PosedShape, passage: &Passage) -> bool {
    let (mut room_a, mut room_b) = (None, None);
    let (Some(hull_a), Some(hull_b)) = (hull_about(a, b, &mut room_a), hull_about(b, a, &mut room_b)) else {
        return false;
    };
    let mut faces = [hull_a, hull_b].into_iter().flat_map(|hull| &hull.normals()[..hull.faces()]);
    let on_face = faces.any(|face| cosine(*face, passage.normal) > SAME);
    let passage = &Passage { own: if on_face { OWN } else { Unit::ONE }, ..*passage };
    let d = (origin(b, a) - origin(a, b)).narrow();
    let back = Passage { shift: -passage.shift, ..*passage };
    some_face_parts(hull_a, hull_b, d, passage) || some_face_parts(hull_b, hull_a, -d, &back)
}

/// Where the coordinates of [`hull_about`] start: a line may have its centre anywhere.
fn origin(shape: &PosedShape, other: &PosedShape) -> Vec2<Fx> {
    match shape.outline {
        Outline::Circle { .. } | Outline::Polygon(_) => shape.centre,
        Outline::Segment { .. } | Outline::Link(_) => other.centre,
    }
}

/// The outline of a shape as a hull, for which there is room if it is not one.
fn hull_about<'a>(shape: &'a PosedShape, other: &PosedShape, room: &'a mut Option<Hull>) -> Option<&'a Hull> {
    let from_other = shape.centre - other.centre;
    *room = match &shape.outline {
        Outline::Polygon(hull) => return Some(hull),
        Outline::Circle { radius } => Some(Hull::point(*radius)),
        Outline::Segment { a, b } => segment::near_hull(from_other + *a, from_other + *b),
        Outline::Link(link) => segment::near_hull(from_other + link.a, from_other + link.b),
    };
    room.as_ref()
}

/// `d` is the vector from the centre of A to that of B.
fn some_face_parts(a: &Hull, b: &Hull, d: Vec2<Length>, passage: &Passage) -> bool {
    let radii = step_bits(a.radius) + step_bits(b.radius);
    // What rules out most faces comes first.
    (0..a.faces()).any(|edge| {
        let normal = a.normals()[edge];
        let moved = distance_along(normal, passage.shift);
        if -moved > step_bits(passage.approach) || cosine(normal, passage.normal) > passage.own {
            return false;
        }
        let before = round_shift(face_separation(a, edge, b, d), FACE_BITS - Step::FRAC_NBITS) - radii;
        let after = before + moved - step_bits(passage.turn);
        let nearest = before.min(after);
        if nearest < -step_bits(passage.slack) {
            return false;
        }
        // Of what is thin on this axis the slack must not be all.
        let widths = [a, b].map(|hull| width(hull, normal) / 4).into_iter().filter(|&width| width > 0);
        nearest >= -widths.fold(step_bits(passage.slack), i64::min)
    })
}

/// How wide an outline is on an axis, in units of `Step`: 0 for a line across it.
fn width(hull: &Hull, n: Vec2<Unit>) -> i64 {
    let along = |&vertex: &Vec2<Length>| distance_along(n, vertex);
    let (lower, upper) = hull
        .vertices()
        .iter()
        .map(along)
        .fold((i64::MAX, i64::MIN), |(lower, upper), at| (lower.min(at), upper.max(at)));
    upper - lower + 2 * step_bits(hull.radius)
}
