//! Rolling resistance, and surface speed (conveyors).

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_mul, widen};
use lockstep2d::world::World;

fn world(angle: Angle, ground: ShapeDef) -> World {
    let mut world = World::default();
    world.spawn(&BodyDef::fixed().angle(angle), &[ground]).expect("valid");
    world
}

fn line() -> ShapeDef {
    let end = Vec2::new(fx!(1000), fx!(0));
    ShapeDef::new(Geometry::segment(-end, end).expect("valid"))
}

fn block() -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(fx!(100), fx!(1)).expect("valid")).offset((fx!(0), fx!(-1)))
}

fn ball(radius: Fx) -> ShapeDef {
    ShapeDef::new(Geometry::circle(radius).expect("valid"))
}

fn launch(world: &mut World, shape: ShapeDef, angle: Angle, height: Fx, speed: Fx, spin: Fx) -> BodyId {
    let (sin, cos) = (widen(angle.sin()), widen(angle.cos()));
    let place = Vec2::new(-sin, cos).scale(height);
    let velocity = Vec2::new(cos, sin).scale(speed);
    let def = BodyDef::dynamic().position(place).velocity(velocity);
    world.spawn(&def.angle(angle).angular_velocity(spin), &[shape]).expect("valid")
}

fn step(world: &mut World, ticks: u32) {
    for _ in 0..ticks {
        world.step();
    }
    assert_eq!(world.faults(), 0);
}

fn speed(world: &World, body: BodyId) -> Fx {
    world.body(body).expect("there").velocity().x
}

/// A disc with the coefficient `c` of rolling resistance decelerates by `a = c g / (1 + k^2 / r^2) = 2/3 c g`.
#[test]
fn a_ball_slows_down_by_the_law_of_rolling_resistance() {
    for radius in [fx!(0.1), fx!(0.5), fx!(3)] {
        for resistance in [fx!(0.02), fx!(0.1), fx!(0.3)] {
            for on_ground in [false, true] {
                let (mut ground, mut shape) = (line(), ball(radius));
                let resisting = if on_ground { &mut ground } else { &mut shape };
                *resisting = resisting.rolling_resistance(resistance);
                let mut world = world(Angle::ZERO, ground);
                let spin = -lockstep2d::math::fx_div(fx!(10), radius).expect("positive");
                let body = launch(&mut world, shape, Angle::ZERO, radius, fx!(10), spin);
                step(&mut world, 60);
                let expected = fx!(10) - resistance * 20 / 3;
                let error = (speed(&world, body) - expected).abs();
                assert!(error < fx!(0.03), "r {radius}, c {resistance}: {error} m/s off {expected}");
                step(&mut world, 60 * 80);
                let body = world.body(body).expect("there");
                assert!(
                    body.velocity().length() < fx!(0.0001),
                    "expected the ball to be at rest: {:?}",
                    body.velocity()
                );
                assert!(body.angular_velocity().abs() < fx!(0.001));
            }
        }
    }
}

/// The ball stays if `tan(angle)` is below the rolling resistance.
#[test]
fn a_ball_stays_on_a_slope_that_is_flatter_than_its_resistance() {
    for (degrees, stays) in [(fx!(5), true), (fx!(7), false)] {
        let angle = Angle::from_degrees(degrees);
        // 0.105 lies between tan(5 degrees) = 0.087 and tan(7 degrees) = 0.123.
        let mut world = world(angle, line());
        let body = launch(
            &mut world,
            ball(fx!(0.5)).rolling_resistance(fx!(0.105)),
            angle,
            fx!(0.5),
            fx!(0),
            fx!(0),
        );
        let start = world.body(body).expect("there").position();
        step(&mut world, 600);
        let way = world.body(body).expect("there").position().distance(start);
        assert_eq!(way < fx!(0.01), stays, "{degrees} degrees: {way} m");
    }
}

/// The sum of the angular momenta of the two wheels is constant.
#[test]
fn resistance_between_two_wheels_is_equal_and_opposite() {
    let mut world =
        World::new(lockstep2d::world::Config { gravity: Vec2::ZERO, ..Default::default() }).expect("valid");
    let shape = |radius| ball(radius).friction(fx!(0)).rolling_resistance(fx!(0.5));
    let spawn = |world: &mut World, x: Fx, radius: Fx, v: Fx, spin: Fx| {
        let def = BodyDef::dynamic().position((x, fx!(0))).velocity((v, fx!(0))).angular_velocity(spin);
        world.spawn(&def, &[shape(radius)]).expect("valid")
    };
    let a = spawn(&mut world, fx!(-1), fx!(1), fx!(1), fx!(5));
    let b = spawn(&mut world, fx!(0.25), fx!(0.2), fx!(-1), fx!(-8));
    let of = |world: &World, id| {
        let body = world.body(id).expect("there");
        (body.inertia(), body.angular_velocity())
    };
    let before = [a, b].map(|id| of(&world, id));
    step(&mut world, 120);
    let after = [a, b].map(|id| of(&world, id));
    let total = |list: [(Fx, Fx); 2]| list.iter().fold(Fx::ZERO, |sum, &(i, w)| sum + fx_mul(i, w));
    assert!((total(before) - total(after)).abs() < fx!(0.0001), "{before:?} {after:?}");
    assert!((after[0].1 - after[1].1).abs() < (before[0].1 - before[1].1).abs(), "{before:?} {after:?}");
}

/// The velocity of the box is `v = mu g t` until it reaches the speed of the belt.
#[test]
fn a_box_on_a_belt_reaches_its_speed() {
    for ground in [line(), block()] {
        for belt in [fx!(3), fx!(-3)] {
            let mut world = world(Angle::ZERO, ground.friction(fx!(0.3)).surface_speed(belt));
            let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid")).friction(fx!(0.3));
            let body = launch(&mut world, square, Angle::ZERO, fx!(0.5), fx!(0), fx!(0));
            step(&mut world, 30);
            let expected = fx!(1.5) * if belt > 0 { 1 } else { -1 };
            let error = (speed(&world, body) - expected).abs();
            assert!(error < fx!(0.02), "{error} m/s off {expected}");
            step(&mut world, 200);
            assert!((speed(&world, body) - belt).abs() < fx!(0.001), "{} m/s on {belt}", speed(&world, body));
        }
    }
}

/// The angle of the slope is below the angle of friction, so the box does not slide back.
#[test]
fn a_belt_carries_uphill() {
    let angle = Angle::from_degrees(fx!(20));
    let mut world = world(angle, block().surface_speed(fx!(2)));
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
    let body = launch(&mut world, square, angle, fx!(0.5), fx!(0), fx!(0));
    step(&mut world, 300);
    let velocity = world.body(body).expect("there").velocity();
    let expected = Vec2::new(widen(angle.cos()), widen(angle.sin())).scale(fx!(2));
    assert!(velocity.distance(expected) < fx!(0.001), "{velocity:?}, expected {expected:?}");
}

/// In the end the ball rolls, so that `w r = v_belt - v`. It keeps the speed that it gained while slipping:
/// `v = v_belt / 3`.
#[test]
fn a_ball_on_a_belt_takes_a_third_of_its_speed() {
    let mut world = world(Angle::ZERO, line().surface_speed(fx!(3)));
    let body = launch(&mut world, ball(fx!(0.5)), Angle::ZERO, fx!(0.5), fx!(0), fx!(0));
    step(&mut world, 300);
    assert!((speed(&world, body) - fx!(1)).abs() < fx!(0.01), "{} m/s", speed(&world, body));
    let spin = world.body(body).expect("there").angular_velocity();
    assert!((spin - fx!(4)).abs() < fx!(0.02), "{spin} rad/s");
}

/// A body is pressed against the lower side, which runs the opposite way.
#[test]
fn the_lower_side_of_a_belt_runs_back() {
    let mut world =
        World::new(lockstep2d::world::Config { gravity: Vec2::new(fx!(0), fx!(10)), ..Default::default() })
            .expect("valid");
    let belt = ShapeDef::new(Polygon::rectangle(fx!(100), fx!(1)).expect("valid")).surface_speed(fx!(2));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(1))), &[belt]).expect("valid");
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
    let body = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(-0.5))), &[square]).expect("valid");
    step(&mut world, 300);
    assert!((speed(&world, body) + fx!(2)).abs() < fx!(0.001), "{} m/s", speed(&world, body));
}
