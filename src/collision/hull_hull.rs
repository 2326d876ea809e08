//! Two convex outlines: the separating axis test over the face normals of both, then clipping of the incident
//! edge against the reference face (D. Gregorius, "Robust Contact Creation", GDC 2015).
//!
//! In two dimensions the axis of least overlap of two convex polygons is always a face normal. Where they do not
//! overlap the closest features may be two corners, which no face normal sees: that case has its own normal, so
//! that a box falling past the corner of another does not catch on it.

use super::circle_hull::step_bits;
use super::manifold::{Feature, Manifold, ManifoldPoint};
use super::pose::Hull;
use crate::math::{Length, Step, Unit, Vec2, round_shift, round_shift_wide, saturate, saturate_wide};

/// B's best face must beat A's by this much, in metres, to become the reference: 0.5 mm keeps the choice from
/// flickering between two equal faces. Impulses survive a flicker, since features do not depend on the choice,
/// but anchors would jump. The same distance tells apart polygons that are disjoint from those that touch.
const TOLERANCE: Step = Step::lit("0.0005");

/// The fraction bits of a product of a length and a unit vector: of the separation from a face.
pub(super) const FACE_BITS: u32 = Unit::FRAC_NBITS + Length::FRAC_NBITS;

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
        clip(b, a, -d, face_b, apart, margin).swapped().translated(d)
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
#[inline]
pub(super) fn best_face(a: &Hull, b: &Hull, d: Vec2<Length>) -> Face {
    // Most shapes are boxes.
    match (a.as_box(), b.as_quad()) {
        (Some((vertices, normals)), Some(others)) => furthest_of_box(vertices, normals, others, d),
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

/// [`furthest`] for four faces of which opposite ones have opposite normals: `min -n . v` is `-max n . v`.
#[inline]
fn furthest_of_box(
    &[v0, v1, v2, v3]: &[Vec2<Length>; 4],
    &[n0, n1]: &[Vec2<Unit>; 2],
    others: &[Vec2<Length>; 4],
    d: Vec2<Length>,
) -> Face {
    let ((least_0, most_0), (least_1, most_1)) = (extent(n0, others), extent(n1, others));
    let (d_0, d_1) = (product(n0, d), product(n1, d));
    let face_0 = Face { edge: 0, separation: least_0 + d_0 - product(n0, v0) };
    let face_1 = Face { edge: 1, separation: least_1 + d_1 - product(n1, v1) };
    let face_2 = Face { edge: 2, separation: product(n0, v2) - d_0 - most_0 };
    let face_3 = Face { edge: 3, separation: product(n1, v3) - d_1 - most_1 };
    let further = |a: Face, b: Face| if b.separation > a.separation { b } else { a };
    further(further(face_0, face_1), further(face_2, face_3))
}

/// Least and most `n . v` of four vertices.
#[inline]
fn extent(n: Vec2<Unit>, &[a, b, c, d]: &[Vec2<Length>; 4]) -> (i64, i64) {
    let (a, b, c, d) = (product(n, a), product(n, b), product(n, c), product(n, d));
    (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
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
    let reach = match b.as_quad() {
        Some(others) => support(n, others),
        None => support(n, b.vertices()),
    };
    reach + product(n, d) - product(n, point)
}

/// One end of an edge: its vertex, and where it is along the reference edge.
#[derive(Clone, Copy)]
struct End {
    vertex: usize,
    position: Vec2<Length>,
    along: Length,
}

/// Clips the incident edge of `b` against a face of `a`. Positions are about the centre of `a`.
pub(super) fn clip(a: &Hull, b: &Hull, d: Vec2<Length>, face: Face, apart: bool, margin: Length) -> Manifold {
    let normal = a.normals()[face.edge];
    let v1 = a.vertices()[face.edge];
    let tangent = normal.perp();
    let end =
        |vertex: usize, position: Vec2<Length>| End { vertex, position, along: along(tangent, position, v1) };
    let end_of_b = |vertex: usize| end(vertex, b.vertices()[vertex] + d);
    let first = End { vertex: face.edge, position: v1, along: Length::ZERO };
    let last = end(a.next(face.edge), a.vertices()[a.next(face.edge)]);
    // Both outlines run counter-clockwise, so the incident edge runs against the reference edge: its second
    // vertex is the lower end.
    let incident = incident_edge(b, normal);
    let (upper, lower) = (end_of_b(incident), end_of_b(b.next(incident)));

    let context = Clip { normal, v1, radius_a: a.radius, radius_b: b.radius, margin };
    let corners = if apart { nearest_corners(first, last, upper, lower) } else { None };
    if upper.along < first.along || lower.along > last.along {
        // Outlines that overlap deeply may have no incident edge beside the face. Their deepest corner still pushes
        // them apart.
        let beside = if upper.along < first.along { (first, upper) } else { (last, lower) };
        return match corners {
            Some((vertex_a, vertex_b)) => context.corner(vertex_a, vertex_b),
            None => context.face([(beside.0, beside.1, beside.1.position)]),
        };
    }
    let low = clip_end(lower, upper, first.along);
    let high = clip_end(upper, lower, last.along);
    if let Some((vertex_a, vertex_b)) = corners {
        // Rounded edges that are nearly parallel are nearest at a corner too, but rest on both ends: there the
        // corners are no nearer than the clipped edge, nor further than the face.
        let distance = step_bits((vertex_b.position - vertex_a.position).length());
        let nearer = height(normal, low, v1).min(height(normal, high, v1));
        let spread = (nearer - distance).max(distance - (face.separation >> 25));
        if spread > i64::from(TOLERANCE.to_bits()) {
            return context.corner(vertex_a, vertex_b);
        }
    }
    context.face([(first, lower, low), (last, upper, high)])
}

/// The corners that are nearest to each other, if those are what is nearest of two edges that are apart: each lies
/// beyond the end of the other edge.
fn nearest_corners(first: End, last: End, upper: End, lower: End) -> Option<(End, End)> {
    let raw = |length: Length| i64::from(length.to_bits());
    let beyond_incident = |a: End, b: End, other: End| {
        let (outward, edge) = (a.position - b.position, other.position - b.position);
        // Coordinates differ by less than 512 m, so each product has at most 62 bits.
        raw(outward.x) * raw(edge.x) + raw(outward.y) * raw(edge.y) < 0
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
        return nearer(nearer((0, cosine_0), (1, cosine_1)), nearer((2, -cosine_0), (3, -cosine_1))).0;
    }
    b.normals().iter().map(|&n| cosine(n)).enumerate().reduce(nearer).map_or(0, |(edge, _)| edge)
}

/// `t . (v - from)` for a unit vector, rounded, saturated.
#[inline]
fn along(t: Vec2<Unit>, v: Vec2<Length>, from: Vec2<Length>) -> Length {
    Length::from_bits(saturate(round_shift(product(t, v) - product(t, from), Unit::FRAC_NBITS)))
}

/// `n . (v - from)` in units of `Step`, not saturated.
#[inline]
fn height(n: Vec2<Unit>, v: Vec2<Length>, from: Vec2<Length>) -> i64 {
    round_shift(product(n, v) - product(n, from), FACE_BITS - Step::FRAC_NBITS)
}

/// Moves `end` along its edge to where it passes `limit`, if it is beyond it as seen from `other`.
fn clip_end(end: End, other: End, limit: Length) -> Vec2<Length> {
    let (from, to) = (i64::from(end.along.to_bits()), i64::from(other.along.to_bits()));
    let limit = i64::from(limit.to_bits());
    let beyond = if from < to { limit > from } else { limit < from };
    if !beyond || from == to {
        return end.position;
    }
    // The fraction is within 0 to 1, because the edge reaches to the other side of the limit.
    let fraction = Unit::from_bits(crate::math::saturate(((limit - from) << 30) / (to - from)));
    end.position + (other.position - end.position).scale(fraction.clamp(Unit::ZERO, Unit::ONE))
}

struct Clip {
    normal: Vec2<Unit>,
    v1: Vec2<Length>,
    radius_a: Length,
    radius_b: Length,
    margin: Length,
}

impl Clip {
    /// Contact points of clipped incident ends with the face.
    #[inline(always)]
    fn face<const N: usize>(&self, ends: [(End, End, Vec2<Length>); N]) -> Manifold {
        let mut manifold = Manifold::new(self.normal);
        for (end_a, end_b, position) in ends {
            let above_face = height(self.normal, position, self.v1);
            self.push(&mut manifold, end_a.vertex, end_b.vertex, position, above_face);
        }
        manifold
    }

    /// Contact between two corners, along the line that joins them.
    fn corner(&self, a: End, b: End) -> Manifold {
        let d = b.position - a.position;
        let mut manifold = Manifold::new(d.normalized().unwrap_or(self.normal));
        self.push(&mut manifold, a.vertex, b.vertex, b.position, step_bits(d.length()));
        manifold
    }

    /// Adds the contact at a point of B's outline at a distance from A's, radii not counted, if it is near enough.
    /// The distance is in units of `Step` and does not saturate: that of large rounded shapes exceeds the type.
    #[inline]
    fn push(&self, manifold: &mut Manifold, a: usize, b: usize, position: Vec2<Length>, distance: i64) {
        let (radius_a, radius_b) = (step_bits(self.radius_a), step_bits(self.radius_b));
        let separation = distance - (radius_a + radius_b);
        if separation > step_bits(self.margin) {
            return;
        }
        let separation = Step::from_bits(saturate(separation));
        // A's surface is at `radius_a` along the normal and B's at `distance - radius_b`: half-way between them,
        // seen from `position` at `distance`.
        let to_middle = (radius_a - radius_b - distance) / 2;
        // Within 16 m a product with a unit vector has at most 62 bits.
        const EXTRA: u32 = Unit::FRAC_NBITS + Step::FRAC_NBITS - Length::FRAC_NBITS;
        let (x, y) = (manifold.normal.x.to_bits(), manifold.normal.y.to_bits());
        let (x, y) = match i32::try_from(to_middle) {
            Ok(near) => {
                let scaled = |n: i32| round_shift(i64::from(n) * i64::from(near), EXTRA);
                (scaled(x), scaled(y))
            }
            Err(_) => {
                let scaled =
                    |n: i32| saturate_wide(round_shift_wide(i128::from(n) * i128::from(to_middle), EXTRA));
                (scaled(x), scaled(y))
            }
        };
        let anchor = position + Vec2::new(Length::from_bits(saturate(x)), Length::from_bits(saturate(y)));
        manifold.push(ManifoldPoint { anchor, separation, feature: Feature::of_vertices(a, b) });
    }
}
