//! Rays and casts through chains that are solid from one side.

use crate::sweep;
use lockstep2d::body::{BodyDef, Chain, Geometry, ShapeId};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Orientation, Rng, Vec2, orientation};
use lockstep2d::world::{Probe, QueryFilter, World};

fn at(x: Fx, y: Fx) -> Vec2<Fx> {
    Vec2::new(x, y)
}

fn world(chain: &Chain) -> (World, Vec<ShapeId>) {
    let mut world = World::default();
    let body = world.spawn(&BodyDef::fixed(), &chain.links().expect("valid")).expect("valid");
    let links = world.shapes_of(body).to_vec();
    (world, links)
}

/// A room that is solid from inside: left wall, ceiling, right wall and floor.
const ROOM: [Vec2<Fx>; 4] = [
    Vec2::new(fx!(0), fx!(0)),
    Vec2::new(fx!(0), fx!(4)),
    Vec2::new(fx!(10), fx!(4)),
    Vec2::new(fx!(10), fx!(0)),
];

#[test]
fn a_ray_through_the_wall_of_a_room_meets_the_ceiling() {
    let (world, links) = world(&Chain::new(&ROOM).closed().one_sided());
    let (from, way) = (at(fx!(-1), fx!(2)), at(fx!(4), fx!(4)));
    let hit = world.cast_ray(from, way, QueryFilter::default()).expect("the ceiling");
    assert_eq!((hit.shape, hit.fraction), (links[1], fx!(0.5)));
    let single = world.probe_of(links[1]).expect("there").cast_ray(from, way).expect("the ceiling");
    assert_eq!(single.fraction, fx!(0.5));
}

#[test]
fn a_ray_leaves_a_block_unhindered() {
    let block = [at(fx!(0), fx!(0)), at(fx!(1), fx!(0)), at(fx!(1), fx!(1)), at(fx!(0), fx!(1))];
    let (world, links) = world(&Chain::new(&block).closed().one_sided());
    let (from, way) = (at(fx!(1.2), fx!(0.5)), at(fx!(-1), fx!(-0.6)));
    let hits = world.cast_ray_all(from, way, QueryFilter::default());
    assert!(hits.len() == 1 && hits[0].shape == links[1], "{hits:?}");
    assert_eq!(world.probe_of(links[0]).expect("there").cast_ray(from, way), None);
}

/// A ray meets the links of a two-sided chain on whose right side it starts.
#[test]
fn rays_meet_one_sided_links_from_the_right() {
    let mut rng = Rng::new(7);
    let (mut met, mut passed) = (0, 0);
    for case in 0..sweep::size(100_000, 5_000) {
        let mut vector = || at(rng.range(fx!(-5), fx!(5)), rng.range(fx!(-5), fx!(5)));
        let points: Vec<_> = (0..6).map(|_| vector()).collect();
        let (from, way) = (vector(), vector());
        let chain = if case % 2 == 0 { Chain::new(&points) } else { Chain::new(&points).closed() };
        let ((both, links), (right, same_links)) = (world(&chain), world(&chain.one_sided()));
        assert_eq!(links, same_links);
        let filter = QueryFilter::default();
        let mut wanted = both.cast_ray_all(from, way, filter);
        let count = wanted.len();
        wanted.retain(|hit| {
            let i = links.iter().position(|&link| link == hit.shape).expect("a link");
            orientation(points[i], points[(i + 1) % 6], from) != Orientation::CounterClockwise
        });
        assert_eq!(right.cast_ray_all(from, way, filter), wanted, "{points:?} {from} {way}");
        assert_eq!(right.cast_ray(from, way, filter), wanted.first().copied());
        assert_eq!(right.cast_ray_any(from, way, filter), !wanted.is_empty());
        (met, passed) = (met + wanted.len(), passed + count - wanted.len());
    }
    assert!(met > 1_000 && passed > 1_000, "{met} {passed}");
}

#[test]
fn casts_through_the_wall_of_a_room_meet_the_ceiling() {
    let (world, links) = world(&Chain::new(&ROOM).closed().one_sided());
    let filter = QueryFilter::default();
    let ball = Probe::new(Geometry::circle(fx!(0.2)).expect("valid"), at(fx!(-1), fx!(2))).expect("valid");
    let way = at(fx!(4), fx!(4));
    for hit in [world.cast_shape(&ball, way, filter), world.cast_turning(&ball, way, fx!(0.1), filter)] {
        let hit = hit.expect("the ceiling");
        assert!(hit.shape == links[1] && (hit.travelled.y - fx!(1.8)).abs() < fx!(0.0002), "{hit:?}");
    }
    let single = ball.cast(way, &world.probe_of(links[1]).expect("there")).expect("the ceiling");
    assert!(single.fraction > fx!(0.449) && single.fraction < fx!(0.45));
}

/// A shape beside a wall passes over the ends of the ceiling and of the floor, and through the wall itself.
#[test]
fn casts_along_the_outside_of_a_room_meet_nothing() {
    let (world, _) = world(&Chain::new(&ROOM).closed().one_sided());
    let filter = QueryFilter::default();
    for away in [fx!(0.02), fx!(0.1), fx!(0.3)] {
        let ball = |x, y| Probe::new(Geometry::circle(fx!(0.2)).expect("valid"), at(x, y)).expect("valid");
        for (probe, way) in [
            (ball(-away, fx!(2)), at(fx!(0), fx!(4))),
            (ball(-away, fx!(2)), at(fx!(0), fx!(-4))),
            (ball(fx!(10) + away, fx!(2)), at(fx!(0), fx!(4))),
            (ball(fx!(5), fx!(4) + away), at(fx!(9), fx!(0))),
            (ball(fx!(5), -away), at(fx!(-9), fx!(0))),
        ] {
            assert_eq!(world.cast_shape(&probe, way, filter), None, "{probe:?} {way}");
            assert_eq!(world.cast_turning(&probe, way, fx!(0.1), filter), None, "{probe:?} {way}");
        }
    }
}
