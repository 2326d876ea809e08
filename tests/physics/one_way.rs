//! One-way platforms: solid from above, passable from below.

use lockstep2d::body::{BodyDef, BodyId, Chain, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::World;

fn up() -> Angle {
    Angle::from_degrees(fx!(90))
}

/// One-way platforms with their tops at height 0.
fn platforms() -> [ShapeDef; 3] {
    let slab =
        |half: Fx| ShapeDef::new(Polygon::rectangle(fx!(4), half).expect("valid")).offset((fx!(0), -half));
    let end = Vec2::new(fx!(4), fx!(0));
    let line = ShapeDef::new(Geometry::segment(-end, end).expect("valid"));
    [slab(fx!(0.1)), slab(fx!(0.6)), line].map(|shape| shape.one_way(up()))
}

fn movers() -> [(&'static str, ShapeDef); 3] {
    let end = Vec2::new(fx!(0), fx!(0.25));
    [
        ("ball", ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"))),
        ("box", ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"))),
        ("pill", ShapeDef::new(Geometry::capsule(-end, end, fx!(0.25)).expect("valid"))),
    ]
}

fn spawn(world: &mut World, shape: ShapeDef, y: Fx, speed: Fx) -> BodyId {
    world
        .spawn(&BodyDef::dynamic().position((fx!(0.3), y)).velocity((fx!(0), speed)), &[shape])
        .expect("valid")
}

fn height(world: &World, body: BodyId) -> Fx {
    world.body(body).expect("there").position().y
}

/// Bodies start 3 m below the top of the platform. At 10 m/s, which suffices for a rise of 5 m, and at 30 m/s they jump
/// through and land. At lower speeds they turn round half-way and fall back.
#[test]
fn what_jumps_through_lands_and_what_turns_round_half_way_falls_back() {
    for platform in platforms() {
        for (name, shape) in movers() {
            // A body at 7.7 m/s rises from -3 m to 0 m, where its centre is level with the top.
            for (speed, lands) in [(fx!(10), true), (fx!(30), true), (fx!(7.75), false), (fx!(6.9), false)] {
                let mut world = World::default();
                world.spawn(&BodyDef::fixed(), &[platform]).expect("valid");
                let body = spawn(&mut world, shape, fx!(-3), speed);
                let mut below = fx!(0);
                for _ in 0..600 {
                    world.step();
                    below = below.max(height(&world, body));
                }
                let y = height(&world, body);
                let rests = (y - fx!(0.5)).abs() < fx!(0.01);
                let what = format!(
                    "{name} at {speed} m/s on {:?}: highest at {below} m, now at {y} m",
                    platform.geometry
                );
                assert!(if lands { rests } else { y < fx!(-50) }, "{what}");
                assert_eq!(world.faults(), 0);
            }
        }
    }
}

#[test]
fn what_goes_through_is_not_slowed_down() {
    for platform in platforms() {
        for (name, shape) in movers() {
            let way = |platform: Option<ShapeDef>| {
                let mut world = World::default();
                if let Some(platform) = platform {
                    world.spawn(&BodyDef::fixed(), &[platform]).expect("valid");
                }
                let body = spawn(&mut world, shape, fx!(-3), fx!(12));
                for _ in 0..60 {
                    world.step();
                }
                height(&world, body)
            };
            assert_eq!(way(Some(platform)), way(None), "{name} on {:?}", platform.geometry);
        }
    }
}

#[test]
fn it_holds_what_falls_on_it_and_a_pile_on_top() {
    for platform in platforms() {
        let mut world = World::default();
        world.spawn(&BodyDef::fixed(), &[platform]).expect("valid");
        let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
        let bodies: Vec<_> =
            (0..5i32).map(|i| spawn(&mut world, square, fx!(1) + Fx::from_num(i), fx!(-5))).collect();
        for _ in 0..900 {
            world.step();
        }
        for (i, &body) in (0i32..).zip(&bodies) {
            let y = height(&world, body);
            assert!((y - fx!(0.5) - Fx::from_num(i)).abs() < fx!(0.03), "box {i} is at {y} m");
        }
    }
}

#[test]
fn flush_platforms_carry_over_their_seams() {
    for (name, shape) in movers() {
        let mut world = World::default();
        let slab = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.1)).expect("valid")).one_way(up());
        let slabs: Vec<_> = (0..100i32).map(|i| slab.offset((Fx::from_num(i) - fx!(5), fx!(-0.1)))).collect();
        world.spawn(&BodyDef::fixed(), &slabs).expect("valid");
        let def = BodyDef::dynamic().position((fx!(0), fx!(0.5))).velocity((fx!(5), fx!(0)));
        let body = world.spawn(&def, &[shape.friction(fx!(0))]).expect("valid");
        for _ in 0..900 {
            world.step();
            let y = height(&world, body);
            assert!((y - fx!(0.5)).abs() < fx!(0.01) || name == "pill", "{name} is at {y} m");
        }
        assert!(height(&world, body) > fx!(0.2), "{name}");
    }
}

/// A platform on its side lets bodies pass only to the left.
#[test]
fn the_direction_belongs_to_the_body() {
    let platform = platforms()[0];
    for (speed, passes) in [(fx!(-5), true), (fx!(5), false)] {
        let mut world = World::new(lockstep2d::world::Config { gravity: Vec2::ZERO, ..Default::default() })
            .expect("valid");
        world.spawn(&BodyDef::fixed().angle(up()), &[platform]).expect("valid");
        let def = BodyDef::dynamic().position((-speed, fx!(0))).velocity((speed, fx!(0)));
        let body = world.spawn(&def, &[movers()[0].1]).expect("valid");
        for _ in 0..180 {
            world.step();
        }
        let x = world.body(body).expect("there").position().x;
        assert_eq!(x < fx!(-1) && speed < 0, passes, "at {x} m");
        assert!(passes || x < fx!(-0.4), "at {x} m");
    }
}

/// A restored world knows which bodies are passing through a platform.
#[test]
fn passing_survives_a_snapshot() {
    let mut world = World::default();
    world.spawn(&BodyDef::fixed(), &[platforms()[0]]).expect("valid");
    let body = spawn(&mut world, movers()[1].1, fx!(-3), fx!(7.75));
    for _ in 0..46 {
        world.step();
    }
    let y = height(&world, body);
    assert!(y > fx!(-0.3), "expected the body half-way through, at {y} m");
    let mut restored = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    for _ in 0..60 {
        world.step();
        restored.step();
        assert_eq!(world.state_hash(), restored.state_hash());
    }
    assert!(height(&restored, body) < fx!(-1));
}

/// The side of the platform that a body touches first decides whether the body passes, even if another side was nearer
/// at the start of the tick.
#[test]
fn fast_bodies_that_come_over_the_edge_are_held() {
    for ((x, y), velocity) in [
        ((fx!(-3), fx!(0.45)), (fx!(100), fx!(-25))),
        ((fx!(-3), fx!(0.205)), (fx!(60), fx!(-1))),
        ((fx!(3), fx!(0.45)), (fx!(-100), fx!(-25))),
    ] {
        let mut world = World::default();
        let slab = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.1)).expect("valid")).one_way(up());
        world.spawn(&BodyDef::fixed(), &[slab]).expect("valid");
        let def = BodyDef::dynamic().position((x, y)).velocity(velocity);
        let ball = ShapeDef::new(Geometry::circle(fx!(0.1)).expect("valid"));
        let body = world.spawn(&def, &[ball]).expect("valid");
        for _ in 0..2 {
            world.step();
        }
        assert!(height(&world, body) > fx!(0.19), "from {x}, {y}: {}", height(&world, body));
    }
}

/// A resting ball that is hit from below flies through a platform within the tick.
#[test]
fn what_is_shot_from_below_passes_within_the_tick() {
    let mut world =
        World::new(lockstep2d::world::Config { gravity: Vec2::ZERO, ..Default::default() }).expect("valid");
    let slab = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.1)).expect("valid")).one_way(up());
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-0.1))), &[slab]).expect("valid");
    let ball = |radius| ShapeDef::new(Geometry::circle(radius).expect("valid"));
    let at = |y| BodyDef::dynamic().position((fx!(0), y));
    let small = world.spawn(&at(fx!(-0.7)), &[ball(fx!(0.1))]).expect("valid");
    world.spawn(&at(fx!(-1.4)).velocity((fx!(0), fx!(60))), &[ball(fx!(0.5))]).expect("valid");
    world.step();
    // At the end of the tick the large ball is at -0.4 m, and touches the small one.
    let y = height(&world, small);
    assert!((y - fx!(0.2)).abs() < fx!(0.05), "the ball is at {y}");
}

/// Each contact of the platform begins while the mover is half-way through it.
#[test]
fn what_turns_round_half_way_falls_back_between_the_shapes_of_a_platform() {
    let links = Chain::new(&[-4, 0, 4].map(|x| Vec2::new(Fx::from(x), fx!(0)))).links().expect("valid");
    let end = Vec2::new(fx!(2), fx!(0));
    let line = ShapeDef::new(Geometry::segment(-end, end).expect("valid"));
    let slab = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.1)).expect("valid"));
    let in_row = |shape: ShapeDef, y: Fx| vec![shape.offset((fx!(-2), y)), shape.offset((fx!(2), y))];
    for platform in [links, in_row(line, fx!(0)), in_row(slab, fx!(-0.1))] {
        let platform: Vec<_> = platform.into_iter().map(|shape| shape.one_way(up())).collect();
        for (name, shape) in movers() {
            for speed in [fx!(7.6), fx!(7.8), fx!(8)] {
                let mut world = World::default();
                world.spawn(&BodyDef::fixed(), &platform).expect("valid");
                let def = BodyDef::dynamic().position((fx!(-0.4), fx!(-3))).velocity((fx!(0.5), speed));
                let body = world.spawn(&def, &[shape]).expect("valid");
                (0..300).for_each(|_| world.step());
                let y = height(&world, body);
                assert!(y < fx!(-30), "{name} at {speed} m/s on {:?}: at {y} m", platform[0].geometry);
            }
        }
    }
}
