use super::*;
use crate::body::{Body, BodyDef, Geometry, MassProperties, Polygon, ShapeDef};
use crate::collision::SatCounters;
use crate::collision::shape::link::Link;
use crate::math::{Angle, Rng, closest_point_on_segment, narrow};
use alloc::vec::Vec;

fn posed(geometry: Geometry, position: Vec2<Fx>, angle: Angle) -> PosedShape {
    let def = BodyDef::fixed().position(position).angle(angle);
    let body = Body::new(&def, MassProperties::immovable());
    PosedShape::new(&ShapeDef::new(geometry), &body, body.rotation())
}

fn random_geometry(rng: &mut Rng) -> Geometry {
    loop {
        let mut coordinate = || rng.range(fx!(-1), fx!(1));
        let points: Vec<_> = (0..7).map(|_| Vec2::new(coordinate(), coordinate())).collect();
        let radius = rng.range(fx!(0), fx!(0.3));
        let geometry = match rng.below(6) {
            0 => Geometry::circle(radius + fx!(0.1)).ok(),
            1 => Geometry::segment(points[0], points[1]).ok(),
            4 => Geometry::capsule(points[0], points[1], radius).ok(),
            2 => Polygon::rectangle(radius + fx!(0.1), fx!(0.3)).ok().map(Geometry::from),
            3 => Polygon::hull(&points).ok().map(Geometry::from),
            _ => Polygon::hull(&points).and_then(|hull| hull.rounded(radius)).ok().map(Geometry::from),
        };
        if let Some(geometry) = geometry {
            return geometry;
        }
    }
}

fn random_pose(rng: &mut Rng) -> PosedShape {
    let geometry = random_geometry(rng);
    let position = Vec2::new(rng.range(fx!(-1.5), fx!(1.5)), rng.range(fx!(-1.5), fx!(1.5)));
    posed(geometry, position, rng.angle())
}

#[test]
fn reject_and_cached_axis_change_no_result() {
    let mut rng = Rng::new(1);
    let mut counters = SatCounters::default();
    let mut touching = 0;
    for _ in 0..200_000 {
        let (a, b) = (random_pose(&mut rng), random_pose(&mut rng));
        let margin = narrow(rng.range(fx!(0.005), fx!(0.2)));
        let mut cached_axis = CachedAxis::default();
        let plain = collide_near(&a, &b, margin, &mut cached_axis, &mut SatCounters::default());
        for _ in 0..2 {
            let found = collide(&a, &b, margin, &mut cached_axis, &mut counters);
            assert_eq!(found.points(), plain.points());
            assert!(found.points().is_empty() || found == plain, "expected {plain:?}, got {found:?}");
            let other = random_pose(&mut rng);
            collide_near(&a, &other, margin, &mut cached_axis, &mut SatCounters::default());
        }
        touching += u32::from(!plain.points().is_empty());
    }
    assert!(
        touching > 20_000 && counters.cached_axis_hits > 10_000,
        "touching pairs and cached axes should be frequent: {touching} touch, {counters:?}"
    );
}

#[test]
fn a_shape_that_is_shifted_is_as_if_it_had_been_posed_there() {
    let mut rng = Rng::new(4);
    for _ in 0..20_000 {
        let (geometry, angle) = (random_geometry(&mut rng), rng.angle());
        let mut place = || Vec2::new(rng.range(fx!(-900), fx!(900)), rng.range(fx!(-900), fx!(900)));
        let (from, to) = (place(), place());
        let mut shifted = posed(geometry, from, angle);
        shifted.shift(to - from);
        assert_eq!(alloc::format!("{shifted:?}"), alloc::format!("{:?}", posed(geometry, to, angle)));
    }
}

fn corners(shape: &PosedShape) -> (Vec<Vec2<Fx>>, Fx) {
    match &shape.outline {
        Outline::Circle { radius } => (alloc::vec![shape.centre], widen(*radius)),
        Outline::Segment { a, b } | Outline::Link(Link { a, b, .. }) => {
            (alloc::vec![shape.centre + *a, shape.centre + *b], Fx::ZERO)
        }
        Outline::Polygon(hull) => {
            let vertices = hull.vertices().iter().map(|vertex| shape.centre + vertex.widen());
            (vertices.collect(), widen(hull.radius))
        }
    }
}

fn distance(a: &[Vec2<Fx>], b: &[Vec2<Fx>]) -> Fx {
    let from = |points: &[Vec2<Fx>], outline: &[Vec2<Fx>]| {
        let edges = outline.iter().zip(outline.iter().cycle().skip(1));
        edges
            .flat_map(|(p, q)| {
                points.iter().map(|&point| closest_point_on_segment(point, *p, *q).distance(point))
            })
            .min()
            .unwrap_or(Fx::MAX)
    };
    from(a, b).min(from(b, a))
}

/// Compares the separation with brute force in 64 bits. Skips outlines that, without their radii, cross or are within
/// 0.5 mm of each other.
#[test]
fn separation_is_the_distance_of_outlines_that_are_apart() {
    let mut rng = Rng::new(2);
    let margin = narrow(fx!(0.05));
    let (mut compared, mut none) = (0, 0);
    for _ in 0..300_000 {
        let (a, b) = (random_pose(&mut rng), random_pose(&mut rng));
        if matches!((&a.outline, &b.outline), (Outline::Segment { .. }, Outline::Segment { .. })) {
            continue;
        }
        let ((corners_a, radius_a), (corners_b, radius_b)) = (corners(&a), corners(&b));
        let manifold = collide(&a, &b, margin, &mut CachedAxis::default(), &mut SatCounters::default());
        let nearest = manifold.points().iter().map(|point| Fx::from(point.separation)).min();
        let expected = distance(&corners_a, &corners_b) - radius_a - radius_b;
        match nearest {
            None => {
                none += 1;
                assert!(expected > fx!(0.04999), "missed a contact at {expected} m: {a:?} {b:?}");
            }
            // Outlines within 0.5 mm of each other count as overlapping: the separation is that of a face, and not the
            // distance.
            Some(found) if found + radius_a + radius_b > fx!(0.0005) => {
                compared += 1;
                // Nearly parallel edges are treated as faces, with an error up to the tolerance of 0.5 mm.
                let error = found - expected;
                assert!(error.abs() < fx!(0.000502), "expected {expected} m, got {found} m: {a:?} {b:?}");
            }
            Some(_) => {}
        }
    }
    assert!(
        compared > 5_000 && none > 10_000,
        "both cases should be frequent: {compared} compared, {none} without contact"
    );
}

/// No face normal of these shapes separates them, because they lie on one line.
#[test]
fn shapes_in_line_are_apart_and_pushed_along_the_line() {
    let pill = || Geometry::capsule(Vec2::new(fx!(-1), fx!(0)), Vec2::new(fx!(1), fx!(0)), fx!(0.5)).unwrap();
    let stick = Geometry::segment(Vec2::new(fx!(-1.5), fx!(0)), Vec2::new(fx!(1.5), fx!(0))).unwrap();
    let ball = Geometry::circle(fx!(1.5)).unwrap();
    for (other, angle) in [
        (pill(), Angle::ZERO),
        (pill(), Angle::from_degrees(fx!(180))),
        (pill(), Angle::from_degrees(fx!(0.01))),
        (stick, Angle::ZERO),
        (ball, Angle::ZERO),
    ] {
        for gap in [fx!(-0.3), fx!(0), fx!(0.04)] {
            let a = posed(pill(), Vec2::new(fx!(7), fx!(2)), Angle::ZERO);
            let b = posed(other, Vec2::new(fx!(10) + gap, fx!(2)), angle);
            let margin = narrow(fx!(0.05));
            let found = collide(&a, &b, margin, &mut CachedAxis::default(), &mut SatCounters::default());
            assert_eq!(found.points().len(), 1, "{other:?}, gap {gap}");
            assert!(found.normal.x > Length::lit("0.999"), "{:?}", found.normal);
            let error = widen(found.points()[0].separation) - gap;
            assert!(error.abs() < fx!(0.00001), "expected a separation of {gap} m, off by {error} m");
        }
    }
}

#[test]
fn exchanged_shapes_give_the_opposite_normal() {
    let mut rng = Rng::new(3);
    let margin = narrow(fx!(0.05));
    let mut compared = 0;
    for _ in 0..50_000 {
        let (a, b) = (random_pose(&mut rng), random_pose(&mut rng));
        let collide = |a, b| collide(a, b, margin, &mut CachedAxis::default(), &mut SatCounters::default());
        let (ab, ba) = (collide(&a, &b), collide(&b, &a));
        let same_axis = (ab.normal + ba.normal).length() < crate::math::Unit::lit("0.0001");
        if ab.points().is_empty() || !same_axis {
            continue;
        }
        compared += 1;
        let mut features = [Vec::new(), Vec::new()];
        features[0].extend(ab.points().iter().map(|point| point.feature));
        features[1].extend(ba.swapped().points().iter().map(|point| point.feature));
        features.iter_mut().for_each(|list| list.sort());
        assert_eq!(features[0], features[1], "{a:?} {b:?}");
    }
    assert!(compared > 10_000, "expected over 10000 comparisons, got {compared}");
}
