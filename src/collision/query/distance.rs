//! Distance of two cores, which are shapes without their radii. GJK finds the point of `B - A` nearest to the origin
//! (E. Gilbert, D. Johnson, S. Keerthi, "A Fast Procedure for Computing the Distance Between Complex Objects", 1988).
//!
//! In two dimensions, a search direction is the vector from a vertex to the origin or the perpendicular of an edge, and
//! neither needs rounding. With exact signs, each step finds a feature strictly nearer to the origin, so the search
//! ends without a tolerance and cannot cycle. The separating axis test gives the depth of overlapping cores.

use crate::collision::shape::support::{
    Fraction, Grid, SupportShape, cross, direction, edges, height, length, scaled, scaled_along,
};
use crate::collision::shape::support::{dot, from_grid, to_fx};
use crate::math::{Fx, Unit, Vec2};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Distance {
    /// Distance between the surfaces in metres, or the negative length of the shortest translation that separates them.
    /// The error is up to 20 nm for separate cores, and up to 1e-9 of the size of the shapes for overlapping cores.
    pub(crate) distance: Fx,
    /// Nearest point of A, or its deepest point inside B, relative to the origin of the support shapes.
    pub(crate) point_a: Vec2<Fx>,
    /// The corresponding point of B.
    pub(crate) point_b: Vec2<Fx>,
    /// Unit vector from A to B.
    pub(crate) normal: Vec2<Unit>,
}

pub(crate) fn distance(a: &SupportShape, b: &SupportShape) -> Distance {
    let Axis { separation, normal, point_a, point_b } = axis(a, b);
    let (point_a, point_b) = (point_a + scaled(normal, a.radius), point_b - scaled(normal, b.radius));
    Distance {
        distance: to_fx(separation - a.radius - b.radius),
        point_a: from_grid(point_a),
        point_b: from_grid(point_b),
        normal,
    }
}

/// Whether two shapes share a point, borders included.
pub(crate) fn overlap(a: &SupportShape, b: &SupportShape) -> bool {
    match nearest(a, b) {
        None => true,
        Some(axis) => axis.separation <= a.radius + b.radius,
    }
}

/// Axis of largest separation or least overlap of two cores.
struct Axis {
    separation: Grid,
    normal: Vec2<Unit>,
    point_a: Vec2<Grid>,
    point_b: Vec2<Grid>,
}

fn axis(a: &SupportShape, b: &SupportShape) -> Axis {
    nearest(a, b).unwrap_or_else(|| deepest(a, b))
}

#[derive(Clone, Copy)]
struct Vertex {
    a: Vec2<Grid>,
    b: Vec2<Grid>,
    /// `b - a`.
    w: Vec2<Grid>,
}

impl Vertex {
    /// Vertex of `B - A` furthest along a direction. The first one wins a tie.
    fn support(a: &SupportShape, b: &SupportShape, d: Vec2<Grid>) -> Self {
        let (a, b) = (furthest(a.points(), -d), furthest(b.points(), d));
        Vertex { a, b, w: b - a }
    }
}

fn furthest(points: &[Vec2<Grid>], d: Vec2<Grid>) -> Vec2<Grid> {
    let (mut best, mut best_along) = (points[0], dot(points[0], d));
    for &point in &points[1..] {
        let along = dot(point, d);
        if along > best_along {
            (best, best_along) = (point, along);
        }
    }
    best
}

#[derive(Clone, Copy)]
enum Nearest {
    Vertex(Vertex),
    /// The origin projects strictly between the ends.
    Edge(Vertex, Vertex),
}

/// Nearest points of two cores. `None` if the cores share a point.
fn nearest(a: &SupportShape, b: &SupportShape) -> Option<Axis> {
    let (first_a, first_b) = (a.points()[0], b.points()[0]);
    let mut found = Nearest::Vertex(Vertex { a: first_a, b: first_b, w: first_b - first_a });
    loop {
        found = match found {
            Nearest::Vertex(p) => {
                let to_origin = -p.w;
                if to_origin == Vec2::ZERO {
                    return None;
                }
                let s = Vertex::support(a, b, to_origin);
                if dot(s.w - p.w, to_origin) <= 0 {
                    return Some(between_vertices(p));
                }
                if projects_inside(s, p) { Nearest::Edge(p, s) } else { Nearest::Vertex(s) }
            }
            Nearest::Edge(p, q) => {
                let perp = (q.w - p.w).perp();
                let to_origin = match dot(perp, p.w) {
                    0 => return None,
                    ..0 => perp,
                    _ => -perp,
                };
                let s = Vertex::support(a, b, to_origin);
                if dot(s.w - p.w, to_origin) <= 0 {
                    return Some(on_edge(p, q, to_origin));
                }
                nearest_of_triangle(p, q, s)?
            }
        };
    }
}

/// Feature of the triangle `p q s` nearest to the origin. `None` if the origin is inside. `s` must be on the origin's
/// side of the edge `p q`, and the origin must project onto the interior of that edge.
fn nearest_of_triangle(p: Vertex, q: Vertex, s: Vertex) -> Option<Nearest> {
    let winding = cross(q.w - p.w, s.w - p.w).signum();
    // Whether the origin is beyond an edge, as seen from the third vertex of the triangle.
    let beyond_ps = cross(p.w - s.w, -s.w) * winding < 0;
    let beyond_sq = cross(s.w - q.w, -q.w) * winding < 0;
    match (beyond_ps, beyond_sq) {
        (false, false) => None,
        (true, _) if projects_inside(s, p) => Some(Nearest::Edge(p, s)),
        (_, true) if projects_inside(s, q) => Some(Nearest::Edge(s, q)),
        _ => Some(Nearest::Vertex(s)),
    }
}

/// Whether the origin and `p` are on the same side of the line through `s` that is perpendicular to `s p`.
fn projects_inside(s: Vertex, p: Vertex) -> bool {
    dot(p.w - s.w, -s.w) > 0
}

fn between_vertices(p: Vertex) -> Axis {
    let normal = direction(p.w).unwrap_or(Vec2::Y);
    Axis { separation: length(p.w), normal, point_a: p.a, point_b: p.b }
}

fn on_edge(p: Vertex, q: Vertex, to_origin: Vec2<Grid>) -> Axis {
    let edge = q.w - p.w;
    let fraction = Fraction::ratio(-dot(p.w, edge), dot(edge, edge));
    let point_a = p.a + fraction.of(q.a - p.a);
    let point_b = p.b + fraction.of(q.b - p.b);
    // The normal follows from the exact edge direction, because the difference of the points is rounded.
    let normal = direction(-to_origin).unwrap_or(Vec2::Y);
    Axis { separation: length(point_b - point_a), normal, point_a, point_b }
}

/// Face of least depth of two cores that share a point.
fn deepest(a: &SupportShape, b: &SupportShape) -> Axis {
    let shared = a.points()[0];
    let mut best: Option<Axis> = None;
    let mut keep = |axis: Axis| {
        if best.as_ref().is_none_or(|best| axis.separation > best.separation) {
            best = Some(axis);
        }
    };
    for (normal, separation, point) in faces(a, b) {
        keep(Axis { separation, normal, point_a: point - scaled(normal, separation), point_b: point });
    }
    for (normal, separation, point) in faces(b, a) {
        let point_b = point - scaled(normal, separation);
        keep(Axis { separation, normal: -normal, point_a: point, point_b });
    }
    // If both cores are points, there are no faces.
    best.unwrap_or(Axis { separation: Grid::ZERO, normal: Vec2::Y, point_a: shared, point_b: shared })
}

/// For each face of `support_shape`: its normal, the separation of the other core from the face, and the other core's
/// point nearest to the face, or deepest behind it.
fn faces(
    support_shape: &SupportShape,
    other: &SupportShape,
) -> impl Iterator<Item = (Vec2<Unit>, Grid, Vec2<Grid>)> {
    edges(support_shape.points()).filter_map(|(p, q)| {
        let edge = q - p;
        let tangent = direction(edge)?;
        let point = furthest(other.points(), edge.perp());
        let separation = height(-cross(edge, point - p), scaled_along(tangent, edge));
        Some((-tangent.perp(), separation, point))
    })
}

#[cfg(test)]
mod tests;
