//! A circle against a convex outline: a polygon, or a segment as a polygon with two sides.
//!
//! The centre is inside (the nearest face pushes it out, so that it is never pushed through), beside a face, or
//! in the region of a corner.

use fixed::types::extra::U27;

use super::manifold::{Feature, Manifold, ManifoldPoint};
use super::pose::Hull;
use crate::math::{Length, Step, Unit, Vec2, convert};

/// A is the hull, B the circle with its centre at `centre` from the hull's.
pub(crate) fn collide(hull: &Hull, radius: Length, centre: Vec2<Length>, margin: Length) -> Manifold {
    let (edge, face_separation) = nearest_face(hull, centre);
    let reach: Step = convert(margin.saturating_add(radius).saturating_add(hull.radius));
    if face_separation > reach {
        return Manifold::NONE;
    }
    let (v1, v2) = (hull.vertices()[edge], hull.vertices()[hull.next(edge)]);
    let face_normal = hull.normals()[edge];
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
        Some(vertex) if face_separation > 0 => {
            let d = centre - vertex;
            (d.normalized().unwrap_or(face_normal), convert(d.length()))
        }
        _ => (face_normal, face_separation),
    };
    let separation = distance.saturating_sub(convert(radius.saturating_add(hull.radius)));
    if separation > convert::<_, U27>(margin) {
        return Manifold::NONE;
    }
    // The circle's surface is `radius` before its centre; half-way back to the hull's is another half separation.
    let back: Length = radius.saturating_add(convert(separation / 2));
    let anchor = centre - normal.scale(back);
    Manifold::single(normal, ManifoldPoint { anchor, separation, feature: Feature::SINGLE })
}

/// The face with the largest distance to a point, and that distance: negative for a point inside.
fn nearest_face(hull: &Hull, point: Vec2<Length>) -> (usize, Step) {
    let mut best = (0, Step::MIN);
    for (i, (&vertex, &normal)) in hull.vertices().iter().zip(hull.normals()).enumerate() {
        let separation = distance_along(normal, point - vertex);
        if separation > best.1 {
            best = (i, separation);
        }
    }
    best
}

/// `n . d` with the resolution of a separation.
fn distance_along(n: Vec2<Unit>, d: Vec2<Length>) -> Step {
    d.dot(n)
}
