//! Two circles: `separation = |d| - r_a - r_b` along `d / |d|`.

use crate::collision::manifold::{Feature, Manifold, ManifoldPoint};
use crate::math::{Length, Vec2, convert};

/// `d` is the vector from the centre of A to the centre of B.
pub(crate) fn collide(radius_a: Length, radius_b: Length, d: Vec2<Length>, margin: Length) -> Manifold {
    // The normal of concentric circles is up.
    let (normal, distance) = d.normalized_with_length().unwrap_or((Vec2::Y, Length::ZERO));
    let separation = distance.saturating_sub(radius_a).saturating_sub(radius_b);
    if separation > margin {
        return Manifold::NONE;
    }
    let middle = radius_a.saturating_add(separation / 2);
    let point = ManifoldPoint {
        anchor: normal.scale(middle),
        separation: convert(separation),
        feature: Feature::SINGLE,
    };
    Manifold::single(normal, point)
}
