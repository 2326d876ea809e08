//! Queries agree with a brute-force oracle and with every broad phase in a changing world, at the origin and far away.

mod casts;
mod churn;
mod contacts;
mod extremes;
mod one_sided;
mod oracle;
mod single;

use churn::Churn;
use lockstep2d::body::{Polygon, ShapeId};
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::fx;
use lockstep2d::math::{Aabb, Fx, Rng, Vec2, fx_mul};
use lockstep2d::world::{CastHit, ClosestPoints, Probe, QueryFilter, RayHit, World};
use lockstep2d_tests::sweep;
use oracle::{Solid, TOLERANCE, along, seen};

#[derive(Clone, Copy, Debug)]
enum Query {
    Ray { origin: Vec2<Fx>, translation: Vec2<Fx> },
    Cast { probe: Probe, translation: Vec2<Fx> },
    Box { area: Aabb },
    Shape { probe: Probe },
    Point { point: Vec2<Fx> },
    Closest { point: Vec2<Fx>, within: Fx },
}

#[derive(Debug, PartialEq)]
enum Answer {
    Ray { first: Option<RayHit>, all: Vec<RayHit>, any: bool },
    Cast(Option<CastHit>),
    Shapes(Vec<ShapeId>),
    Closest(Option<(ShapeId, ClosestPoints)>),
}

impl Query {
    fn random(churn: &mut Churn) -> Self {
        let size = [fx!(0), fx!(0.01), fx!(3), fx!(25), fx!(2000)][churn.rng.below(5) as usize];
        let (point, translation) = (churn.place(fx!(12)), churn.vector(size));
        let geometry = churn.geometry();
        let probe = Probe::new(geometry, point).expect("valid").turned(churn.rng.angle());
        match churn.rng.below(6) {
            0 => Query::Ray { origin: point, translation },
            1 => Query::Cast { probe, translation },
            2 => {
                let other = point + churn.vector(size.min(fx!(25)));
                Query::Box { area: Aabb::new(point.min(other), point.max(other)) }
            }
            3 => Query::Shape { probe },
            4 => Query::Point { point },
            _ => Query::Closest { point, within: churn.rng.range(-fx!(0.1), size.max(fx!(0.1))) },
        }
    }

    fn ask(&self, world: &World, filter: QueryFilter) -> Answer {
        match *self {
            Query::Ray { origin, translation } => Answer::Ray {
                first: world.cast_ray(origin, translation, filter),
                all: world.cast_ray_all(origin, translation, filter),
                any: world.cast_ray_any(origin, translation, filter),
            },
            Query::Cast { probe, translation } => Answer::Cast(world.cast_shape(&probe, translation, filter)),
            Query::Box { area } => Answer::Shapes(world.overlap_box(area, filter)),
            Query::Shape { probe } => Answer::Shapes(world.overlap_shape(&probe, filter)),
            Query::Point { point } => Answer::Shapes(world.overlap_point(point, filter)),
            Query::Closest { point, within } => Answer::Closest(world.closest(point, within, filter)),
        }
    }
}

fn random_filter(churn: &mut Churn) -> QueryFilter {
    let mask = if churn.rng.chance(1, 2) { u64::MAX } else { u64::from(churn.rng.below(8)) };
    let except = churn.any_body().filter(|_| churn.rng.chance(1, 3));
    QueryFilter { mask, sensors: churn.rng.chance(1, 2), except, ..QueryFilter::default() }
}

/// Copies of a world with different broad phases or caches.
fn twins(world: &World) -> Vec<World> {
    let with = |kind| {
        let mut twin = world.clone();
        twin.set_broad_phase(kind);
        twin
    };
    let mut restored = World::default();
    restored.restore(&world.save());
    vec![
        with(BroadPhaseKind::Tree),
        with(BroadPhaseKind::SweepAndPrune),
        with(BroadPhaseKind::BruteForce),
        World::from_bytes(&world.to_bytes()).expect("its own bytes"),
        restored,
    ]
}

/// Counts of queries, of non-empty results, and of rays and casts that the oracle has checked.
#[derive(Default, Debug)]
struct Tally {
    queries: u32,
    found: u32,
    rays: u32,
    casts: u32,
}

fn churn_and_ask(seed: u64, centre: Vec2<Fx>, states: u32) -> Tally {
    let mut churn = Churn::new(seed, centre);
    let mut tally = Tally::default();
    for state in 0..states {
        (0..1 + churn.rng.below(4)).for_each(|_| churn.change());
        if state % 3 != 0 {
            churn.world.step();
        }
        let twins = twins(&churn.world);
        for _ in 0..50 {
            let (query, filter) = (Query::random(&mut churn), random_filter(&mut churn));
            let answer = query.ask(&churn.world, filter);
            for (i, twin) in twins.iter().enumerate() {
                assert_eq!(query.ask(twin, filter), answer, "twin {i}: {query:?} {filter:?}");
            }
            tally.queries += 1;
            check(&churn.world, filter, query, &answer, &mut tally);
        }
    }
    tally
}

fn check(world: &World, filter: QueryFilter, query: Query, answer: &Answer, tally: &mut Tally) {
    let solids = seen(world, filter);
    let thorough = tally.queries.is_multiple_of(8);
    match (query, answer) {
        (Query::Ray { origin, translation }, Answer::Ray { first, all, any }) => {
            assert_eq!((first.as_ref(), *any), (all.first(), !all.is_empty()), "{query:?}");
            assert!(all.is_sorted_by_key(|hit| hit.fraction), "{all:?}");
            tally.found += u32::from(*any);
            if thorough {
                solids.iter().for_each(|solid| check_ray(solid, origin, translation, all, tally));
            }
        }
        (Query::Cast { probe, translation }, Answer::Cast(hit)) => {
            tally.found += u32::from(hit.is_some());
            if thorough {
                check_cast(world, &solids, probe, translation, hit.as_ref(), tally);
            }
        }
        (Query::Box { area }, Answer::Shapes(found)) => {
            let (centre, size) = (area.centre(), area.extents());
            let Ok(rectangle) = Polygon::rectangle(size.x, size.y) else { return };
            let probe = Probe::new(rectangle, centre).expect("valid");
            let gap = |id| world.probe_distance(&probe, id).expect("there").distance;
            check_list(&solids, found, |solid| gap(solid.id), fx!(0.000002), tally);
        }
        (Query::Shape { probe }, Answer::Shapes(found)) => {
            let gap = |id| world.probe_distance(&probe, id).expect("there").distance;
            check_list(&solids, found, |solid| gap(solid.id), Fx::ZERO, tally);
        }
        (Query::Point { point }, Answer::Shapes(found)) => {
            check_list(&solids, found, |solid| solid.distance(point), TOLERANCE, tally);
        }
        (Query::Closest { point, within }, Answer::Closest(found)) => {
            let nearest = solids.iter().map(|solid| solid.distance(point)).min().unwrap_or(Fx::MAX);
            match found {
                None => assert!(nearest > within - TOLERANCE || within < 0, "{nearest} {query:?}"),
                Some((_, proximity)) => {
                    tally.found += 1;
                    assert!((proximity.distance - nearest).abs() < TOLERANCE, "{nearest} {answer:?}");
                    assert!(proximity.distance <= within, "{query:?} {answer:?}");
                    let apart = proximity.point_a.distance(proximity.point_b);
                    assert!((apart - proximity.distance.abs()).abs() < TOLERANCE, "{answer:?}");
                }
            }
        }
        _ => unreachable!("the answer belongs to a different query"),
    }
}

/// Checks that a query has found all overlapping shapes, in slot order. Shapes within the tolerance of touching are not
/// checked.
fn check_list(
    solids: &[Solid],
    found: &[ShapeId],
    distance: impl Fn(&Solid) -> Fx,
    tolerance: Fx,
    tally: &mut Tally,
) {
    assert!(found.is_sorted());
    assert!(
        found.iter().all(|id| solids.iter().any(|solid| solid.id == *id)),
        "expected only shapes that pass the filter: {found:?}"
    );
    tally.found += u32::from(!found.is_empty());
    for solid in solids {
        let gap = distance(solid);
        if gap.abs() > tolerance || tolerance == Fx::ZERO {
            assert_eq!(found.contains(&solid.id), gap <= Fx::ZERO, "{gap} {}", solid.id);
        }
    }
}

fn check_ray(solid: &Solid, origin: Vec2<Fx>, translation: Vec2<Fx>, all: &[RayHit], tally: &mut Tally) {
    if solid.one_sided {
        return;
    }
    let Some(traced) = solid.trace(origin, translation) else { return };
    let hit = all.iter().find(|hit| hit.shape == solid.id);
    tally.rays += 1;
    let Some(hit) = hit else {
        // The oracle may report a hit for a near miss.
        let Some(reached) = traced else { return };
        for i in 0..=64 {
            let point = along(origin, translation, (reached + fx!(0.00001) * i).min(translation.length()));
            assert!(solid.distance(point) > -TOLERANCE, "{origin:?} {translation:?} {}", solid.id);
        }
        return;
    };
    let surface = solid.distance(hit.point);
    assert!(surface < TOLERANCE, "{surface} {hit:?}");
    let Some(way) = traced else { panic!("{hit:?} is not on the ray") };
    // The oracle stops slightly above the surface. If the ray is almost parallel to the surface, this stop is far from
    // the hit.
    let steep = -translation.normalized().unwrap_or(Vec2::X).widen().dot(hit.normal.widen());
    let apart = (way - fx_mul(hit.fraction, translation.length())).abs();
    if hit.fraction > 0 && steep > fx!(0.05) {
        assert!(
            fx_mul(apart, steep) < TOLERANCE * 2 + translation.length() / 1_000_000_000,
            "{apart} {hit:?}"
        );
    }
}

fn check_cast(
    world: &World,
    solids: &[Solid],
    probe: Probe,
    translation: Vec2<Fx>,
    hit: Option<&CastHit>,
    tally: &mut Tally,
) {
    let skin = fx!(0.0001);
    let solid: Vec<_> = solids.iter().filter(|solid| !solid.one_sided).map(|solid| solid.id).collect();
    let one_sided = hit.is_some_and(|hit| !solid.contains(&hit.shape));
    let gap = |way: Fx| {
        let moved = probe.at(along(probe.position(), translation, way));
        solid.iter().map(|&id| world.probe_distance(&moved, id).expect("there").distance).min()
    };
    if one_sided || gap(Fx::ZERO).is_none_or(|gap| gap < skin + fx!(0.00001)) {
        return;
    }
    let length = translation.length();
    let mut way = Fx::ZERO;
    for _ in 0..100 {
        let free = gap(way).expect("solids") - skin;
        if free < fx!(0.000001) {
            // The probe touches a shape or passes very close. The cast may hit or miss.
            tally.casts += u32::from(hit.is_some());
            break;
        }
        way += free;
        if way > length {
            assert!(hit.is_none_or(|hit| hit.fraction > fx!(0.999)), "{hit:?} {probe:?} {translation:?}");
            tally.casts += 1;
            return;
        }
    }
    if let Some(hit) = hit {
        let moved = probe.at(probe.position() + hit.travelled);
        let gap = world.probe_distance(&moved, hit.shape).expect("there").distance;
        assert!((gap - skin).abs() < fx!(0.000001), "{gap} {hit:?}");
        let all = solid.iter().map(|&id| world.probe_distance(&moved, id).expect("there").distance).min();
        assert!(all.is_none_or(|gap| gap > skin - fx!(0.000001)), "{all:?} {hit:?}");
        assert!(hit.travelled.length() > way - fx!(0.00001), "{way} {hit:?}");
    }
}

#[test]
fn queries_find_what_looking_at_every_shape_finds() {
    let tally = churn_and_ask(1, Vec2::ZERO, 1400);
    assert!(tally.queries == 70_000 && tally.found > 20_000 && tally.rays > 10_000 && tally.casts > 100);
}

#[test]
fn queries_are_as_exact_far_from_the_origin() {
    for (seed, x, y) in [(2, fx!(1000000000), fx!(-1000000000)), (3, fx!(-1073741000), fx!(123456789.25))] {
        let tally = churn_and_ask(seed, Vec2::new(x, y), 300);
        assert!(tally.queries == 15_000 && tally.found > 4_000, "{tally:?}");
    }
}

/// Among equal shapes, the one with the lowest slot is returned.
#[test]
fn of_equals_the_first_slot_is_found() {
    use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
    let mut rng = Rng::new(1);
    let mut world = World::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
    let ids: Vec<_> = (0..20).map(|_| world.spawn(&BodyDef::fixed(), &[ball]).expect("valid")).collect();
    let shape = |i: usize| world.body(ids[i]).expect("there").shapes()[0];
    let all: Vec<_> = (0..20).map(shape).collect();
    let filter = QueryFilter::default();
    for _ in 0..200 {
        let from = Vec2::new(rng.range(fx!(1), fx!(1000)), rng.range(fx!(-1000), fx!(1000)));
        let hits = world.cast_ray_all(from, -from, filter);
        assert_eq!(hits.iter().map(|hit| hit.shape).collect::<Vec<_>>(), all);
        assert_eq!(world.cast_ray(from, -from, filter).expect("hit").shape, all[0]);
        assert_eq!(world.closest(from, Fx::MAX, filter).expect("near").0, all[0]);
        let probe = Probe::new(Geometry::circle(fx!(0.3)).expect("valid"), from).expect("valid");
        assert_eq!(world.cast_shape(&probe, -from, filter).expect("hit").shape, all[0]);
    }
    assert_eq!(world.overlap_point(Vec2::ZERO, filter), all);
    let ray = world.cast_ray_all(Vec2::ZERO, Vec2::ZERO, filter);
    assert!(ray.len() == 20 && ray.iter().all(|hit| hit.fraction == 0 && hit.normal == Vec2::ZERO));
}

/// The side of a one-sided link is decided by the position of the probe's shape, not by the probe's origin.
#[test]
fn a_probe_above_its_origin_lands_on_a_one_sided_chain() {
    use lockstep2d::body::{BodyDef, Chain, Geometry};
    let at = |x, y| Vec2::new(x, y);
    let mut world = World::default();
    let ground = [at(fx!(5), fx!(0)), at(fx!(-5), fx!(0))];
    let links = Chain::new(&ground).one_sided().links().expect("valid");
    let chain = world.spawn(&BodyDef::fixed(), &links).expect("valid");
    let link = world.probe_of(world.shapes_of(chain)[0]).expect("there");
    let pill = Geometry::capsule(at(fx!(0), fx!(1)), at(fx!(0), fx!(2)), fx!(0.3)).expect("valid");
    let probe = Probe::new(pill, at(fx!(0), fx!(-0.5))).expect("valid");
    let hit = world.cast_shape(&probe, at(fx!(0), fx!(-1)), QueryFilter::default()).expect("ground");
    assert!((hit.travelled.y - fx!(-0.1999)).abs() < fx!(0.000001), "{hit:?}");
    assert_eq!(world.collide_mover(&probe, fx!(1), QueryFilter::default()).len(), 1);
    let below = probe.at(at(fx!(0), fx!(-2.5)));
    assert_eq!(world.cast_shape(&below, at(fx!(0), fx!(4)), QueryFilter::default()), None);
    assert_eq!(world.collide_mover(&below, fx!(1), QueryFilter::default()), []);
    assert_eq!(probe.cast(at(fx!(0), fx!(-1)), &link).map(|hit| hit.fraction), Some(hit.fraction));
    assert_eq!(below.cast(at(fx!(0), fx!(4)), &link), None);
}
