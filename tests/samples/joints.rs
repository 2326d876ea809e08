//! Samples of Box2D's group "Joints", without the machines, which are in `machines.rs`.

use lockstep2d::body::{BodyDef, BodyId};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_div, fx_mul, sqrt, widen};
use lockstep2d::solver::{
    Distance, JointDef, JointKind, JointPart, Motor, Prismatic, Revolute, Threshold, ThresholdAction, Weld,
    Wheel,
};

use super::{Stage, ball, capsule, near, num, rect, square};

/// Unit vector at 45 degrees.
fn diagonal() -> Vec2<Fx> {
    at!(0.70710678, 0.70710678)
}

/// Displacement `g / (2 pi f)^2` by which a spring yields to a weight.
fn sag(gravity: Fx, hertz: Fx) -> Fx {
    let omega = fx_mul(lockstep2d::math::PI * 2, hertz);
    fx_div(gravity, fx_mul(omega, omega)).expect("positive")
}

/// Sample "Distance Joint": rods.
#[test]
fn rods_keep_their_lengths() {
    let mut stage = Stage::new();
    let mut before = stage.spawn(BodyDef::fixed().position(at!(0, 20)), &[]);
    let joints: Vec<_> = (1..=5)
        .map(|i| {
            let def = BodyDef::dynamic().position(Vec2::new(num(i), fx!(20))).angular_damping(fx!(1));
            let body = stage.spawn(def, &[ball(fx!(0.25)).density(fx!(20))]);
            let joint = stage.join(JointDef::new(before, body, Distance::rod(fx!(1))));
            before = body;
            joint
        })
        .collect();
    stage.run_and(600, |stage| {
        for &joint in &joints {
            near(stage.world.joint_length(joint).expect("there"), fx!(1), fx!(0.01));
        }
    });
}

/// Sample "Distance Joint": springs and limits.
#[test]
fn a_distance_joint_is_a_spring_with_limits() {
    let hang = |kind: Distance, ticks: u32| {
        let mut stage = Stage::new();
        let top = stage.spawn(BodyDef::fixed().position(at!(0, 20)), &[]);
        let body = stage.add(at!(0, 19), ball(fx!(0.25)).density(fx!(20)));
        let joint = stage.join(JointDef::new(top, body, kind));
        stage.run(ticks);
        stage.world.joint_length(joint).expect("there")
    };
    near(
        hang(Distance::new().spring(fx!(5), fx!(0.5), fx!(1)), 600),
        fx!(1) + sag(fx!(10), fx!(5)),
        fx!(0.001),
    );
    near(
        hang(Distance::new().spring(fx!(0.5), fx!(0.5), fx!(1)).limit(fx!(0.5), fx!(1.5)), 600),
        fx!(1.5),
        fx!(0.005),
    );
    near(hang(Distance::new().limit(fx!(0.5), fx!(2)), 300), fx!(2), fx!(0.005));
    // A spring that only pushes does not hold the ball. In one second the ball falls by g t^2 / 2 = 5 m, so the length
    // grows from 1 m to 6 m.
    let fallen = hang(Distance::new().spring(fx!(5), fx!(0), fx!(1)).spring_force(fx!(0), fx!(100)), 60);
    near(fallen, fx!(6), fx!(0.1));
    // This spring pulls with at most 19.635 N, half the weight of the ball. It reaches this force when stretched by half its sag, after a
    // sixth of its period. The ball then has (g / w) sin(60 degrees) = 0.276 m/s, and accelerates at 5 m/s².
    let fallen =
        hang(Distance::new().spring(fx!(5), fx!(0), fx!(1)).spring_force(fx!(-19.635), fx!(100)), 60);
    near(fallen, fx!(3.61), fx!(0.03));
}

/// Sample "Motor Joint".
#[test]
fn a_motor_joint_follows_its_target() {
    let mut stage = Stage::with_floor();
    let target = stage.spawn(BodyDef::kinematic().position(at!(0, 8)), &[]);
    let body = stage.add(at!(0, 8), rect(fx!(2), fx!(0.5)));
    let motor =
        Motor::new().linear_spring(fx!(4), fx!(0.7), fx!(5000)).angular_spring(fx!(4), fx!(0.7), fx!(500));
    let joint = stage.join(JointDef::new(target, body, motor));
    let ground = stage.spawn(BodyDef::fixed(), &[]);
    let held = stage.add(at!(-9, 2), square(fx!(0.5)));
    let spring =
        Motor::new().linear_spring(fx!(7.5), fx!(0.7), fx!(500)).angular_spring(fx!(7.5), fx!(0.7), fx!(100));
    stage.join(JointDef::new(ground, held, spring).anchor_a(at!(-9, 2)));
    for tick in 1..=600 {
        let time = Angle::from_radians(num(tick) / 60);
        let place = Vec2::new(widen((time + time).sin()) * 6, fx!(8) + widen(time.sin()) * 4);
        stage.world.move_to(target, place, time + time).expect("in range");
        stage.run(1);
        // The target accelerates by at most 24 m/s² along x and 4 m/s² along y. With gravity this is sqrt(24^2 + 14^2)
        // = 28 m/s².
        let bound = sag(fx!(28), fx!(4)) * 2;
        // The bound does not hold in the first second, because the velocity of the target jumps to 12 m/s at the start.
        assert!(
            tick < 60 || stage.place(body).distance(place) < bound,
            "tick {tick}: {:?} of {place:?}",
            stage.place(body)
        );
    }
    near(stage.place(held).y, fx!(2) - sag(fx!(10), fx!(7.5)), fx!(0.001));
    assert!(stage.world.joint_force(joint).is_some_and(|(force, _)| force.length() < fx!(5000)));
}

/// Sample "Top Down Friction". A friction of 10 N stops 1 kg at 5 m/s after half a second and 1.25 m.
#[test]
fn a_motor_joint_is_friction_seen_from_above() {
    let mut stage = Stage::weightless();
    let ground = stage.spawn(BodyDef::fixed(), &[]);
    let def = BodyDef::dynamic().velocity(at!(3, 4)).angular_velocity(fx!(6));
    let body = stage.spawn(def, &[square(fx!(0.5))]);
    let motor = Motor::new().linear(Vec2::ZERO, fx!(10)).angular(fx!(0), fx!(1));
    stage.join(JointDef::new(ground, body, motor).colliding());
    // A friction of 1 N m stops 6 rad/s after a second: the inertia is 1/6 kg m².
    stage.run(30);
    near(stage.velocity(body).length(), fx!(0), fx!(0.01));
    near(stage.body(body).angular_velocity(), fx!(3), fx!(0.01));
    stage.run(60);
    assert!(stage.place(body).distance(at!(0.75, 1)) < fx!(0.03), "{:?}", stage.place(body));
    near(stage.body(body).angular_velocity(), fx!(0), fx!(0.001));
}

/// Sample "Filter Joint".
#[test]
fn a_filter_joint_lets_two_bodies_overlap() {
    let mut stage = Stage::with_floor();
    let left = stage.add(at!(-0.5, 2), square(fx!(2)));
    let right = stage.add(at!(0.5, 2), square(fx!(2)));
    let joint = stage.join(JointDef::new(left, right, JointKind::Filter));
    stage.run(120);
    near(stage.place(right).x - stage.place(left).x, fx!(1), fx!(0.001));
    stage.world.remove_joint(joint).expect("there");
    stage.run(300);
    let apart = stage.place(right) - stage.place(left);
    assert!(apart.x.abs().max(apart.y.abs()) > fx!(3.97), "still at {apart:?}");
}

/// Sample "Revolute".
#[test]
fn a_hinge_has_motor_limit_and_spring() {
    let hinge = |kind: Revolute, gravity: Fx, ticks: u32| {
        let mut stage = Stage::with_gravity(Vec2::new(Fx::ZERO, gravity));
        let ground = stage.spawn(BodyDef::fixed(), &[]);
        let body = stage.add(at!(-10, 20), capsule(at!(0, -1), at!(0, 6), fx!(0.5)));
        let joint = stage.join_at(ground, body, kind, at!(-10, 20.5));
        stage.run(ticks);
        (
            stage.world.joint_angle(joint).expect("there"),
            stage.world.joint_angular_velocity(joint).expect("there"),
        )
    };
    let limit = (fx!(-1.5708), fx!(0.157));
    let driven = Revolute::new().motor(fx!(-1), fx!(1000));
    let ((start, _), (angle, speed)) = (hinge(driven, fx!(-10), 60), hinge(driven, fx!(-10), 120));
    near(angle - start, fx!(-1), fx!(0.005));
    near(speed, fx!(-1), fx!(0.01));
    let (angle, speed) =
        hinge(Revolute::new().motor(fx!(-1), fx!(1000)).limit(limit.0, limit.1), fx!(-10), 300);
    near(angle, limit.0, fx!(0.01));
    near(speed, fx!(0), fx!(0.01));
    let (angle, _) = hinge(Revolute::new().motor(fx!(1), fx!(1000)).limit(limit.0, limit.1), fx!(-10), 120);
    near(angle, limit.1, fx!(0.01));
    let (angle, _) = hinge(Revolute::new().spring(fx!(2), fx!(0.5), fx!(0.785)), fx!(0), 600);
    near(angle, fx!(0.785), fx!(0.001));

    let mut stage = Stage::with_floor();
    let ground = stage.spawn(BodyDef::fixed(), &[]);
    let lever = stage.add(at!(20, 10), rect(fx!(10), fx!(0.5)).offset(at!(-10, 0)));
    let kind = Revolute::new().limit(fx!(-0.7854), fx!(0)).motor(fx!(0), fx!(1000));
    let joint = stage.join_at(ground, lever, kind, at!(19, 10));
    // A force of 200 N at 9 m overcomes the motor, and turns the body counter-clockwise to the upper limit of 0.
    stage.run(120);
    near(stage.world.joint_angle(joint).expect("there"), fx!(0), fx!(0.01));
    let (_, motor) = stage.world.joint_part_force(joint, JointPart::Motor).expect("there");
    assert!(motor.abs() <= fx!(1000.1), "{motor} N m");
    let (_, limit) = stage.world.joint_part_force(joint, JointPart::Limit).expect("there");
    near((motor + limit).abs(), fx!(1800), fx!(20));
    let ball = stage.add(at!(5, 30), ball(fx!(2)));
    stage.run(600);
    assert!(stage.world.joint_angle(joint).is_some_and(|angle| angle.abs() < fx!(0.02)));
    assert!(stage.place(ball).y < fx!(13));
}

/// Sample "Prismatic".
#[test]
fn a_slider_stays_on_its_axis() {
    let slide = |kind: Prismatic, ticks: u32| {
        let mut stage = Stage::new();
        let ground = stage.spawn(BodyDef::fixed(), &[]);
        let body = stage.add(at!(0, 10), rect(fx!(0.5), fx!(2)));
        let joint = stage.join_along((ground, body), kind, at!(0, 9), diagonal());
        stage.run_and(ticks, |stage| {
            near(stage.world.joint_translation(joint).expect("there").y, fx!(0), fx!(0.005));
            near(stage.angle(body), fx!(0), fx!(0.005));
        });
        stage.world.joint_translation(joint).expect("there").x
    };
    let limited = Prismatic::new().limit(fx!(-10), fx!(10));
    // The body slides by g sin(45 degrees) t^2 / 2.
    near(slide(limited, 60), fx!(-3.5355), fx!(0.07));
    near(slide(limited, 600), fx!(-10), fx!(0.01));
    // The weight of 4 kg pulls with 28.28 N along the axis. A motor of 25 N leaves 0.8211 m/s².
    near(slide(limited.motor(fx!(2), fx!(25)), 120), fx!(-1.642), fx!(0.03));
    // A motor of 100 N accelerates by a = 17.9 m/s² up to v = 2 m/s. In 2 s the body moves by 2 s * v - v^2 / 2 a.
    near(slide(limited.motor(fx!(2), fx!(100)), 120), fx!(3.888), fx!(0.02));
    near(slide(limited.spring(fx!(1), fx!(0.5), fx!(0)), 900), -sag(fx!(7.0711), fx!(1)), fx!(0.002));
}

/// Sample "Wheel".
#[test]
fn a_wheel_turns_on_its_spring() {
    let mut stage = Stage::new();
    let ground = stage.spawn(BodyDef::fixed(), &[]);
    let wheel = stage.add(at!(0, 10), ball(fx!(0.5)));
    let kind = Wheel::new().spring(fx!(1), fx!(0.7), fx!(0)).limit(fx!(-3), fx!(3)).motor(fx!(2), fx!(5));
    let joint = stage.join_along((ground, wheel), kind, at!(0, 10), diagonal());
    stage.run(900);
    let translation = stage.world.joint_translation(joint).expect("there");
    near(translation.x, -sag(fx!(7.0711), fx!(1)), fx!(0.002));
    near(translation.y, fx!(0), fx!(0.002));
    near(stage.body(wheel).angular_velocity(), fx!(2), fx!(0.001));
}

/// Boxes of 4 kg, joined to a fixed body by joints of six kinds.
fn held_boxes(stage: &mut Stage, locks: BodyDef, change: impl Fn(JointDef) -> JointDef) -> Vec<BodyId> {
    let ground = stage.spawn(BodyDef::fixed(), &[]);
    let wheel = Wheel::new().spring(fx!(1), fx!(0.7), fx!(0)).limit(fx!(-1), fx!(1)).motor(fx!(1), fx!(10));
    let kinds: [(JointKind, Vec2<Fx>); 6] = [
        (Distance::rod(fx!(2)).into(), at!(0, 1)),
        (Motor::new().linear(Vec2::ZERO, fx!(1000)).angular(fx!(0), fx!(20)).into(), at!(0, 0)),
        (Prismatic::new().into(), at!(-1, 0)),
        (Revolute::new().into(), at!(-1, 0)),
        (Weld::rigid().into(), at!(-1, 0)),
        (wheel.into(), at!(-1, 0)),
    ];
    let mut bodies = Vec::new();
    for (i, (kind, anchor)) in (0..).zip(kinds) {
        let place = Vec2::new(num(5 * i) - fx!(12.5), fx!(10));
        let body = stage.spawn(locks.position(place), &[square(fx!(1))]);
        let above = if matches!(kind, JointKind::Distance(_)) { at!(0, 2) } else { Vec2::ZERO };
        let def =
            JointDef::new(ground, body, kind).anchor_a(place + anchor + above).anchor_b(anchor).colliding();
        stage.join(change(def));
        bodies.push(body);
    }
    bodies
}

/// Sample "Motion Locks".
#[test]
fn locks_and_joints_agree() {
    let mut stage = Stage::new();
    let upright = held_boxes(&mut stage, BodyDef::dynamic().lock_rotation(), |def| def);
    stage.run_and(300, |stage| assert!(upright.iter().all(|&id| stage.angle(id) == Fx::ZERO)));
    for &id in &upright {
        near(stage.place(id).y, fx!(10), fx!(0.01));
    }
    let mut stage = Stage::new();
    let held = held_boxes(&mut stage, BodyDef::dynamic().lock_x().lock_y(), |def| def);
    let places: Vec<_> = held.iter().map(|&id| stage.place(id)).collect();
    stage.run(300);
    for (&id, start) in held.iter().zip(places) {
        assert_eq!(stage.place(id), start);
    }
}

/// Samples "Breakable" and, of the group "Events", "Joint". A box weighs 40 N. If it swings on a hinge at the distance
/// `r` from its centre, the load at the lowest point is `m g (1 + 2 r^2 / (r^2 + k^2)) = 88 N`, with the radius of
/// gyration `k`.
#[test]
fn joints_break_above_their_threshold() {
    for action in [ThresholdAction::Break, ThresholdAction::Event] {
        for (newtons, holds) in [(fx!(100), true), (fx!(30), false)] {
            let mut stage = Stage::with_floor();
            let threshold = Threshold { force: Some(newtons), torque: None, action };
            let bodies =
                held_boxes(&mut stage, BodyDef::dynamic().never_sleeps(), |def| def.threshold(threshold));
            let mut events = 0;
            stage.run_and(300, |stage| {
                let broken: Vec<_> = stage.world.events().joints.iter().map(|event| event.joint).collect();
                events += broken.len();
                if action == ThresholdAction::Event {
                    broken.iter().for_each(|&id| stage.world.remove_joint(id).expect("still there"));
                }
            });
            assert_eq!((stage.world.joint_count(), events), if holds { (6, 0) } else { (0, 6) });
            let fallen = |&&id: &&BodyId| stage.place(id).y < fx!(1.1);
            assert_eq!(bodies.iter().filter(fallen).count(), if holds { 0 } else { 6 });
        }
    }
}

/// Sample "Separation".
#[test]
fn joints_close_after_a_blow() {
    let mut stage = Stage::new();
    let bodies = held_boxes(&mut stage, BodyDef::dynamic().never_sleeps(), |def| def);
    stage.run(60);
    for &id in &bodies {
        let centre = stage.place(id);
        stage.world.apply_impulse(id, at!(40, -60), centre + at!(0, 0.5)).expect("valid");
    }
    let joints: Vec<_> = stage.world.joints().map(|(id, _)| id).collect();
    stage.run(600);
    for id in joints {
        // A motor joint has no rigid part.
        let is_motor = matches!(stage.world.joint(id).expect("there").def().kind, JointKind::Motor(_));
        let error = stage.world.joint_error(id);
        assert!(error.map_or(is_motor, |error| error < fx!(0.005)), "{error:?} m");
    }
}

/// Sample "User Constraint". Ropes are impulses that the test applies between the ticks.
#[test]
fn a_constraint_of_ones_own_holds_a_box() {
    let mut stage = Stage::new();
    let def = BodyDef::dynamic().angular_damping(fx!(0.5)).linear_damping(fx!(0.2)).never_sleeps();
    let body = stage.spawn(def, &[rect(fx!(1), fx!(0.5)).density(fx!(20))]);
    let (hook, corners) = (at!(3, 0), [at!(1, -0.5), at!(1, 0.5)]);
    let rope = |stage: &Stage, corner: Vec2<Fx>| hook.distance(stage.body(body).transform().apply(corner));
    // Each rope is a spring that only pulls, with 3 Hz for half of the 40 kg and a damping ratio of 0.7.
    let stiffness = fx!(20) * 355;
    let damping = fx!(20) * 26;
    for _ in 0..3600 {
        stage.run(1);
        let pulls = corners.map(|corner| {
            let end = stage.body(body).transform().apply(corner);
            let stretch = rope(&stage, corner) - fx!(1);
            if stretch > 0 {
                let away = (end - hook).scale(fx_div(fx!(1), hook.distance(end)).expect("positive"));
                let speed = stage.body(body).velocity_at(end).dot(away);
                let pull = (fx_mul(stiffness, stretch) + fx_mul(damping, speed)).max(Fx::ZERO) / 60;
                (away.scale(-pull), end)
            } else {
                (Vec2::ZERO, end)
            }
        });
        for (impulse, end) in pulls {
            stage.world.apply_impulse(body, impulse, end).expect("valid");
        }
    }
    // The two ropes carry 400 N evenly, each at asin(0.5 / length) from the vertical.
    for corner in corners {
        let length = rope(&stage, corner);
        let lean = sqrt(fx_mul(length, length) - fx!(0.25)).expect("longer than half a metre");
        let tension = fx_div(fx_mul(fx!(200), length), lean).expect("positive");
        // A part of the tension is damping. The impulses are computed between two ticks, when the box falls at
        // `1.5 g h`, where `h` is a sub-step.
        let damped = fx_div(fx_mul(damping, lean), length * 16).expect("positive");
        near(length, fx!(1) + fx_div(tension - damped, stiffness).expect("positive"), fx!(0.001));
    }
    near(stage.place(body).x, fx!(3), fx!(0.05));
    assert!(stage.place(body).y < fx!(-1.5));
}
