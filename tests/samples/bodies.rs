//! Samples of Box2D's group "Bodies".

use lockstep2d::body::{BodyDef, BodyKind, MassSource};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_mul, widen};
use lockstep2d::solver::{Prismatic, Revolute};
use lockstep2d::world::Explosion;

use super::{Stage, ball, capsule, line, near, num, pill, rect, square};

/// Sample "Body Type".
#[test]
fn a_jointed_platform_changes_its_kind() {
    let mut stage = Stage::new();
    let ground = stage.floor();
    let attachment = stage.add(at!(-2, 3), rect(fx!(0.5), fx!(2)));
    let platform = stage.add(at!(0, 5), rect(fx!(4), fx!(0.5)).density(fx!(2)));
    let hinge = Revolute::new().motor(fx!(0), fx!(50));
    stage.join_at(attachment, platform, hinge, at!(-2, 5));
    let slider = Prismatic::new().limit(fx!(-10), fx!(10)).motor(fx!(0), fx!(1000));
    stage.join_at(ground, platform, slider, at!(0, 5));
    let load = stage.add(at!(-1, 6.25), square(fx!(0.75)).density(fx!(2)));
    stage.run(60);
    near(stage.place(platform).y, fx!(5), fx!(0.01));
    near(stage.place(load).y, fx!(6.25), fx!(0.02));

    stage.world.set_kind(platform, BodyKind::Kinematic).expect("valid");
    let start = stage.place(platform);
    stage.world.set_velocity(platform, at!(3, 0), fx!(0)).expect("valid");
    stage.run(60);
    near(stage.place(platform).x, start.x + fx!(3), fx!(0.000001));
    assert_eq!(stage.place(platform).y, start.y);
    // Friction 0.6 accelerates the load to 3 m/s in half a second.
    near(stage.velocity(load).x, fx!(3), fx!(0.01));

    stage.world.set_kind(platform, BodyKind::Fixed).expect("valid");
    let start = stage.place(platform);
    stage.run(60);
    assert_eq!(stage.place(platform), start);
    near(stage.velocity(load).x, fx!(0), fx!(0.01));

    stage.world.set_kind(platform, BodyKind::Dynamic).expect("valid");
    stage.run(60);
    near(stage.place(platform).y, fx!(5), fx!(0.01));
    stage.world.disable(platform).expect("valid");
    stage.run(120);
    near(stage.place(load).y, fx!(0.75), fx!(0.01));
    near(stage.place(platform).y, fx!(5), fx!(0.01));
}

/// Sample "Weeble", with a low centre of mass.
#[test]
fn a_weeble_rights_itself() {
    let mut stage = Stage::with_floor();
    let mass = MassSource::Given { mass: fx!(7.14), centre: at!(0, -1.5), gyration: fx!(1) };
    let def = BodyDef::dynamic().position(at!(0, 3)).angle(Angle::from_degrees(fx!(45)));
    let shape = capsule(at!(0, -1), at!(0, 1), fx!(1));
    let weeble = stage.spawn(def.mass(mass).angular_damping(fx!(1)), &[shape]);
    stage.run(900);
    near(stage.angle(weeble), fx!(0), fx!(0.05));
    let centre = stage.place(weeble) + at!(-2, 0);
    stage.world.explode(&Explosion { radius: fx!(2), ..Explosion::new(centre, fx!(8)) }).expect("valid");
    let mut tilt = fx!(0);
    stage.run_and(900, |stage| tilt = tilt.max(stage.angle(weeble).abs()));
    assert!(tilt > fx!(0.1), "expected the explosion to tilt it, by {tilt} rad");
    near(stage.angle(weeble), fx!(0), fx!(0.05));
    // The velocity of a point is v + w x r.
    stage.world.set_velocity(weeble, at!(1, 2), fx!(3)).expect("valid");
    let body = stage.body(weeble);
    let point = body.centre_of_mass() + at!(0.5, 2);
    assert_eq!(body.velocity_at(point), at!(-5, 3.5));
}

/// Sample "Sleep".
#[test]
fn sleepers_wait_to_be_woken() {
    let mut stage = Stage::with_floor();
    let sensor = capsule(at!(0, 0), at!(1, 0), fx!(1)).sensor();
    let def = BodyDef::dynamic().position(at!(-4, 3)).asleep();
    let floating = stage.spawn(def, &[pill(fx!(0.5), fx!(0.5)), sensor]);
    let restless =
        stage.spawn(BodyDef::dynamic().position(at!(0, 3)).asleep().never_sleeps(), &[ball(fx!(1))]);
    let lower = stage.spawn(BodyDef::dynamic().position(at!(5, 1)).asleep(), &[square(fx!(1))]);
    let upper = stage.add(at!(5, 5), square(fx!(0.5)));
    // The ball flies above the solid part of the sleeper, through its sensor.
    let def = BodyDef::dynamic().position(at!(-4, 3.8)).gravity_scale(fx!(0)).velocity((fx!(6), fx!(0)));
    let visitor = stage.spawn(def, &[ball(fx!(0.1))]);
    let (mut begins, mut ends, mut woken) = (0, 0, false);
    stage.run_and(120, |stage| {
        begins += stage.world.events().sensor_begin.len();
        ends += stage.world.events().sensor_end.len();
        woken |= !stage.body(lower).is_asleep();
    });
    assert!(stage.body(floating).is_asleep() && stage.place(floating) == at!(-4, 3));
    assert_eq!((begins, ends), (1, 1), "expected the visitor to cross the sensor");
    assert!(stage.place(visitor).x > fx!(0));
    near(stage.place(restless).y, fx!(1), fx!(0.01));
    assert!(!stage.body(restless).is_asleep());
    assert!(woken, "expected the falling box to wake the lower one");
    near(stage.place(upper).y, fx!(2.5), fx!(0.02));
}

/// Sample "Sleep": the long pendulum.
#[test]
fn a_long_pendulum_does_not_fall_asleep_at_its_turning_point() {
    let mut stage = Stage::new();
    let ground = stage.spawn(BodyDef::fixed(), &[]);
    let def = BodyDef::dynamic().position(at!(0, 100)).angular_damping(fx!(0.5)).sleep_speed(fx!(0.05));
    let pendulum = stage.spawn(def, &[capsule(at!(0, 0), at!(90, 0), fx!(0.25))]);
    stage.join_at(ground, pendulum, Revolute::new(), at!(0, 100));
    for _ in 0..120 * 60 {
        stage.world.step();
        if stage.body(pendulum).is_asleep() {
            break;
        }
    }
    assert!(stage.body(pendulum).is_asleep(), "expected the pendulum to come to rest");
    near(stage.angle(pendulum), -fx!(1.5708), fx!(0.02));
}

/// Sample "Bad". A dynamic body without mass keeps its velocity like a kinematic body.
#[test]
fn a_body_without_mass_coasts() {
    let mut stage = Stage::with_floor();
    let def = BodyDef::dynamic().position(at!(0, 3)).angular_velocity(fx!(0.5));
    let bad = stage.spawn(def, &[capsule(at!(0, -1), at!(0, 1), fx!(1)).density(fx!(0))]);
    let good = stage.add(at!(5, 3), capsule(at!(0, -1), at!(0, 1), fx!(1)));
    stage.run_and(60, |stage| stage.world.apply_force_to_centre(bad, at!(0, 10)).expect("valid"));
    assert_eq!(stage.place(bad), at!(0, 3));
    near(stage.angle(bad), fx!(0.5), fx!(0.0001));
    near(stage.place(good).y, fx!(2), fx!(0.02));
}

/// Sample "Pivot". At first, the lower end of the bar is at rest.
#[test]
fn a_bar_starts_to_turn_about_its_lower_end() {
    let mut stage = Stage::weightless();
    let spin = fx!(-5 / 3);
    let def = BodyDef::dynamic().position(at!(0, 3)).velocity(at!(5, 0)).angular_velocity(spin);
    let bar = stage.spawn(def, &[rect(fx!(0.1), fx!(3))]);
    let lower_end = |stage: &Stage| stage.body(bar).transform().apply(at!(0, -3));
    let body = stage.body(bar);
    assert!(body.velocity_at(Vec2::ZERO).length() < fx!(0.00001), "{:?}", body.velocity_at(Vec2::ZERO));
    for tick in 1..=30 {
        stage.world.step();
        // With half the length `l` of the bar, the lower end of a free bar is at x = v t - l sin(w t), y = l - l cos(w
        // t).
        let turn = Angle::from_radians(fx_mul(spin, num(tick) / 60));
        let x = num(tick) / 12 + widen(turn.sin()) * 3;
        let expected = Vec2::new(x, fx!(3) - widen(turn.cos()) * 3);
        assert!(lower_end(&stage).distance(expected) < fx!(0.0005), "tick {tick}: {:?}", lower_end(&stage));
    }
}

/// Sample "Kinematic".
#[test]
fn a_kinematic_body_follows_a_figure_of_eight() {
    let mut stage = Stage::new();
    let body = stage.spawn(BodyDef::kinematic().position(at!(4, 0)), &[rect(fx!(0.1), fx!(1))]);
    for tick in 0..240 {
        let time = Angle::from_radians(num(tick) / 60);
        let place = Vec2::new(widen(time.cos()) * 4, widen((time + time).sin()) * 2);
        stage.world.move_to(body, place, time + time).expect("in range");
        stage.run(1);
        assert_eq!((stage.place(body), stage.body(body).angle()), (place, time + time));
    }
}

/// Sample "Mixed Locks".
#[test]
fn locks_hold_exactly() {
    let mut stage = Stage::with_floor();
    let dynamic = BodyDef::dynamic();
    let upright = stage.spawn(dynamic.position(at!(-1, 1)).lock_rotation(), &[square(fx!(0.5))]);
    let vertical = stage.spawn(dynamic.position(at!(-2, 2)).lock_x(), &[square(fx!(0.5))]);
    let level = stage.spawn(dynamic.position(at!(-1, 2.5)).lock_y().lock_rotation(), &[square(fx!(0.5))]);
    let held = dynamic.position(at!(0, 1)).lock_x().lock_y().lock_rotation();
    let held = stage.spawn(held, &[square(fx!(0.5))]);
    for i in 0..6 {
        stage.throw(Vec2::new(num(i) / 2 - fx!(2.2), num(6 + i)), at!(1, -3), square(fx!(0.3)));
    }
    stage.run_and(300, |stage| {
        assert_eq!(stage.angle(upright), Fx::ZERO);
        assert_eq!(stage.place(vertical).x, fx!(-2));
        assert_eq!((stage.place(level).y, stage.angle(level)), (fx!(2.5), Fx::ZERO));
        assert_eq!((stage.place(held), stage.angle(held)), (at!(0, 1), Fx::ZERO));
    });
    near(stage.place(upright).y, fx!(0.5), fx!(0.02));
}

/// Sample "Set Velocity".
#[test]
fn a_box_that_is_pushed_down_does_not_sink() {
    let mut stage = Stage::with_floor();
    let body = stage.add(at!(0, 0.5), square(fx!(0.5)));
    stage.run_and(120, |stage| {
        near(stage.place(body).y, fx!(0.5), fx!(0.01));
        stage.world.set_velocity(body, at!(0, -20), fx!(0)).expect("valid");
    });
}

/// Sample "Wake Touching".
#[test]
fn waking_the_ground_wakes_what_lies_on_it() {
    let mut stage = Stage::new();
    let ground = stage.fixed(Vec2::ZERO, line(at!(-20, 0), at!(20, 0)));
    let boxes: Vec<_> =
        (0..10).map(|i| stage.add(Vec2::new(num(2 * i - 9), fx!(1)), square(fx!(0.5)))).collect();
    stage.run(180);
    assert!(boxes.iter().all(|&id| stage.body(id).is_asleep()));
    stage.world.wake(ground).expect("valid");
    assert!(boxes.iter().all(|&id| !stage.body(id).is_asleep()));
}
