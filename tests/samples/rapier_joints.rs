//! The 2D examples of rapier that are about joints.

use lockstep2d::body::{BodyDef, BodyId};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, PI, Vec2, fx_mul};
use lockstep2d::solver::{Distance, JointDef, Prismatic, Revolute, Weld, Wheel};

use super::{Stage, ball, capsule, degrees, near, num, pill, rect, square};

/// Example `debug_angular_limits2`, with limits beyond a turn.
#[test]
fn arms_stop_at_limits_beyond_half_a_turn() {
    for (lower, upper) in [(-45, 45), (0, 270), (135, 225), (-350, 0), (-200, 200), (-700, 500)] {
        for direction in [1, -1] {
            let mut stage = Stage::weightless();
            let ground = stage.spawn(BodyDef::fixed(), &[]);
            let start = degrees((lower + upper) / 2);
            let place = start.direction().widen();
            let arm = stage.spawn(BodyDef::dynamic().position(place).angle(start), &[rect(fx!(1), fx!(0.1))]);
            let radians = |angle: i32| fx_mul(num(angle), PI) / 180;
            let middle = radians((lower + upper) / 2);
            // The limits are relative to the pose in which the joint is created.
            let hinge = Revolute::new().limit(radians(lower) - middle, radians(upper) - middle);
            let hinge = hinge.motor(fx!(5) * direction, fx!(20));
            let joint = stage.join_at(ground, arm, hinge, Vec2::ZERO);
            stage.run(300);
            let end = radians(if direction > 0 { upper } else { lower }) - middle;
            near(stage.world.joint_angle(joint).expect("there"), end, fx!(0.01));
        }
    }
}

/// Example `joint_motor_position2`.
#[test]
fn springs_turn_arms_to_their_targets() {
    for eighth in -3..=4 {
        let mut stage = Stage::weightless();
        let ground = stage.spawn(BodyDef::fixed(), &[]);
        let def = BodyDef::dynamic().position(at!(0, 0.5)).never_sleeps();
        let arm = stage.spawn(def, &[rect(fx!(0.1), fx!(0.5))]);
        let target = fx_mul(PI, num(eighth)) / 4;
        let joint = stage.join_at(ground, arm, Revolute::new().spring(fx!(3), fx!(1), target), Vec2::ZERO);
        stage.run(300);
        near(stage.world.joint_angle(joint).expect("there"), target, fx!(0.001));
        let end = PI / 2;
        let driven = Revolute::new().motor(fx!(1.5), fx!(10)).limit(-PI, end.max(target));
        let def = JointDef { kind: driven.into(), ..*stage.world.joint(joint).expect("there").def() };
        stage.world.set_joint(joint, &def).expect("valid");
        stage.run(600);
        near(stage.world.joint_angle(joint).expect("there"), end.max(target), fx!(0.005));
    }
}

/// Examples `joint_ball2`, `joint_fixed2`, `joint_prismatic2` and `joints2`.
#[test]
fn nets_hang() {
    let mut stage = Stage::new();
    let mut nodes: Vec<BodyId> = Vec::new();
    for i in 0..64 {
        let place = Vec2::new(num(i % 8), num(-i / 8));
        let def = if i < 8 && i % 3 == 0 { BodyDef::fixed() } else { BodyDef::dynamic() };
        let node = stage.spawn(def.position(place), &[ball(fx!(0.2))]);
        for other in [i - 8, if i % 8 > 0 { i - 1 } else { -1 }] {
            if let Some(&other) = usize::try_from(other).ok().and_then(|other| nodes.get(other)) {
                stage.join_at(other, node, Revolute::new(), stage.place(other));
            }
        }
        nodes.push(node);
    }
    // Rows of welds and of sliders hang beside the net.
    for (x, is_weld) in [(12, true), (22, false)] {
        let mut before = stage.spawn(BodyDef::fixed().position(Vec2::new(num(x), Fx::ZERO)), &[]);
        for i in 1..5 {
            let body = stage.add(Vec2::new(num(x + i), Fx::ZERO), ball(fx!(0.3)));
            let middle = Vec2::new(num(x + i) - fx!(0.5), Fx::ZERO);
            if is_weld {
                stage.join_at(before, body, Weld::rigid(), middle);
            } else {
                stage.join_along(
                    (before, body),
                    Prismatic::new().limit(fx!(-0.5), fx!(0.5)),
                    middle,
                    at!(0, 1),
                );
            }
            before = body;
        }
    }
    stage.run(600);
    assert!(stage.world.widest_joint_gap() < fx!(0.02), "{} m", stage.world.widest_joint_gap());
    assert!(nodes.iter().all(|&id| stage.place(id).y > fx!(-12)));
}

/// Example `locked_rotations2`.
#[test]
fn locks_of_rotation_and_of_translation() {
    let mut stage = Stage::with_floor();
    let bar =
        stage.spawn(BodyDef::dynamic().position(at!(0, 3)).lock_x().lock_y(), &[rect(fx!(2), fx!(0.6))]);
    let def = BodyDef::dynamic().position(at!(0.5, 5)).angle(Angle::from_radians(fx!(1))).lock_rotation();
    let pill = stage.spawn(def, &[capsule(at!(0, -0.6), at!(0, 0.6), fx!(0.4))]);
    let (start, mut turned) = (stage.body(pill).angle(), Fx::ZERO);
    stage.run_and(600, |stage| {
        assert_eq!((stage.place(bar), stage.body(pill).angle()), (at!(0, 3), start));
        turned = turned.max(stage.angle(bar).abs());
    });
    assert!(turned > fx!(0.3) && stage.place(pill).y < fx!(2), "{turned} rad, {:?}", stage.place(pill));
}

/// Example `multi_pendulum2`.
#[test]
fn pendulums_of_bars_gain_no_energy() {
    for bars in 1..=6 {
        let mut stage = Stage::new();
        let mut before = stage.spawn(BodyDef::fixed(), &[]);
        for i in 0..bars {
            let bar = stage.spawn(
                BodyDef::dynamic().position(Vec2::new(num(2 * i), Fx::ZERO)).never_sleeps(),
                &[pill(fx!(1), fx!(0.2)).offset(at!(1, 0))],
            );
            stage.join_at(before, bar, Revolute::new(), Vec2::new(num(2 * i), Fx::ZERO));
            before = bar;
        }
        let start = stage.energy();
        // The tolerance is a hundredth of the difference in energy between the level and the hanging pose.
        let allowed = fx!(0.1) * i64::from(bars * bars);
        stage.run_and(600, |stage| assert!(stage.energy() < start + allowed, "{bars}: {} J", stage.energy()));
        assert!(stage.world.widest_joint_gap() < fx!(0.01));
    }
}

/// Example `pin_slot_joint2`.
#[test]
fn a_cube_slides_and_turns_in_a_slot() {
    let mut stage = Stage::new();
    let ground = stage.spawn(BodyDef::fixed(), &[]);
    let cube = stage.add(at!(2, 1.6), square(fx!(0.4)));
    let marker = stage.add(at!(2, 1.2), ball(fx!(0.1)));
    stage.join_at(cube, marker, Weld::rigid(), at!(2, 1.2));
    let slot = Wheel::new().limit(fx!(-1), fx!(1000));
    let slot = stage.join_along((ground, cube), slot, at!(2, 2), at!(1, 1));
    stage.run_and(600, |stage| {
        let translation = stage.world.joint_translation(slot).expect("there");
        assert!(translation.x > fx!(-1.02) && translation.y.abs() < fx!(0.01), "{translation:?}");
        assert!(stage.world.widest_joint_gap() < fx!(0.01));
    });
    near(stage.world.joint_translation(slot).expect("there").x, fx!(-1), fx!(0.02));
}

/// Example `rope_joints2`.
#[test]
fn a_rope_tows() {
    let mut stage = Stage::with_floor();
    let tug = stage
        .spawn(BodyDef::kinematic().position(at!(0, 1)).velocity(at!(2, 0)), &[rect(fx!(0.15), fx!(0.3))]);
    let towed = stage.add(at!(-1, 0.1), ball(fx!(0.1)));
    let rope = stage.join(JointDef::new(tug, towed, Distance::rope(fx!(2))));
    stage.run_and(600, |stage| {
        assert!(stage.world.joint_length(rope).is_some_and(|length| length < fx!(2.01)));
    });
    near(stage.velocity(towed).x, fx!(2), fx!(0.05));
}
