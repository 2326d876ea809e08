//! Contact of two convex outlines: the separating axis test over the face normals of both, then clipping of the
//! incident edge against the reference face (D. Gregorius, "Robust Contact Creation", GDC 2015).
//!
//! If the outlines do not overlap, the closest features may be two corners, which no face normal detects. The normal is
//! then parallel to the line between the corners, so that a box that falls past the corner of another box does not
//! catch on it.

mod clip;

pub(in crate::collision) use clip::{CLIP_BITS, FINER, clip};

use crate::collision::manifold::Manifold;
use crate::collision::shape::posed::{BoxFaces, Hull};
use crate::math::{Length, Step, Unit, Vec2};

/// Tolerance of separations, in metres. B's best face becomes the reference face only if its separation exceeds that of
/// A's best face by more than the tolerance. Otherwise the choice between two equal faces would change from tick to
/// tick, and contact anchors would jump. Outlines with a separation above the tolerance count as disjoint.
pub(in crate::collision) const TOLERANCE: Step = Step::lit("0.0005");

/// Fraction bits of the product of a length and a unit vector.
pub(in crate::collision) const FACE_BITS: u32 = Unit::FRAC_NBITS + Length::FRAC_NBITS;

/// [`TOLERANCE`] with [`FACE_BITS`] fraction bits.
pub(in crate::collision) const TOLERANCE_WIDE: i64 = (TOLERANCE.to_bits() as i64) << 25;

/// The face of A or B that separated a pair when the pair was last tested. If this face still separates them by more
/// than the speculative margin, there is no contact, and the other faces need no test. The cache does not change
/// results.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum CachedAxis {
    #[default]
    None,
    OfA(u8),
    OfB(u8),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SatCounters {
    pub(crate) cached_axis_hits: u32,
    pub(crate) searches: u32,
}

/// Cosine of 2.6 degrees, in the format of a product of two [`Unit`] numbers. Two faces within this angle count as
/// parallel, and between parallel faces of separate rounded outlines A's face is preferred, within [`TOLERANCE`]. If
/// the reference face alternated between A and B, columns of 50 to 100 rounded boxes would fall.
pub(in crate::collision) const PARALLEL_WIDE: i64 = (Unit::lit("0.999").to_bits() as i64) << Unit::FRAC_NBITS;

#[derive(Clone, Copy)]
pub(in crate::collision) struct Face {
    pub(in crate::collision) edge: usize,
    /// Smallest distance of the other outline's vertices from the line of the face, without radii, in metres with 52
    /// fraction bits. Negative behind the face.
    pub(in crate::collision) separation: i64,
}

/// Contact manifold of two outlines, with anchors relative to the centre of A. `d` is the vector from the centre of A
/// to the centre of B. The manifold has no points if the surfaces are more than `margin` metres apart.
pub(crate) fn collide(
    a: &Hull,
    b: &Hull,
    d: Vec2<Length>,
    margin: Length,
    cached_axis: &mut CachedAxis,
    counters: &mut SatCounters,
) -> Manifold {
    let radii = a.radius.saturating_add(b.radius);
    let reach = i64::from(margin.saturating_add(radii).to_bits()) << 30;
    let from_cache = match *cached_axis {
        // Pairs of small boxes use no cached axis, because the SIMD path has none. The counters are then equal on all
        // machines.
        _ if a.is_small_box() && b.is_small_box() => i64::MIN,
        CachedAxis::OfA(edge) if usize::from(edge) < a.vertices().len() => {
            face_separation(a, edge.into(), b, d)
        }
        CachedAxis::OfB(edge) if usize::from(edge) < b.vertices().len() => {
            face_separation(b, edge.into(), a, -d)
        }
        _ => i64::MIN,
    };
    if from_cache > reach {
        counters.cached_axis_hits += 1;
        return Manifold::NONE;
    }
    counters.searches += 1;
    let face_a = best_face(a, b, d);
    if face_a.separation > reach {
        *cached_axis = CachedAxis::OfA(small(face_a.edge));
        return Manifold::NONE;
    }
    let face_b = best_face(b, a, -d);
    if face_b.separation > reach {
        *cached_axis = CachedAxis::OfB(small(face_b.edge));
        return Manifold::NONE;
    }
    *cached_axis = CachedAxis::None;
    let apart = are_apart(a, b, d, face_a, face_b);
    if is_reference_of_b(a, b, face_a, face_b, apart) {
        let mut manifold = clip(b, a, -d, face_b, apart, margin);
        manifold.swap();
        manifold.translate(d);
        manifold
    } else {
        clip(a, b, d, face_a, apart, margin)
    }
}

#[inline]
pub(in crate::collision) fn is_reference_of_b(
    a: &Hull,
    b: &Hull,
    face_a: Face,
    face_b: Face,
    apart: bool,
) -> bool {
    // A's face is preferred within the tolerance if the outlines overlap, or if they are rounded and their faces are
    // parallel. In all other cases only the face with the larger separation is next to the nearest corner.
    let is_rounded = a.radius.saturating_add(b.radius) > 0;
    let prefers_a = !apart || is_rounded && are_parallel(a.normals()[face_a.edge], b.normals()[face_b.edge]);
    face_b.separation > face_a.separation + if prefers_a { TOLERANCE_WIDE } else { 0 }
}

fn are_parallel(n: Vec2<Unit>, other: Vec2<Unit>) -> bool {
    let bits = |x: Unit| i64::from(x.to_bits());
    (bits(n.x) * bits(other.x) + bits(n.y) * bits(other.y)).abs() > PARALLEL_WIDE
}

/// Whether two outlines without their radii are disjoint.
#[inline]
pub(in crate::collision) fn are_apart(
    a: &Hull,
    b: &Hull,
    d: Vec2<Length>,
    face_a: Face,
    face_b: Face,
) -> bool {
    face_a.separation.max(face_b.separation) > TOLERANCE_WIDE
        || (a.is_line() && beyond_an_end(a, b, d))
        || (b.is_line() && beyond_an_end(b, a, -d))
}

/// Whether `a` is a line and `b` is beyond an end of `a`. A line has no faces at its ends, so the separating axis test
/// does not detect this case.
fn beyond_an_end(a: &Hull, b: &Hull, d: Vec2<Length>) -> bool {
    let &[start, end] = a.vertices() else { return false };
    let t = a.normals()[0].perp();
    let (x, y) = (i64::from(t.x.to_bits()), i64::from(t.y.to_bits()));
    let along = |v: Vec2<Length>| x * i64::from(v.x.to_bits()) + y * i64::from(v.y.to_bits());
    let of_b = |from: Vec2<Length>| b.vertices().iter().map(move |&vertex| along(vertex) + along(d - from));
    of_b(start).all(|along| along < -TOLERANCE_WIDE) || of_b(end).all(|along| along > TOLERANCE_WIDE)
}

#[expect(clippy::cast_possible_truncation, reason = "at most 8 edges")]
fn small(edge: usize) -> u8 {
    edge as u8
}

/// Face of `a` with the largest separation from `b`. The first wins a tie.
#[inline(always)]
pub(in crate::collision) fn best_face(a: &Hull, b: &Hull, d: Vec2<Length>) -> Face {
    match (a.as_box(), b.as_box()) {
        (Some(a), Some((others, _))) => furthest_of_box(a, others, d),
        _ => furthest(a, b, d),
    }
}

/// Face of a hull with the largest separation from a point. The first wins a tie.
#[inline]
pub(in crate::collision) fn face_before(hull: &Hull, point: Vec2<Length>) -> Face {
    match hull.as_box() {
        Some(faces) => furthest_of_box(faces, &[Vec2::ZERO; 2], point),
        None => furthest_over(hull, |_| 0, point),
    }
}

#[inline(never)]
fn furthest(a: &Hull, b: &Hull, d: Vec2<Length>) -> Face {
    // Each call has a constant number of vertices, so that the compiler unrolls its loop.
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

/// [`furthest`] for two boxes. Opposite vertices and opposite normals of a box differ only in sign, so the first two
/// faces are enough to find the best of the four.
#[inline(always)]
fn furthest_of_box((vertices, normals): BoxFaces, others: &[Vec2<Length>; 2], d: Vec2<Length>) -> Face {
    let further_of_opposite = |edge: usize, n: Vec2<Unit>, vertex: Vec2<Length>| {
        let along = product(n, d);
        let separation = along.abs() - product(n, vertex) - half_extent(n, others);
        Face { edge: if along >= 0 { edge } else { edge + 2 }, separation }
    };
    let a = further_of_opposite(0, normals[0], vertices[0]);
    let b = further_of_opposite(1, normals[1], vertices[1]);
    // The lower edge index wins a tie.
    if (b.separation, a.edge) > (a.separation, b.edge) { b } else { a }
}

/// Largest `n . v` over the four vertices `v` of a box, with 52 fraction bits. The arguments are the first two
/// vertices; the others are opposite to them.
#[inline(always)]
fn half_extent(n: Vec2<Unit>, &[a, b]: &[Vec2<Length>; 2]) -> i64 {
    product(n, a).abs().max(product(n, b).abs())
}

/// `n . v` with 52 fraction bits.
#[inline]
fn product(n: Vec2<Unit>, v: Vec2<Length>) -> i64 {
    i64::from(n.x.to_bits()) * i64::from(v.x.to_bits()) + i64::from(n.y.to_bits()) * i64::from(v.y.to_bits())
}

/// Smallest `n . v` over the vertices, with 52 fraction bits.
#[inline]
fn support(n: Vec2<Unit>, vertices: &[Vec2<Length>]) -> i64 {
    vertices.iter().fold(i64::MAX, |least, &vertex| least.min(product(n, vertex)))
}

/// Separation of `b` from a face of `a`, without radii, with 52 fraction bits.
pub(in crate::collision) fn face_separation(a: &Hull, edge: usize, b: &Hull, d: Vec2<Length>) -> i64 {
    plane_separation(a.normals()[edge], a.vertices()[edge], b, d)
}

/// Smallest signed distance of the vertices of `b` from the line through `point` with the normal `n`, with 52 fraction
/// bits. `d` is the centre of `b` in the coordinates of `point`.
#[inline]
pub(in crate::collision) fn plane_separation(
    n: Vec2<Unit>,
    point: Vec2<Length>,
    b: &Hull,
    d: Vec2<Length>,
) -> i64 {
    let reach = match b.as_box() {
        Some((others, _)) => -half_extent(n, others),
        None => support(n, b.vertices()),
    };
    reach + product(n, d) - product(n, point)
}
