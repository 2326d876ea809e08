//! Queries of single shapes agree with brute force.

use crate::casts::random_geometry;
use crate::sweep;
use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{
    Angle, Fx, Rng, Rot, Vec2, closest_point_on_segment, fx_div, fx_mul, point_in_polygon, ratio,
    segment_intersection,
};
use lockstep2d::world::{Displacement, Probe, TimeOfImpact, World};

/// Corners in world coordinates, and a radius.
struct Outline {
    corners: Vec<Vec2<Fx>>,
    radius: Fx,
}

impl Outline {
    fn of(geometry: &Geometry, position: Vec2<Fx>, angle: Angle) -> Self {
        let (corners, radius) = match geometry {
            Geometry::Circle { radius } => (vec![Vec2::ZERO], *radius),
            Geometry::Segment { a, b } | Geometry::Link { a, b, .. } => (vec![*a, *b], Fx::ZERO),
            Geometry::Capsule { a, b, radius } => (vec![*a, *b], *radius),
            Geometry::Polygon(polygon) => {
                (polygon.vertices().iter().map(|v| v.widen()).collect(), polygon.radius().into())
            }
        };
        let turn = Rot::from_angle(angle);
        let corners = corners.into_iter().map(|corner| position + turn.apply_wide(corner)).collect();
        Outline { corners, radius }
    }

    fn edges(&self) -> impl Iterator<Item = (Vec2<Fx>, Vec2<Fx>)> {
        self.corners.iter().copied().zip(self.corners.iter().copied().cycle().skip(1))
    }

    /// Whether the polygon without its radius contains a point.
    fn holds(&self, point: Vec2<Fx>) -> bool {
        self.corners.len() > 2 && point_in_polygon(&self.corners, point)
    }

    /// Distance of a point in metres, negative inside.
    fn gap_to(&self, point: Vec2<Fx>) -> Fx {
        let nearest = self.edges().map(|(a, b)| closest_point_on_segment(point, a, b).distance(point)).min();
        let nearest = nearest.expect("corners");
        (if self.holds(point) { -nearest } else { nearest }) - self.radius
    }

    /// Distance of the outlines in metres. `None` if the polygons without their radii overlap.
    fn distance(&self, other: &Outline) -> Option<Fx> {
        if self.holds(other.corners[0]) || other.holds(self.corners[0]) {
            return None;
        }
        let crosses = |(a, b)| other.edges().any(|(p, q)| segment_intersection(a, b, p, q).is_some());
        if self.edges().any(crosses) {
            return None;
        }
        let reach = |one: &Outline, two: &Outline| {
            let nearest = |&corner: &Vec2<Fx>| {
                two.edges().map(|(a, b)| closest_point_on_segment(corner, a, b).distance(corner)).min()
            };
            one.corners.iter().filter_map(nearest).min().expect("corners")
        };
        Some(reach(self, other).min(reach(other, self)) - self.radius - other.radius)
    }
}

struct Sample {
    geometry: Geometry,
    position: Vec2<Fx>,
    angle: Angle,
    probe: Probe,
}

impl Sample {
    fn new(rng: &mut Rng, origin: Vec2<Fx>, spread: Fx) -> Self {
        let geometry = random_geometry(rng);
        let position = origin + Vec2::new(rng.range(-spread, spread), rng.range(-spread, spread));
        let angle = rng.angle();
        let probe = Probe::new(geometry, position).expect("valid").turned(angle);
        Sample { geometry, position, angle, probe }
    }

    fn outline(&self) -> Outline {
        Outline::of(&self.geometry, self.position, self.angle)
    }

    fn moved(&self, by: Displacement, fraction: Fx) -> Outline {
        let turned = Angle::from_turns(fx_mul(by.turns, fraction));
        Outline::of(&self.geometry, self.position + by.translation.scale(fraction), self.angle + turned)
    }
}

fn origin(case: u32) -> Vec2<Fx> {
    if case.is_multiple_of(2) { Vec2::ZERO } else { Vec2::new(fx!(1000000000), fx!(-999999999.125)) }
}

/// Tolerance in metres for the rounding of rotated corner coordinates.
const TOLERANCE: Fx = fx!(0.000002);

#[test]
fn distances_overlaps_and_manifolds_are_those_of_brute_force() {
    let mut rng = Rng::new(1);
    let (mut apart, mut over, mut touching) = (0, 0, 0);
    for case in 0..sweep::size(100_000, 10_000) {
        let (a, b) =
            (Sample::new(&mut rng, origin(case), fx!(1.5)), Sample::new(&mut rng, origin(case), fx!(1.5)));
        let found = a.probe.distance(&b.probe);
        assert_eq!(a.probe.overlaps(&b.probe), found.distance <= 0, "{found:?}");
        let expected = a.outline().distance(&b.outline());
        match expected {
            Some(expected) => {
                apart += 1;
                assert!(
                    (found.distance - expected).abs() < TOLERANCE,
                    "{found:?} {expected} {a_b:?}",
                    a_b = (a.probe, b.probe)
                );
                let between = found.point_b - found.point_a - found.normal.widen().scale(found.distance);
                assert!(between.length() < TOLERANCE, "{found:?}");
                assert!(a.outline().gap_to(found.point_a).abs() < TOLERANCE, "{found:?}");
                assert!(b.outline().gap_to(found.point_b).abs() < TOLERANCE, "{found:?}");
            }
            None => {
                over += 1;
                assert!(found.distance <= TOLERANCE, "{found:?}");
            }
        }
        let lines = matches!((a.geometry, b.geometry), (Geometry::Segment { .. }, Geometry::Segment { .. }));
        let manifold = a.probe.manifold(&b.probe, fx!(0.05));
        let deepest = manifold.points().iter().map(|point| Fx::from(point.separation)).min();
        match (expected, deepest) {
            (_, None) => assert!(lines || expected.is_some_and(|gap| gap > fx!(0.04999)), "{expected:?}"),
            (Some(gap), Some(deepest)) => {
                touching += 1;
                // Nearly parallel edges touch as faces do. The separation then differs from the distance by up to half
                // a millimetre.
                assert!((gap - deepest).abs() < fx!(0.000502) || gap < fx!(0.0005), "{gap} {deepest}");
            }
            (None, Some(deepest)) => assert!(deepest < fx!(0.0006), "{deepest}"),
        }
    }
    assert!(apart > 5_000 && over > 1_000 && touching > 200, "{apart} {over} {touching}");
}

#[test]
fn rays_and_points_are_those_of_brute_force() {
    let mut rng = Rng::new(2);
    let (mut hits, mut misses, mut inside) = (0, 0, 0);
    for case in 0..sweep::size(100_000, 10_000) {
        let shape = Sample::new(&mut rng, origin(case), fx!(1));
        let outline = shape.outline();
        let mut vector = |size: Fx| Vec2::new(rng.range(-size, size), rng.range(-size, size));
        let from = origin(case) + vector(fx!(4));
        let translation = origin(case) + vector(fx!(1)) - from;
        let translation = translation.scale(rng.range(fx!(0.3), fx!(2)));
        let gap = outline.gap_to(from);
        assert!(shape.probe.contains_point(from) == (gap <= 0) || gap.abs() < TOLERANCE, "{gap}");
        let hit = shape.probe.cast_ray(from, translation);
        if gap < -TOLERANCE {
            inside += 1;
            let hit = hit.expect("inside");
            assert!(hit.starts_inside && hit.fraction == 0 && hit.point == from, "{hit:?}");
            continue;
        }
        // Sphere tracing does not step past the surface.
        let length = translation.length();
        let mut way = Fx::ZERO;
        for _ in 0..300 {
            let step = outline.gap_to(from + translation.scale(fx_div(way, length).expect("a ray")));
            way += step;
            if step < TOLERANCE || way > length {
                break;
            }
        }
        match hit {
            Some(hit) => {
                hits += 1;
                assert!(outline.gap_to(hit.point).abs() < TOLERANCE, "{hit:?}");
                assert!(fx_mul(hit.fraction, length) > way - fx!(0.00001), "{hit:?} {way}");
                let facing = hit.normal.widen().dot(translation);
                assert!(facing <= fx!(0.000001) && !hit.starts_inside, "{hit:?}");
            }
            None => {
                misses += 1;
                for step in 0..=100 {
                    let gap = outline.gap_to(from + translation.scale(ratio(step, 100)));
                    assert!(gap > -TOLERANCE, "{gap} at {step}");
                }
            }
        }
    }
    assert!(hits > 1_000 && misses > 1_000 && inside > 100, "{hits} {misses} {inside}");
}

#[test]
fn times_of_impact_are_the_first_touch_of_small_steps() {
    let mut rng = Rng::new(3);
    let (mut hits, mut misses, mut overlaps) = (0, 0, 0);
    for case in 0..sweep::size(100_000, 4_000) {
        let (a, b) =
            (Sample::new(&mut rng, origin(case), fx!(3)), Sample::new(&mut rng, origin(case), fx!(3)));
        let mut displacement = || Displacement {
            translation: Vec2::new(rng.range(fx!(-4), fx!(4)), rng.range(fx!(-4), fx!(4))),
            turns: rng.range(fx!(-2), fx!(2)),
        };
        let (by_a, by_b) = (displacement(), displacement());
        let gap = |fraction| a.moved(by_a, fraction).distance(&b.moved(by_b, fraction));
        let found = a.probe.time_of_impact(by_a, &b.probe, by_b);
        let end = match found {
            TimeOfImpact::Overlapped => {
                overlaps += 1;
                assert!(gap(fx!(0)).is_none_or(|gap| gap < TOLERANCE));
                continue;
            }
            TimeOfImpact::Separated => {
                misses += 1;
                fx!(1)
            }
            TimeOfImpact::Hit { fraction } => {
                hits += 1;
                let gap = gap(fraction).expect("not beyond the surface");
                assert!(gap < fx!(0.00015) + TOLERANCE, "{gap} {found:?}");
                fraction
            }
            TimeOfImpact::Failed { fraction } => panic!("gave up at {fraction}"),
        };
        for step in 0..=100 {
            let gap = gap(fx_mul(end, ratio(step, 100)));
            let least = if end == 0 { fx!(0) } else { fx!(0.0001) };
            assert!(gap.is_some_and(|gap| gap > least - TOLERANCE), "{gap:?} at {step} of {found:?}");
        }
    }
    assert!(hits > 300 && misses > 300 && overlaps > 100, "{hits} {misses} {overlaps}");
}

/// Products of far ends with a unit normal have large errors, so that a line is clipped whichever shape it is.
#[test]
fn times_of_impact_with_a_line_across_the_world_do_not_depend_on_the_order() {
    let mut rng = Rng::new(6);
    for _ in 0..300 {
        let mut far = || Vec2::new(fx!(1000000000), rng.range(fx!(-300000000), fx!(300000000)));
        let ends = [-far(), far()];
        let line =
            Probe::new(Geometry::segment(ends[0], ends[1]).expect("valid"), Vec2::ZERO).expect("valid");
        let near = closest_point_on_segment(Vec2::ZERO, ends[0], ends[1]);
        let ball = Probe::new(Geometry::circle(fx!(0.5)).expect("valid"), near + Vec2::new(fx!(0.5), fx!(3)));
        let ball = ball.expect("valid");
        let by = Displacement { translation: Vec2::new(fx!(1), fx!(-8)), turns: rng.range(fx!(-1), fx!(1)) };
        let rest = Displacement::default();
        let TimeOfImpact::Hit { fraction } = ball.time_of_impact(by, &line, rest) else { panic!("a hit") };
        let there = ball.at(ball.position() + by.translation.scale(fraction));
        let gap = there.distance(&line).distance;
        assert!(gap > fx!(0.00009) && gap < fx!(0.00016), "{gap} {ends:?}");
        let swapped = line.time_of_impact(rest, &ball, by);
        let TimeOfImpact::Hit { fraction: other } = swapped else { panic!("{swapped:?} {ends:?}") };
        assert!((other - fraction).abs() < fx!(0.000001), "{other} {fraction} {ends:?}");
    }
}

/// A shape of the world answers like a probe with its geometry and pose.
#[test]
fn a_probe_of_a_shape_is_at_its_pose() {
    let mut rng = Rng::new(4);
    for case in 0..500 {
        let mut world = World::default();
        let (first, other) =
            (Sample::new(&mut rng, origin(case), fx!(2)), Sample::new(&mut rng, origin(case), fx!(2)));
        let def = BodyDef::fixed().position(first.position).angle(first.angle);
        let body = world.spawn(&def, &[ShapeDef::new(first.geometry)]).expect("valid");
        let shape = world.body(body).expect("there").shapes()[0];
        let probe = world.probe_of(shape).expect("there");
        let expected = world.probe_distance(&other.probe, shape).expect("there");
        assert_eq!(other.probe.distance(&probe), expected);
        assert_eq!(other.probe.distance(&first.probe), expected);
        let way = first.position - other.position;
        let ray = world.cast_ray(other.position, way, Default::default());
        let single = probe.cast_ray(other.position, way);
        assert_eq!(
            ray.map(|hit| (hit.fraction, hit.point, hit.normal)),
            single.map(|hit| (hit.fraction, hit.point, hit.normal))
        );
        let cast = world.cast_shape(&other.probe, way, Default::default());
        let single = other.probe.cast(way, &probe);
        assert_eq!(cast.map(|hit| (hit.fraction, hit.normal)), single.map(|hit| (hit.fraction, hit.normal)));
        world.despawn(body).expect("there");
        assert!(world.probe_of(shape).is_none());
    }
}
