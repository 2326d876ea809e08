//! Friction, angular momentum and energy of an impact do not depend on how far the bodies are apart at the start of the
//! tick. A `phase` of 0 to 15 in these tests changes this distance by sixteenths of the movement in a tick.

use lockstep2d::body::{BodyDef, BodyId, BodyKind, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, PI, Rot, Vec2, fx_div, fx_mul};
use lockstep2d::world::{Config, World};

use crate::sweep;

fn world_with(tick_rate: u32, gravity: Fx) -> World {
    let gravity = Vec2::new(fx!(0), gravity);
    World::new(Config { tick_rate, gravity, ..Config::default() }).expect("valid")
}

fn circle(radius: Fx) -> ShapeDef {
    ShapeDef::new(Geometry::circle(radius).expect("valid"))
}

fn rectangle(half_width: Fx, half_height: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(half_width, half_height).expect("valid"))
}

fn segment(a: Vec2<Fx>, b: Vec2<Fx>) -> ShapeDef {
    ShapeDef::new(Geometry::segment(a, b).expect("valid"))
}

/// Kinetic energy of the dynamic bodies in J.
fn kinetic(world: &World) -> Fx {
    let dynamic = world.bodies().filter(|(_, body)| body.kind() == BodyKind::Dynamic);
    dynamic.fold(Fx::ZERO, |sum, (_, body)| sum + body.kinetic_energy())
}

/// A spinning disc falls onto a floor and then rolls at `r w / 3` without sliding, because of
/// `m k^2 w = m (k^2 + r^2) w'` and `k^2 = r^2 / 2`.
#[test]
fn a_spinning_ball_rolls_at_a_third_of_its_surface_speed() {
    let speeds = [5, 10, 20, 40, 100, 200].into_iter();
    let cases =
        speeds.flat_map(|speed| [60u32, 240].map(|rate| (0..16).map(move |phase| (speed, rate, phase))));
    sweep::for_each(sweep::sample(cases.flatten(), 7), |(speed, rate, phase): (i32, u32, i32)| {
        let mut world = world_with(rate, fx!(-10));
        let floor = segment(Vec2::new(fx!(-100), fx!(0)), Vec2::new(fx!(100), fx!(0)));
        world.spawn(&BodyDef::fixed(), &[floor]).expect("valid");
        let speed = Fx::from(speed);
        let height = fx!(0.5) + speed / 20 + speed * i64::from(phase) / 16 / i64::from(rate);
        let def = BodyDef::dynamic().position((fx!(0), height)).velocity((fx!(0), -speed));
        let ball = world.spawn(&def.angular_velocity(fx!(10)), &[circle(fx!(0.5))]).expect("valid");
        (0..rate).for_each(|_| world.step());
        let rolls = -world.body(ball).expect("there").velocity().x;
        let expected = fx!(5) / 3;
        assert!((rolls - expected).abs() < expected / 50, "{speed} m/s, {rate} Hz, {phase}: {rolls} m/s");
    });
}

/// Two balls in free space, one of which spins, collide off centre.
#[test]
fn colliding_balls_keep_their_angular_momentum() {
    let speeds = [5, 10, 20].into_iter();
    let cases = speeds.flat_map(|speed| [fx!(0.05), fx!(0.3), fx!(0.6)].map(|offset| (speed, offset)));
    let cases = cases.flat_map(|case| [fx!(0), fx!(0.5), fx!(1)].map(|restitution| (case, restitution)));
    let cases = cases.flat_map(|(case, restitution)| (0..16).map(move |phase| (case, restitution, phase)));
    sweep::for_each(
        sweep::sample(cases, 5),
        |((speed, offset), restitution, phase): ((i32, Fx), Fx, i32)| {
            let mut world = world_with(60, fx!(0));
            let speed = Fx::from(speed);
            let x = fx!(1.5) + speed * i64::from(phase) / 960;
            let spins =
                BodyDef::dynamic().position((-x, fx!(0))).velocity((speed, fx!(0))).angular_velocity(fx!(20));
            let ball = circle(fx!(0.5)).restitution(restitution);
            world.spawn(&spins, &[ball]).expect("valid");
            let def = BodyDef::dynamic().position((x, offset)).velocity((-speed, fx!(0)));
            world.spawn(&def, &[ball]).expect("valid");
            // Angular momentum, and the sum of the absolute values of its parts.
            let momentum = |world: &World| {
                world.bodies().fold((Fx::ZERO, Fx::ZERO), |(sum, all), (_, body)| {
                    let orbital = fx_mul(body.mass(), body.centre_of_mass().cross(body.velocity()));
                    let spin = fx_mul(body.inertia(), body.angular_velocity());
                    (sum + orbital + spin, all + orbital.abs() + spin.abs())
                })
            };
            let (before, all) = momentum(&world);
            (0..60).for_each(|_| world.step());
            let change = (momentum(&world).0 - before).abs();
            let case = format!("{speed} m/s, offset {offset}, restitution {restitution}, {phase}");
            assert!(change <= all / 100, "{case}: {change} of {all}");
        },
    );
}

/// A bar falls flat onto a ledge that is below one half of it. The impulse points upwards, so the bar must hardly move
/// sideways. The limits are the sideways speeds in Box2D.
#[test]
fn a_bar_on_a_ledge_is_not_kicked_sideways() {
    let cases = [60u32, 240].into_iter().flat_map(|rate| {
        [(fx!(10), fx!(0.23)), (fx!(40), fx!(0.68))].map(|(speed, most)| (rate, speed, most))
    });
    for (rate, speed, most) in cases {
        for phase in 0..16 {
            let mut world = world_with(rate, fx!(-10));
            let ledge = rectangle(fx!(10), fx!(1)).offset((fx!(-10), fx!(-1)));
            world.spawn(&BodyDef::fixed(), &[ledge]).expect("valid");
            let height = fx!(0.1) + speed / 20 + speed * phase / 16 / i64::from(rate);
            let def = BodyDef::dynamic().position((fx!(0), height)).velocity((fx!(0), -speed));
            let bar = world.spawn(&def, &[rectangle(fx!(1), fx!(0.1))]).expect("valid");
            for _ in 0..rate / 3 {
                world.step();
                let bar = world.body(bar).expect("there");
                if bar.position().y > fx!(-1) {
                    let aside = bar.velocity().x.abs();
                    assert!(aside <= most, "{speed} m/s, {rate} Hz, {phase}: {aside} m/s sideways");
                }
            }
        }
    }
}

/// A rod of restitution 1 on a frictionless floor gains no energy, and loses nearly none.
#[test]
fn a_spinning_rod_gains_no_energy() {
    for speed in [5, 20, 40] {
        let cases: Vec<i32> = sweep::sample(0..504, 11);
        let mut sum = Fx::ZERO;
        for &case in &cases {
            let mut world = world_with(60, fx!(0));
            let slippery = |shape: ShapeDef| shape.friction(fx!(0)).restitution(fx!(1));
            let floor = slippery(rectangle(fx!(100), fx!(1)));
            world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
            let speed = Fx::from(speed);
            let height = fx!(2) + speed * i64::from(case / 24) / 21 / 60;
            let def = BodyDef::dynamic().position((fx!(0), height)).velocity((fx!(0), -speed));
            let def = def.angle(Angle::from_radians(PI * i64::from(case % 24) / 24));
            let spin = [fx!(5), fx!(-10), fx!(20)][case.unsigned_abs() as usize % 3];
            world
                .spawn(&def.angular_velocity(spin), &[slippery(rectangle(fx!(1), fx!(0.1)))])
                .expect("valid");
            let before = kinetic(&world);
            (0..60).for_each(|_| world.step());
            let ratio = fx_div(kinetic(&world), before).expect("moving");
            assert!(ratio < fx!(1.0005), "{speed} m/s, case {case}: {ratio}");
            sum += ratio;
        }
        let mean = sum / i64::try_from(cases.len()).expect("few");
        assert!((fx!(0.98)..fx!(1.0001)).contains(&mean), "{speed} m/s: {mean} in the mean");
    }
}

/// Adds the walls of a square room with sides of `2 half` metres.
fn add_room(world: &mut World, half: i32, material: impl Fn(ShapeDef) -> ShapeDef) {
    let (place, length) = (half + 1, half + 2);
    for (x, y) in [(0, -place), (0, place), (-place, 0), (place, 0)] {
        let def = BodyDef::fixed().position((Fx::from(x), Fx::from(y)));
        let [half_width, half_height] = [x, y].map(|at| if at == 0 { Fx::from(length) } else { fx!(1) });
        world.spawn(&def, &[material(rectangle(half_width, half_height))]).expect("valid");
    }
}

/// A single body with restitution 1 moves in a room for a minute. Some of the shapes have corners, and two thirds of
/// the cases have friction.
#[test]
fn a_closed_room_keeps_its_energy() {
    let shapes = |at: usize| match at {
        0 => rectangle(fx!(0.5), fx!(0.5)),
        1 => rectangle(fx!(1), fx!(0.1)),
        2 => circle(fx!(0.5)),
        3 => ShapeDef::new(Polygon::regular(6, fx!(0.5)).expect("valid")),
        4 => ShapeDef::new(Polygon::regular(3, fx!(0.5)).expect("valid")),
        _ => ShapeDef::new(
            Geometry::capsule((fx!(-0.6), fx!(0)), (fx!(0.6), fx!(0)), fx!(0.2)).expect("valid"),
        ),
    };
    let cases = (0..6).flat_map(|shape| [60u32, 120].map(|rate| (shape, rate)));
    let cases = cases.flat_map(|case| [fx!(0), fx!(0.2), fx!(0.6)].map(|friction| (case, friction)));
    let cases = cases.flat_map(|(case, friction)| (0..8).map(move |start| (case, friction, start)));
    sweep::for_each(sweep::sample(cases, 13), |((shape, rate), friction, start): ((usize, u32), Fx, i32)| {
        let mut world = world_with(rate, fx!(0));
        let elastic = |shape: ShapeDef| shape.friction(friction).restitution(fx!(1));
        add_room(&mut world, 5, elastic);
        let speed = [fx!(5), fx!(10), fx!(20), fx!(40)][start.unsigned_abs() as usize % 4];
        let direction = Rot::from_angle(Angle::from_radians(fx!(0.3) + Fx::from(start)));
        let velocity = direction.apply_wide(Vec2::new(speed, fx!(0)));
        let def = BodyDef::dynamic().position((fx!(0.3), fx!(0.1))).velocity(velocity);
        let def = def.angular_velocity(Fx::from(5 + start));
        world.spawn(&def, &[elastic(shapes(shape))]).expect("valid");
        let before = kinetic(&world);
        for tick in 0..rate * 60 {
            world.step();
            let ratio = fx_div(kinetic(&world), before).expect("moving");
            let case = format!("shape {shape}, {rate} Hz, friction {friction}, start {start}");
            assert!(ratio <= fx!(1.001), "{case}, tick {tick}: {ratio}");
        }
    });
}

/// In these cases, bodies often hit a wall and another body in the same sub-step.
#[test]
fn several_bodies_in_a_closed_room_keep_its_energy() {
    let shapes = [rectangle(fx!(0.5), fx!(0.5)), rectangle(fx!(1), fx!(0.1)), circle(fx!(0.5))];
    let cases = [30u32, 60, 120].into_iter().flat_map(|rate| [2, 3, 4, 5, 8].map(|count| (rate, count)));
    let cases = cases.flat_map(|case| [fx!(20), fx!(30), fx!(60)].map(|speed| (case, speed)));
    let cases = cases.flat_map(|(case, speed)| (0..3).map(move |shape| (case, speed, shape)));
    let cases = cases.flat_map(|case| (0..6).map(move |start| (case, start)));
    type Case = (((u32, i32), Fx, usize), i32);
    sweep::for_each(sweep::sample(cases, 11), |(((rate, count), speed, shape), start): Case| {
        let mut world = world_with(rate, fx!(0));
        let friction = if start % 2 == 0 { fx!(0) } else { fx!(0.6) };
        let elastic =
            |shape: ShapeDef| shape.friction(friction).restitution(fx!(1)).restitution_threshold(fx!(0));
        add_room(&mut world, 7, elastic);
        for i in 0..count {
            let direction = Rot::from_angle(Angle::from_radians(Fx::from(i) * fx!(2.4) + Fx::from(start)));
            let place = Vec2::new(Fx::from(i % 5) * fx!(2.5) - fx!(5), Fx::from(i / 5) * fx!(2.5) - fx!(5));
            let def = BodyDef::dynamic().position(place).angular_velocity(Fx::from(3 + i));
            let def = def.velocity(direction.apply_wide(Vec2::new(speed, fx!(0))));
            world.spawn(&def, &[elastic(shapes[shape])]).expect("valid");
        }
        let before = kinetic(&world);
        for tick in 0..rate * 30 {
            world.step();
            let ratio = fx_div(kinetic(&world), before).expect("moving");
            let case = format!("{count} of shape {shape} at {speed} m/s, {rate} Hz, start {start}");
            assert!(ratio <= fx!(1.003), "{case}, tick {tick}: {ratio}");
        }
    });
}

/// A ball of restitution 1 is shot into a corner.
#[test]
fn a_corner_with_friction_adds_no_energy() {
    let cases =
        [fx!(0.2), fx!(0.6)].into_iter().flat_map(|friction| (0..1200).map(move |shot| (friction, shot)));
    sweep::for_each(sweep::sample(cases, 17), |(friction, shot): (Fx, i32)| {
        let mut world = world_with(60, fx!(0));
        let elastic = |shape: ShapeDef| shape.friction(friction).restitution(fx!(1));
        for (x, y, half_width, half_height) in [(0, -1, 30, 1), (-1, 0, 1, 30)] {
            let def = BodyDef::fixed().position((Fx::from(x), Fx::from(y)));
            let wall = rectangle(Fx::from(half_width), Fx::from(half_height));
            world.spawn(&def, &[elastic(wall)]).expect("valid");
        }
        let speed = [fx!(5), fx!(10), fx!(20), fx!(40)][shot.unsigned_abs() as usize % 4];
        let angle = Angle::from_radians(PI + fx!(0.05) + fx!(0.0049) * i64::from(shot % 300));
        let velocity = Rot::from_angle(angle).apply_wide(Vec2::new(speed, fx!(0)));
        // After `seconds` the ball reaches both walls at once, or one of them a little earlier.
        let seconds = fx!(0.3) + fx!(0.0013) * i64::from(shot % 53);
        let aside = fx!(0.01) * i64::from(shot % 11 - 5);
        let start = Vec2::new(fx!(0.5) + aside.max(Fx::ZERO), fx!(0.5) - aside.min(Fx::ZERO));
        let start = start - velocity.scale(seconds);
        let def =
            BodyDef::dynamic().position(start).velocity(velocity).angular_velocity(Fx::from(shot % 41 - 20));
        world.spawn(&def, &[elastic(circle(fx!(0.5)))]).expect("valid");
        let before = kinetic(&world);
        (0..60).for_each(|_| world.step());
        let ratio = fx_div(kinetic(&world), before).expect("moving");
        assert!(ratio <= fx!(1.0001), "friction {friction}, shot {shot}: {ratio}");
    });
}

/// The position stays within 5 mm of that of a ball that rebounds exactly at the time of each impact.
#[test]
fn a_ball_between_walls_keeps_time() {
    for speed in [fx!(3), fx!(10), fx!(40), fx!(123)] {
        let mut world = world_with(60, fx!(0));
        let (left, right) = (fx!(-5.17), fx!(5));
        for x in [left - fx!(1), right + fx!(1)] {
            let wall = rectangle(fx!(1), fx!(5));
            world.spawn(&BodyDef::fixed().position((x, fx!(0))), &[wall]).expect("valid");
        }
        let def = BodyDef::dynamic().velocity((speed, fx!(0)));
        let ball = world.spawn(&def, &[circle(fx!(0.5)).restitution(fx!(1))]).expect("valid");
        let way = right - left - fx!(1);
        for tick in 1..=1200 {
            world.step();
            let path = (speed * tick / 60 - left - fx!(0.5)) % (way * 2);
            let expected = left + fx!(0.5) + path.min(way * 2 - path);
            let error = (world.body(ball).expect("there").position().x - expected).abs();
            assert!(error < fx!(0.005), "{speed} m/s, tick {tick}: off by {error} m");
        }
    }
}

/// A ball falls into a wedge of 27 degrees, and comes to rest between its walls. The combined friction of ball and
/// walls is 0.35, so the ball sticks wherever it stops.
#[test]
fn a_ball_in_a_wedge_rests_between_the_walls() {
    let speeds = [5, 20, 40, 100, 200].into_iter();
    let cases = speeds.flat_map(|speed| (0..16).map(move |phase| (speed, phase)));
    sweep::for_each(sweep::sample(cases, 3), |(speed, phase): (i32, i32)| {
        let mut world = world_with(60, fx!(-10));
        let (left, corner, right) = (Vec2::new(fx!(-4), fx!(8)), Vec2::ZERO, Vec2::new(fx!(0), fx!(8)));
        world.spawn(&BodyDef::fixed(), &[segment(left, corner), segment(corner, right)]).expect("valid");
        let speed = Fx::from(speed);
        let height = fx!(10.75) + speed * i64::from(phase) / 960;
        let def = BodyDef::dynamic().position((fx!(-0.45), height)).velocity((fx!(0), -speed));
        let ball: BodyId = world.spawn(&def, &[circle(fx!(0.3)).friction(fx!(0.2))]).expect("valid");
        for _ in 0..60 * 20 {
            world.step();
        }
        let Vec2 { x, y } = world.body(ball).expect("there").position();
        // The walls are the lines x = 0 and y = -2 x.
        let from_left = fx_mul(x * 2 + y, fx!(0.4472135955));
        let overlap = fx!(0.3) - (-x).min(from_left);
        assert!(overlap < fx!(0.0105), "{speed} m/s, {phase}: {overlap} m in a wall, at ({x}, {y})");
        assert!(world.body(ball).expect("there").is_asleep(), "{speed} m/s, {phase}");
    });
}
