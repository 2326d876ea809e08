//! Samples of Box2D's groups "World", "Determinism" and "Benchmark". `crates/scenes` has the large benchmarks.

use lockstep2d::body::{BodyDef, BodyId, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Vec2, widen};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{BodyPose, Explosion, QueryFilter, World};

use super::{Stage, ball, capsule, line, near, num, rect, rounded, square};

/// Sample "Tiles".
#[test]
fn tiles_carry() {
    let mut stage = Stage::new();
    for column in 0..40 {
        let height = widen(Angle::from_turns(num(column) / 40).cos()) * 4;
        let tile = |j: i32| rounded(fx!(0.5), fx!(0.5), fx!(0.1)).offset(Vec2::new(Fx::ZERO, num(j)));
        let tiles: Vec<ShapeDef> = (0..height.round().to_num::<i32>() + 12).map(tile).collect();
        stage.spawn(BodyDef::fixed().position(Vec2::new(num(column), Fx::ZERO)), &tiles);
    }
    // The bottom of the valley is in the middle, with tiles up to 7.5 m.
    let place = |i: i32| Vec2::new(fx!(17) + fx!(0.6) * i64::from(i % 10), fx!(10) + num(i / 10) / 2);
    let boxes: Vec<_> = (0..50).map(|i| stage.add(place(i), rect(fx!(0.3), fx!(0.2)))).collect();
    for tick in 0..600 {
        if tick % 60 == 30 && tick < 300 {
            let blast = Explosion { radius: fx!(2), falloff: fx!(0.1), ..Explosion::new(at!(20, 7), fx!(1)) };
            stage.world.explode(&blast).expect("valid");
        }
        stage.run(1);
    }
    let within = |&&id: &&BodyId| {
        stage.place(id).y > fx!(7.6) && stage.place(id).x > fx!(0) && stage.place(id).x < fx!(39)
    };
    assert_eq!(boxes.iter().filter(within).count(), 50);
    assert!(stage.fastest() < fx!(0.1), "still {} m/s", stage.fastest());
}

/// A pyramid and a row of hinged links. Returns final positions relative to `origin`, and angles.
fn heap(origin: Vec2<Fx>) -> Vec<(Vec2<Fx>, Angle)> {
    let mut stage = Stage::new();
    let walls =
        [line(at!(-40, 0), at!(40, 0)), line(at!(-40, 0), at!(-40, 12)), line(at!(40, 0), at!(40, 12))];
    stage.spawn(BodyDef::fixed().position(origin), &walls);
    for row in 0..8 {
        for i in row..8 {
            let place = Vec2::new(num(2 * i - row - 8) / 4, num(2 * row + 1) / 4);
            stage.add(origin + place, square(fx!(0.25)));
        }
    }
    let mut before: Option<BodyId> = None;
    for i in 0..6 {
        let place = origin + Vec2::new(num(i) + fx!(3), fx!(6));
        let link = stage.add(place, capsule(at!(-0.4, 0), at!(0.4, 0), fx!(0.2)));
        if let Some(before) = before {
            let hinge = Revolute::new().limit(fx!(-0.7), fx!(0.7)).spring(fx!(1), fx!(0.5), fx!(0));
            stage.join_at(before, link, hinge, place - at!(0.5, 0));
        }
        before = Some(link);
    }
    stage.run(300);
    let dynamic = stage.world.bodies().filter(|(_, body)| body.is_dynamic());
    dynamic.map(|(_, body)| (body.position() - origin, body.angle())).collect()
}

/// Samples "Far Pyramid" and "Far Ragdolls". Up to a million kilometres from the origin, results agree within 10 µm
/// with those near the origin. Far to the left and below, results are bit-identical to those near the origin. Far to
/// the right and above, results are bit-identical to each other.
#[test]
fn the_world_is_the_same_everywhere() {
    let (here, there) = (heap(Vec2::ZERO), heap(at!(1000, 1000)));
    for origin in [at!(100, 200), at!(-10000000, -20000)] {
        assert_eq!(heap(origin), here, "at {origin:?}");
    }
    for origin in [at!(10000000, 1000), at!(1000000000, 70000)] {
        assert_eq!(heap(origin), there, "at {origin:?}");
    }
    for ((a, _), (b, _)) in here.iter().zip(&there) {
        assert!(a.distance(*b) < fx!(0.00001), "{a:?} and {b:?}");
    }
}

/// Rows of hinged boxes that fall in a heap.
fn falling_hinges() -> World {
    let mut stage = Stage::with_floor();
    for column in 0..2 {
        let mut before: Option<BodyId> = None;
        for row in 0..10 {
            let place = Vec2::new(num(3 * column) + num(row % 2) / 4, num(row) * 3 / 5 + fx!(1));
            let def = BodyDef::dynamic().position(place).angle(Angle::from_radians(num(row) / 10));
            let body = stage.spawn(def, &[rounded(fx!(0.25), fx!(0.25), fx!(0.05)).friction(fx!(0.3))]);
            if let (Some(before), 1) = (before, row % 2) {
                let hinge = Revolute::new().limit(fx!(-0.3), fx!(0.6)).spring(fx!(0.5), fx!(0.5), fx!(0.8));
                stage.join(JointDef::new(before, body, hinge).anchor_a(at!(0.2, 0.3)).anchor_b(at!(0, -0.3)));
            }
            before = Some(body);
        }
    }
    stage.world
}

/// Steps until all bodies sleep, for at most 3000 ticks. Returns the number of ticks and the state hash.
fn until_asleep(world: &mut World) -> (u64, lockstep2d::hash::StateHash) {
    while world.awake_body_count() > 0 && world.tick() < 3000 {
        world.step();
        // Queries must not change later states.
        let _ = world.cast_ray(at!(-10, 2), at!(20, 0), QueryFilter::default());
    }
    assert_eq!(world.awake_body_count(), 0, "expected the heap to fall asleep");
    (world.tick(), world.state_hash())
}

/// Samples "Falling Hinges" and "Rollback".
#[test]
fn falling_hinges_end_alike_from_every_saved_state() {
    let mut world = falling_hinges();
    let mut saved = Vec::new();
    for _ in 0..4 {
        saved.push((world.save(), world.to_bytes()));
        (0..40).for_each(|_| world.step());
    }
    let reference = until_asleep(&mut world);
    assert_eq!(until_asleep(&mut falling_hinges()), reference);
    for (snapshot, bytes) in saved.iter().rev() {
        world.restore(snapshot);
        assert_eq!(until_asleep(&mut world), reference);
        let mut other = World::from_bytes(bytes).expect("its own bytes");
        assert_eq!(until_asleep(&mut other), reference);
    }
}

/// Sample "Barrel".
#[test]
fn a_barrel_holds_what_falls_into_it() {
    let mix = [square(fx!(0.25)), rect(fx!(0.4), fx!(0.1))];
    let compound = [square(fx!(0.2)).offset(at!(-0.2, 0)), square(fx!(0.2)).offset(at!(0.2, 0))];
    let kinds: [&[ShapeDef]; 4] =
        [&[ball(fx!(0.25))], &[capsule(at!(0, -0.2), at!(0, 0.2), fx!(0.15))], &mix[..1], &compound];
    for shapes in kinds {
        let mut stage = Stage::with_floor();
        stage.fixed(at!(-5, 10), rect(fx!(0.5), fx!(10)));
        stage.fixed(at!(5, 10), rect(fx!(0.5), fx!(10)));
        let place = |i: i32| Vec2::new(num(i % 10) * 4 / 5 - fx!(3.6), num(i / 10) * 4 / 5 + fx!(0.6));
        let poses: Vec<_> = (0..100)
            .map(|i| BodyPose { position: place(i), angle: Angle::from_radians(num(i % 3) / 10) })
            .collect();
        let bodies = stage.world.spawn_each(&BodyDef::dynamic(), shapes, &poses).expect("valid");
        assert_eq!(bodies.len(), 100);
        stage.run(200);
        for (_, body) in stage.world.bodies().filter(|(_, body)| body.is_dynamic()) {
            assert!(
                body.position().x.abs() < fx!(4.6) && body.position().y > fx!(0),
                "{:?}",
                body.position()
            );
        }
    }
}

/// Sample "Many Tumblers".
#[test]
fn tumblers_lose_nothing() {
    let mut stage = Stage::new();
    let walls = [
        rect(fx!(0.25), fx!(2)).offset(at!(2, 0)),
        rect(fx!(0.25), fx!(2)).offset(at!(-2, 0)),
        rect(fx!(2), fx!(0.25)).offset(at!(0, 2)),
        rect(fx!(2), fx!(0.25)).offset(at!(0, -2)),
    ];
    let mut inside = Vec::new();
    for i in 0..4 {
        let centre = Vec2::new(num(8 * i), Fx::ZERO);
        stage.spawn(BodyDef::kinematic().position(centre).angular_velocity(fx!(0.436)), &walls);
        for j in 0..16 {
            let place = centre + Vec2::new(num(j % 4) / 2 - fx!(0.75), num(j / 4) / 2 - fx!(0.75));
            inside.push((stage.add(place, rect(fx!(0.125), fx!(0.125))), centre));
        }
    }
    stage.run_and(900, |stage| {
        assert!(inside.iter().all(|&(id, centre)| stage.place(id).distance(centre) < fx!(2.6)));
    });
}

/// Sample "CreateDestroy".
#[test]
fn what_is_removed_leaves_nothing() {
    let mut stage = Stage::with_floor();
    for _ in 0..10 {
        let pose =
            |i: i32| BodyPose { position: Vec2::new(num(i % 8), num(i / 8) + fx!(0.5)), angle: Angle::ZERO };
        let poses: Vec<_> = (0..40).map(pose).collect();
        let bodies = stage.world.spawn_each(&BodyDef::dynamic(), &[square(fx!(0.5))], &poses).expect("valid");
        stage.run(5);
        assert!(stage.world.contacts().count() >= 40);
        bodies.into_iter().for_each(|id| stage.world.despawn(id).expect("there"));
        stage.run(1);
        assert_eq!(
            (stage.world.body_count(), stage.world.shape_count(), stage.world.contacts().count()),
            (1, 1, 0)
        );
    }
}

/// Benchmark samples "Sleep" and "Kinematic".
#[test]
fn a_pyramid_is_woken_as_a_whole() {
    let mut stage = Stage::with_floor();
    let mut boxes = Vec::new();
    for row in 0..8 {
        for i in 0..8 - row {
            boxes.push(stage.add(Vec2::new(num(2 * i + row), num(2 * row + 1)), square(fx!(0.99))));
        }
    }
    stage.run(400);
    assert_eq!(stage.world.awake_body_count(), 0);
    stage.world.wake(boxes[0]).expect("there");
    assert_eq!(stage.world.awake_body_count(), boxes.len());
    stage.run(200);
    assert_eq!(stage.world.awake_body_count(), 0);

    let mut stage = Stage::new();
    let grid: Vec<_> = (0..400)
        .map(|i| square(fx!(0.1)).offset(Vec2::new(num(i % 20 - 10) / 4, num(i / 20 - 10) / 4)))
        .collect();
    let body = stage.spawn(BodyDef::kinematic().angular_velocity(fx!(1)), &grid);
    stage.run(60);
    near(stage.angle(body), fx!(1), fx!(0.0001));
}

/// Sample "Capacity".
#[test]
fn the_world_grows() {
    let mut stage = Stage::with_floor();
    let mut rng = Rng::new(9);
    for round in 0..20 {
        for i in 0..50 {
            let x = num(i * 2 - 50) + rng.range(fx!(-0.1), fx!(0.1));
            stage.add(Vec2::new(x, num(2 * round + 2)), square(fx!(0.5)));
        }
        stage.run(2);
    }
    assert_eq!((stage.world.body_count(), stage.world.stats().bodies), (1001, 1000));
}
