//! Joints pass the limits of their range by at most a hundredth of the range.

use lockstep2d::body::{BodyDef, JointId, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, TAU, Vec2};
use lockstep2d::solver::{Distance, JointDef, JointKind, JointLimit, Prismatic, Revolute, Wheel};
use lockstep2d::world::{Config, World};

use crate::joint_bench::{Bench, Ground, close, grounds};

/// Drives a joint towards its upper limit, and another one towards its lower limit. A motor may accelerate a joint at
/// 300 m/s² or rad/s². Each joint must reach its limit and pass neither end of the range.
fn stays(
    kind: impl Fn(Fx, Fx, Fx) -> JointKind,
    place: Vec2<Fx>,
    (lower, upper): (Fx, Fx),
    at: impl Fn(&World, JointId) -> Fx,
) {
    for (ground, mass, inertia) in grounds() {
        for (speed, end) in [(fx!(5), upper), (fx!(-5), lower)] {
            let mut bench = Bench::new(ground, fx!(0), place, fx!(0));
            let joint = bench.join(JointDef::new(bench.a, bench.b, kind(speed, mass * 300, inertia * 300)));
            let slack = (upper - lower) / 100;
            bench.run(300, |tick, world| {
                let x = at(world, joint);
                assert!(lower - slack <= x && x <= upper + slack, "{ground:?}, tick {tick}: {x}");
            });
            close(at(&bench.world, joint), end, slack, "position at the limit");
        }
    }
}

#[test]
fn a_hinge_stops_at_its_limits() {
    let angle = |world: &World, id| world.joint_angle(id).expect("there");
    // The second range is more than a turn in both directions.
    for (lower, upper) in [(fx!(-0.5), fx!(0.75)), (fx!(-9), fx!(8))] {
        let kind = |speed, _, torque| Revolute::new().limit(lower, upper).motor(speed, torque).into();
        stays(kind, Vec2::ZERO, (lower, upper), angle);
    }
}

#[test]
fn a_slider_and_a_suspension_stop_at_their_limits() {
    let translation = |world: &World, id: JointId| world.joint_translation(id).expect("there").x;
    let (place, range) = (Vec2::new(fx!(1), fx!(0)), (fx!(0.5), fx!(2)));
    let kind = |speed, force, _| Prismatic::new().limit(range.0, range.1).motor(speed, force).into();
    stays(kind, place, range, translation);
    // A spring with its target at +10 m or -10 m drives the joint.
    let kind =
        |speed: Fx, _, _| Wheel::new().limit(range.0, range.1).spring(fx!(1), fx!(0.1), speed * 2).into();
    stays(kind, place, range, translation);
}

#[test]
fn a_distance_stops_at_its_limits() {
    let length = |world: &World, id| world.joint_length(id).expect("there");
    let range = (fx!(1), fx!(3));
    let kind = |speed, force, _| Distance::new().limit(range.0, range.1).motor(speed, force).into();
    stays(kind, Vec2::new(fx!(1.2), fx!(1.6)), range, length);
}

/// A load of 2 kg on a rod falls from the horizontal onto a stop.
#[test]
fn a_limit_bears_a_falling_rod() {
    let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(fx!(2), fx!(0)), fx!(0));
    let def = JointDef::new(bench.a, bench.b, Revolute::new().limit(fx!(-1), fx!(1)));
    let joint = bench.join(def.anchor_b((fx!(-2), fx!(0))));
    let mut lowest = fx!(0);
    bench.run(300, |_, world| {
        lowest = lowest.min(world.joint_angle(joint).expect("there"));
        let gap = world.joint_length(joint).expect("there");
        // Limit and hinge are solved one after the other, so the anchors come apart most at the impact, at 5.6 m/s.
        assert!(gap < fx!(0.03), "gap {gap} m");
    });
    assert!(lowest > fx!(-1.02), "{lowest} rad");
    let (force, torque) = bench.world.joint_force(joint).expect("there");
    // The hinge carries the weight of 20 N, and the stop carries its torque of 20 N x 2 m x cos(1) = 21.6 N m.
    close(force.y, fx!(20), fx!(0.2), "N");
    close(torque, fx!(21.612), fx!(0.3), "N m");
}

/// The body falls freely until the rope of 3 m is taut.
#[test]
fn a_rope_is_slack_and_then_taut() {
    let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(fx!(0), fx!(-1)), fx!(0));
    let joint = bench.join(JointDef::new(bench.a, bench.b, Distance::rope(fx!(3))));
    let (b, mut longest) = (bench.b, fx!(0));
    bench.run(240, |tick, world| {
        let body = world.body(b).expect("there");
        if tick < 36 {
            assert!(
                body.velocity().y < fx!(-0.16) * i64::try_from(tick + 1).expect("few"),
                "tick {tick}: expected free fall on a slack rope"
            );
        }
        longest = longest.max(world.joint_length(joint).expect("there"));
    });
    assert!(longest < fx!(3.03), "{longest} m");
    close(bench.world.joint_length(joint).expect("there"), fx!(3), fx!(0.005), "m of rope");
    close(bench.world.joint_force(joint).expect("there").0.y, fx!(20), fx!(0.2), "N");
}

/// A motor of up to 10^9 N m turns a hinge against its limit, where the hinge stays. If motor and limit acted against
/// each other, their impulses would grow until the hinge turned through the limit, by up to 266 rad.
#[test]
fn a_motor_of_any_force_does_not_turn_a_hinge_through_its_limit() {
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
    for base in [BodyDef::dynamic(), BodyDef::fixed()] {
        for max in [10, 1000, 100_000, 1_000_000_000].map(Fx::from_num) {
            for speed in [fx!(1), fx!(10), fx!(30), fx!(-30)] {
                let mut world =
                    World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid");
                let a = world.spawn(&base, &[square]).expect("valid");
                let b = BodyDef::dynamic().position((fx!(2), fx!(0)));
                let b = world.spawn(&b, &[square]).expect("valid");
                let kind = Revolute::new().limit(fx!(-0.5), fx!(0.5)).motor(speed, max);
                let def = JointDef::new(a, b, kind).anchor_a((fx!(1), fx!(0))).anchor_b((fx!(-1), fx!(0)));
                let joint = world.add_joint(&def).expect("valid");
                let what = format!("{:?}, {max} N m, {speed} rad/s", base.kind);
                for tick in 0..300 {
                    world.step();
                    let angle = world.joint_angle(joint).expect("there").abs();
                    assert!(angle < fx!(0.71), "{what}, tick {tick}: {angle} rad");
                }
                let angle = world.joint_angle(joint).expect("there");
                close(angle, fx!(0.5) * speed.signum(), fx!(0.001), &what);
                let speeds = world.bodies().map(|(_, body)| body.angular_velocity().abs());
                assert!(speeds.max().expect("bodies") < fx!(0.001) && world.faults() == 0, "{what}");
            }
        }
    }
}

#[test]
fn the_angle_of_a_hinge_counts_turns() {
    let mut bench = Bench::new(Ground::Free(fx!(3)), fx!(0), Vec2::ZERO, fx!(0));
    let kind = Revolute::new().motor(fx!(30), fx!(1000));
    let joint = bench.join(JointDef::new(bench.a, bench.b, kind).angle_a(Angle::QUARTER));
    let turns = TAU * 10;
    let mut ticks = 0;
    while bench.world.joint_angle(joint).expect("there") < turns {
        bench.run(1, |_, _| {});
        ticks += 1;
        assert!(ticks < 200);
    }
    // The angle starts at minus a quarter turn, and grows by 0.5 rad in a tick.
    close(fx!(0.5) * ticks, turns + TAU / 4, fx!(1), "rad");
    // A spring turns the hinge to the lower limit, 9 turns away.
    let mut bench = Bench::new(Ground::Fixed, fx!(0), Vec2::ZERO, fx!(0));
    let nine = TAU * 9;
    let kind = Revolute::new().limit(-nine, nine).spring(fx!(0.5), fx!(1), -nine * 2);
    let joint = bench.join(JointDef::new(bench.a, bench.b, kind));
    bench.run(600, |_, _| {});
    close(bench.world.joint_angle(joint).expect("there"), -nine, nine / 100, "rad");
}

/// While the joint is at 3 m, its upper limit changes to 2 m. The motor of the joint has no largest force; at a speed
/// of 0 it acts as a brake. The gap to the limit shrinks to `e^-60` of its size in a second.
#[test]
fn a_strong_motor_returns_to_a_limit_that_it_is_beyond() {
    let kinds: [fn(Fx) -> JointKind; 2] = [
        |speed| Prismatic::new().limit(fx!(0), fx!(3)).motor(speed, Fx::MAX).into(),
        |speed| Distance::new().limit(fx!(0), fx!(3)).motor(speed, Fx::MAX).into(),
    ];
    for (at, kind) in kinds.into_iter().enumerate() {
        for (speed, in_block) in [(fx!(1), false), (fx!(0), false), (fx!(1), true), (fx!(0), true)] {
            let mut bench = Bench::new(Ground::Fixed, fx!(0), Vec2::new(fx!(3), fx!(0)), fx!(0));
            let joint = bench.join(JointDef::new(bench.a, bench.b, kind(speed)));
            if in_block {
                bench.join(JointDef::new(bench.a, bench.b, Distance::rope(fx!(10))));
            }
            bench.run(10, |_, _| {});
            let limit = JointLimit { lower: fx!(0), upper: fx!(2) };
            bench.world.set_joint_limit(joint, Some(limit)).expect("valid");
            bench.run(30, |_, _| {});
            let what = format!("kind {at} at {speed} m/s, in a block: {in_block}");
            close(bench.world.body(bench.b).expect("there").position().x, fx!(2), fx!(0.001), &what);
            close(bench.world.joint_force(joint).expect("there").0.length(), fx!(0), fx!(0.1), &what);
        }
    }
}
