//! Motors reach their speed within their limits of force.

use lockstep2d::body::{BodyDef, Geometry, JointId, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{Distance, JointDef, JointKind, Motor, Prismatic, Revolute, Wheel};
use lockstep2d::world::World;

use crate::joint_bench::{Bench, Ground, close, grounds};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Load {
    Mass,
    Inertia,
}

/// A motor that needs 2 s to reach its speed accelerates at `max / mass` until then, and holds the speed afterwards.
fn accelerates(
    kind: impl Fn(Fx, Fx) -> JointKind,
    place: Vec2<Fx>,
    load: Load,
    speed: impl Fn(&World, JointId) -> Fx,
) {
    for (ground, mass, inertia) in grounds() {
        let mut bench = Bench::new(ground, fx!(0), place, fx!(0));
        let max = if load == Load::Mass { mass } else { inertia };
        let joint = bench.join(JointDef::new(bench.a, bench.b, kind(fx!(2), max)));
        bench.run(60, |tick, world| {
            let expected = Fx::from_num(tick + 1) / 60;
            let what = format!("{ground:?}, tick {tick}: speed");
            close(speed(world, joint), expected, expected / 100, &what);
        });
        bench.run(90, |_, _| {});
        close(speed(&bench.world, joint), fx!(2), fx!(0.0002), "final speed");
    }
}

#[test]
fn motors_have_the_acceleration_of_theory() {
    let turning = |world: &World, id| world.joint_angular_velocity(id).expect("there");
    accelerates(|speed, max| Revolute::new().motor(speed, max).into(), Vec2::ZERO, Load::Inertia, turning);
    accelerates(|speed, max| Wheel::new().motor(speed, max).into(), Vec2::ZERO, Load::Inertia, turning);
    accelerates(|speed, max| Motor::new().angular(speed, max).into(), Vec2::ZERO, Load::Inertia, turning);
    let along = |world: &World, id| world.joint_velocity(id).expect("there").x;
    let place = Vec2::new(fx!(3), fx!(0));
    accelerates(|speed, max| Prismatic::new().motor(speed, max).into(), place, Load::Mass, along);
    accelerates(|speed, max| Distance::new().motor(speed, max).into(), place, Load::Mass, along);
    let velocity = |speed: Fx| Vec2::new(speed * 3 / 5, speed * 4 / 5);
    let kind = |speed, max| Motor::new().linear(velocity(speed), max).into();
    let drift = |world: &World, id| {
        let v = world.joint_velocity(id).expect("there");
        v.x * 3 / 5 + v.y * 4 / 5
    };
    accelerates(kind, Vec2::ZERO, Load::Mass, drift);
}

/// With 2 kg at 1 m from the hinge, a motor of 18 N m yields and a motor of 22 N m lifts the load.
#[test]
fn a_motor_stalls_under_a_larger_load() {
    for (torque, rises) in [(fx!(18), false), (fx!(22), true)] {
        let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(fx!(1), fx!(0)), fx!(0));
        let def = JointDef::new(bench.a, bench.b, Revolute::new().motor(fx!(1), torque));
        let joint = bench.join(def.anchor_b((fx!(-1), fx!(0))));
        bench.run(30, |tick, world| {
            let (_, exerted) = world.joint_force(joint).expect("there");
            assert!(exerted <= torque + fx!(0.05), "tick {tick}: {exerted} N m");
        });
        let angle = bench.world.joint_angle(joint).expect("there");
        assert_eq!(angle > fx!(0), rises, "{torque} N m: {angle} rad");
    }
    // The load of 20 N now hangs on a vertical slider.
    for (force, rises) in [(fx!(18), false), (fx!(22), true)] {
        let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::ZERO, fx!(0));
        let kind = Prismatic::new().motor(fx!(1), force);
        let def = JointDef::new(bench.a, bench.b, kind).angle_a(Angle::QUARTER).angle_b(Angle::QUARTER);
        let joint = bench.join(def);
        bench.run(30, |_, _| {});
        let height = bench.world.joint_translation(joint).expect("there").x;
        // 2 N accelerate 2 kg at 1 m/s² for half a second.
        close(height.abs(), fx!(0.125), fx!(0.005), "m");
        assert_eq!(height > fx!(0), rises);
    }
}

/// With a coefficient of 0.5, friction holds a box of 4 kg against up to 20 N.
#[test]
fn dragging_with_less_than_friction_does_not_move_a_box() {
    for (force, moves) in [(fx!(18), false), (fx!(24), true)] {
        let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(fx!(0), fx!(50)), fx!(0));
        let surface = |shape: ShapeDef| shape.friction(fx!(0.5));
        let floor = surface(ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).expect("valid")));
        let floor_body = BodyDef::fixed().position((fx!(0), fx!(-1)));
        bench.world.spawn(&floor_body, &[floor]).expect("valid");
        let shape = surface(ShapeDef::new(Polygon::square(fx!(1)).expect("valid"))).density(fx!(1));
        let body =
            bench.world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(1))), &[shape]).expect("valid");
        bench.run(60, |_, _| {});
        let kind = Motor::new().linear_spring(fx!(5), fx!(1), force);
        let joint = bench.join(JointDef::new(bench.a, body, kind).anchor_a((fx!(6), fx!(1))));
        bench.run(120, |tick, world| {
            let (exerted, _) = world.joint_force(joint).expect("there");
            assert!(exerted.length() <= force + fx!(0.05), "tick {tick}: {} N", exerted.length());
        });
        let x = bench.world.body(body).expect("there").position().x;
        if moves {
            // About 4 N accelerate 4 kg at 1 m/s² for 2 s.
            assert!(x > fx!(1) && x < fx!(4), "{force} N: {x} m");
        } else {
            assert!(x.abs() < fx!(0.01), "{force} N: {x} m");
        }
    }
}

/// A hinge with friction, a limit and a spring, as in a ragdoll.
#[test]
fn a_stiff_joint_comes_to_rest() {
    let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(fx!(0.3), fx!(0)), fx!(0));
    let kind =
        Revolute::new().limit(fx!(-0.8), fx!(0.8)).motor(fx!(0), fx!(0.5)).spring(fx!(2), fx!(0.5), fx!(0.1));
    let joint = bench.join(JointDef::new(bench.a, bench.b, kind).anchor_b((fx!(-0.3), fx!(0))));
    bench.run(300, |tick, world| {
        let angle = world.joint_angle(joint).expect("there");
        assert!(angle.abs() < fx!(0.816), "tick {tick}: {angle}");
        assert!(world.joint_length(joint).expect("there") < fx!(0.005));
    });
    let angle = bench.world.joint_angle(joint).expect("there");
    bench.run(60, |_, _| {});
    close(bench.world.joint_angle(joint).expect("there"), angle, fx!(0.001), "at rest");
    // Torques in N m: that of the spring is I omega^2 (0.1 - angle) = 78.96 (0.1 - angle), that of the weight is 6
    // cos(angle), and that of friction is at most 0.5.
    assert!(fx!(0.01) < angle + fx!(0.05) && angle < fx!(0.05), "{angle} rad");
}

/// `Fx::MAX` as the largest torque means no limit. If it were taken as a number of N m, it would accelerate a disc of
/// 31 kt by only 0.014 rad/s².
#[test]
fn motors_without_a_limit_move_any_mass_at_once() {
    let turning: [JointKind; 3] = [
        Revolute::new().motor(fx!(3), Fx::MAX).into(),
        Wheel::new().motor(fx!(3), Fx::MAX).into(),
        Motor::new().angular(fx!(3), Fx::MAX).into(),
    ];
    let moving: [JointKind; 3] = [
        Prismatic::new().motor(fx!(3), Fx::MAX).into(),
        Distance::new().motor(fx!(3), Fx::MAX).into(),
        Motor::new().linear((fx!(3), fx!(0)), Fx::MAX).into(),
    ];
    for (kind, turns) in turning.map(|kind| (kind, true)).into_iter().chain(moving.map(|kind| (kind, false)))
    {
        let mut world = World::default();
        world.set_gravity(Vec2::ZERO).expect("valid");
        let ground = world.spawn(&BodyDef::fixed().position((fx!(-5), fx!(0))), &[]).expect("valid");
        let disc = ShapeDef::new(Geometry::circle(fx!(100)).expect("valid")).density(fx!(1000));
        let disc = world.spawn(&BodyDef::dynamic(), &[disc]).expect("valid");
        let place = if matches!(kind, JointKind::Distance(_)) { fx!(0) } else { fx!(5) };
        let def = JointDef::new(ground, disc, kind).anchor_a((place, fx!(0)));
        let joint = world.add_joint(&def).expect("valid");
        world.step();
        let speed = if turns {
            world.joint_angular_velocity(joint)
        } else {
            world.joint_velocity(joint).map(|v| v.x)
        };
        close(speed.expect("there"), fx!(3), fx!(0.03), &format!("{kind:?}"));
    }
}
