//! A circle against a polygon, segment or capsule.
//!
//! The circle's centre is inside the outline, beside a face, or in the Voronoi region of a corner. If it is inside, the
//! nearest face pushes the circle out.

use super::hull_hull::{self, FACE_BITS, Face};
use crate::collision::manifold::{Feature, Manifold, ManifoldPoint};
use crate::collision::shape::posed::Hull;
use crate::math::{Length, Step, Unit, Vec2, convert, round_shift, saturate};

/// `centre` is the circle's centre relative to the hull's.
pub(crate) fn collide(hull: &Hull, radius: Length, centre: Vec2<Length>, margin: Length) -> Manifold {
    let radii = step_bits(radius) + step_bits(hull.radius);
    // Distances are not saturated: for a large shape, only the difference of the distance and the radii fits `Step`.
    let Face { edge, separation } = hull_hull::face_before(hull, centre);
    let face_distance = round_shift(separation, FACE_BITS - Step::FRAC_NBITS);
    if face_distance - radii > step_bits(margin) {
        return Manifold::NONE;
    }
    let (v1, v2) = (hull.vertex(edge), hull.vertex(hull.next(edge)));
    let face_normal = hull.normal(edge);
    let tangent = face_normal.perp();
    let before: Length = (centre - v1).dot(tangent);
    let after: Length = (centre - v2).dot(tangent);
    let corner = if before < 0 {
        Some(v1)
    } else if after > 0 {
        Some(v2)
    } else {
        None
    };
    let (normal, distance) = match corner {
        // For a line, the sign of the distance does not matter: a centre on the line beyond an end has distance 0 from
        // both faces, or slightly less by rounding.
        Some(vertex) if face_distance >= 0 || hull.is_line() => {
            let polar = (centre - vertex).normalized_with_length();
            let (normal, distance) = polar.unwrap_or((face_normal, Length::ZERO));
            (normal, step_bits(distance))
        }
        _ => (face_normal, face_distance),
    };
    if distance - radii > step_bits(margin) {
        return Manifold::NONE;
    }
    let separation = Step::from_bits(saturate(distance - radii));
    // Distance from the circle's centre to the middle of the gap: the radius, plus half the separation.
    let back: Length = radius.saturating_add(convert(separation / 2));
    let anchor = centre - normal.scale(back);
    Manifold::single(normal, ManifoldPoint { anchor, separation, feature: Feature::SINGLE })
}

/// `n . d` in units of `Step`, not saturated.
pub(in crate::collision) fn distance_along(n: Vec2<Unit>, d: Vec2<Length>) -> i64 {
    let product = |a: Unit, b: Length| i64::from(a.to_bits()) * i64::from(b.to_bits());
    round_shift(
        product(n.x, d.x) + product(n.y, d.y),
        Unit::FRAC_NBITS + Length::FRAC_NBITS - Step::FRAC_NBITS,
    )
}

/// A length in units of `Step`, not saturated.
pub(in crate::collision) fn step_bits(length: Length) -> i64 {
    i64::from(length.to_bits()) << (Step::FRAC_NBITS - Length::FRAC_NBITS)
}
