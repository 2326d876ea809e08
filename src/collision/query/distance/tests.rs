//! Compares distances with brute force.

use super::*;
use crate::collision::shape::support::{samples, to_grid};
use crate::fx;
use crate::math::{Rng, Rot, closest_point_on_segment, point_in_polygon, segment_intersection};

/// Distance of two cores in metres, by brute force. `None` if the cores share a point.
fn naive(a: &SupportShape, b: &SupportShape) -> Option<Fx> {
    let (a, b) = (samples::world_points(a), samples::world_points(b));
    if point_in_polygon(&a, b[0]) || point_in_polygon(&b, a[0]) {
        return None;
    }
    let mut best = Fx::MAX;
    for (i, &p) in a.iter().enumerate() {
        for (j, &q) in b.iter().enumerate() {
            let (p2, q2) = (a[(i + 1) % a.len()], b[(j + 1) % b.len()]);
            if segment_intersection(p, p2, q, q2).is_some() {
                return None;
            }
            best = best.min(closest_point_on_segment(p, q, q2).distance(p));
            best = best.min(closest_point_on_segment(q, p, p2).distance(q));
        }
    }
    Some(best)
}

#[test]
fn distance_is_that_of_the_nearest_vertex_and_edge() {
    let mut rng = Rng::new(1);
    let (mut apart, mut worst) = (0, Fx::ZERO);
    for i in 0..100_000 {
        let (a, b) = if i % 2 == 0 {
            (samples::placed(&mut rng, fx!(1.5)), samples::placed(&mut rng, fx!(1.5)))
        } else {
            let start = to_grid(samples::vector(&mut rng, fx!(200)));
            (samples::large(&mut rng), samples::large(&mut rng).moved(start))
        };
        let found = distance(&a, &b);
        let radii = to_fx(a.radius + b.radius);
        let Some(expected) = naive(&a, &b) else {
            assert!(found.distance <= -radii && overlap(&a, &b), "{a:?} {b:?}");
            continue;
        };
        apart += 1;
        worst = worst.max((found.distance - (expected - radii)).abs());
        assert_eq!(overlap(&a, &b), found.distance <= 0, "{a:?} {b:?}");
        let between = found.point_b - found.point_a;
        let error = between - found.normal.widen().scale(found.distance);
        assert!(error.length() < fx!(0.000001), "{error:?} {found:?} {a:?} {b:?}");
    }
    assert!(apart > 60_000, "expected over 60000 separate pairs, got {apart}");
    assert!(worst < fx!(0.00000002), "the largest error should be below 20 nm, not {worst} m");
}

/// If B moves by the depth along the normal, the shapes touch. If B moves by less, in any direction, they still
/// overlap.
#[test]
fn depth_is_the_shortest_way_out() {
    let mut rng = Rng::new(2);
    let mut tested = 0;
    for _ in 0..30_000 {
        let (a, b) = (samples::placed(&mut rng, fx!(0.7)), samples::placed(&mut rng, fx!(0.7)));
        let found = distance(&a, &b);
        if found.distance > fx!(-0.001) {
            continue;
        }
        tested += 1;
        let out = b.moved(to_grid(found.normal.widen().scale(-found.distance)));
        let touching = distance(&a, &out).distance;
        assert!(touching.abs() < fx!(0.00000005), "{touching} {found:?} {a:?} {b:?}");
        let shorter = Vec2::new(-found.distance - fx!(0.0001), Fx::ZERO);
        let way = Rot::from_angle(rng.angle()).apply_wide(shorter);
        assert!(overlap(&a, &b.moved(to_grid(way))), "{found:?} {a:?} {b:?}");
    }
    assert!(tested > 5_000, "expected over 5000 overlapping pairs, got {tested}");
}

#[test]
fn segments_across_the_world_are_exact() {
    let far = fx!(1073741824);
    let floor = SupportShape::from_points([Vec2::new(-far, -far), Vec2::new(far, far)], Fx::ZERO);
    let ball = SupportShape::disc(Vec2::new(fx!(1), fx!(-1)), fx!(1));
    let found = distance(&floor, &ball);
    assert!((found.distance - fx!(0.414213562373)).abs() < fx!(0.00000001), "{found:?}");
    assert!(found.point_a.length() < fx!(0.00000001), "{found:?}");
    let deep = SupportShape::from_points(
        [(-1, -2), (2, -2), (2, 1)].map(|(x, y)| Vec2::new(Fx::from_num(x), Fx::from_num(y))),
        Fx::ZERO,
    );
    assert!((distance(&floor, &deep).distance - fx!(0.7071067811865)).abs() < fx!(0.00000001));
    let deep = deep.moved(to_grid(Vec2::new(fx!(-1), fx!(1))));
    assert!((distance(&floor, &deep).distance + fx!(0.7071067811865)).abs() < fx!(0.00000001));
}

#[test]
fn nothing_overflows_at_the_edge_of_the_world() {
    let corners = [-Fx::MAX, Fx::MAX];
    for x in corners {
        for y in corners {
            let corner = Vec2::new(x, y);
            let across = SupportShape::from_points([corner, -corner], fx!(110));
            for other in [corner, corner.perp(), Vec2::new(x, -y)] {
                let found = distance(&across, &SupportShape::disc(other, fx!(110)));
                assert!(found.distance >= fx!(-220));
                let found = distance(&across, &SupportShape::from_points([other, -other], Fx::ZERO));
                assert!(found.distance <= fx!(-110), "{found:?}");
            }
        }
    }
}
