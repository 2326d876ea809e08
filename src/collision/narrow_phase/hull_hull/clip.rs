//! Clipping of the incident edge of one outline against the reference face of another.
//!
//! Let `v1`, `t` and `n` be the start, the tangent and the normal of the reference face, and `rA` and `rB` the radii of
//! the outlines. A point of the incident edge is at the distance `along` from `v1` in the direction of `t`, and at the
//! distance `above` in the direction of `n`. Its contact point has
//!
//! ```text
//! anchor = v1 + t along + n (above + rA - rB) / 2,    separation = above - rA - rB
//! ```

use super::{FACE_BITS, Face, TOLERANCE};
use crate::collision::manifold::{Feature, Manifold, ManifoldPoint};
use crate::collision::narrow_phase::circle_hull::step_bits;
use crate::collision::shape::posed::Hull;
use crate::math::{Length, Step, Unit, Vec2, round_shift, saturate};

/// Difference between the numbers of fraction bits of a `Step` and of a `Length`.
pub(in crate::collision) const FINER: u32 = Step::FRAC_NBITS - Length::FRAC_NBITS;

/// Fraction bits of the clip fraction, the part of the incident edge that is cut off. The product of this fraction and
/// the length of an edge (at most 570 m, in units of `Step`) has 63 bits.
pub(in crate::collision) const CLIP_BITS: u32 = 26;

/// Position of an end of an edge, relative to the start of the reference edge: `along` the reference edge in units of
/// `Length`, and `above` it in units of `Step`. The numbers are not saturated.
#[derive(Clone, Copy)]
struct ClipPoint {
    vertex: usize,
    along: i64,
    above: i64,
}

/// Clips the incident edge of `b` against a face of `a`. `apart` is whether the outlines without their radii are
/// disjoint. Anchors are relative to the centre of `a`.
pub(in crate::collision) fn clip(
    a: &Hull,
    b: &Hull,
    d: Vec2<Length>,
    face: Face,
    apart: bool,
    margin: Length,
) -> Manifold {
    let next = a.next(face.edge);
    let (normal, v1) = (a.normal(face.edge), a.vertex(face.edge));
    let (first, last) = (
        ClipPoint { vertex: face.edge, along: 0, above: 0 },
        ClipPoint { vertex: next, along: along(normal, between(v1, a.vertex(next))), above: 0 },
    );
    // Both outlines run counter-clockwise, so the incident edge runs backwards along the reference face: its first
    // vertex is the upper end, and its second vertex is the lower end.
    let to_b = between(v1, d);
    let end_of_b = |vertex: usize| {
        let position = b.vertex(vertex);
        let p = (to_b.0 + i64::from(position.x.to_bits()), to_b.1 + i64::from(position.y.to_bits()));
        ClipPoint { vertex, along: along(normal, p), above: above(normal, p) }
    };
    let edge_of_b = |edge: usize| (end_of_b(edge), end_of_b(b.next(edge)));
    let mut incident = incident_edge(b, normal);
    let (mut upper, mut lower) = edge_of_b(incident);
    // On an outline with small bends, the edge most opposed to the face may lie beside the face while a neighbour of
    // this edge is in front of the face. The loop then moves on to the neighbour. Separate outlines do not need this:
    // their nearest corner is an end of the most opposed edge.
    let neighbours = if apart { 0 } else { b.faces() };
    for _ in 0..neighbours {
        let neighbour = if upper.along < first.along {
            b.previous(incident)
        } else if lower.along > last.along {
            b.next(incident)
        } else {
            break;
        };
        if !bends_little(b, incident, neighbour) || dot(b.normal(neighbour), normal) >= 0 {
            break;
        }
        incident = neighbour;
        (upper, lower) = edge_of_b(incident);
    }

    let context = Clip { a, b, d, face: face.edge, margin };
    let corners = if apart { nearest_corners(first, last, upper, lower) } else { None };
    if upper.along < first.along || lower.along > last.along {
        // The incident edge lies beside the face, so there is nothing to clip. This also happens to outlines that
        // overlap deeply: the end of the incident edge that is nearest to the face then pushes them apart.
        let (end_a, end_b) = if upper.along < first.along { (first, upper) } else { (last, lower) };
        return match corners {
            Some((vertex_a, vertex_b)) => context.corner(&Gap::between(&context, vertex_a, vertex_b)),
            None => context.face([(end_a.vertex, end_b)]),
        };
    }
    let low = if lower.along < first.along { clipped(lower, upper, first.along) } else { lower };
    let high = if upper.along > last.along { clipped(upper, lower, last.along) } else { upper };
    if let Some((vertex_a, vertex_b)) = corners {
        // Nearly parallel rounded edges also have two corners as nearest points, but need a contact point at each end.
        // The edges are nearly parallel if the distance between the corners is at most `TOLERANCE` below the height of
        // the clipped edge's nearer end and at most `TOLERANCE` above the separation of the face.
        let gap = Gap::between(&context, vertex_a, vertex_b);
        let distance = step_bits(gap.distance);
        let nearer = low.above.min(high.above);
        let spread = (nearer - distance).max(distance - (face.separation >> 25));
        if spread > i64::from(TOLERANCE.to_bits()) {
            return context.corner(&gap);
        }
    }
    context.face([(first.vertex, low), (last.vertex, high)])
}

/// The two corners that are the nearest points of two separate edges: each corner lies beyond an end of the other edge.
/// `None` if a nearest point lies inside an edge.
fn nearest_corners(
    first: ClipPoint,
    last: ClipPoint,
    upper: ClipPoint,
    lower: ClipPoint,
) -> Option<(ClipPoint, ClipPoint)> {
    let beyond_incident = |a: ClipPoint, b: ClipPoint, other: ClipPoint| {
        let from_b = |end: ClipPoint| (end.along - b.along, (end.above - b.above) >> FINER);
        let (outward, edge) = (from_b(a), from_b(other));
        // The product of the two vectors' lengths is below (512 m)^2, which is 2^62 units, so the sum fits 64 bits.
        outward.0 * edge.0 + outward.1 * edge.1 < 0
    };
    [(upper, lower), (lower, upper)].into_iter().find_map(|(b, other)| {
        if b.along < first.along && beyond_incident(first, b, other) {
            Some((first, b))
        } else if b.along > last.along && beyond_incident(last, b, other) {
            Some((last, b))
        } else {
            None
        }
    })
}

/// Edge whose normal is most opposed to `normal`. On a tie, the edge with the lowest index wins, but in a box, edge 0
/// or 2 wins against edge 1 or 3.
#[inline]
fn incident_edge(b: &Hull, normal: Vec2<Unit>) -> usize {
    let cosine = |n: Vec2<Unit>| dot(n, normal);
    let nearer = |a: (usize, i64), b: (usize, i64)| if b.1 < a.1 { b } else { a };
    if let Some((_, &[n0, n1])) = b.as_box() {
        let (cosine_0, cosine_1) = (cosine(n0), cosine(n1));
        let edge_0 = if cosine_0 <= 0 { 0 } else { 2 };
        let edge_1 = if cosine_1 <= 0 { 1 } else { 3 };
        return nearer((edge_0, -cosine_0.abs()), (edge_1, -cosine_1.abs())).0;
    }
    b.normals().iter().map(|&n| cosine(n)).enumerate().reduce(nearer).map_or(0, |(edge, _)| edge)
}

/// Whether an outline turns by less than an eighth of a turn from an edge to its neighbour. With a larger turn, the
/// neighbour's face usually wins the separating axis test.
fn bends_little(b: &Hull, edge: usize, neighbour: usize) -> bool {
    const COS_EIGHTH: i64 = (Unit::lit("0.70711").to_bits() as i64) << Unit::FRAC_NBITS;
    dot(b.normal(edge), b.normal(neighbour)) > COS_EIGHTH
}

/// `a . b` with 60 fraction bits.
#[inline]
fn dot(a: Vec2<Unit>, b: Vec2<Unit>) -> i64 {
    i64::from(a.x.to_bits()) * i64::from(b.x.to_bits()) + i64::from(a.y.to_bits()) * i64::from(b.y.to_bits())
}

/// `to - from` in units of `Length`. The result may need one bit more than a `Length` has.
#[inline]
fn between(from: Vec2<Length>, to: Vec2<Length>) -> (i64, i64) {
    let apart = |from: Length, to: Length| i64::from(to.to_bits()) - i64::from(from.to_bits());
    (apart(from.x, to.x), apart(from.y, to.y))
}

/// `t . p` in units of `Length`, for `t` the normal rotated by a quarter turn.
#[inline]
fn along(n: Vec2<Unit>, p: (i64, i64)) -> i64 {
    round_shift(i64::from(n.x.to_bits()) * p.1 - i64::from(n.y.to_bits()) * p.0, Unit::FRAC_NBITS)
}

/// `n . p` in units of `Step`.
#[inline]
fn above(n: Vec2<Unit>, p: (i64, i64)) -> i64 {
    let above = i64::from(n.x.to_bits()) * p.0 + i64::from(n.y.to_bits()) * p.1;
    round_shift(above, FACE_BITS - Step::FRAC_NBITS)
}

/// Moves `end` along its edge, towards `other`, to the point at which `along` is `limit`. The limit is between the two
/// ends.
#[inline]
fn clipped(end: ClipPoint, other: ClipPoint, limit: i64) -> ClipPoint {
    let fraction = ((limit - end.along) << CLIP_BITS) / (other.along - end.along);
    ClipPoint {
        along: limit,
        above: end.above + round_shift((other.above - end.above) * fraction, CLIP_BITS),
        ..end
    }
}

struct Clip<'a> {
    a: &'a Hull,
    b: &'a Hull,
    /// Vector from the centre of A to the centre of B.
    d: Vec2<Length>,
    face: usize,
    margin: Length,
}

struct Gap {
    vertices: (usize, usize),
    normal: Vec2<Unit>,
    distance: Length,
}

impl Gap {
    fn between(clip: &Clip, a: ClipPoint, b: ClipPoint) -> Self {
        let d = clip.b.vertex(b.vertex) + clip.d - clip.a.vertex(a.vertex);
        let (normal, distance) =
            d.normalized_with_length().unwrap_or((clip.a.normal(clip.face), Length::ZERO));
        Gap { vertices: (a.vertex, b.vertex), normal, distance }
    }
}

impl Clip<'_> {
    /// Contact points at ends of B's edge. Each end comes with the vertex of A that is the other half of the point's
    /// [`Feature`].
    #[inline(always)]
    fn face<const N: usize>(&self, ends: [(usize, ClipPoint); N]) -> Manifold {
        let (normal, start) = (self.a.normal(self.face), self.a.vertex(self.face));
        let mut manifold = Manifold::new(normal);
        for (vertex, end) in ends {
            self.push(&mut manifold, start, vertex, end);
        }
        manifold
    }

    /// Contact point on the line that joins two corners.
    fn corner(&self, gap: &Gap) -> Manifold {
        let mut manifold = Manifold::new(gap.normal);
        let end = ClipPoint { vertex: gap.vertices.1, along: 0, above: step_bits(gap.distance) };
        self.push(&mut manifold, self.a.vertex(gap.vertices.0), gap.vertices.0, end);
        manifold
    }

    /// Adds the contact point at `end` if its separation is at most the margin. The position of `end` is relative to
    /// `start`, and `vertex` is the vertex of A in the point's feature.
    #[inline(always)]
    fn push(&self, manifold: &mut Manifold, start: Vec2<Length>, vertex: usize, end: ClipPoint) {
        let (radius_a, radius_b) = (step_bits(self.a.radius), step_bits(self.b.radius));
        let separation = end.above - (radius_a + radius_b);
        if separation > step_bits(self.margin) {
            return;
        }
        // A's surface is at `radius_a` above its outline, and B's at `above - radius_b`.
        let middle = round_shift(end.above + radius_a - radius_b, FINER + 1);
        let (x, y) = (i64::from(manifold.normal.x.to_bits()), i64::from(manifold.normal.y.to_bits()));
        let moved = |from: Length, by: i64| {
            Length::from_bits(saturate(i64::from(from.to_bits()) + round_shift(by, Unit::FRAC_NBITS)))
        };
        let anchor =
            Vec2::new(moved(start.x, x * middle - y * end.along), moved(start.y, y * middle + x * end.along));
        let separation = Step::from_bits(saturate(separation));
        manifold.push(ManifoldPoint {
            anchor,
            separation,
            feature: Feature::of_vertices(vertex, end.vertex),
        });
    }
}
