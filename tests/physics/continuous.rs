//! Continuous collision: fast bodies do not tunnel through thin walls.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_mul};
use lockstep2d::world::{Config, World};

/// Returns a shape 5 cm in size.
fn small(kind: u32) -> ShapeDef {
    let geometry = match kind {
        0 => Geometry::circle(fx!(0.025)),
        1 => Geometry::capsule(Vec2::new(fx!(0), fx!(-0.0125)), Vec2::new(fx!(0), fx!(0.0125)), fx!(0.0125)),
        _ => Polygon::square(fx!(0.025)).map(Geometry::from),
    };
    ShapeDef::new(geometry.expect("valid"))
}

/// Spawns a wall 1 cm thick through the origin, rotated by an angle, and returns its normal.
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
        // The rod starts above the wall and rotates into it.
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
