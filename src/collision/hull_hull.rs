//! Two convex outlines: the separating axis test over the face normals of both, then clipping of the incident
//! edge against the reference face (D. Gregorius, "Robust Contact Creation", GDC 2015).
//!
//! In two dimensions the axis of least overlap of two convex polygons is always a face normal. Where they do not
//! overlap the closest features may be two corners, which no face normal sees: that case has its own normal, so
//! that a box falling past the corner of another does not catch on it.

mod clip;

pub(super) use clip::{CLIP_BITS, FINER, clip};

use super::manifold::Manifold;
use super::pose::{BoxFaces, Hull};
use crate::math::{Length, Step, Unit, Vec2};

/// B's best face must beat A's by this much, in metres, to become the reference: 0.5 mm keeps the choice from
/// flickering between two equal faces. Impulses survive a flicker, since features do not depend on the choice,
/// but anchors would jump. The same distance tells apart polygons that are disjoint from those that touch.
pub(super) const TOLERANCE: Step = Step::lit("0.0005");

/// The fraction bits of a product of a length and a unit vector: of the separation from a face.
pub(super) const FACE_BITS: u32 = Unit::FRAC_NBITS + Length::FRAC_NBITS;

/// [`TOLERANCE`] with [`FACE_BITS`] fraction bits.
pub(super) const TOLERANCE_WIDE: i64 = (TOLERANCE.to_bits() as i64) << 25;

#[derive(Clone, Copy)]
pub(super) struct Face {
    pub(super) edge: usize,
    /// Of the other outline's vertices from the face, without radii: 52 fraction bits.
    pub(super) separation: i64,
}

/// `d` is the vector from the centre of A to the centre of B.
pub(crate) fn collide(a: &Hull, b: &Hull, d: Vec2<Length>, margin: Length) -> Manifold {
    let radii = a.radius.saturating_add(b.radius);
    let reach = i64::from(margin.saturating_add(radii).to_bits()) << 30;
    let face_a = best_face(a, b, d);
    if face_a.separation > reach {
        return Manifold::NONE;
    }
    let face_b = best_face(b, a, -d);
    if face_b.separation > reach {
        return Manifold::NONE;
    }
    let apart = are_apart(a, b, d, face_a, face_b);
    // Outlines that are apart need the true best face, which is next to the nearest corner.
    let preference = if apart { 0 } else { TOLERANCE_WIDE };
    if face_b.separation > face_a.separation + preference {
        let mut manifold = clip(b, a, -d, face_b, apart, margin);
        manifold.swap();
        manifold.translate(d);
        manifold
    } else {
        clip(a, b, d, face_a, apart, margin)
    }
}

/// Whether two outlines do not touch, radii not counted, told by the best face of each.
#[inline]
pub(super) fn are_apart(a: &Hull, b: &Hull, d: Vec2<Length>, face_a: Face, face_b: Face) -> bool {
    face_a.separation.max(face_b.separation) > TOLERANCE_WIDE
        || (a.is_line() && beyond_an_end(a, b, d))
        || (b.is_line() && beyond_an_end(b, a, -d))
}

/// Whether `b` lies beyond an end of `a`, which has two sides and no face there: of two capsules end to end no face
/// tells that they are apart.
fn beyond_an_end(a: &Hull, b: &Hull, d: Vec2<Length>) -> bool {
    let &[start, end] = a.vertices() else { return false };
    let t = a.normals()[0].perp();
    let (x, y) = (i64::from(t.x.to_bits()), i64::from(t.y.to_bits()));
    let along = |v: Vec2<Length>| x * i64::from(v.x.to_bits()) + y * i64::from(v.y.to_bits());
    let of_b = |from: Vec2<Length>| b.vertices().iter().map(move |&vertex| along(vertex) + along(d - from));
    of_b(start).all(|along| along < -TOLERANCE_WIDE) || of_b(end).all(|along| along > TOLERANCE_WIDE)
}

/// The face of `a` that is furthest from `b`: of equal ones the first.
#[inline(always)]
pub(super) fn best_face(a: &Hull, b: &Hull, d: Vec2<Length>) -> Face {
    // Most shapes are boxes.
    match (a.as_box(), b.as_box()) {
        (Some(a), Some((others, _))) => furthest_of_box(a, others, d),
        _ => furthest(a, b, d),
    }
}

/// The face of a hull that is furthest from a point: of equal ones the first.
#[inline]
pub(super) fn face_before(hull: &Hull, point: Vec2<Length>) -> Face {
    match hull.as_box() {
        Some(faces) => furthest_of_box(faces, &[Vec2::ZERO; 2], point),
        None => furthest_over(hull, |_| 0, point),
    }
}

#[inline(never)]
fn furthest(a: &Hull, b: &Hull, d: Vec2<Length>) -> Face {
    // Loops of known length are unrolled.
    let others = b.vertices();
    match others.len() {
        2 => furthest_from::<2>(a, others, d),
        3 => furthest_from::<3>(a, others, d),
        4 => furthest_from::<4>(a, others, d),
        5 => furthest_from::<5>(a, others, d),
        6 => furthest_from::<6>(a, others, d),
        _ => furthest_over(a, |n| support(n, others), d),
    }
}

fn furthest_from<const N: usize>(a: &Hull, others: &[Vec2<Length>], d: Vec2<Length>) -> Face {
    match others.first_chunk::<N>() {
        Some(others) => furthest_over(a, |n| support(n, others), d),
        None => Face { edge: 0, separation: i64::MIN },
    }
}

#[inline]
fn furthest_over(a: &Hull, support: impl Fn(Vec2<Unit>) -> i64, d: Vec2<Length>) -> Face {
    let mut best = Face { edge: 0, separation: i64::MIN };
    for (edge, (&vertex, &n)) in a.vertices().iter().zip(a.normals()).enumerate() {
        let separation = support(n) + product(n, d) - product(n, vertex);
        if separation > best.separation {
            best = Face { edge, separation };
        }
    }
    best
}

/// [`furthest`] of two boxes: `max n . v` and `min n . v` over the vertices of one differ in sign alone, and so do the
/// distances of its own opposite faces from its centre.
#[inline(always)]
fn furthest_of_box((vertices, normals): BoxFaces, others: &[Vec2<Length>; 2], d: Vec2<Length>) -> Face {
    let further_of_opposite = |edge: usize, n: Vec2<Unit>, vertex: Vec2<Length>| {
        let along = product(n, d);
        let separation = along.abs() - product(n, vertex) - half_extent(n, others);
        Face { edge: if along >= 0 { edge } else { edge + 2 }, separation }
    };
    let a = further_of_opposite(0, normals[0], vertices[0]);
    let b = further_of_opposite(1, normals[1], vertices[1]);
    // Of equal ones the first.
    if (b.separation, a.edge) > (a.separation, b.edge) { b } else { a }
}

/// The most `n . v` of a box given by its first two vertices: the least is the opposite.
#[inline(always)]
fn half_extent(n: Vec2<Unit>, &[a, b]: &[Vec2<Length>; 2]) -> i64 {
    product(n, a).abs().max(product(n, b).abs())
}

/// `n . v` with 52 fraction bits.
#[inline]
fn product(n: Vec2<Unit>, v: Vec2<Length>) -> i64 {
    i64::from(n.x.to_bits()) * i64::from(v.x.to_bits()) + i64::from(n.y.to_bits()) * i64::from(v.y.to_bits())
}

/// How far some vertices, at least one, reach against a direction: `min n . v` with 52 fraction bits.
#[inline]
fn support(n: Vec2<Unit>, vertices: &[Vec2<Length>]) -> i64 {
    vertices.iter().fold(i64::MAX, |least, &vertex| least.min(product(n, vertex)))
}

/// Smallest distance of the vertices of `b` from a face of `a`, with 52 fraction bits.
pub(super) fn face_separation(a: &Hull, edge: usize, b: &Hull, d: Vec2<Length>) -> i64 {
    plane_separation(a.normals()[edge], a.vertices()[edge], b, d)
}

/// Smallest distance of the vertices of `b` from the line through a point across `n`, with 52 fraction bits.
#[inline]
pub(super) fn plane_separation(n: Vec2<Unit>, point: Vec2<Length>, b: &Hull, d: Vec2<Length>) -> i64 {
    let reach = match b.as_box() {
        Some((others, _)) => -half_extent(n, others),
        None => support(n, b.vertices()),
    };
    reach + product(n, d) - product(n, point)
}
