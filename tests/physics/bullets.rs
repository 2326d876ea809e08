//! Bullets do not pass through moving bodies, and moving bodies do not push them into walls.

use lockstep2d::body::{BodyDef, BodyId, Continuous, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_mul};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{Config, World};

use crate::sweep;

fn weightless(tick_rate: u32) -> World {
    World::new(Config { gravity: Vec2::ZERO, tick_rate, ..Config::default() }).expect("valid")
}

/// How a flipper turns.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drive {
    /// By the motor of its hinge.
    Motor,
    Kinematic,
}

/// Adds a flipper from the origin to 1 m along the direction of `angle`, 4 cm thick, that turns about the origin.
fn flipper(world: &mut World, drive: Drive, angle: Angle, omega: Fx) -> BodyId {
    let corners = [(0, -2), (100, -2), (100, 2), (0, 2)];
    let corners = corners.map(|(x, y)| Vec2::new(Fx::from(x) / 100, Fx::from(y) / 100));
    let blade = ShapeDef::new(Polygon::new(&corners).expect("convex")).density(fx!(20));
    if drive == Drive::Kinematic {
        let def = BodyDef::kinematic().angle(angle).angular_velocity(omega);
        return world.spawn(&def, &[blade]).expect("valid");
    }
    let centre: Vec2<Fx> = angle.direction().widen().scale(fx!(0.5));
    let def = BodyDef::dynamic().angle(angle).angular_velocity(omega).velocity(centre.perp().scale(omega));
    let flipper = world.spawn(&def, &[blade]).expect("valid");
    let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let hinge = JointDef::new(ground, flipper, Revolute::new().motor(omega, fx!(100)));
    world.add_joint(&hinge).expect("valid");
    flipper
}

fn ball(radius: Fx) -> ShapeDef {
    ShapeDef::new(Geometry::circle(radius).expect("valid")).restitution(fx!(0.5))
}

/// Position of a body in the axes of another.
fn seen_from(world: &World, from: BodyId, body: BodyId) -> Vec2<Fx> {
    let [from, body] = [from, body].map(|id| world.body(id).expect("alive"));
    from.transform().apply_inverse(body.position())
}

/// A ball flies towards a flipper that turns towards it.
#[test]
fn a_bullet_does_not_pass_a_flipper() {
    let drives = [Drive::Motor, Drive::Kinematic];
    let cases = drives.into_iter().flat_map(|drive| [5, 20, 40].map(|omega| (drive, omega)));
    let cases = cases.flat_map(|case| [5, 20, 60].map(|speed| (case, speed)));
    let cases: Vec<_> = cases.collect();
    sweep::for_each(cases, |((drive, omega), speed): ((Drive, i32), i32)| {
        let (omega, speed) = (Fx::from(omega), Fx::from(speed));
        let (mut passed, mut fastest) = (0, fx!(0));
        for phase in 0..64i32 {
            let mut world = weightless(60);
            // The flipper meets the line y = 0 after two ticks and a part of a third.
            let ticks = fx!(2) + Fx::from(phase) / 64;
            let angle = Angle::from_radians(-fx_mul(omega, ticks) / 60);
            let flipper = flipper(&mut world, drive, angle, omega);
            let at = Vec2::new(fx!(0.3) + fx!(0.05) * i64::from(phase % 9), fx!(0.1));
            let place = at + Vec2::new(fx!(0), fx_mul(speed, ticks) / 60);
            let def = BodyDef::dynamic().position(place).velocity((fx!(0), -speed)).bullet();
            let ball = world.spawn(&def, &[ball(fx!(0.05))]).expect("valid");
            let mut last = seen_from(&world, flipper, ball);
            for _ in 0..8 {
                world.step();
                let now = seen_from(&world, flipper, ball);
                // A ball beyond the tip may get behind the flipper.
                let is_along = [last, now].iter().all(|at| at.x > 0 && at.x < 1);
                passed += i32::from(is_along && last.y > 0 && now.y < 0);
                last = now;
                let turned = world.body(ball).expect("alive").velocity().length();
                fastest = fastest.max(turned);
            }
        }
        let what = format!("{drive:?}, {omega} rad/s, {speed} m/s");
        assert_eq!(passed, 0, "{what}: {passed} of 64 pass");
        // The tip moves at `omega` times 1 m.
        let most = speed + (speed + omega) * 3 / 2;
        assert!(fastest < most + fx!(0.5), "{what}: {fastest} m/s instead of at most {most} m/s");
    });
}

/// A flipper drives a ball against a wall of 4 cm. The ball is squeezed, but its centre does not pass the middle of the
/// wall.
#[test]
fn a_flipper_does_not_push_a_bullet_into_a_wall() {
    let drives = [
        (Drive::Motor, Continuous::Bullet),
        (Drive::Kinematic, Continuous::Bullet),
        (Drive::Kinematic, Continuous::Kinematic),
    ];
    let cases = drives.into_iter().flat_map(|(drive, ball)| [5, 20, 40].map(|omega| (drive, ball, omega)));
    sweep::for_each(cases.collect(), |(drive, continuous, omega): (Drive, Continuous, i32)| {
        let omega = Fx::from(omega);
        for phase in 0..64i32 {
            let mut world = weightless(60);
            let angle = Angle::from_radians(-fx_mul(omega, fx!(2) + Fx::from(phase) / 64) / 60);
            flipper(&mut world, drive, angle, omega);
            let wall = ShapeDef::new(Polygon::rectangle(fx!(5), fx!(0.02)).expect("valid"));
            world.spawn(&BodyDef::fixed().position((fx!(0), fx!(0.4))), &[wall]).expect("valid");
            let at = Vec2::new(fx!(0.4) + fx!(0.05) * i64::from(phase % 9), fx!(0.12));
            let def = BodyDef::dynamic().position(at).velocity((fx!(0), fx!(-15))).continuous(continuous);
            let ball = world.spawn(&def, &[ball(fx!(0.05))]).expect("valid");
            for tick in 0..12 {
                world.step();
                let y = world.body(ball).expect("alive").position().y;
                let what = format!("{drive:?}, {continuous:?}, {omega} rad/s, phase {phase}, tick {tick}");
                assert!(y < fx!(0.4), "{what}: at {y} m");
            }
        }
    });
}
