//! Compares convex hulls with their definition: two points are an edge if all other points are to its left, or on it
//! between the two points.

use lockstep2d::body::{Polygon, SHAPE_EXTENT_MAX};
use lockstep2d::math::{Fx, Length, Rng, Vec2};
use num_bigint::BigInt;
use num_traits::Signed;

use crate::source::Source;

/// Minimum length of an edge, in units of `Length`: half a millimetre.
const EDGE_MIN: i64 = (1 << 22) / 2000;

type Point = Vec2<Length>;

/// Makes the hull of the points that the bytes describe. Returns whether [`Polygon::hull`] accepts them.
///
/// # Panics
/// If the hull is wrong or depends on the order or the repetition of points, or if points with a valid hull are
/// refused.
pub fn run(bytes: &[u8]) -> bool {
    let mut source = Source::new(bytes);
    let points = points(&mut source);
    let narrow: Vec<Point> = points.iter().map(|point| point.narrow()).collect();
    let found = Polygon::hull(&points);
    let mut others = points.clone();
    Rng::new(source.word()).shuffle(&mut others);
    others.extend_from_slice(&points[..source.below(points.len() + 1)]);
    // Errors are not compared: if there are several, the order of the points decides which one is reported.
    assert_eq!(
        found.as_ref().ok(),
        Polygon::hull(&others).as_ref().ok(),
        "the hull must not depend on the order of the points"
    );
    let in_range = |value: Fx| (-SHAPE_EXTENT_MAX..=SHAPE_EXTENT_MAX).contains(&value);
    let legal = points.iter().all(|point| in_range(point.x) && in_range(point.y));
    let corners = if legal { slow_hull(&narrow) } else { Vec::new() };
    let Ok(hull) = found else {
        let valid = (3..=8).contains(&corners.len()) && corners.iter().all(|(a, b)| length_is_legal(*a, *b));
        assert!(!valid, "a valid hull of {points:?} is refused: {found:?}");
        return false;
    };
    assert!(legal, "points out of range are accepted: {points:?}");
    let vertices = hull.vertices();
    assert_eq!(vertices.len(), corners.len(), "the hull of {points:?}");
    for (at, &vertex) in vertices.iter().enumerate() {
        let next = vertices[(at + 1) % vertices.len()];
        assert!(
            corners.contains(&(vertex, next)),
            "{vertex:?} to {next:?} is not an edge of the hull of {points:?}"
        );
        assert_normal(hull.normals()[at], vertex, next);
    }
    let wide: Vec<_> = vertices.iter().map(|vertex| vertex.widen()).collect();
    assert_eq!(Polygon::new(&wide), Ok(hull), "the vertices of a hull make the same polygon");
    assert_eq!(Polygon::hull(&wide), Ok(hull), "the hull of a hull's vertices is the same hull");
    true
}

fn points(source: &mut Source<'_>) -> Vec<Vec2<Fx>> {
    let reach = source.pick(&[1000, 3, 110_000, 20, 120_000]);
    let way = source.below(4);
    (0..source.below(20))
        .map(|_| match way {
            // Points on a grid of 4 by 4, so that many are equal or on one line.
            0 => Vec2::new(Fx::from(source.below(4) as i32), Fx::from(source.below(4) as i32)),
            1 => source.mostly_vec(-reach, reach),
            2 => {
                let turned = lockstep2d::math::Rot::from_angle(source.angle());
                turned.apply_wide(Vec2::new(lockstep2d::math::ratio(reach, 1000), Fx::ZERO))
            }
            _ => {
                let along = source.thousandths(-reach, reach);
                Vec2::new(along, along + Fx::from_bits(i64::from(source.byte()) << 8))
            }
        })
        .collect()
}

fn cross(a: Point, b: Point, c: Point) -> BigInt {
    let difference = |from: Length, to: Length| BigInt::from(to.to_bits()) - from.to_bits();
    difference(a.x, b.x) * difference(a.y, c.y) - difference(a.y, b.y) * difference(a.x, c.x)
}

/// The edges of the hull, found by testing the definition for all pairs of points.
fn slow_hull(points: &[Point]) -> Vec<(Point, Point)> {
    let mut edges = Vec::new();
    for &a in points {
        for &b in points {
            let on_or_left = |&c: &Point| {
                let side = cross(a, b, c);
                side.is_positive() || side == BigInt::from(0) && is_between(c, a, b)
            };
            if a != b && !edges.contains(&(a, b)) && points.iter().all(on_or_left) {
                edges.push((a, b));
            }
        }
    }
    edges
}

fn is_between(c: Point, a: Point, b: Point) -> bool {
    let (low, high) = (a.min(b), a.max(b));
    (low.x..=high.x).contains(&c.x) && (low.y..=high.y).contains(&c.y)
}

/// Whether the exact length of an edge exceeds the minimum by more than one unit. Then its rounded length does not fall
/// below the minimum.
fn length_is_legal(a: Point, b: Point) -> bool {
    let difference = |from: Length, to: Length| BigInt::from(to.to_bits()) - from.to_bits();
    let square = difference(a.x, b.x).pow(2) + difference(a.y, b.y).pow(2);
    square > BigInt::from(EDGE_MIN + 1).pow(2)
}

/// Checks that the normal of the edge from `a` to `b` is perpendicular to it except for rounding, and points outwards,
/// to the right of the edge.
fn assert_normal(normal: Vec2<lockstep2d::math::Unit>, a: Point, b: Point) {
    let (x, y) = (BigInt::from(normal.x.to_bits()), BigInt::from(normal.y.to_bits()));
    let (dx, dy) = (BigInt::from(b.x.to_bits()) - a.x.to_bits(), BigInt::from(b.y.to_bits()) - a.y.to_bits());
    // Each component of the normal n has an error of at most 0.76 units. For an edge vector e, therefore |n . e| < 0.77
    // (|ex| + |ey|) units.
    let along: BigInt = (&x * &dx + &y * &dy).abs();
    assert!(along * 100 <= (dx.abs() + dy.abs()) * 77, "{normal:?} from {a:?} to {b:?}");
    assert!((&x * &dy - &y * &dx).is_positive(), "{normal:?} points inwards");
}
