//! SIMD kernel of [`hull_hull`](crate::collision::narrow_phase::hull_hull) for boxes.
//!
//! Let `n` be a face normal of a box, `v` a vertex of that face, `d` the vector to the centre of another box, and `w`
//! the vertices of the other box relative to its centre. The separation of the boxes along `n`, from this face or from
//! the opposite face, whichever is nearer, is
//!
//! ```text
//! separation = |n . d| - n . v - max |n . w|
//! ```

use super::vector::{Vector, dot, minus, negated, plus, select_vector};
use super::{Batch, Manifolds, Turned};
use crate::collision::narrow_phase::hull_hull::{CLIP_BITS, FACE_BITS, FINER, PARALLEL_WIDE, TOLERANCE};
use crate::math::{Step, Unit};
use crate::simd::{Ints, Kernel, Lanes, WIDTH, shift};

const UNIT: i32 = shift(Unit::FRAC_NBITS);
/// Shift from the product of a unit vector and a length to a step.
const TO_STEP: i32 = shift(FACE_BITS - Step::FRAC_NBITS);
const CLIP: i32 = shift(CLIP_BITS);

pub(super) struct Collide<'a> {
    pub(super) batches: &'a mut [Batch],
    /// Boxes by shape slot.
    pub(super) boxes: &'a [Turned],
}

/// The first two normals and vertices of a box. The other two are their negatives.
#[derive(Clone, Copy)]
struct Corners<T> {
    n: [Vector<T>; 2],
    v: [Vector<T>; 2],
}

/// An edge of a box. Its index is `second + 2 opposite`.
#[derive(Clone, Copy)]
struct Choice<M> {
    second: M,
    opposite: M,
}

#[derive(Clone, Copy)]
struct Edge<T> {
    n: Vector<T>,
    start: Vector<T>,
    end: Vector<T>,
}

/// An end of the incident edge, before or after clipping: position along the reference edge, from its start, in raw
/// units of `Length`, and height above the reference edge in raw units of `Step`.
#[derive(Clone, Copy)]
struct ClipPoint<T> {
    along: T,
    above: T,
}

/// Reference edge of a pair. Radii and margin are in raw units of `Step`.
struct Reference<T> {
    n: Vector<T>,
    /// Start of the edge, relative to the centre of A.
    start: Vector<T>,
    radii: T,
    /// Radius of the reference box minus that of the incident box.
    difference: T,
    margin: T,
}

/// Anchor, separation and feature of a contact point. `gone` means that the point is beyond the margin.
struct Point<T, M> {
    gone: M,
    numbers: [T; 4],
}

impl Kernel<WIDTH> for Collide<'_> {
    #[inline(always)]
    fn run<L: Lanes<WIDTH>>(self) {
        for batch in self.batches {
            collide::<L>(batch, self.boxes);
        }
    }
}

#[inline(always)]
fn collide<L: Lanes<WIDTH>>(batch: &mut Batch, boxes: &[Turned]) {
    let Batch { at, d, radius, margin, manifolds } = batch;
    let [a, b] = [corners::<L>(boxes, &at[0]), corners::<L>(boxes, &at[1])];
    let [radius_a, radius_b] = [L::load(&radius[0]), L::load(&radius[1])];
    let (d, margin) = ([L::load(&d[0]), L::load(&d[1])], L::load(margin));
    let radii = L::add(radius_a, radius_b);
    let (face_a, separation_a) = best_face::<L>(&a, &b, d);
    let (face_b, separation_b) = best_face::<L>(&b, &a, negated::<L>(d));
    let reach = L::mul(L::add(margin, radii), L::splat(1 << UNIT));
    let further = L::max_wide(separation_a, separation_b);
    let is_far = L::greater_wide(further, reach);
    let zero = L::splat(0);
    // The tolerance applies as in `hull_hull::is_reference_of_b`.
    let (tolerance, as_product) = (L::splat(TOLERANCE.to_bits()), L::splat(1 << TO_STEP));
    let is_apart = L::greater_wide(further, L::mul(tolerance, as_product));
    let is_flush = L::both(L::greater(radii, zero), are_parallel::<L>(&a, face_a, &b, face_b));
    let of_apart = L::select(is_flush, tolerance, zero);
    let preference = L::mul(L::select(is_apart, of_apart, tolerance), as_product);
    let swapped = L::greater_wide(separation_b, L::add_wide(separation_a, preference));

    let reference_face = chosen::<L>(swapped, face_b, face_a);
    let reference = edge::<L>(&selected::<L>(swapped, &b, &a), reference_face);
    let incident_box = selected::<L>(swapped, &a, &b);
    let incident_face = most_opposed::<L>(&incident_box, reference.n);
    let incident = edge::<L>(&incident_box, incident_face);
    let from_reference = select_vector::<L>(swapped, negated::<L>(d), d);
    let to_incident = minus::<L>(from_reference, reference.start);
    let length = along::<L>(reference.n, minus::<L>(reference.end, reference.start));
    // The incident edge points against the reference edge. Its start is therefore the `upper` end: the one farther
    // along the reference edge.
    let upper = end::<L>(reference.n, plus::<L>(to_incident, incident.start));
    let lower = end::<L>(reference.n, plus::<L>(to_incident, incident.end));
    let mut open = L::either(L::greater(zero, upper.along), L::greater(lower.along, length));
    if L::any(is_apart) {
        let corner = L::either(
            nearest_at_corner::<L>(length, upper, lower),
            nearest_at_corner::<L>(length, lower, upper),
        );
        open = L::either(open, L::both(is_apart, corner));
    }
    manifolds.open = L::bits(open) & !L::bits(is_far);

    let [below, beyond] = [L::sub(zero, lower.along), L::sub(upper.along, length)];
    let span = L::sub(upper.along, lower.along);
    let low = ClipPoint { along: L::max(lower.along, zero), above: clipped::<L>(lower, upper, below, span) };
    let high =
        ClipPoint { along: L::min(upper.along, length), above: clipped::<L>(upper, lower, beyond, span) };
    let [radius_r, radius_i] =
        [L::select(swapped, radius_b, radius_a), L::select(swapped, radius_a, radius_b)];
    let reference = Reference {
        n: reference.n,
        // Anchors are relative to the centre of A.
        start: plus::<L>(reference.start, select_vector::<L>(swapped, d, [zero; 2])),
        radii: as_step::<L>(radii),
        difference: as_step::<L>(L::sub(radius_r, radius_i)),
        margin: as_step::<L>(margin),
    };
    let (edge, opposed) = (index::<L>(reference_face), index::<L>(incident_face));
    let features =
        [feature::<L>(swapped, edge, next::<L>(opposed)), feature::<L>(swapped, next::<L>(edge), opposed)];
    let first = point::<L>(&reference, low, features[0], is_far);
    let second = point::<L>(&reference, high, features[1], is_far);
    store::<L>(&first, &second, manifolds);
    let normal = select_vector::<L>(swapped, negated::<L>(reference.n), reference.n);
    L::store(normal[0], &mut manifolds.normal[0]);
    L::store(normal[1], &mut manifolds.normal[1]);
}

#[inline(always)]
fn point<L: Lanes<WIDTH>>(
    reference: &Reference<L::Int>,
    end: ClipPoint<L::Int>,
    feature: L::Int,
    is_far: L::Mask,
) -> Point<L::Int, L::Mask> {
    let Reference { n: [x, y], start, radii, difference, margin } = *reference;
    let separation = L::sub(end.above, radii);
    let middle = L::narrow::<32>(L::mul(L::add(end.above, difference), L::splat(1 << (31 - FINER))));
    let across = L::sub_wide(L::mul(x, middle), L::mul(y, end.along));
    let up = L::add_wide(L::mul(y, middle), L::mul(x, end.along));
    let anchor = plus::<L>(start, [L::narrow::<UNIT>(across), L::narrow::<UNIT>(up)]);
    Point {
        gone: L::either(is_far, L::greater(separation, margin)),
        numbers: [anchor[0], anchor[1], separation, feature],
    }
}

/// Feature of a contact point, as in [`Feature`](crate::collision::Feature).
#[inline(always)]
fn feature<L: Lanes<WIDTH>>(swapped: L::Mask, of_reference: L::Int, of_incident: L::Int) -> L::Int {
    let of_a = L::select(swapped, of_incident, of_reference);
    let of_b = L::select(swapped, of_reference, of_incident);
    L::add(L::low(L::mul(of_a, L::splat(1 << 8))), of_b)
}

/// Stores the valid points of each pair at the front, in order.
#[inline(always)]
fn store<L: Lanes<WIDTH>>(
    first: &Point<L::Int, L::Mask>,
    second: &Point<L::Int, L::Mask>,
    manifolds: &mut Manifolds,
) {
    let (none, not_both) = (L::both(first.gone, second.gone), L::either(first.gone, second.gone));
    let [front, back] = &mut manifolds.points;
    for i in 0..4 {
        let foremost = L::select(first.gone, second.numbers[i], first.numbers[i]);
        L::store(L::select(none, L::splat(0), foremost), &mut front.0[i]);
        L::store(L::select(not_both, L::splat(0), second.numbers[i]), &mut back.0[i]);
    }
    let fewer = L::add(L::to_int(none), L::to_int(not_both));
    L::store(L::add(L::splat(2), fewer), &mut manifolds.count);
}

#[inline(always)]
fn corners<L: Lanes<WIDTH>>(boxes: &[Turned], at: &[u32; WIDTH]) -> Corners<L::Int> {
    let Turned([vertices, normals]) = &boxes[at[0] as usize];
    let (mut vertices, mut normals) = ([vertices; WIDTH], [normals; WIDTH]);
    for lane in 1..WIDTH {
        let Turned(quads) = &boxes[at[lane] as usize];
        [vertices[lane], normals[lane]] = [&quads[0], &quads[1]];
    }
    let [v0x, v0y, v1x, v1y] = L::transposed(vertices);
    let [n0x, n0y, n1x, n1y] = L::transposed(normals);
    Corners { n: [[n0x, n0y], [n1x, n1y]], v: [[v0x, v0y], [v1x, v1y]] }
}

/// Face of `a` with the largest separation from `b`. Ties go to the face with the lower index.
#[inline(always)]
fn best_face<L: Lanes<WIDTH>>(
    a: &Corners<L::Int>,
    b: &Corners<L::Int>,
    d: Vector<L::Int>,
) -> (Choice<L::Mask>, L::Wide) {
    let (opposite_0, separation_0) = further_of_opposite::<L>(a.n[0], a.v[0], b, d);
    let (opposite_1, separation_1) = further_of_opposite::<L>(a.n[1], a.v[1], b, d);
    // The first candidate is face 0 or 2, the second is face 1 or 3. Ties go to the lower index, so on a tie the second
    // candidate wins only as face 1 against face 2.
    let ahead = L::greater(L::to_int(opposite_1), L::to_int(opposite_0));
    let advantage = L::mul(L::to_int(ahead), L::splat(-1));
    let second = L::greater_wide(L::add_wide(separation_1, advantage), separation_0);
    let opposite = choose::<L>(second, opposite_1, opposite_0);
    (Choice { second, opposite }, L::max_wide(separation_0, separation_1))
}

/// Whether `b` is on the side of the opposite face, and the separation of `b` from the nearer of the two faces.
#[inline(always)]
fn further_of_opposite<L: Lanes<WIDTH>>(
    n: Vector<L::Int>,
    v: Vector<L::Int>,
    b: &Corners<L::Int>,
    d: Vector<L::Int>,
) -> (L::Mask, L::Wide) {
    let towards = dot::<L>(n, d);
    let half = L::max_wide(L::abs_wide(dot::<L>(n, b.v[0])), L::abs_wide(dot::<L>(n, b.v[1])));
    let separation = L::sub_wide(L::sub_wide(L::abs_wide(towards), dot::<L>(n, v)), half);
    (L::greater_wide(nothing::<L>(), towards), separation)
}

#[inline(always)]
fn are_parallel<L: Lanes<WIDTH>>(
    a: &Corners<L::Int>,
    face_a: Choice<L::Mask>,
    b: &Corners<L::Int>,
    face_b: Choice<L::Mask>,
) -> L::Mask {
    let n_a = select_vector::<L>(face_a.second, a.n[1], a.n[0]);
    let n_b = select_vector::<L>(face_b.second, b.n[1], b.n[0]);
    let cosine = L::abs_wide(dot::<L>(n_a, n_b));
    L::greater_wide(cosine, L::load_wide(&[PARALLEL_WIDE; WIDTH]))
}

/// Edge whose normal is most opposed to `n`. Ties go to edge 0 or 2.
#[inline(always)]
fn most_opposed<L: Lanes<WIDTH>>(of: &Corners<L::Int>, n: Vector<L::Int>) -> Choice<L::Mask> {
    let [cosine_0, cosine_1] = [dot::<L>(of.n[0], n), dot::<L>(of.n[1], n)];
    let second = L::greater_wide(L::abs_wide(cosine_1), L::abs_wide(cosine_0));
    let [opposite_0, opposite_1] =
        [L::greater_wide(cosine_0, nothing::<L>()), L::greater_wide(cosine_1, nothing::<L>())];
    Choice { second, opposite: choose::<L>(second, opposite_1, opposite_0) }
}

#[inline(always)]
fn edge<L: Lanes<WIDTH>>(of: &Corners<L::Int>, Choice { second, opposite }: Choice<L::Mask>) -> Edge<L::Int> {
    let n = select_vector::<L>(second, of.n[1], of.n[0]);
    let start = select_vector::<L>(second, of.v[1], of.v[0]);
    let end = select_vector::<L>(second, negated::<L>(of.v[0]), of.v[1]);
    Edge {
        n: select_vector::<L>(opposite, negated::<L>(n), n),
        start: select_vector::<L>(opposite, negated::<L>(start), start),
        end: select_vector::<L>(opposite, negated::<L>(end), end),
    }
}

#[inline(always)]
fn next<L: Lanes<WIDTH>>(edge: L::Int) -> L::Int {
    L::select(L::greater(edge, L::splat(2)), L::splat(0), L::add(edge, L::splat(1)))
}

/// Index of the edge, 0 to 3.
#[inline(always)]
fn index<L: Lanes<WIDTH>>(Choice { second, opposite }: Choice<L::Mask>) -> L::Int {
    let (second, opposite) = (L::to_int(second), L::to_int(opposite));
    L::sub(L::sub(L::sub(L::splat(0), second), opposite), opposite)
}

/// Clip point at `place`, a vector from the start of the reference edge.
#[inline(always)]
fn end<L: Lanes<WIDTH>>(n: Vector<L::Int>, place: Vector<L::Int>) -> ClipPoint<L::Int> {
    ClipPoint { along: along::<L>(n, place), above: L::narrow::<TO_STEP>(dot::<L>(n, place)) }
}

/// `t . p`, for `t` the normal rotated by a quarter turn.
#[inline(always)]
fn along<L: Lanes<WIDTH>>(n: Vector<L::Int>, p: Vector<L::Int>) -> L::Int {
    L::narrow::<UNIT>(L::sub_wide(L::mul(n[0], p[1]), L::mul(n[1], p[0])))
}

/// Whether the nearest features are the end `corner` of the incident edge and an end of the reference edge. They are if
/// each of the two lies beyond the other edge. `other` is the other end of the incident edge.
#[inline(always)]
fn nearest_at_corner<L: Lanes<WIDTH>>(
    length: L::Int,
    corner: ClipPoint<L::Int>,
    other: ClipPoint<L::Int>,
) -> L::Mask {
    let zero = L::splat(0);
    let edge = [L::sub(other.along, corner.along), as_length::<L>(L::sub(other.above, corner.above))];
    let up = L::mul(as_length::<L>(L::sub(zero, corner.above)), edge[1]);
    let from_start = L::add_wide(L::mul(L::sub(zero, corner.along), edge[0]), up);
    let from_end = L::add_wide(L::mul(L::sub(length, corner.along), edge[0]), up);
    let before = L::both(L::greater(zero, corner.along), L::greater_wide(nothing::<L>(), from_start));
    let behind = L::both(L::greater(corner.along, length), L::greater_wide(nothing::<L>(), from_end));
    L::either(before, behind)
}

/// Height of an end of the incident edge after clipping. If `past` is positive, it is the length to cut off at this
/// end. `past` and `span`, the extent of the incident edge, are measured along the reference edge.
#[inline(always)]
fn clipped<L: Lanes<WIDTH>>(
    end: ClipPoint<L::Int>,
    other: ClipPoint<L::Int>,
    past: L::Int,
    span: L::Int,
) -> L::Int {
    let (mut fractions, mut spans) = (Ints::ZERO, Ints::ZERO);
    L::store(L::max(past, L::splat(0)), &mut fractions);
    L::store(span, &mut spans);
    for (fraction, &span) in fractions.0.iter_mut().zip(&spans.0) {
        if *fraction != 0 {
            *fraction = part(*fraction, span);
        }
    }
    let way = L::mul(L::sub(other.above, end.above), L::load(&fractions));
    L::add(end.above, L::narrow::<CLIP>(way))
}

/// `past / span` for positive operands. Lanes left to the scalar path do not use the result.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 1")]
fn part(past: i32, span: i32) -> i32 {
    (((past as u64) << CLIP) / span.max(1) as u64) as i32
}

#[inline(always)]
fn as_step<L: Lanes<WIDTH>>(length: L::Int) -> L::Int {
    L::low(L::mul(length, L::splat(1 << FINER)))
}

/// Converts a step to a length, rounded down.
#[inline(always)]
fn as_length<L: Lanes<WIDTH>>(step: L::Int) -> L::Int {
    let half = L::splat(1 << (FINER - 1));
    L::narrow::<32>(L::mul(L::sub(step, half), L::splat(1 << (32 - FINER))))
}

#[inline(always)]
fn nothing<L: Lanes<WIDTH>>() -> L::Wide {
    L::load_wide(&[0; WIDTH])
}

#[inline(always)]
fn selected<L: Lanes<WIDTH>>(mask: L::Mask, yes: &Corners<L::Int>, no: &Corners<L::Int>) -> Corners<L::Int> {
    Corners {
        n: [select_vector::<L>(mask, yes.n[0], no.n[0]), select_vector::<L>(mask, yes.n[1], no.n[1])],
        v: [select_vector::<L>(mask, yes.v[0], no.v[0]), select_vector::<L>(mask, yes.v[1], no.v[1])],
    }
}

#[inline(always)]
fn choose<L: Lanes<WIDTH>>(mask: L::Mask, yes: L::Mask, no: L::Mask) -> L::Mask {
    L::negative(L::select(mask, L::to_int(yes), L::to_int(no)))
}

#[inline(always)]
fn chosen<L: Lanes<WIDTH>>(mask: L::Mask, yes: Choice<L::Mask>, no: Choice<L::Mask>) -> Choice<L::Mask> {
    Choice {
        second: choose::<L>(mask, yes.second, no.second),
        opposite: choose::<L>(mask, yes.opposite, no.opposite),
    }
}
