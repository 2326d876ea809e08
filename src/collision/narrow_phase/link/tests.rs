//! Tests of contacts between chains and other shapes.

use alloc::vec::Vec;

use crate::body::{Body, BodyDef, Chain, Geometry, MassProperties, Polygon, ShapeDef};
use crate::collision::narrow_phase::hull_hull::{CachedAxis, SatCounters};
use crate::collision::{Manifold, Outline, PosedShape, collide};
use crate::fx;
use crate::math::{Angle, Fx, Length, Rng, Unit, Vec2, closest_point_on_segment, narrow, widen};

fn posed(shape: &ShapeDef, position: Vec2<Fx>, angle: Angle) -> PosedShape {
    let def = BodyDef::fixed().position(position).angle(angle);
    let body = Body::new(&def, MassProperties::immovable());
    PosedShape::new(shape, &body, body.rotation())
}

fn found(a: &PosedShape, b: &PosedShape, margin: Fx) -> Manifold {
    collide(
        a,
        b,
        narrow::<fixed::types::extra::U22>(margin),
        &mut CachedAxis::default(),
        &mut SatCounters::default(),
    )
}

fn nearest(manifold: &Manifold) -> Option<Fx> {
    manifold.points().iter().map(|point| widen(point.separation)).min()
}

fn random_mover(rng: &mut Rng) -> Geometry {
    loop {
        let mut coordinate = || rng.range(fx!(-0.5), fx!(0.5));
        let points: Vec<_> = (0..6).map(|_| Vec2::new(coordinate(), coordinate())).collect();
        let radius = rng.range(fx!(0.01), fx!(0.3));
        let geometry = match rng.below(4) {
            0 => Geometry::circle(radius).ok(),
            1 => Geometry::capsule(points[0], points[1], radius).ok(),
            2 => Polygon::hull(&points).ok().map(Geometry::from),
            _ => Polygon::hull(&points).and_then(|hull| hull.rounded(radius)).ok().map(Geometry::from),
        };
        if let Some(geometry) = geometry {
            return geometry;
        }
    }
}

fn corners(shape: &PosedShape) -> (Vec<Vec2<Fx>>, Fx) {
    match &shape.outline {
        Outline::Circle { radius } => (alloc::vec![shape.centre], widen(*radius)),
        Outline::Polygon(hull) => {
            let vertices = hull.vertices().iter().map(|vertex| shape.centre + vertex.widen());
            (vertices.collect(), widen(hull.radius))
        }
        Outline::Segment { .. } | Outline::Link(_) => unreachable!("a mover should be a circle or a hull"),
    }
}

/// Distance between a closed outline and a polyline that do not cross, by brute force over all pairs of a vertex and an
/// edge.
fn distance(outline: &[Vec2<Fx>], line: &[Vec2<Fx>]) -> Fx {
    let from_line = outline.iter().flat_map(|&corner| {
        line.windows(2).map(move |link| closest_point_on_segment(corner, link[0], link[1]).distance(corner))
    });
    let edges = outline.iter().zip(outline.iter().cycle().skip(1));
    let from_outline = edges.flat_map(|(&p, &q)| {
        line.iter().map(move |&point| closest_point_on_segment(point, p, q).distance(point))
    });
    from_line.chain(from_outline).min().unwrap_or(Fx::MAX)
}

fn crosses(outline: &[Vec2<Fx>], line: &[Vec2<Fx>]) -> bool {
    let mut edges = outline.iter().zip(outline.iter().cycle().skip(1));
    edges.any(|(&p, &q)| {
        line.windows(2).any(|link| crate::math::segment_intersection(p, q, link[0], link[1]).is_some())
    })
}

/// A polyline that turns by less than a right angle at each point, so that it does not return to itself.
fn random_line(rng: &mut Rng) -> Vec<Vec2<Fx>> {
    let mut heading = rng.angle();
    let mut points = alloc::vec![Vec2::new(rng.range(fx!(-1), fx!(1)), rng.range(fx!(-1), fx!(1)))];
    for _ in 0..3 {
        let length = rng.range(fx!(0.05), fx!(1));
        let step = crate::math::Rot::from_angle(heading).apply_wide(Vec2::new(length, fx!(0)));
        points.push(points[points.len() - 1] + step);
        heading += Angle::from_degrees(rng.range(fx!(-50), fx!(50)));
    }
    points
}

#[test]
fn a_chain_has_no_holes() {
    let mut rng = Rng::new(1);
    let margin = fx!(0.05);
    let (mut near, mut far) = (0, 0);
    for _ in 0..60_000 {
        let line = random_line(&mut rng);
        let chain = Chain::new(&line).links().unwrap();
        let mover = ShapeDef::new(random_mover(&mut rng));
        let position = Vec2::new(rng.range(fx!(-1.5), fx!(1.5)), rng.range(fx!(-1.5), fx!(1.5)));
        let mover = posed(&mover, position, rng.angle());
        let (outline, radius) = corners(&mover);
        if crosses(&outline, &line) {
            continue;
        }
        let expected = distance(&outline, &line) - radius;
        let links = chain.iter().map(|link| posed(link, Vec2::ZERO, Angle::ZERO));
        let contact = links.filter_map(|link| nearest(&found(&link, &mover, margin))).min();
        if expected < margin - fx!(0.001) {
            near += 1;
            let contact = contact.unwrap_or(Fx::MAX);
            assert!(
                contact <= expected + fx!(0.001),
                "expected {expected}, got {contact}: {mover:?} on {line:?}"
            );
            let is_circle = matches!(mover.outline, Outline::Circle { .. });
            assert!(
                !is_circle || expected > 0 || contact >= expected - fx!(0.00001),
                "expected {expected}, got {contact}"
            );
        } else {
            far += 1;
        }
    }
    assert!(near > 3_000 && far > 10_000, "both cases should be frequent: {near} near, {far} far");
}

#[test]
fn a_flat_chain_only_pushes_straight() {
    let mut rng = Rng::new(2);
    let line: Vec<_> = (0..40i32).map(|i| Vec2::new(Fx::from_num(20 - i) / 5, fx!(0))).collect();
    let chain = Chain::new(&line).links().unwrap();
    let links: Vec<_> = chain.iter().map(|link| posed(link, Vec2::ZERO, Angle::ZERO)).collect();
    let mut contacts = 0;
    for _ in 0..5_000 {
        let mover = ShapeDef::new(random_mover(&mut rng));
        let angle = rng.angle();
        let (outline, radius) = corners(&posed(&mover, Vec2::ZERO, angle));
        let lowest = outline.iter().map(|corner| corner.y).min().unwrap() - radius;
        let height = rng.range(fx!(-0.004), fx!(0.03)) - lowest;
        let (x, y) = (rng.range(fx!(-2), fx!(2)), if rng.below(2) == 0 { height } else { -height });
        let angle = if y == height { angle } else { angle + Angle::from_degrees(fx!(180)) };
        let mover = posed(&mover, Vec2::new(x, y), angle);
        for link in &links {
            let manifold = found(link, &mover, fx!(0.2));
            if manifold.points().is_empty() {
                continue;
            }
            contacts += 1;
            let up = if y == height { manifold.normal.y } else { -manifold.normal.y };
            assert!(up > Unit::lit("0.9999999"), "{:?}: {mover:?} over {:?}", manifold.normal, link.outline);
        }
    }
    assert!(contacts > 10_000, "expected over 10000 contacts, got {contacts}");
}

#[test]
fn a_single_link_is_a_segment() {
    let mut rng = Rng::new(3);
    let mut compared = 0;
    for _ in 0..60_000 {
        let line = &random_line(&mut rng)[..2];
        let link = posed(&Chain::new(line).links().unwrap()[0], Vec2::ZERO, Angle::ZERO);
        let segment = ShapeDef::new(Geometry::segment(line[0], line[1]).unwrap());
        let segment = posed(&segment, Vec2::ZERO, Angle::ZERO);
        let position = Vec2::new(rng.range(fx!(-1.5), fx!(1.5)), rng.range(fx!(-1.5), fx!(1.5)));
        let mover = posed(&ShapeDef::new(random_mover(&mut rng)), position, rng.angle());
        let (outline, radius) = corners(&mover);
        if crosses(&outline, line) {
            continue;
        }
        let (of_link, of_segment) = (found(&link, &mover, fx!(0.05)), found(&segment, &mover, fx!(0.05)));
        assert_eq!(of_link.points().len(), of_segment.points().len(), "{mover:?} on {line:?}");
        let (Some(a), Some(b)) = (nearest(&of_link), nearest(&of_segment)) else { continue };
        // A segment inside a polygon may push the polygon to either side.
        if b < -radius {
            continue;
        }
        compared += 1;
        assert!((a - b).abs() < fx!(0.0000005), "link {a}, segment {b}: {mover:?} on {line:?}");
        let difference: Vec2<Length> = (of_link.normal - of_segment.normal).convert();
        assert!(difference.length() < Length::lit("0.001"), "{mover:?} on {line:?}");
    }
    assert!(compared > 2_000, "expected over 2000 comparisons, got {compared}");
}
