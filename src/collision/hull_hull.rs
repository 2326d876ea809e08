//! Two convex outlines: the separating axis test over the face normals of both, then clipping of the incident
//! edge against the reference face (D. Gregorius, "Robust Contact Creation", GDC 2015).
//!
//! In two dimensions the axis of least overlap of two convex polygons is always a face normal. Where they do not
//! overlap the closest features may be two corners, which no face normal sees: that case has its own normal, so
//! that a box falling past the corner of another does not catch on it.

use super::circle_hull::step_bits;
use super::manifold::{Feature, Manifold, ManifoldPoint};
use super::pose::{BoxFaces, Hull};
use crate::math::{Length, Step, Unit, Vec2, round_shift, saturate};

/// B's best face must beat A's by this much, in metres, to become the reference: 0.5 mm keeps the choice from
/// flickering between two equal faces. Impulses survive a flicker, since features do not depend on the choice,
/// but anchors would jump. The same distance tells apart polygons that are disjoint from those that touch.
const TOLERANCE: Step = Step::lit("0.0005");

/// The fraction bits of a product of a length and a unit vector: of the separation from a face.
pub(super) const FACE_BITS: u32 = Unit::FRAC_NBITS + Length::FRAC_NBITS;

/// How many fraction bits a step has more than a length.
const FINER: u32 = Step::FRAC_NBITS - Length::FRAC_NBITS;

/// [`TOLERANCE`] with [`FACE_BITS`] fraction bits.
pub(super) const TOLERANCE_WIDE: i64 = (TOLERANCE.to_bits() as i64) << 25;

/// The face that separated a pair in the last tick, if one did. Trying it first changes no result: any axis with a gap
/// beyond the margin proves that there is no contact.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum AxisHint {
    #[default]
    None,
    OfA(u8),
    OfB(u8),
}

/// How often the hint saved the search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SatCounters {
    pub(crate) hint_hits: u32,
    pub(crate) searches: u32,
}

#[derive(Clone, Copy)]
pub(super) struct Face {
    pub(super) edge: usize,
    /// Of the other outline's vertices from the face, without radii: 52 fraction bits.
    pub(super) separation: i64,
}

/// `d` is the vector from the centre of A to the centre of B.
pub(crate) fn collide(
    a: &Hull,
    b: &Hull,
    d: Vec2<Length>,
    margin: Length,
    hint: &mut AxisHint,
    counters: &mut SatCounters,
) -> Manifold {
    let radii = a.radius.saturating_add(b.radius);
    let reach = i64::from(margin.saturating_add(radii).to_bits()) << 30;
    let hinted = match *hint {
        AxisHint::OfA(edge) if usize::from(edge) < a.vertices().len() => {
            face_separation(a, edge.into(), b, d)
        }
        AxisHint::OfB(edge) if usize::from(edge) < b.vertices().len() => {
            face_separation(b, edge.into(), a, -d)
        }
        _ => i64::MIN,
    };
    if hinted > reach {
        counters.hint_hits += 1;
        return Manifold::NONE;
    }
    counters.searches += 1;
    let face_a = best_face(a, b, d);
    if face_a.separation > reach {
        *hint = AxisHint::OfA(small(face_a.edge));
        return Manifold::NONE;
    }
    let face_b = best_face(b, a, -d);
    if face_b.separation > reach {
        *hint = AxisHint::OfB(small(face_b.edge));
        return Manifold::NONE;
    }
    *hint = AxisHint::None;
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

#[expect(clippy::cast_possible_truncation, reason = "at most 8 edges")]
fn small(edge: usize) -> u8 {
    edge as u8
}

/// The face of `a` that is furthest from `b`: of equal ones the first.
#[inline(always)]
pub(super) fn best_face(a: &Hull, b: &Hull, d: Vec2<Length>) -> Face {
    // Most shapes are boxes.
    match (a.as_box(), b.as_box()) {
        (Some(a), Some(b)) => furthest_of_boxes(a, b, d),
        _ => furthest(a, b, d),
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
fn furthest_of_boxes((vertices, normals): BoxFaces, (others, _): BoxFaces, d: Vec2<Length>) -> Face {
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

/// One end of an edge, about the start of the reference edge, in units of `Length` and `Step` that do not saturate.
#[derive(Clone, Copy)]
struct End {
    vertex: usize,
    along: i64,
    above: i64,
}

/// Clips the incident edge of `b` against a face of `a`. Anchors are about the centre of `a`.
pub(super) fn clip(a: &Hull, b: &Hull, d: Vec2<Length>, face: Face, apart: bool, margin: Length) -> Manifold {
    let next = a.next(face.edge);
    let (normal, v1) = (a.normal(face.edge), a.vertex(face.edge));
    let (first, last) = (
        End { vertex: face.edge, along: 0, above: 0 },
        End { vertex: next, along: along(normal, between(v1, a.vertex(next))), above: 0 },
    );
    // Both outlines run counter-clockwise, so the incident edge runs against the reference edge: its second
    // vertex is the lower end.
    let incident = incident_edge(b, normal);
    let to_b = between(v1, d);
    let end_of_b = |vertex: usize| {
        let position = b.vertex(vertex);
        let p = (to_b.0 + i64::from(position.x.to_bits()), to_b.1 + i64::from(position.y.to_bits()));
        End { vertex, along: along(normal, p), above: above(normal, p) }
    };
    let (upper, lower) = (end_of_b(incident), end_of_b(b.next(incident)));

    let context = Clip { a, b, d, face: face.edge, margin };
    let corners = if apart { nearest_corners(first, last, upper, lower) } else { None };
    if upper.along < first.along || lower.along > last.along {
        // Outlines that overlap deeply may have no incident edge beside the face. Their deepest corner still pushes
        // them apart.
        let (end_a, end_b) = if upper.along < first.along { (first, upper) } else { (last, lower) };
        return match corners {
            Some((vertex_a, vertex_b)) => context.corner(&Gap::between(&context, vertex_a, vertex_b)),
            None => context.face([(end_a.vertex, end_b)]),
        };
    }
    let low = if lower.along < first.along { clipped(lower, upper, first.along) } else { lower };
    let high = if upper.along > last.along { clipped(upper, lower, last.along) } else { upper };
    if let Some((vertex_a, vertex_b)) = corners {
        // Rounded edges that are nearly parallel are nearest at a corner too, but rest on both ends: there the
        // corners are no nearer than the clipped edge, nor further than the face.
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

/// The corners that are nearest to each other, if those are what is nearest of two edges that are apart: each lies
/// beyond the end of the other edge.
fn nearest_corners(first: End, last: End, upper: End, lower: End) -> Option<(End, End)> {
    let beyond_incident = |a: End, b: End, other: End| {
        let from_b = |end: End| (end.along - b.along, (end.above - b.above) >> FINER);
        let (outward, edge) = (from_b(a), from_b(other));
        // Points of a pair differ by less than 512 m, so each product has at most 62 bits.
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

/// The edge whose normal is most opposed to `normal`: of equal ones the first.
#[inline]
fn incident_edge(b: &Hull, normal: Vec2<Unit>) -> usize {
    let cosine = |n: Vec2<Unit>| {
        i64::from(n.x.to_bits()) * i64::from(normal.x.to_bits())
            + i64::from(n.y.to_bits()) * i64::from(normal.y.to_bits())
    };
    let nearer = |a: (usize, i64), b: (usize, i64)| if b.1 < a.1 { b } else { a };
    if let Some((_, &[n0, n1])) = b.as_box() {
        let (cosine_0, cosine_1) = (cosine(n0), cosine(n1));
        let edge_0 = if cosine_0 <= 0 { 0 } else { 2 };
        let edge_1 = if cosine_1 <= 0 { 1 } else { 3 };
        return nearer((edge_0, -cosine_0.abs()), (edge_1, -cosine_1.abs())).0;
    }
    b.normals().iter().map(|&n| cosine(n)).enumerate().reduce(nearer).map_or(0, |(edge, _)| edge)
}

/// From one position to another, in units of `Length`: one bit more than that holds.
#[inline]
fn between(from: Vec2<Length>, to: Vec2<Length>) -> (i64, i64) {
    let apart = |from: Length, to: Length| i64::from(to.to_bits()) - i64::from(from.to_bits());
    (apart(from.x, to.x), apart(from.y, to.y))
}

/// How far along the face with a normal, in units of `Length`: `t . p` for `t` the normal turned a quarter.
#[inline]
fn along(n: Vec2<Unit>, p: (i64, i64)) -> i64 {
    round_shift(i64::from(n.x.to_bits()) * p.1 - i64::from(n.y.to_bits()) * p.0, Unit::FRAC_NBITS)
}

/// How far above the face with a normal, in units of `Step`: `n . p`.
#[inline]
fn above(n: Vec2<Unit>, p: (i64, i64)) -> i64 {
    let above = i64::from(n.x.to_bits()) * p.0 + i64::from(n.y.to_bits()) * p.1;
    round_shift(above, FACE_BITS - Step::FRAC_NBITS)
}

/// Moves an end along its edge to where it passes a limit, which is between it and the other end.
#[inline]
fn clipped(end: End, other: End, limit: i64) -> End {
    // Edges are at most 570 m long: the product has 63 bits.
    const BITS: u32 = 26;
    let fraction = ((limit - end.along) << BITS) / (other.along - end.along);
    End { along: limit, above: end.above + round_shift((other.above - end.above) * fraction, BITS), ..end }
}

struct Clip<'a> {
    a: &'a Hull,
    b: &'a Hull,
    /// From the centre of A to that of B.
    d: Vec2<Length>,
    face: usize,
    margin: Length,
}

/// What is between two corners.
struct Gap {
    vertices: (usize, usize),
    normal: Vec2<Unit>,
    distance: Length,
}

impl Gap {
    fn between(clip: &Clip, a: End, b: End) -> Self {
        let d = clip.b.vertex(b.vertex) + clip.d - clip.a.vertex(a.vertex);
        let (normal, distance) =
            d.normalized_with_length().unwrap_or((clip.a.normal(clip.face), Length::ZERO));
        Gap { vertices: (a.vertex, b.vertex), normal, distance }
    }
}

impl Clip<'_> {
    /// Contact points of clipped incident ends, each with the vertex of A that it is next to.
    #[inline(always)]
    fn face<const N: usize>(&self, ends: [(usize, End); N]) -> Manifold {
        let (normal, start) = (self.a.normal(self.face), self.a.vertex(self.face));
        let mut manifold = Manifold::new(normal);
        for (vertex, end) in ends {
            self.push(&mut manifold, start, (vertex, end));
        }
        manifold
    }

    /// Contact between two corners, along the line that joins them.
    fn corner(&self, gap: &Gap) -> Manifold {
        let mut manifold = Manifold::new(gap.normal);
        let end = End { vertex: gap.vertices.1, along: 0, above: step_bits(gap.distance) };
        self.push(&mut manifold, self.a.vertex(gap.vertices.0), (gap.vertices.0, end));
        manifold
    }

    /// Adds the contact at an end of B, given about a place on A's outline, radii not counted, if it is near enough.
    #[inline(always)]
    fn push(&self, manifold: &mut Manifold, start: Vec2<Length>, (vertex, end): (usize, End)) {
        let (radius_a, radius_b) = (step_bits(self.a.radius), step_bits(self.b.radius));
        let separation = end.above - (radius_a + radius_b);
        if separation > step_bits(self.margin) {
            return;
        }
        // A's surface is at `radius_a` above the outline and B's at `above - radius_b`.
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
