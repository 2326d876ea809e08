//! Shape casts that go along floors, that turn, and that start inside of shapes.

use crate::oracle::along;
use crate::sweep;
use lockstep2d::body::{BodyDef, Chain, Geometry, Polygon, ShapeDef};
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_mul, ratio};
use lockstep2d::world::{InitialOverlap, Probe, QueryFilter, World};

fn at(x: Fx, y: Fx) -> Vec2<Fx> {
    Vec2::new(x, y)
}

/// Shapes with their lowest point at `y = -0.5`.
fn shapes() -> [Geometry; 4] {
    let pill = Geometry::capsule(at(fx!(0), fx!(-0.2)), at(fx!(0), fx!(0.4)), fx!(0.3)).expect("valid");
    let round = Polygon::rectangle(fx!(0.4), fx!(0.4)).and_then(|polygon| polygon.rounded(fx!(0.1)));
    let square = Polygon::square(fx!(0.5)).expect("valid");
    [pill, round.expect("valid").into(), square.into(), Geometry::circle(fx!(0.5)).expect("valid")]
}

/// A sloping floor of 40 tiles or links of 0.5 m, with its middle at the origin.
fn floor(tiles: bool, slope: Angle, world: &mut World) {
    let turn = Rot::from_angle(slope);
    if tiles {
        for i in -20..20 {
            let place = turn.apply_wide(at(Fx::from_num(i) / 2 + fx!(0.25), fx!(-0.25)));
            let tile = ShapeDef::new(Polygon::rectangle(fx!(0.25), fx!(0.25)).expect("valid"));
            world.spawn(&BodyDef::fixed().position(place).angle(slope), &[tile]).expect("valid");
        }
    } else {
        let points: Vec<_> = (-20..=20).map(|i| turn.apply_wide(at(Fx::from_num(i) / 2, fx!(0)))).collect();
        world.spawn(&BodyDef::fixed(), &Chain::new(&points).links().expect("valid")).expect("valid");
    }
}

/// The shape starts up to 5 mm deep in a floor, like a resting body, or up to 0.3 mm above it. The cast passes seams,
/// and stops at a ledge of 1 cm.
#[test]
fn casts_along_a_floor_pass_its_seams_and_stop_at_a_ledge() {
    let mut rng = Rng::new(1);
    let mut ledges = 0;
    for case in 0..sweep::size(20_000, 800) {
        let slope = Angle::from_degrees(rng.range(fx!(-50), fx!(50)));
        let turn = Rot::from_angle(slope);
        let mut world = World::default();
        floor(case % 2 == 0, slope, &mut world);
        let (height, to) = (rng.range(fx!(-0.005), fx!(0.0003)), rng.range(fx!(-4), fx!(4)));
        let start = turn.apply_wide(at(rng.range(fx!(-3), fx!(3)), fx!(0.5) + height));
        let probe = Probe::new(shapes()[case / 2 % 4], start).expect("valid").turned(slope);
        let way = turn.apply_wide(at(to, fx!(0)));
        let hit = world.cast_shape(&probe, way, QueryFilter::default());
        assert_eq!(hit, None, "{case}: {height} {to} {slope:?}");
        let hit = world.cast_turning(&probe, way, fx!(0), QueryFilter::default());
        assert_eq!(hit, None, "{case}: {height} {to} {slope:?}");

        let ledge = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.51)).expect("valid"));
        let side = if to > 0 { fx!(1) } else { fx!(-1) };
        let place = turn.apply_wide(at(fx_mul(fx!(8.5), side), fx!(-0.5)));
        world.spawn(&BodyDef::fixed().position(place).angle(slope), &[ledge]).expect("valid");
        let way = turn.apply_wide(at(fx_mul(fx!(14), side), fx!(0)));
        let wanted = world.cast_shape(&probe, way, QueryFilter::default()).expect("a ledge");
        let turning = world.cast_turning(&probe, way, fx!(0), QueryFilter::default()).expect("a ledge");
        for hit in [wanted, turning] {
            let end = turn.apply_inverse_wide(start + hit.travelled);
            let away = fx!(8) - fx_mul(end.x, side);
            assert!(hit.shape == wanted.shape && away > 0 && away < fx!(0.51), "{case}: {away} {hit:?}");
            ledges += 1;
        }
    }
    assert!(ledges > 1000);
}

/// The shape is between a floor and a ceiling that it touches. The cast stops at a ledge of 2 mm.
#[test]
fn casts_between_a_floor_and_a_ceiling_pass_the_seams_of_both() {
    let mut rng = Rng::new(2);
    for case in 0..sweep::size(4000, 400) {
        let mut world = World::default();
        floor(case % 2 == 0, Angle::ZERO, &mut world);
        let gap = rng.range(fx!(-0.001), fx!(0.0006));
        for i in -20..20 {
            let place = at(Fx::from_num(i) / 2 + fx!(0.1), fx!(1.25) + gap);
            let tile = ShapeDef::new(Polygon::rectangle(fx!(0.25), fx!(0.25)).expect("valid"));
            world.spawn(&BodyDef::fixed().position(place), &[tile]).expect("valid");
        }
        let start = at(rng.range(fx!(-3), fx!(3)), fx!(0.5) + gap / 2);
        let probe = Probe::new(Polygon::square(fx!(0.5)).expect("valid"), start).expect("valid");
        let way = at(if case % 4 < 2 { fx!(4) } else { fx!(-4) }, fx!(0));
        assert_eq!(world.cast_shape(&probe, way, QueryFilter::default()), None, "{case}: {gap}");
        assert_eq!(world.cast_turning(&probe, way, fx!(0), QueryFilter::default()), None, "{case}: {gap}");

        let side = if way.x > 0 { fx!(1) } else { fx!(-1) };
        let ledge = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.502)).expect("valid"));
        let place = at(fx_mul(fx!(8.5), side), fx!(-0.5));
        world.spawn(&BodyDef::fixed().position(place), &[ledge]).expect("valid");
        let hit = world.cast_shape(&probe, way.scale(fx!(3)), QueryFilter::default()).expect("a ledge");
        let away = fx!(8) - fx_mul(start.x + hit.travelled.x, side);
        assert!(away > fx!(0.5) && away < fx!(0.501), "{case}: {gap} {hit:?}");
    }
}

/// If a cast first pushed the shape out of the floor or the ceiling, it would start up to 1 cm farther from the ramp.
#[test]
fn casts_between_a_floor_and_a_ceiling_stop_at_ramps_at_their_ends() {
    for upside_down in [false, true] {
        let up = if upside_down { fx!(-1) } else { fx!(1) };
        for sunk in [fx!(0), fx!(0.002), fx!(0.01)] {
            let mut world = World::default();
            let slab = ShapeDef::new(Polygon::rectangle(fx!(9), fx!(0.5)).expect("valid"));
            for y in [fx!(-1) + sunk, fx!(1) - sunk] {
                world.spawn(&BodyDef::fixed().position((fx!(0), y)), &[slab]).expect("valid");
            }
            let ramp = [at(fx!(2), fx!(-0.5)), at(fx!(4), fx!(-0.5)), at(fx!(4), fx!(1.5))];
            let ramp = ramp.map(|corner| at(corner.x, fx_mul(corner.y, up)));
            let ramp = ShapeDef::new(Polygon::hull(&ramp).expect("valid"));
            world.spawn(&BodyDef::fixed(), &[ramp]).expect("valid");
            let probe = Probe::new(Polygon::square(fx!(0.5)).expect("valid"), Vec2::ZERO).expect("valid");
            let filter = QueryFilter::default();
            let hit = world.cast_shape(&probe, at(fx!(3), fx!(0)), filter).expect("the ramp");
            assert!((hit.travelled.x - fx!(1.5)).abs() < fx!(0.001), "{hit:?}");
            for beyond in [fx!(0.0005), fx!(0.003)] {
                let way = at(hit.travelled.x + beyond, fx!(0));
                assert!(world.cast_shape(&probe, way, filter).is_some(), "{sunk} {beyond} {upside_down}");
                assert!(world.cast_turning(&probe, way, fx!(0), filter).is_some(), "{sunk} {beyond}");
            }
        }
    }
}

/// The boxes of a sleeping pile are tilted by microradians.
#[test]
fn casts_of_the_boxes_of_a_pile_pass_the_boxes_above_and_below() {
    let mut world = World::default();
    floor(false, Angle::ZERO, &mut world);
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
    let boxes: Vec<_> = (0..10)
        .map(|row| {
            let place = at(fx!(-2), Fx::from_num(row) + fx!(0.5));
            world.spawn(&BodyDef::dynamic().position(place), &[square]).expect("valid")
        })
        .collect();
    (0..600).for_each(|_| world.step());
    for &body in &boxes {
        assert!(world.body(body).expect("there").is_asleep());
        let probe = world.probe_of(world.shapes_of(body)[0]).expect("there");
        let filter = QueryFilter::default().except(body);
        for to in [fx!(-4), fx!(4)] {
            assert_eq!(world.cast_shape(&probe, at(to, fx!(0)), filter), None, "{body:?}");
            assert_eq!(world.cast_turning(&probe, at(to, fx!(0)), fx!(0), filter), None, "{body:?}");
        }
    }
}

#[test]
fn a_cast_says_when_it_starts_inside_or_ignores_it() {
    let mut world = World::default();
    let mut add = |x: Fx, half: Fx| {
        let wall = ShapeDef::new(Polygon::square(half).expect("valid"));
        world.spawn(&BodyDef::fixed().position((x, fx!(0))), &[wall]).expect("valid")
    };
    let (near, far) = (add(fx!(0), fx!(1)), add(fx!(6), fx!(1)));
    let shape = |body| world.body(body).expect("there").shapes()[0];
    let (near, far) = (shape(near), shape(far));
    let filter = |overlap| QueryFilter::default().initial_overlap(overlap);
    let (resist, report, ignore) =
        (filter(InitialOverlap::Resist), filter(InitialOverlap::Report), filter(InitialOverlap::Ignore));
    let probe = Probe::new(Geometry::circle(fx!(0.5)).expect("valid"), at(fx!(1.2), fx!(0))).expect("valid");
    let way = at(fx!(8), fx!(0));
    for turns in [fx!(0), fx!(1.5)] {
        let cast = |way, filter| match turns == 0 {
            true => world.cast_shape(&probe, way, filter),
            false => world.cast_turning(&probe, way, turns, filter),
        };
        // The cast leaves the near wall, and stops at the far wall.
        let hit = cast(way, resist).expect("the far wall");
        assert!(hit.shape == far && !hit.starts_inside && (hit.travelled.x - fx!(3.3)).abs() < fx!(0.0002));
        let hit = cast(way, report).expect("the near wall");
        assert!(hit.shape == near && hit.starts_inside && hit.fraction == 0 && hit.normal.x == 1);
        assert_eq!(cast(way, ignore).expect("the far wall").shape, far);
        // This cast goes deeper into the near wall, so it stops at once.
        let hit = cast(-way, resist).expect("the near wall");
        assert!(hit.shape == near && hit.travelled.length() < fx!(0.0002), "{hit:?}");
        assert_eq!(cast(-way, ignore), None);
    }
    let origin = at(fx!(0.5), fx!(0));
    for filter in [resist, report] {
        let hit = world.cast_ray(origin, way, filter).expect("inside");
        assert!(hit.shape == near && hit.starts_inside && hit.fraction == 0);
        assert_eq!(world.cast_ray_all(origin, way, filter).len(), 2);
    }
    let hit = world.cast_ray(origin, way, ignore).expect("the far wall");
    assert!(hit.shape == far && !hit.starts_inside);
    assert!(!world.cast_ray_any(origin, -way, ignore));
}

#[test]
fn queries_leave_out_several_bodies() {
    let mut world = World::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
    let bodies: Vec<_> = (0..10)
        .map(|i| {
            world.spawn(&BodyDef::fixed().position((Fx::from_num(i) * 2, fx!(0))), &[ball]).expect("valid")
        })
        .collect();
    let seen = |filter| world.cast_ray_all(at(fx!(-2), fx!(0)), at(fx!(30), fx!(0)), filter).len();
    for count in 0..=8 {
        let filter = QueryFilter::default().except_all(&bodies[..count]).expect("at most 8");
        assert_eq!((seen(filter), seen(filter.except(bodies[9]))), (10 - count, 9 - count));
    }
    assert_eq!(QueryFilter::default().except_all(&bodies[..9]), None);
}

/// A random shape that is not centred on its position.
pub(crate) fn random_geometry(rng: &mut Rng) -> Geometry {
    loop {
        let mut vector = || at(rng.range(fx!(-1), fx!(1)), rng.range(fx!(-1), fx!(1)));
        let points: Vec<_> = (0..7).map(|_| vector()).collect();
        let radius = rng.range(fx!(0.02), fx!(0.4));
        let geometry = match rng.below(5) {
            0 => Geometry::circle(radius).ok(),
            1 => Geometry::segment(points[0], points[1]).ok(),
            2 => Geometry::capsule(points[0], points[1], radius).ok(),
            3 => Polygon::hull(&points).ok().map(Geometry::from),
            _ => Polygon::hull(&points[..3]).and_then(|hull| hull.rounded(radius)).ok().map(Geometry::from),
        };
        if let Some(geometry) = geometry {
            return geometry;
        }
    }
}

/// The cast is compared with many small steps: no step touches a shape before the hit.
#[test]
fn a_turning_cast_stops_at_the_first_touch_of_small_steps() {
    let mut rng = Rng::new(5);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..sweep::size(100_000, 2_000) {
        let mut world = World::default();
        for _ in 0..4 {
            let place = (rng.range(fx!(-4), fx!(4)), rng.range(fx!(-4), fx!(4)));
            let shape = ShapeDef::new(random_geometry(&mut rng));
            world.spawn(&BodyDef::fixed().position(place).angle(rng.angle()), &[shape]).expect("valid");
        }
        let place = at(rng.range(fx!(-4), fx!(4)), rng.range(fx!(-4), fx!(4)));
        let angle = rng.angle();
        let probe = Probe::new(random_geometry(&mut rng), place).expect("valid").turned(angle);
        let way = at(rng.range(fx!(-6), fx!(6)), rng.range(fx!(-6), fx!(6)));
        let turns = rng.range(fx!(-2), fx!(2));
        let gap = |fraction: Fx| {
            let turned = Angle::from_turns(fx_mul(turns, fraction));
            let there = probe.at(place + way.scale(fraction)).turned(angle + turned);
            world.shapes().map(|(id, _)| world.probe_distance(&there, id).expect("there").distance).min()
        };
        if gap(fx!(0)).expect("shapes") < fx!(0.0002) {
            continue;
        }
        let hit = world.cast_turning(&probe, way, turns, QueryFilter::default());
        let end = hit.map_or(fx!(1), |hit| hit.fraction);
        for step in 0..=200 {
            let fraction = fx_mul(end, ratio(step, 200));
            let gap = gap(fraction).expect("shapes");
            assert!(gap > fx!(0.000098), "{gap} at {fraction} of {end}: {hit:?} {probe:?} {way:?} {turns}");
        }
        match hit {
            Some(hit) => {
                hits += 1;
                let gap = gap(hit.fraction).expect("shapes");
                assert!(gap < fx!(0.000152), "{gap} {hit:?}");
                assert_eq!(hit.travelled, way.scale(hit.fraction));
                let length = fx_mul(hit.fraction, way.length());
                assert!((along(place, way, length) - place - hit.travelled).length() < fx!(0.00001));
            }
            None => misses += 1,
        }
    }
    assert!(hits > 300 && misses > 100, "{hits} {misses}");
}

/// A time-of-impact search that gives up may report a shape too early. Even so, the first hit must not depend on the
/// order in which the broad phase finds the shapes.
#[test]
fn turning_casts_do_not_depend_on_the_broad_phase() {
    let mut rng = Rng::new(17);
    let (mut hits, mut given_up) = (0, 0);
    for _ in 0..300 {
        let mut world = World::default();
        let distance = [fx!(3), fx!(1000), fx!(1000000000)][rng.below(3) as usize];
        let mut place = |reach: Fx| at(rng.range(-reach, reach), rng.range(fx!(-2), fx!(2)));
        for _ in 0..8 {
            let shape = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
            world.spawn(&BodyDef::fixed().position(place(distance)), &[shape]).expect("in range");
        }
        let start = place(fx!(2));
        let probe =
            Probe::new(Polygon::rectangle(fx!(2), fx!(0.1)).expect("valid"), start).expect("in range");
        let way = at(if rng.below(2) == 0 { distance } else { -distance }, fx!(0));
        let turns = rng.range(fx!(-300), fx!(300));
        let mut answers = [BroadPhaseKind::Tree, BroadPhaseKind::SweepAndPrune, BroadPhaseKind::BruteForce]
            .map(|kind| {
                world.set_broad_phase(kind);
                world.cast_turning(&probe, way, turns, QueryFilter::default())
            });
        assert!(
            answers.windows(2).all(|pair| pair[0] == pair[1]),
            "{turns} turns along {way:?}: {answers:?}"
        );
        hits += answers.iter_mut().filter_map(|answer| answer.take()).count();
        given_up += u32::from(turns.abs() > fx!(160));
    }
    assert!(hits > 300 && given_up > 50, "{hits} hits, {given_up} given up");
}

#[test]
fn a_cast_from_within_a_shape_starts_inside_with_and_without_a_turn() {
    let mut world = World::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
    world.spawn(&BodyDef::fixed().position((fx!(4), fx!(0))), &[ball]).expect("valid");
    let probe = Probe::new(Geometry::circle(fx!(1)).expect("valid"), at(fx!(5), fx!(0))).expect("valid");
    for initial_overlap in [InitialOverlap::Report, InitialOverlap::Resist] {
        let filter = QueryFilter::default().initial_overlap(initial_overlap);
        let way = at(fx!(-1), fx!(0));
        let straight = world.cast_shape(&probe, way, filter).expect("the ball");
        let turning = world.cast_turning(&probe, way, fx!(0.1), filter).expect("the ball");
        assert!(straight.starts_inside && turning.starts_inside, "{straight:?} {turning:?}");
    }
}

/// A one-sided chain forms a roof with a vertical lip at one end. Queries from below pass through the roof, even if
/// they start on the solid side of the line through the lip.
#[test]
fn queries_from_below_a_convex_corner_pass_through_the_roof() {
    for points in [
        &[at(fx!(0), fx!(-1)), at(fx!(0), fx!(0)), at(fx!(-10), fx!(0))][..],
        &[at(fx!(100), fx!(-3)), at(fx!(0), fx!(-3)), at(fx!(0), fx!(0)), at(fx!(-10), fx!(0))],
        &[at(fx!(10), fx!(0)), at(fx!(0), fx!(0)), at(fx!(0), fx!(-1))],
    ] {
        let mut world = World::default();
        let links = Chain::new(points).one_sided().links().expect("valid");
        world.spawn(&BodyDef::fixed(), &links).expect("valid");
        let mirrored = if points.last().is_some_and(|last| last.x == 0) { -1 } else { 1 };
        let (from, way) = (at(fx!(5) * mirrored, fx!(-10)), at(fx!(-10) * mirrored, fx!(12)));
        let filter = QueryFilter::default();
        assert_eq!(world.cast_ray(from, way, filter), None, "{points:?}");
        assert_eq!(world.cast_ray_all(from, way, filter), [], "{points:?}");
        let ball = Probe::new(Geometry::circle(fx!(0.1)).expect("valid"), from).expect("valid");
        assert_eq!(world.cast_shape(&ball, way, filter), None, "{points:?}");
        assert_eq!(world.cast_turning(&ball, way, fx!(0.1), filter), None, "{points:?}");
        // From above and from beside, roof and lip are solid.
        let above = at(fx!(5) * mirrored, fx!(10));
        assert!(world.cast_ray(above, at(fx!(-10) * mirrored, fx!(-12)), filter).is_some(), "{points:?}");
        let beside = at(fx!(5) * mirrored, fx!(-0.5));
        assert!(world.cast_ray(beside, at(fx!(-10) * mirrored, fx!(0)), filter).is_some(), "{points:?}");
    }
}
