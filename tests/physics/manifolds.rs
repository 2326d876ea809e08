//! Contact points at corners of rounded shapes, and on polygons with almost parallel neighbouring faces.

use lockstep2d::body::{Geometry, Polygon};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_mul};
use lockstep2d::world::Probe;

use crate::sweep;

/// Separation of the deepest point in metres.
fn gap(a: &Probe, b: &Probe) -> Option<Fx> {
    let manifold = a.manifold(b, fx!(0.1));
    manifold.points().iter().map(|point| Fx::from(point.separation)).min()
}

/// For shapes that are apart, the gap equals the distance. Exchanging the shapes changes the gap by at most 0.51 mm: a
/// face of the second shape becomes the reference face only if its separation is larger by 0.5 mm.
#[test]
fn the_gap_of_two_rounded_polygons_does_not_depend_on_their_order() {
    let (count, tolerance) = (sweep::size(100_000, 10_000), fx!(0.00051));
    let (mut rng, mut compared) = (Rng::new(61), 0);
    for case in 0..count {
        let (length, height) = (rng.range(fx!(0.1), fx!(1)), rng.range(fx!(0.1), fx!(1)));
        let hexagon = Polygon::regular(6, rng.range(fx!(0.2), fx!(1)));
        let hexagon = hexagon.and_then(|shape| shape.rounded(rng.range(fx!(0.02), fx!(0.3))));
        let rectangle = Polygon::rectangle(length, height);
        let radius = rng.range(fx!(0.05), fx!(0.3));
        let rectangle =
            rectangle.and_then(|shape| if case % 2 == 0 { shape.rounded(radius) } else { Ok(shape) });
        let apart = Vec2::new(rng.range(fx!(0.3), fx!(2.6)), fx!(0));
        let apart = Rot::from_angle(rng.angle()).apply_wide(apart);
        let a = Probe::new(hexagon.expect("valid"), Vec2::ZERO).expect("valid").turned(rng.angle());
        let b = Probe::new(rectangle.expect("valid"), apart).expect("valid").turned(rng.angle());
        let (first, second) = (gap(&a, &b), gap(&b, &a));
        let (Some(first), Some(second)) = (first, second) else {
            assert_eq!(first.is_some(), second.is_some(), "case {case}: {first:?} or {second:?}");
            continue;
        };
        assert!((first - second).abs() <= tolerance, "case {case}: {first} or {second} m");
        let distance = a.distance(&b).distance;
        if distance > 0 {
            compared += 1;
            assert!((first - distance).abs() <= tolerance, "case {case}: {first} m instead of {distance} m");
        }
    }
    assert!(compared > count / 50, "expected shapes that are apart, found {compared}");
}

/// Contact points lie half-way between the surfaces. This holds even for triangles up to 117 m long and micrometres
/// thick: the directions of their faces differ by less than the rounding of the normals.
#[test]
fn contact_points_lie_on_outlines_that_hardly_bend() {
    let (mut rng, mut points) = (Rng::new(67), 0);
    let count = sweep::size(100_000, 10_000);
    for case in 0..count {
        let length = rng.range(fx!(20), fx!(117));
        // The triangle is 2 um to 2 cm thick.
        let thin = |rng: &mut Rng| {
            let most = [fx!(0.00001), fx!(0.0005), fx!(0.02)][rng.below(3) as usize];
            rng.range(fx!(0.000002), most)
        };
        let triangle = |half: Fx, top: Fx, height: Fx| {
            let corners = [Vec2::new(-half, fx!(0)), Vec2::new(half, fx!(0)), Vec2::new(top, height)];
            Polygon::new(&corners).expect("valid")
        };
        let long = triangle(length / 2, fx_mul(rng.range(fx!(-0.45), fx!(0.45)), length), thin(&mut rng));
        let turn = rng.angle();
        let a = Probe::new(long, Vec2::ZERO).expect("valid").turned(turn);
        let size = [fx!(0.1), fx!(1), fx!(20)][rng.below(3) as usize];
        let size = fx_mul(size, rng.range(fx!(0.5), fx!(1.5)));
        let end = Vec2::new(size, fx!(0));
        let other = match rng.below(4) {
            0 => Polygon::square(size).expect("valid").into(),
            1 => Polygon::regular(6, size).expect("valid").into(),
            2 => Geometry::capsule(-end, end, size / 3).expect("valid"),
            _ => triangle(size, size / 3, thin(&mut rng)).into(),
        };
        let along = fx_mul(rng.range(fx!(-0.55), fx!(0.55)), length);
        let above = [size, -size][rng.below(2) as usize] + rng.range(fx!(-0.05), fx!(0.05));
        let place = Rot::from_angle(turn).apply_wide(Vec2::new(along, above));
        let tilt = [fx!(0), fx!(1.5708), rng.range(fx!(-0.01), fx!(0.01))][rng.below(3) as usize];
        let b = Probe::new(other, place).expect("valid").turned(turn + Angle::from_radians(tilt));
        for manifold in [a.manifold(&b, fx!(0.05)), b.manifold(&a, fx!(0.05))] {
            for point in manifold.points() {
                points += 1;
                let anchor = Vec2::new(Fx::from(point.anchor.x), Fx::from(point.anchor.y));
                let radius = fx!(0.005);
                let ball = Probe::new(Geometry::circle(radius).expect("valid"), manifold.origin + anchor);
                let ball = ball.expect("valid");
                let half = Fx::from(point.separation).abs() / 2;
                let beside = [&a, &b].map(|shape| ball.distance(shape).distance + radius - half);
                let most = fx!(0.00001);
                assert!(beside.iter().all(|&distance| distance < most), "case {case}: {beside:?} m beside");
            }
        }
    }
    assert!(points > count / 4, "expected contact points, found {points}");
}
