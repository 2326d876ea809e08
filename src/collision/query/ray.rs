//! Ray cast against a shape: the point `o + t d` of the shape with the smallest `t` from 0 to 1.
//!
//! The outline of a core with a radius `r` consists of its edges, moved outwards by `r`, and of circles about its
//! vertices. For an edge vector `e` from `p`, a ray crosses the moved line where `e x (o + t d - p) = -r |e|`. The ray
//! enters a circle about `p` half a chord before the ray's nearest point to `p`. Products are exact. `|e|` and `|d|`
//! have a relative error of 1.5e-9, but are only multiplied by lengths up to the radius. The error is therefore small
//! even for rays and segments as long as the world.

#[cfg(test)]
mod tests;

use super::distance::overlap;
use crate::collision::shape::support::{
    Fraction, Grid, SupportShape, along, cross, direction, dot, edges, from_grid, height,
};
use crate::collision::shape::support::{scaled_along, to_grid};
use crate::math::{Fx, Unit, Vec2};

/// Largest distance in metres of a hit point from the surface.
const ROUNDING: Grid = Grid::lit("0.000001");

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RayHit {
    /// Fraction of the translation, 0 to 1, rounded down to a multiple of 2^-32: 0.25 m on a ray of 2^30 m.
    pub(crate) fraction: Fx,
    /// The fraction with more bits, to order two hits.
    pub(crate) order: Fraction,
    /// Hit point relative to the origin of the support shape, within 1 µm of the surface.
    pub(crate) point: Vec2<Fx>,
    /// Outward surface normal. Zero if the ray starts inside the shape or on its border.
    pub(crate) normal: Vec2<Unit>,
}

/// First hit of a ray. A ray hits a segment from both sides, and a ray along the segment hits its end.
pub(crate) fn cast_ray(shape: &SupportShape, origin: Vec2<Fx>, translation: Vec2<Fx>) -> Option<RayHit> {
    if contains_point(shape, origin) {
        let (fraction, order) = (Fx::ZERO, Fraction::ZERO);
        return Some(RayHit { fraction, order, point: origin, normal: Vec2::ZERO });
    }
    // Rounds both ends to the grid, so that a ray from the end of another ray starts exactly at this end.
    let end = to_grid(origin + translation);
    let origin = to_grid(origin);
    let translation = end - origin;
    let (fraction, normal) = entry(shape.points(), shape.radius, origin, translation)?;
    let point = from_grid(origin + fraction.of(translation));
    Some(RayHit { fraction: fraction.to_fx(), order: fraction, point, normal })
}

/// Whether a point is in a shape, borders included.
pub(crate) fn contains_point(shape: &SupportShape, point: Vec2<Fx>) -> bool {
    overlap(shape, &SupportShape::point(point))
}

/// Fraction and normal at which a ray from outside comes within `radius` of the hull of `points`. The ray starts at `o`
/// and has the translation `d`.
pub(in crate::collision) fn entry(
    points: &[Vec2<Grid>],
    radius: Grid,
    o: Vec2<Grid>,
    d: Vec2<Grid>,
) -> Option<(Fraction, Vec2<Unit>)> {
    let forward = direction(d)?;
    // A ray enters a convex shape through at most one face, so the first face found that the ray hits from outside is
    // the entry.
    if let Some(found) = edges(points).find_map(|(p, q)| enter_face(p, q, radius, o, d)) {
        return Some(found);
    }
    // Without a radius, the vertices have no circles. But a shape of one or two vertices may be hit at a vertex: a
    // point anywhere, and a segment at an end by a ray along the segment.
    if radius == 0 && points.len() > 2 {
        return None;
    }
    let fraction = points.iter().filter_map(|&p| enter_circle(p, radius, o, d, forward)).min()?;
    let hit = o + fraction.of(d);
    let from = points.iter().min_by_key(|&&p| dot(hit - p, hit - p)).map(|&p| hit - p)?;
    let normal = if radius == 0 { None } else { direction(from) };
    Some((fraction, normal.unwrap_or(-forward)))
}

/// Entry of a ray through the face from `p` to `q`, moved outwards by `radius`.
fn enter_face(
    p: Vec2<Grid>,
    q: Vec2<Grid>,
    radius: Grid,
    o: Vec2<Grid>,
    d: Vec2<Grid>,
) -> Option<(Fraction, Vec2<Unit>)> {
    let e = q - p;
    let inwards = cross(e, d);
    if inwards <= 0 {
        return None;
    }
    let tangent = direction(e)?;
    let way = -cross(e, o - p) - times_length(radius, e, tangent);
    // `way` is negative if rounding puts the start of the ray behind the face although it is outside of the shape.
    if way < -times_length(radius.min(ROUNDING), e, tangent) || way > inwards {
        return None;
    }
    let fraction = Fraction::ratio(way.max(0), inwards);
    let on_face = if radius == 0 {
        // Exact, so that no ray passes between two faces at a corner.
        (0..=inwards).contains(&cross(o - p, d))
    } else {
        (0..=dot(e, e)).contains(&dot(e, o + fraction.of(d) - p))
    };
    on_face.then_some((fraction, -tangent.perp()))
}

/// Entry of a ray into the circle about `p`. `forward` is the ray's direction.
fn enter_circle(
    p: Vec2<Grid>,
    radius: Grid,
    o: Vec2<Grid>,
    d: Vec2<Grid>,
    forward: Vec2<Unit>,
) -> Option<Fraction> {
    let from_centre = o - p;
    let (before, beside) = (-dot(from_centre, d), cross(from_centre, d).abs());
    if before < 0 || beside > times_length(radius, d, forward) {
        return None;
    }
    let (r, h) = (radius.to_bits(), height(beside, scaled_along(forward, d)).to_bits());
    let half_chord = (i128::from(r - h) * i128::from(r + h)).max(0).isqrt();
    let way = before - ((half_chord * (scaled_along(forward, d) >> 8)) >> (Unit::FRAC_NBITS - 8));
    let whole = dot(d, d);
    // `way` is negative if a rounding error puts the start of the ray inside the circle.
    (way <= whole).then(|| Fraction::ratio(way.max(0), whole))
}

/// `radius |v|` in units of 2^-56 m². `direction` is the direction of `v`. The shift keeps the product within 128 bits.
fn times_length(radius: Grid, v: Vec2<Grid>, direction: Vec2<Unit>) -> i128 {
    ((scaled_along(direction, v) >> 8) * i128::from(radius.to_bits())) >> (Unit::FRAC_NBITS - 8)
}

/// Distance in metres by which a translation approaches a surface with this outward normal.
pub(in crate::collision) fn approach(normal: Vec2<Unit>, translation: Vec2<Grid>) -> Grid {
    -along(normal, translation)
}
