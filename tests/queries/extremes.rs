//! Extreme values: no panic, and equal answers from every broad phase.

use super::{Query, twins};
use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Aabb, Fx, Rng, Vec2};
use lockstep2d::world::{Displacement, Probe, QueryFilter, World};

const FAR: Fx = fx!(1073741824);

fn world() -> World {
    let mut world = World::default();
    let mut add = |geometry: Geometry, x: Fx, y: Fx| {
        world.spawn(&BodyDef::fixed().position((x, y)), &[ShapeDef::new(geometry)]).expect("valid");
    };
    let corner = Vec2::new(FAR, FAR);
    for (x, y) in [(fx!(0), fx!(0)), (FAR, -FAR), (-FAR, FAR), (FAR, FAR)] {
        add(Geometry::segment(-corner, corner).expect("valid"), x, y);
        add(Geometry::circle(fx!(110)).expect("valid"), x, y);
        add(Polygon::rectangle(fx!(100), fx!(0.01)).expect("valid").into(), x, y);
    }
    world
}

fn number(rng: &mut Rng) -> Fx {
    let near = rng.range(fx!(-200), fx!(200));
    let small = [Fx::DELTA, -Fx::DELTA, fx!(0), fx!(1), fx!(-1), near];
    let large =
        [Fx::MIN, Fx::MAX, FAR, -FAR, FAR + near, near - FAR, Fx::MIN + Fx::DELTA, rng.range(-FAR, FAR)];
    match rng.below(2) {
        0 => small[rng.below(6) as usize],
        _ => large[rng.below(8) as usize],
    }
}

#[test]
fn extreme_queries_do_not_panic() {
    let mut rng = Rng::new(1);
    let world = world();
    let twins = twins(&world);
    let corner = Vec2::new(FAR, -FAR);
    let geometries = [
        Geometry::circle(fx!(110)).expect("valid"),
        Geometry::segment(-corner, corner).expect("valid"),
        Polygon::square(fx!(70)).expect("valid").into(),
        Geometry::capsule(Vec2::ZERO, Vec2::new(fx!(0.002), fx!(0)), fx!(0.002)).expect("valid"),
    ];
    for _ in 0..20_000 {
        let mut vector = || Vec2::new(number(&mut rng), number(&mut rng));
        let (point, translation) = (vector(), vector());
        let probe = Probe::new(geometries[rng.below(4) as usize], point).expect("valid").turned(rng.angle());
        let query = match rng.below(6) {
            0 => Query::Ray { origin: point, translation },
            1 => Query::Cast { probe, translation },
            2 => Query::Box { area: Aabb::new(point, translation) },
            3 => Query::Shape { probe },
            4 => Query::Point { point },
            _ => Query::Closest { point, within: number(&mut rng) },
        };
        let answer = query.ask(&world, QueryFilter::default());
        for twin in &twins {
            assert_eq!(query.ask(twin, QueryFilter::default()), answer, "{query:?}");
        }
        let _ = world.collide_mover(&probe, translation.x, QueryFilter::default());
        let _ = world.cast_turning(&probe, translation, number(&mut rng), QueryFilter::default());
        let other = world.shapes().nth(rng.below(12) as usize).expect("12 shapes").0;
        let other = world.probe_of(other).expect("enabled");
        let by = Displacement { translation, turns: number(&mut rng) };
        let _ = (
            other.time_of_impact(by, &probe, Displacement::default()),
            other.manifold(&probe, translation.y),
        );
        let _ = (
            other.cast(translation, &probe),
            other.cast_ray(point, translation),
            other.contains_point(point),
        );
    }
}

#[test]
fn boxes_that_are_no_boxes_hold_nothing() {
    let world = world();
    let at = |x, y| Vec2::new(x, y);
    let filter = QueryFilter::default();
    let all = Aabb::new(at(Fx::MIN, Fx::MIN), at(Fx::MAX, Fx::MAX));
    assert_eq!(world.overlap_box(all, filter).len(), world.shape_count());
    assert_eq!(world.overlap_box(Aabb::new(all.upper, all.lower), filter), []);
    assert_eq!(world.overlap_box(Aabb::new(at(fx!(5), fx!(0)), at(fx!(4), fx!(9))), filter), []);
    let point = Aabb::new(at(fx!(50), fx!(50)), at(fx!(50), fx!(50)));
    let line = Aabb::new(at(fx!(-300), fx!(111)), at(fx!(300), fx!(111)));
    assert!(world.overlap_box(point, filter).len() >= 2);
    assert_eq!(world.overlap_box(point, filter), world.overlap_point(point.lower, filter));
    assert!(!world.overlap_box(line, filter).is_empty());
}

#[test]
fn a_ray_across_the_world_tells_neighbours_apart() {
    let mut world = World::default();
    // The fraction of a ray of 2^31 m has a resolution of half a metre, which does not tell the balls apart.
    let ball = ShapeDef::new(Geometry::circle(fx!(0.01)).expect("valid"));
    for x in [fx!(1000.06), fx!(1000.03), fx!(1000)] {
        world.spawn(&BodyDef::fixed().position((x, fx!(0))), &[ball]).expect("valid");
    }
    let (from, way) = (Vec2::new(-FAR, fx!(0)), Vec2::new(fx!(2147483647), fx!(0)));
    let hits = world.cast_ray_all(from, way, QueryFilter::default());
    assert!(hits.is_sorted_by_key(|hit| hit.point.x) && hits.len() == 3, "{hits:?}");
    assert_eq!(world.cast_ray(from, way, QueryFilter::default()).as_ref(), hits.first());
}

#[test]
fn a_point_at_the_end_of_numbers_has_a_closest_shape() {
    let world = world();
    let (shape, found) = world
        .closest(Vec2::new(Fx::MIN, Fx::MIN), Fx::MAX, QueryFilter::default())
        .expect("everything is near");
    assert!(world.shape(shape).is_some() && found.distance > fx!(1000000000), "{found:?}");
    assert_eq!(world.closest(Vec2::ZERO, fx!(-1), QueryFilter::default()), None);
    assert!(world.closest(Vec2::ZERO, fx!(0), QueryFilter::default()).is_some());
}
