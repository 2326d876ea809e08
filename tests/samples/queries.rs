//! Samples of Box2D's groups "Collision" and "Character", and its benchmarks of queries.

use lockstep2d::body::{BodyDef, Chain, Geometry, JointId, Polygon, ShapeId};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::solver::{Distance, JointDef};
use lockstep2d::world::{
    Displacement, Mover, MoverState, Probe, QueryFilter, TimeOfImpact, World, clip_velocity, solve_planes,
};

use super::{Stage, ball, capsule, degrees, hull, near, num, rect, square};

fn probe(geometry: impl Into<Geometry>, place: Vec2<Fx>) -> Probe {
    Probe::new(geometry, place).expect("a valid probe")
}

fn block(half: Fx, place: Vec2<Fx>) -> Probe {
    probe(Polygon::square(half).expect("valid"), place)
}

fn disc(radius: Fx, place: Vec2<Fx>) -> Probe {
    probe(Geometry::circle(radius).expect("valid"), place)
}

/// Sample "Shape Distance" and its benchmark.
#[test]
fn distances_of_loose_shapes() {
    let triangle = Polygon::new(&[at!(-0.5, 0), at!(0.5, 0), at!(0, 1)]).expect("valid");
    let block = block(fx!(0.5), at!(0, 0));
    // The base of the triangle is 1.5 m above the block.
    let found = probe(triangle, at!(0, 2)).distance(&block);
    near(found.distance, fx!(1.5), fx!(0.000001));
    near(found.point_a.y - found.point_b.y, fx!(1.5), fx!(0.000001));
    // The nearest core corners are (0.5, 0.5) and (1.5, 1.5). The radius of 0.2 reduces their distance.
    let rounded = Polygon::square(fx!(0.5)).and_then(|core| core.rounded(fx!(0.2))).expect("valid");
    near(probe(rounded, at!(2, 2)).distance(&block).distance, fx!(1.21421356), fx!(0.000001));
    // A corner points down: the distance is 2 - 0.70711 - 0.5.
    let square = Polygon::square(fx!(0.5)).expect("valid");
    near(
        probe(square, at!(0, 2)).turned(degrees(45)).distance(&block).distance,
        fx!(0.79289322),
        fx!(0.000001),
    );
    assert!(probe(square, at!(0.5, 0)).overlaps(&block));
}

/// Sample "Ray Cast".
#[test]
fn rays_meet_single_shapes() {
    let triangle = Polygon::new(&[at!(-2, 0), at!(2, 0), at!(2, 3)]).expect("valid");
    let end = at!(1, 0);
    let cases: [(Geometry, Fx, Vec2<Fx>); 5] = [
        (Geometry::circle(fx!(2)).expect("valid"), fx!(2), at!(0, 1)),
        (Geometry::capsule(-end, end, fx!(0.5)).expect("valid"), fx!(0.5), at!(0, 1)),
        (Polygon::square(fx!(2)).expect("valid").into(), fx!(2), at!(0, 1)),
        // The upper side goes from (-2, 0) to (2, 3).
        (triangle.into(), fx!(1.5), at!(-0.6, 0.8)),
        (Geometry::segment(at!(-2, 0), at!(2, 0)).expect("valid"), fx!(0), at!(0, 1)),
    ];
    for (geometry, top, normal) in cases {
        let shape = probe(geometry, at!(5, 5));
        let hit = shape.cast_ray(at!(5, 10), at!(0, -10)).expect("a hit");
        near(hit.point.y, fx!(5) + top, fx!(0.000001));
        near(hit.fraction, (fx!(5) - top) / 10, fx!(0.000001));
        assert!(hit.normal.widen().distance(normal) < fx!(0.000001), "{:?}", hit.normal);
        assert!(
            shape.cast_ray(at!(5, 10), at!(0, 10)).is_none()
                && shape.cast_ray(at!(9, 10), at!(0, -10)).is_none()
        );
    }
}

/// Blocks in a row along the x axis, at 0, 2, 4, ...
fn row(count: i32) -> (Stage, Vec<ShapeId>) {
    let mut stage = Stage::new();
    let bodies: Vec<_> =
        (0..count).map(|i| stage.fixed(Vec2::new(num(2 * i), fx!(0)), square(fx!(0.5)))).collect();
    let shapes = bodies.iter().map(|&id| stage.shape(id)).collect();
    (stage, shapes)
}

/// Sample "Cast World", and the benchmark "Cast".
#[test]
fn casts_through_a_world() {
    let (stage, shapes) = row(10);
    let (from, way, all) = (at!(-3, 0), at!(30, 0), QueryFilter::default());
    let closest = stage.world.cast_ray(from, way, all).expect("a hit");
    assert_eq!((closest.shape, closest.point), (shapes[0], at!(-0.5, 0)));
    assert!(stage.world.cast_ray_any(from, way, all));
    assert!(!stage.world.cast_ray_any(at!(-3, 1), way, all));
    let hits = stage.world.cast_ray_all(from, way, all);
    assert_eq!(hits.iter().map(|hit| hit.shape).collect::<Vec<_>>(), shapes);
    // The first three hits are those of the sample's mode "multiple".
    assert!(hits.iter().take(3).zip(0..).all(|(hit, i)| hit.point.x == num(2 * i) - fx!(0.5)));
    let first = stage.world.shape(shapes[0]).expect("there").body();
    let others = QueryFilter::default().except(first);
    assert_eq!(stage.world.cast_ray(from, way, others).map(|hit| hit.shape), Some(shapes[1]));
    let end = at!(0.5, 0);
    let casts: [(Geometry, Fx); 3] = [
        (Geometry::circle(fx!(0.3)).expect("valid"), fx!(0.3)),
        (Geometry::capsule(-end, end, fx!(0.25)).expect("valid"), fx!(0.75)),
        (Polygon::rectangle(fx!(0.125), fx!(0.25)).expect("valid").into(), fx!(0.125)),
    ];
    for (geometry, front) in casts {
        let hit = stage.world.cast_shape(&probe(geometry, from), way, all).expect("a hit");
        assert_eq!(hit.shape, shapes[0]);
        near(hit.travelled.x, fx!(2.5) - front, fx!(0.001));
    }
}

/// Sample "Overlap World".
#[test]
fn overlaps_of_a_world() {
    let (stage, shapes) = row(10);
    let all = QueryFilter::default();
    let plank = probe(Polygon::rectangle(fx!(2), fx!(0.4)).expect("valid"), at!(7, 0));
    assert_eq!(stage.world.overlap_shape(&plank, all), shapes[3..5]);
    // Upright, the plank reaches neither shape.
    assert_eq!(stage.world.overlap_shape(&plank.turned(degrees(90)), all), []);
    assert_eq!(stage.world.overlap_shape(&disc(fx!(1), at!(4, 1.2)), all), shapes[2..3]);
    assert_eq!(stage.world.overlap_point(at!(6.4, 0.4), all), shapes[3..4]);
    let skipped = QueryFilter::default().except(stage.world.shape(shapes[3]).expect("there").body());
    assert_eq!(stage.world.overlap_shape(&plank, skipped), shapes[4..5]);
}

/// Sample "Manifold".
#[test]
fn manifolds_of_loose_shapes() {
    let pill = |place| {
        let end = at!(0.5, 0);
        probe(Geometry::capsule(-end, end, fx!(0.25)).expect("valid"), place)
    };
    let segment = probe(Geometry::segment(at!(-0.5, 0), at!(0.5, 0)).expect("valid"), at!(0, 0));
    let rounded = Polygon::square(fx!(0.4)).and_then(|core| core.rounded(fx!(0.1))).expect("valid");
    let wedge = Polygon::new(&[at!(-0.1, -0.5), at!(0.1, -0.5), at!(0, 0.5)]).expect("valid");
    // Name, shape A, shape B and number of contact points. In each case, B lies on A.
    let cases = [
        ("ball, ball", disc(fx!(0.5), at!(0, 0)), disc(fx!(0.5), at!(0, 1)), 1),
        ("capsule, ball", pill(at!(0, 0)), disc(fx!(0.5), at!(0, 0.75)), 1),
        ("segment, ball", segment, disc(fx!(0.5), at!(0, 0.5)), 1),
        ("box, ball", block(fx!(0.5), at!(0, 0)), disc(fx!(0.5), at!(0, 1)), 1),
        ("capsule, capsule", pill(at!(0, 0)), pill(at!(0, 0.5)), 2),
        ("box, capsule", block(fx!(0.5), at!(0, 0)), pill(at!(0, 0.75)), 2),
        ("segment, capsule", segment, pill(at!(0, 0.25)), 2),
        ("box, box", block(fx!(0.5), at!(0, 0)), block(fx!(0.5), at!(0, 1)), 2),
        ("box, rounded box", block(fx!(0.5), at!(0, 0)), probe(rounded, at!(0, 1)), 2),
        ("rounded boxes", probe(rounded, at!(0, 0)), probe(rounded, at!(0, 1)), 2),
        ("segment, rounded box", segment, probe(rounded, at!(0, 0.5)), 2),
        ("box, wedge", block(fx!(0.5), at!(0, 0)), probe(wedge, at!(0, 1)), 2),
    ];
    for (name, a, b, points) in cases {
        let manifold = a.manifold(&b, fx!(0.02));
        assert_eq!(manifold.points().len(), points, "{name}");
        assert!(manifold.normal.widen().distance(at!(0, 1)) < fx!(0.0001), "{name}: {:?}", manifold.normal);
        for point in manifold.points() {
            near(point.separation.into(), fx!(0), fx!(0.0001));
        }
        let apart = b.at(b.position() + at!(0, 0.05));
        assert_eq!(a.manifold(&apart, fx!(0.02)).points().len(), 0, "{name}");
    }
}

/// Sample "Smooth Manifold".
#[test]
fn links_have_no_sideways_normals() {
    let points: Vec<_> = (0..9).map(|i| Vec2::new(num(2 * i - 8), Fx::ZERO)).collect();
    let links = Chain::new(&points).links().expect("valid");
    for step in 0..80 {
        let body = block(fx!(0.5), Vec2::new(num(step) / 10 - fx!(4), fx!(0.49)));
        for link in &links {
            let link = probe(link.geometry, Vec2::ZERO);
            let manifold = link.manifold(&body, fx!(0.02));
            if !manifold.points().is_empty() {
                assert!(manifold.normal.widen().x.abs() < fx!(0.0001), "{:?}", manifold.normal);
            }
        }
    }
}

/// Samples "Shape Cast" and "Time of Impact".
#[test]
fn casts_and_times_of_impact_of_loose_shapes() {
    let target = block(fx!(0.5), at!(5, 0));
    let hit = disc(fx!(0.5), at!(0, 0)).cast(at!(10, 0), &target).expect("a hit");
    near(hit.fraction, fx!(0.4), fx!(0.0001));
    near(hit.point.x, fx!(4.5), fx!(0.001));
    assert!(disc(fx!(0.5), at!(0, 0)).cast(at!(10, 5), &target).is_none());
    let moved = |translation| Displacement { translation, turns: fx!(0) };
    let body = block(fx!(0.5), at!(0, 0));
    // The shapes approach each other by 10 m, with a gap of 4 m.
    let TimeOfImpact::Hit { fraction } = body.time_of_impact(moved(at!(5, 0)), &target, moved(at!(-5, 0)))
    else {
        panic!("expected a hit");
    };
    near(fraction, fx!(0.4), fx!(0.0001));
    assert_eq!(body.time_of_impact(moved(at!(-5, 0)), &target, moved(at!(5, 0))), TimeOfImpact::Separated);
    // A plank of 5 m by 2 cm turns clockwise about its middle. Its corner hits a wall 2 m away: asin(2 / 2.5) -
    // atan(0.01 / 2.5) = 0.1469 turns.
    let plank = probe(Polygon::rectangle(fx!(0.01), fx!(2.5)).expect("valid"), at!(0, 0));
    let wall = probe(Polygon::rectangle(fx!(1), fx!(9)).expect("valid"), at!(3, 0));
    let turn = Displacement { translation: Vec2::ZERO, turns: fx!(-0.25) };
    let TimeOfImpact::Hit { fraction } = plank.time_of_impact(turn, &wall, Displacement::default()) else {
        panic!("expected a hit");
    };
    near(fraction, fx!(0.5878), fx!(0.0005));
}

/// Benchmarks "Cast" and "Sensor". Casts agree with a linear search, and a sweeping sensor reports each begin once.
#[test]
fn casts_among_many_boxes_agree_with_a_walk_over_all() {
    let mut stage = Stage::new();
    let mut rng = Rng::new(3);
    let mut shapes = Vec::new();
    for _ in 0..2000 {
        let place = Vec2::new(rng.range(fx!(-50), fx!(50)), rng.range(fx!(-50), fx!(50)));
        let body =
            stage.spawn(BodyDef::fixed().position(place).angle(rng.angle()), &[rect(fx!(0.1), fx!(0.3))]);
        shapes.push(stage.shape(body));
    }
    for _ in 0..100 {
        let mut point = || Vec2::new(rng.range(fx!(-60), fx!(60)), rng.range(fx!(-60), fx!(60)));
        let (from, way) = (point(), point());
        let naive = shapes.iter().filter_map(|&id| {
            let hit = stage.world.probe_of(id).expect("there").cast_ray(from, way)?;
            Some((hit.fraction, id))
        });
        let found = stage.world.cast_ray(from, way, QueryFilter::default());
        assert_eq!(found.map(|hit| hit.fraction), naive.min().map(|(fraction, _)| fraction));
    }
    let bar = rect(fx!(50), fx!(0.1)).sensor();
    let sweeper = stage.spawn(BodyDef::kinematic().position(at!(0, -55)).velocity(at!(0, 60)), &[bar]);
    let crossing = stage.add(at!(0, 60), ball(fx!(0.5)));
    let mut seen = 0;
    stage.run_and(120, |stage| seen += stage.world.events().sensor_begin.len());
    assert!(stage.place(sweeper).y > fx!(60) && seen == 2001, "seen {seen}, {:?}", stage.place(crossing));
}

/// Sample "Geometric Mover": planes and clipping, and then `move_character`.
#[test]
fn a_mover_of_planes_walks_to_a_wall() {
    let mut stage = Stage::with_floor();
    stage.fixed(at!(6, 3), rect(fx!(1), fx!(3)));
    stage.fixed(at!(2, 0), hull(&[at!(-1, 0), at!(1, 0), at!(1, 0.5)]));
    let upright = Geometry::capsule(at!(0, -0.5), at!(0, 0.5), fx!(0.3)).expect("valid");
    let (mut place, mut velocity) = (at!(-2, 0.81), Vec2::ZERO);
    for _ in 0..240 {
        velocity = Vec2::new(fx!(4), velocity.y - fx!(10 / 60));
        let mut planes = stage.world.collide_mover(&probe(upright, place), fx!(0.5), QueryFilter::default());
        place += solve_planes(velocity.scale(fx!(1 / 60)), &mut planes);
        velocity = clip_velocity(velocity, &planes);
    }
    near(place.x, fx!(4.7), fx!(0.02));
    near(place.y, fx!(0.8), fx!(0.02));
    let mover = Mover::new(upright).expect("valid").step_height(fx!(0.3)).snap_distance(fx!(0.3));
    let mut state = MoverState::at(at!(-2, 0.81));
    for _ in 0..240 {
        let fall = if state.is_on_ground() { Fx::ZERO } else { state.velocity.y - fx!(10 / 60) };
        state.velocity = Vec2::new(fx!(4), fall);
        state = stage.world.move_character(&mover, &state, QueryFilter::default()).state;
    }
    near(state.position.x, fx!(4.7), fx!(0.02));
    near(state.position.y, fx!(0.8), fx!(0.02));
    assert!(state.is_on_ground());
}

/// Sample "Dynamic Mover". A ray measures the height above the ground, and a spring force carries the body.
#[test]
fn a_body_on_a_spring_leg_keeps_its_height() {
    let mut stage = Stage::with_floor();
    stage.fixed(at!(6, 0), rect(fx!(3), fx!(0.3)));
    let def = BodyDef::dynamic().position(at!(0, 1.5)).lock_rotation().never_sleeps();
    let body = stage.spawn(def, &[capsule(at!(0, -0.3), at!(0, 0.3), fx!(0.3))]);
    let rest = fx!(1.2);
    let height = |world: &World, place: Vec2<Fx>| {
        let filter = QueryFilter::default().except(body);
        world.cast_ray(place, at!(0, -3), filter).map(|hit| hit.fraction * 3)
    };
    for tick in 0..360 {
        let (place, velocity, mass) = (stage.place(body), stage.velocity(body), stage.body(body).mass());
        // The leg is a spring of 5 Hz, critically damped. The body is driven at 1 m/s.
        if let Some(height) = height(&stage.world, place) {
            let lift = (rest - height) * 987 - velocity.y.saturating_mul(fx!(62.8)) + fx!(10);
            let drive = (fx!(1) - velocity.x) * 20;
            let force = Vec2::new(drive, lift).scale(mass);
            stage.world.apply_force_to_centre(body, force).expect("valid");
        }
        stage.run(1);
        let ground = if stage.place(body).x > fx!(3) { fx!(0.3) } else { Fx::ZERO };
        let settled = tick > 90 && (stage.place(body).x - fx!(3)).abs() > fx!(0.5);
        assert!(
            !settled || (stage.place(body).y - ground - rest).abs() < fx!(0.02),
            "{:?}",
            stage.place(body)
        );
    }
    assert!(stage.place(body).x > fx!(5));
}

/// Sample "Dynamic Mover" with its pogo, a spring to the ground that is created again in every tick. The pogo pushes
/// with at most three times the weight, and pulls with at most half of it.
#[test]
fn a_pogo_is_a_spring_to_the_ground() {
    let mut stage = Stage::with_floor();
    stage.fixed(at!(6, 0), rect(fx!(3), fx!(0.3)));
    let def = BodyDef::dynamic().position(at!(0, 1.5)).lock_rotation().never_sleeps();
    let body = stage.spawn(def, &[capsule(at!(0, -0.3), at!(0, 0.3), fx!(0.3))]);
    let weight = stage.body(body).mass() * 10;
    // The weight compresses a spring of 5 Hz by 10 / (10 pi)^2 m.
    let rest = fx!(1.2);
    let spring = Distance::new().spring(fx!(5), fx!(1), rest + fx!(0.01013));
    let pogo = spring.spring_force(-weight / 2, weight * 3);
    let mut leg: Option<JointId> = None;
    for tick in 0..360 {
        if let Some(leg) = leg.take() {
            stage.world.remove_joint(leg).expect("there");
        }
        let (place, velocity) = (stage.place(body), stage.velocity(body));
        let under = stage.world.cast_ray(place, at!(0, -2), QueryFilter::default().except(body));
        if let Some(hit) = under {
            let ground = stage.world.shape(hit.shape).expect("there").body();
            let anchor = hit.point - stage.place(ground);
            leg = Some(stage.join(JointDef::new(ground, body, pogo).anchor_a(anchor)));
        }
        let drive = Vec2::new((fx!(1) - velocity.x) * 20, Fx::ZERO).scale(stage.body(body).mass());
        stage.world.apply_force_to_centre(body, drive).expect("valid");
        stage.run(1);
        let place = stage.place(body);
        let ground = if place.x > fx!(3) { fx!(0.3) } else { Fx::ZERO };
        let settled = tick > 90 && (place.x - fx!(3)).abs() > fx!(0.5);
        assert!(!settled || (place.y - ground - rest).abs() < fx!(0.02), "{tick}: {place:?}");
    }
    assert!(stage.place(body).x > fx!(5));
}
