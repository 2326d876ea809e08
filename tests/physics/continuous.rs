//! Fast bodies do not tunnel through thin walls.

use lockstep2d::body::{BodyDef, BodyId, Continuous, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_mul};
use lockstep2d::world::{Config, World};

/// A shape that is 5 cm long: 0 is a circle, 1 a capsule, 2 a square.
fn small(kind: u32) -> ShapeDef {
    let geometry = match kind {
        0 => Geometry::circle(fx!(0.025)),
        1 => Geometry::capsule(Vec2::new(fx!(0), fx!(-0.0125)), Vec2::new(fx!(0), fx!(0.0125)), fx!(0.0125)),
        _ => Polygon::square(fx!(0.025)).map(Geometry::from),
    };
    ShapeDef::new(geometry.expect("valid"))
}

/// Adds a wall that is 1 cm thick and passes through the origin. Returns its normal.
fn wall(world: &mut World, angle: Angle) -> Vec2<Fx> {
    let wall = ShapeDef::new(Polygon::rectangle(fx!(100), fx!(0.005)).expect("valid"));
    world.spawn(&BodyDef::fixed().angle(angle), &[wall]).expect("valid");
    Rot::from_angle(angle).apply_wide(Vec2::new(fx!(0), fx!(1)))
}

fn weightless() -> World {
    World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid")
}

#[test]
fn five_centimetres_at_400_metres_per_second_never_pass_one_centimetre() {
    let mut rng = Rng::new(41);
    for round in 0..1000u32 {
        let mut world = weightless();
        let angle = rng.angle();
        let normal = wall(&mut world, angle);
        let along = -normal.perp();
        let (height, offset) = (rng.range(fx!(0.05), fx!(7)), rng.range(fx!(-20), fx!(20)));
        let place = normal.scale(height) + along.scale(offset);
        let course = Angle::from_degrees(rng.range(fx!(-89.5), fx!(89.5)));
        let down = Rot::from_angle(angle + course).apply_wide(Vec2::new(fx!(0), fx!(-399.9)));
        let body = BodyDef::dynamic().position(place).angle(rng.angle()).velocity(down);
        let spin = rng.range(fx!(-100), fx!(100));
        let body = world.spawn(&body.angular_velocity(spin), &[small(round % 3)]).expect("valid");
        for tick in 0..20 {
            world.step();
            let there = world.body(body).expect("alive").position();
            let beside = there.dot(along).abs() > fx!(99);
            assert!(
                beside || there.dot(normal) > 0,
                "round {round}, tick {tick}: from {height} m at {course:?}, wall at {angle:?}, now {there:?}"
            );
        }
    }
}

#[test]
fn a_thin_rod_that_spins_does_not_pass_a_wall() {
    let mut rng = Rng::new(43);
    for round in 0..300 {
        let mut world = weightless();
        let normal = wall(&mut world, Angle::ZERO);
        let rod = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.01)).expect("valid"));
        // The rod rotates into the wall from above.
        let tilt = rng.range(fx!(0.05), fx!(1.5));
        let height = fx_mul(fx!(1.02), Angle::from_radians(tilt).sin().into()) + fx!(0.03);
        let spin = if rng.chance(1, 2) { fx!(50) } else { fx!(-50) };
        let body = BodyDef::dynamic()
            .position((rng.range(fx!(-3), fx!(3)), height))
            .angle(Angle::from_radians(tilt))
            .angular_velocity(spin)
            .velocity((fx!(0), rng.range(fx!(-5), fx!(0))));
        let body = world.spawn(&body, &[rod]).expect("valid");
        for tick in 0..60 {
            world.step();
            let there = world.body(body).expect("alive").position();
            assert!(there.dot(normal) > 0, "round {round}, tick {tick}: tilt {tilt}, now at {there:?}");
        }
    }
}

#[test]
fn a_bullet_does_not_pass_a_thin_body() {
    let mut world = weightless();
    let plate = ShapeDef::new(Polygon::rectangle(fx!(0.005), fx!(1)).expect("valid")).density(fx!(10000));
    world.spawn(&BodyDef::dynamic().position((fx!(3), fx!(0))), &[plate]).expect("valid");
    let bullet = BodyDef::dynamic().velocity((fx!(390), fx!(0))).bullet();
    let bullet = world.spawn(&bullet, &[small(0)]).expect("valid");
    for _ in 0..10 {
        world.step();
        assert!(world.body(bullet).expect("alive").position().x < fx!(3.5));
    }
}

#[test]
fn a_bullet_does_not_pass_a_plate_that_comes_towards_it() {
    for kind in 0..3 {
        for speed in [fx!(1), fx!(5), fx!(20)] {
            let mut world = weightless();
            let plate = ShapeDef::new(Polygon::rectangle(fx!(0.005), fx!(5)).expect("valid"));
            let def = BodyDef::kinematic().position((fx!(5), fx!(0))).velocity((-speed, fx!(0)));
            let plate = world.spawn(&def, &[plate]).expect("valid");
            let bullet = BodyDef::dynamic().velocity((fx!(390), fx!(3))).bullet();
            let bullet = world.spawn(&bullet, &[small(kind)]).expect("valid");
            for tick in 0..30 {
                world.step();
                let x = |body| world.body(body).expect("alive").position().x;
                assert!(x(bullet) < x(plate), "shape {kind}, {speed} m/s, tick {tick}");
            }
        }
    }
}

/// Launches 300 balls with a diameter of 6 cm near a blade that is 2 cm thick and turns by up to half a radian in a
/// tick. Returns the number of balls that pass through the blade.
fn balls_that_pass_a_blade(continuous: Continuous) -> u32 {
    let mut rng = Rng::new(47);
    let mut passed = 0;
    for _ in 0..300 {
        let mut world = weightless();
        let blade = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.01)).expect("valid"));
        let spin = rng.range(fx!(5), fx!(30));
        let rotor =
            BodyDef::kinematic().angular_velocity(spin).velocity((rng.range(fx!(-20), fx!(20)), fx!(0)));
        let rotor = world.spawn(&rotor, &[blade]).expect("valid");
        let ball = ShapeDef::new(Geometry::circle(fx!(0.03)).expect("valid")).restitution(fx!(0.5));
        let place = Rot::from_angle(rng.angle()).apply_wide(Vec2::new(rng.range(fx!(0.2), fx!(1.7)), fx!(0)));
        let far = place.y.abs() > fx!(0.05);
        let velocity = Vec2::new(rng.range(fx!(-60), fx!(60)), rng.range(fx!(-60), fx!(60)));
        let body = BodyDef::dynamic().position(place).velocity(velocity).continuous(continuous);
        let body = world.spawn(&body, &[ball]).expect("valid");
        let across = |world: &World| {
            let rotor = world.body(rotor).expect("alive");
            rotor.transform().apply_inverse(world.body(body).expect("alive").position())
        };
        let mut last = across(&world);
        for _ in 0..20 {
            let turned = fx_mul(spin, fx!(0.0166666));
            world.step();
            let now = across(&world);
            // Counts only balls that are at the same half of the blade before and after the tick. For other balls, the
            // side of the blade can change without passing through it.
            let is_along = now.x.abs() < fx!(1.9) && last.x.abs() < fx!(1.9);
            let same_half = (now.x > 0) == (last.x > 0) && turned < fx!(0.6);
            passed += u32::from(far && is_along && same_half && (now.y > 0) != (last.y > 0));
            last = now;
        }
    }
    passed
}

#[test]
fn balls_that_see_kinematic_bodies_do_not_pass_a_blade() {
    let (blind, seeing) =
        (balls_that_pass_a_blade(Continuous::Fixed), balls_that_pass_a_blade(Continuous::Kinematic));
    assert!(blind > 0, "expected some to pass without");
    assert_eq!(seeing, 0, "{blind} pass without");
}

/// The sweep against kinematic bodies does not change the path of a body that rides on a fast platform or turntable.
#[test]
fn what_a_kinematic_body_carries_is_not_held_back() {
    let mut hashes = Vec::new();
    for continuous in [Continuous::Fixed, Continuous::Kinematic] {
        let mut world = World::default();
        let platform = ShapeDef::new(Polygon::rectangle(fx!(8), fx!(0.2)).expect("valid")).friction(fx!(1));
        let lift = BodyDef::kinematic().velocity((fx!(40), fx!(10)));
        world.spawn(&lift, &[platform]).expect("valid");
        let square = ShapeDef::new(Polygon::square(fx!(0.25)).expect("valid"));
        let mut bodies = Vec::new();
        for index in 0..10 {
            let at = (Fx::from_num(index) - fx!(5), fx!(0.45));
            let body = BodyDef::dynamic().position(at).velocity((fx!(40), fx!(10))).continuous(continuous);
            bodies.push(world.spawn(&body, &[square]).expect("valid"));
        }
        // A tray that turns at 6 rad/s about a distant point carries a box at 22.2 m/s, 3.7 m from this point.
        let tray = ShapeDef::new(Polygon::rectangle(fx!(0.6), fx!(0.05)).expect("valid"));
        let tray = tray.offset((fx!(0), fx!(-4)));
        let arm = BodyDef::kinematic().position((fx!(0), fx!(100))).angular_velocity(fx!(6));
        world.spawn(&arm, &[tray]).expect("valid");
        let body = BodyDef::dynamic().position((fx!(0), fx!(96.3))).velocity((fx!(22.2), fx!(0)));
        let body = body.angular_velocity(fx!(6)).continuous(continuous);
        bodies.push(world.spawn(&body, &[square.friction(fx!(4))]).expect("valid"));
        let mut impacts = 0;
        for _ in 0..120 {
            world.step();
            impacts += world.stats().impacts;
        }
        assert_eq!(impacts, 0, "{continuous:?}");
        hashes
            .push(bodies.iter().map(|&body| world.body(body).expect("alive").position()).collect::<Vec<_>>());
    }
    assert_eq!(hashes[0], hashes[1]);
}

/// The drum turns as fast as that of the scene `washer`. Sweeping boxes against the drum must not press them deeper
/// into each other. The motion is chaotic, so the test compares means over several starts of the median depth.
#[test]
fn boxes_in_a_drum_overlap_no_more_for_seeing_it() {
    const STARTS: i32 = 8;
    let deepest = |continuous: Continuous, start: i32| {
        let mut world = World::default();
        let wall = |index: u32| {
            let turn = Angle::from_bits(index << 28);
            let corner = |angle: Angle, radius: Fx| {
                Rot::from_angle(angle).apply(Vec2::<lockstep2d::math::Unit>::X).widen().scale(radius)
            };
            let next = turn + Angle::from_bits(1 << 28);
            let corners = [(turn, fx!(4)), (next, fx!(4)), (next, fx!(3.9)), (turn, fx!(3.9))];
            let corners: Vec<_> = corners.into_iter().map(|(angle, radius)| corner(angle, radius)).collect();
            ShapeDef::new(Polygon::hull(&corners).expect("valid"))
        };
        let drum: Vec<_> = (0..16).map(wall).collect();
        world.spawn(&BodyDef::kinematic().angular_velocity(fx!(2)), &drum).expect("valid");
        let square = ShapeDef::new(Polygon::square(fx!(0.15)).expect("valid"));
        for index in 0..150 {
            let at =
                Vec2::new(Fx::from_num(index % 15) / 3 - fx!(2.3), Fx::from_num(index / 15) / 3 - fx!(2));
            let at = at + Vec2::new(Fx::from(start) / 100, fx!(0));
            let body = BodyDef::dynamic().position(at).continuous(continuous);
            world.spawn(&body, &[square]).expect("valid");
        }
        let mut depths = Vec::new();
        for _ in 0..600 {
            world.step();
            depths.push(crate::deepest(&world));
        }
        let inside = world.bodies().filter(|(_, body)| body.position().length() < fx!(4)).count();
        assert_eq!(inside, 151, "{continuous:?}: nothing leaves the drum");
        depths.sort_unstable();
        depths[depths.len() / 2]
    };
    let mean = |continuous: Continuous| {
        (0..STARTS).map(|start| deepest(continuous, start)).sum::<Fx>() / i64::from(STARTS)
    };
    let (blind, seeing) = (mean(Continuous::Fixed), mean(Continuous::Kinematic));
    assert!(seeing < blind + fx!(0.003), "{seeing} m instead of {blind} m");
}

/// A kinematic arm from 0.1 m to 2 m along the x axis, 2 cm thick, that turns about the origin.
fn arm(world: &mut World, spin: Fx) -> BodyId {
    let (near, far, half) = (fx!(0.1), fx!(2), fx!(0.01));
    let corners = [(near, -half), (far, -half), (far, half), (near, half)].map(|(x, y)| Vec2::new(x, y));
    let blade = ShapeDef::new(Polygon::new(&corners).expect("convex"));
    world.spawn(&BodyDef::kinematic().angular_velocity(spin), &[blade]).expect("valid")
}

/// A ball of 10 cm at an angle, 1.5 m from the origin.
fn ball_at(world: &mut World, degrees: Fx, def: BodyDef) -> BodyId {
    let place = Rot::from_angle(Angle::from_degrees(degrees)).apply_wide(Vec2::new(fx!(1.5), fx!(0)));
    let ball = ShapeDef::new(Geometry::circle(fx!(0.05)).expect("valid"));
    world.spawn(&def.position(place), &[ball]).expect("valid")
}

/// Height of a body above the line of an arm, in the axes of the arm.
fn ahead_of(world: &World, arm: BodyId, body: BodyId) -> Fx {
    let arm = world.body(arm).expect("alive").transform();
    arm.apply_inverse(world.body(body).expect("alive").position()).y
}

#[test]
fn a_sleeping_ball_wakes_before_a_turning_arm_passes_it() {
    for (spin, degrees) in [(fx!(90), fx!(30)), (fx!(-90), fx!(-30)), (fx!(90), fx!(60)), (fx!(60), fx!(20))]
    {
        let mut world = weightless();
        let arm = arm(&mut world, spin);
        let def = BodyDef::dynamic().asleep().continuous(Continuous::Kinematic);
        let ball = ball_at(&mut world, degrees, def);
        assert!(world.body(ball).expect("alive").is_asleep());
        for tick in 0..3 {
            world.step();
            let ahead = ahead_of(&world, arm, ball);
            assert!((ahead > 0) == (spin > 0), "{spin} rad/s, {degrees} degrees, tick {tick}: {ahead}");
        }
        assert!(!world.body(ball).expect("alive").is_asleep());
        assert_eq!(world.validate(), Ok(()));
    }
}

/// An arm that does not reach a sleeping ball, or that the settings let pass through it, leaves the ball asleep.
#[test]
fn an_arm_that_meets_no_sleeping_ball_wakes_none() {
    let sleeps = |continuous: Continuous, degrees: Fx, spin: Fx, config: Config| {
        let mut world = World::new(Config { gravity: Vec2::ZERO, ..config }).expect("valid");
        let arm = arm(&mut world, spin);
        let ball = ball_at(&mut world, degrees, BodyDef::dynamic().asleep().continuous(continuous));
        world.step();
        world.set_velocity(arm, Vec2::ZERO, fx!(0)).expect("valid");
        world.step();
        world.body(ball).expect("alive").is_asleep()
    };
    // The arm turns by 86 degrees.
    assert!(sleeps(Continuous::Kinematic, fx!(100), fx!(90), Config::default()));
    assert!(sleeps(Continuous::Kinematic, fx!(-30), fx!(90), Config::default()));
    assert!(sleeps(Continuous::Fixed, fx!(60), fx!(90), Config::default()));
    let without = Config { continuous: false, ..Config::default() };
    assert!(sleeps(Continuous::Kinematic, fx!(60), fx!(90), without));
    assert!(!sleeps(Continuous::Kinematic, fx!(60), fx!(90), Config::default()));
}

/// At 20 ticks per second an arm may turn by 206 degrees in a tick. It carries a ball in front of it along, and leaves
/// a ball alone that only a turn in the other direction would meet.
#[test]
fn an_arm_that_turns_by_more_than_half_a_turn_is_swept_the_right_way_round() {
    for continuous in [Continuous::Kinematic, Continuous::Bullet] {
        for (spin, degrees, meets) in [
            (fx!(72), fx!(60), true),
            (fx!(-72), fx!(-60), true),
            (fx!(72), fx!(-60), false),
            (fx!(-72), fx!(60), false),
        ] {
            let mut world = World::new(Config { gravity: Vec2::ZERO, tick_rate: 20, ..Config::default() })
                .expect("valid");
            let arm = arm(&mut world, spin);
            // A bullet is swept only if it is fast itself.
            let speed = if continuous == Continuous::Bullet { fx!(1.5) } else { fx!(0) };
            let inwards = Rot::from_angle(Angle::from_degrees(degrees)).apply_wide(Vec2::new(-speed, fx!(0)));
            let ball = BodyDef::dynamic().continuous(continuous).velocity(inwards);
            let ball = ball_at(&mut world, degrees, ball);
            let start = world.body(ball).expect("alive").position();
            world.step();
            let moved =
                (world.body(ball).expect("alive").position() - start - inwards.scale(fx!(0.05))).length();
            let case = format!("{continuous:?}, {spin} rad/s, {degrees} degrees: {moved}");
            let ahead = ahead_of(&world, arm, ball);
            if !meets {
                assert!(moved < fx!(0.001), "{case}");
            } else if continuous == Continuous::Bullet {
                // The sweep stops a bullet where it meets the arm.
                assert!(moved > fx!(0.001), "{case}, {ahead}");
            } else {
                assert!((fx!(0.02)..fx!(0.1)).contains(&ahead.abs()), "{case}, {ahead}");
                assert!((ahead > 0) == (spin > 0), "{case}, {ahead}");
            }
        }
    }
}
