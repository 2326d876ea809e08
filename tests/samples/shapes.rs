//! Samples of Box2D's group "Shapes": outlines, compounds and filters. `surfaces.rs` has materials, explosions and
//! wind.

use lockstep2d::body::{BodyDef, Chain, Filter, Geometry, Polygon, ShapeDef, Sides};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Vec2};

use super::{Stage, ball, capsule, hull, line, near, num, pill, rect, rounded, square};

/// Points of slopes that end in a level stretch between two walls.
fn valley() -> [Vec2<Fx>; 8] {
    [at!(-20, 30), at!(-20, 12), at!(-14, 8), at!(-7, 3), at!(-1, 0), at!(9, 0), at!(20, 0), at!(20, 30)]
}

/// Sample "Chain Shape".
#[test]
fn things_come_down_a_chain() {
    for shape in [ball(fx!(0.5)), pill(fx!(0.5), fx!(0.25)), square(fx!(0.5))] {
        let mut stage = Stage::new();
        let chain = Chain::new(&valley()).closed().links().expect("valid");
        stage.spawn(BodyDef::fixed(), &chain.iter().map(|link| link.friction(fx!(0.2))).collect::<Vec<_>>());
        let body = stage.add(at!(-18, 12.5), shape.friction(fx!(0.2)));
        let (mut last, allowed) =
            (stage.energy(), fx!(0.02) * stage.body(body).mass().to_num::<i64>().max(1));
        stage.run_and(900, |stage| {
            let energy = stage.energy();
            assert!(energy < last + allowed, "energy rose from {last} to {energy} J");
            last = energy;
            assert!(stage.place(body).y > fx!(0.2), "fell through: {:?}", stage.place(body));
        });
        assert!(stage.place(body).y < fx!(0.6) && stage.place(body).x > fx!(-1), "{:?}", stage.place(body));
    }
}

/// Sample "Chain Segment". Three links are changed while a body is on them.
#[test]
fn links_of_ones_own_are_smooth_and_can_change() {
    let mut stage = Stage::new();
    let point = |i: i32| Vec2::new(num(i) * 2, Fx::ZERO);
    let link = |i: i32| Geometry::Link {
        a: point(i),
        b: point(i + 1),
        before: Some(point(i - 1)),
        after: Some(point(i + 2)),
        sides: Sides::Both,
    };
    let links: Vec<_> = (-10..10).map(|i| ShapeDef::new(link(i)).friction(fx!(0))).collect();
    let ground = stage.spawn(BodyDef::fixed(), &links);
    let body = stage.throw(at!(-18, 0.5), at!(5, 0), square(fx!(0.5)).friction(fx!(0)));
    stage.run_and(120, |stage| {
        near(stage.velocity(body).x, fx!(5), fx!(0.001));
        near(stage.place(body).y, fx!(0.5), fx!(0.01));
    });
    // The body is at -8 m. The links under it are moved away.
    let shapes = stage.world.shapes_of(ground).to_vec();
    for &id in &shapes[5..8] {
        stage
            .world
            .set_geometry(id, Geometry::segment(at!(0, -9), at!(2, -9)).expect("valid"))
            .expect("valid");
    }
    stage.run(30);
    assert!(stage.place(body).y < fx!(0.3), "{:?}", stage.place(body));
}

/// Sample "Compound Shapes".
#[test]
fn compounds_stand_and_bear_an_intruder() {
    let mut stage = Stage::with_floor();
    let leg = |x| rect(fx!(0.5), fx!(1.5)).offset((x, fx!(1.5)));
    let parts = [rect(fx!(3), fx!(0.5)).offset(at!(0, 3.5)), leg(fx!(-2.5)), leg(fx!(2.5))];
    let table = stage.spawn(BodyDef::dynamic().position(at!(-5, 1)), &parts);
    let wing = |side: Fx| hull(&[Vec2::new(side * 2, fx!(0)), at!(0, 1.33333333333), at!(0, 4)]);
    let ship = stage.spawn(BodyDef::dynamic().position(at!(5, 1)), &[wing(fx!(-1)), wing(fx!(1))]);
    // The centroids of the triangles are at the height (0 + 4 / 3 + 4) / 3.
    near(stage.body(ship).local_centre_of_mass().y, fx!(16 / 9), fx!(0.00001));
    near(stage.body(ship).local_centre_of_mass().x, fx!(0), fx!(0.00001));
    // The table has 6 + 3 + 3 m². Its centre is at the height (6 * 3.5 + 6 * 1.5) / 12.
    near(stage.body(table).mass(), fx!(12), fx!(0.00001));
    near(stage.body(table).local_centre_of_mass().y, fx!(2.5), fx!(0.00001));
    stage.run(180);
    near(stage.place(table).y, fx!(0), fx!(0.02));
    near(stage.angle(table), fx!(0), fx!(0.001));
    let place = stage.place(table) + at!(0, 3);
    stage.add(place, rect(fx!(4), fx!(0.1)));
    stage.add(stage.place(ship) + at!(0, 2), ball(fx!(0.5)));
    stage.run_and(300, |stage| assert!(stage.fastest() < fx!(10), "{} m/s", stage.fastest()));
    // The plank stays jammed between top and legs.
    assert!(stage.fastest() < fx!(0.05), "still {} m/s", stage.fastest());
}

/// Sample "Filter".
#[test]
fn filters_change_at_run_time() {
    let mut stage = Stage::with_floor();
    let team = |own: u64, mask: u64| Filter { category: own, mask, group: 0 };
    let player = |filter| rect(fx!(2), fx!(1)).filter(filter);
    let pile: Vec<_> = (0..3)
        .map(|i| stage.add(Vec2::new(Fx::ZERO, num(2 + 3 * i)), player(team(2 << i, u64::MAX))))
        .collect();
    stage.run(240);
    let heights = |stage: &Stage, expected: [Fx; 3]| {
        for (&id, expected) in pile.iter().zip(expected) {
            near(stage.place(id).y, expected, fx!(0.03));
        }
    };
    heights(&stage, [fx!(1), fx!(3), fx!(5)]);
    stage.world.set_filter(stage.shape(pile[0]), team(2, !4)).expect("valid");
    stage.run(240);
    // The second player falls through the first. The third stays on both.
    heights(&stage, [fx!(1), fx!(1), fx!(3)]);
}

/// Sample "Custom Filter".
#[test]
fn odd_and_even_pass_each_other() {
    let mut stage = Stage::with_floor();
    let filter = |i: i32| {
        let own = if i % 2 == 0 { 2 } else { 4 };
        Filter { category: own, mask: own | 1, group: 0 }
    };
    let place = |i: i32| Vec2::new(Fx::ZERO, num(3 * i + 1));
    let pile: Vec<_> = (0..4).map(|i| stage.add(place(i), square(fx!(1)).filter(filter(i)))).collect();
    stage.run(300);
    for (&id, expected) in pile.iter().zip([1, 1, 3, 3]) {
        near(stage.place(id).y, num(expected), fx!(0.03));
    }
}

/// Sample "Modify Geometry".
#[test]
fn a_shape_grows_and_changes_its_kind() {
    let mut stage = Stage::with_floor();
    let load =
        stage.spawn(BodyDef::dynamic().position(at!(0, 4)).lock_rotation().lock_x(), &[square(fx!(1))]);
    let body = stage.spawn(BodyDef::kinematic().position(at!(0, 1)), &[ball(fx!(0.5))]);
    let shape = stage.shape(body);
    let end = at!(1, 0);
    let kinds = [
        (Geometry::circle(fx!(0.5)), fx!(0.5)),
        (Geometry::circle(fx!(1)), fx!(1)),
        (Polygon::rectangle(fx!(0.5), fx!(0.75)).map(Geometry::from), fx!(0.75)),
        (Geometry::capsule(-end, end, fx!(0.3)), fx!(0.3)),
        (Geometry::segment(-end, end), fx!(0)),
    ];
    for (geometry, top) in kinds {
        stage.world.set_geometry(shape, geometry.expect("valid")).expect("valid");
        stage.world.wake(load).expect("valid");
        stage.run(180);
        near(stage.place(load).y, fx!(2) + top, fx!(0.03));
    }
}

/// Sample "Chain Link".
#[test]
fn two_chains_link_up() {
    for shape in [ball(fx!(0.5)), pill(fx!(0.5), fx!(0.5)), square(fx!(0.5))] {
        let mut stage = Stage::new();
        let link = |a, b, before, after| {
            let geometry = Geometry::Link { a, b, before, after, sides: Sides::Both };
            ShapeDef::new(geometry).friction(fx!(0))
        };
        let (a, b, c) = (at!(-40, 0), at!(0, 0), at!(40, 0));
        stage.fixed(Vec2::ZERO, link(a, b, None, Some(c)));
        stage.fixed(Vec2::ZERO, link(b, c, Some(a), None));
        let body = stage.throw(at!(-5, 0.5), at!(6, 0), shape.friction(fx!(0)));
        stage.run_and(120, |stage| {
            near(stage.place(body).y, fx!(0.5), fx!(0.01));
            near(stage.velocity(body).x, fx!(6), fx!(0.001));
        });
        assert!(stage.place(body).x > fx!(5));
    }
}

/// Sample "Rounded".
#[test]
fn a_heap_of_rounded_polygons_rests() {
    let mut stage = trough();
    let mut rng = Rng::new(5);
    for i in 0..40 {
        let points: Vec<_> = (0..7)
            .map(|_| Vec2::new(rng.range(fx!(-0.5), fx!(0.5)), rng.range(fx!(-0.5), fx!(0.5))))
            .collect();
        let radius = rng.range(fx!(0.05), fx!(0.25));
        let polygon = Polygon::hull(&points).and_then(|core| core.rounded(radius)).expect("valid");
        let shape = ShapeDef::new(polygon).rolling_resistance(fx!(0.3));
        stage.add(Vec2::new(num(i % 5) * 3 / 2 - fx!(3), num(2 + i / 5) * 3 / 2), shape);
    }
    rests_in_the_trough(&mut stage);
}

/// Sample "Ellipse": thin hexagons with a large radius.
#[test]
fn a_heap_of_ellipses_rests() {
    let mut stage = trough();
    let points = [
        at!(0, -0.25),
        at!(0, 0.25),
        at!(0.05, 0.075),
        at!(-0.05, 0.075),
        at!(0.05, -0.075),
        at!(-0.05, -0.075),
    ];
    let ellipse = Polygon::hull(&points).and_then(|core| core.rounded(fx!(0.2))).expect("valid");
    let shape = ShapeDef::new(ellipse).rolling_resistance(fx!(0.2));
    for i in 0..40 {
        stage.add(Vec2::new(num(i % 8) - fx!(3.5), num(2 + i / 8)), shape);
    }
    rests_in_the_trough(&mut stage);
}

/// A trough 10 m wide.
fn trough() -> Stage {
    let mut stage = Stage::with_floor();
    stage.fixed(at!(-6, 10), rect(fx!(1), fx!(10)));
    stage.fixed(at!(6, 10), rect(fx!(1), fx!(10)));
    stage
}

fn rests_in_the_trough(stage: &mut Stage) {
    stage.run(900);
    assert!(stage.fastest() < fx!(0.1), "still {} m/s", stage.fastest());
    assert!(stage.world.deepest_overlap() < fx!(0.05), "{} m deep", stage.world.deepest_overlap());
    for (_, body) in stage.world.bodies().filter(|(_, body)| body.is_dynamic()) {
        assert!(body.position().x.abs() < fx!(5) && body.position().y > fx!(0), "{:?}", body.position());
    }
}

/// Sample "Offset".
#[test]
fn shapes_far_from_their_origins_stack() {
    let mut stage = Stage::new();
    stage.fixed(at!(-1, 1), square(fx!(1)).offset(at!(10, -2)));
    let pill = stage.add(at!(13.5, -0.75), capsule(at!(-5, 1), at!(-4, 1), fx!(0.25)));
    let plank =
        Polygon::rectangle(fx!(0.75), fx!(0.5)).and_then(|plank| plank.rotated(Angle::from_degrees(fx!(90))));
    let upper = stage.add(Vec2::ZERO, ShapeDef::new(plank.expect("valid")).offset(at!(9, 2)));
    assert_eq!(stage.body(upper).centre_of_mass(), at!(9, 2));
    stage.run(300);
    // The centres of all shapes are on x = 9.
    near(stage.body(pill).centre_of_mass().y, fx!(0.25), fx!(0.02));
    near(stage.body(upper).centre_of_mass().y, fx!(1.25), fx!(0.03));
    near(stage.body(upper).centre_of_mass().x, fx!(9), fx!(0.02));
}

/// Sample "Recreate Static".
#[test]
fn a_ground_that_is_replaced_in_every_tick_carries() {
    let mut stage = Stage::new();
    let body = stage.add(at!(0, 1), square(fx!(1)));
    let mut ground = stage.fixed(Vec2::ZERO, line(at!(-10, 0), at!(10, 0)));
    for _ in 0..240 {
        stage.run(1);
        near(stage.place(body).y, fx!(1), fx!(0.02));
        stage.world.despawn(ground).expect("there");
        ground = stage.fixed(Vec2::ZERO, line(at!(-10, 0), at!(10, 0)));
    }
}

/// Sample "Convex Hull" of the group "Geometry".
#[test]
fn a_hull_leaves_out_what_is_inside() {
    let mut rng = Rng::new(11);
    let mut points = vec![at!(-1, -1), at!(1, -1), at!(1, 1), at!(-1, 1)];
    points.extend((0..30).map(|_| Vec2::new(rng.range(fx!(-0.9), fx!(0.9)), rng.range(fx!(-0.9), fx!(0.9)))));
    points.rotate_left(13);
    assert_eq!(Polygon::hull(&points).expect("a square").vertices().len(), 4);
    let corner = |i: i32| Angle::from_turns(num(i) / 9).direction().widen();
    let nine: Vec<_> = (0..9).map(corner).collect();
    assert!(Polygon::hull(&nine).is_err());
    assert!(Polygon::hull(&[at!(0, 0), at!(1, 1), at!(2, 2)]).is_err(), "a hull without area");
    let upright = rounded(fx!(0.5), fx!(0.5), fx!(0.1));
    assert!(matches!(upright.geometry, Geometry::Polygon(polygon) if polygon.vertices().len() == 4));
}
