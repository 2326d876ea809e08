//! Settings that change at run time.

use lockstep2d::body::{BodyDef, BodyId, BodyKind, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{ContactTuning, JointDef, Revolute, SolverSettings};
use lockstep2d::world::{Config, World};

use super::{ball, is_asleep, run, spawn, square, world_with_floor};

/// Eight boxes at rest on the floor.
fn stack(sub_steps: u32) -> (World, Vec<BodyId>) {
    let (mut world, _) = world_with_floor();
    set(&mut world, |config| config.solver.sub_steps = sub_steps);
    let boxes = (0..8).map(|i| {
        let at = BodyDef::dynamic().position((fx!(0), Fx::from_num(i) + fx!(0.5)));
        spawn(&mut world, at, square(fx!(0.5)))
    });
    let boxes = boxes.collect();
    run(&mut world, 60);
    (world, boxes)
}

fn set(world: &mut World, change: impl Fn(&mut Config)) {
    let mut config = *world.config();
    change(&mut config);
    world.set_config(&config).expect("valid");
    assert_eq!(*world.config(), config);
    assert_eq!(world.validate(), Ok(()));
}

/// Impulses of a warm start are converted when the length of sub-steps changes.
#[test]
fn a_stack_stays_at_rest_when_the_length_of_sub_steps_changes() {
    for (from, to, tick_rate) in [(4, 8, 60), (4, 16, 60), (8, 4, 60), (16, 4, 60), (4, 4, 120), (4, 8, 30)] {
        let (mut world, boxes) = stack(from);
        let heights = |world: &World| -> Vec<Fx> {
            boxes.iter().map(|&id| world.body(id).expect("there").position().y).collect()
        };
        let before = heights(&world);
        set(&mut world, |config| (config.solver.sub_steps, config.tick_rate) = (to, tick_rate));
        let mut fastest = Fx::ZERO;
        for _ in 0..30 {
            run(&mut world, 1);
            let speeds = boxes.iter().map(|&id| world.body(id).expect("there").velocity().y.abs());
            fastest = fastest.max(speeds.max().expect("eight"));
            // The largest speed measured is 10.4 mm/s. Without the conversion of impulses it is 21 to 81 mm/s, except
            // for the change from 4 to 16 sub-steps.
            assert!(fastest < fx!(0.015), "from {from} to {to} at {tick_rate}: {fastest} m/s");
            for (now, then) in heights(&world).iter().zip(&before) {
                // Heights hardly change, because contacts keep their 30 Hz: these are at most an eighth of the sub-step
                // rate.
                let moved = (*now - *then).abs();
                assert!(moved < fx!(0.005), "from {from} to {to} at {tick_rate}: moved by {moved}");
            }
        }
    }
}

#[test]
fn a_world_continues_as_one_that_was_made_with_the_settings() {
    let settings = |config: &mut Config| {
        config.gravity = Vec2::new(fx!(1), fx!(-5));
        config.tick_rate = 50;
        config.speculative_distance = fx!(0.03);
        config.fat_margin = fx!(0.2);
        config.continuous = false;
        config.hit_speed = fx!(3);
        config.solver = SolverSettings {
            sub_steps: 5,
            iterations: 2,
            contact: ContactTuning::Soft { hertz: fx!(20), damping_ratio: fx!(5), push_speed: fx!(2) },
            joint_hertz: fx!(40),
            joint_damping_ratio: fx!(1),
            restitution_threshold: fx!(0.5),
            speed_max: fx!(100),
        };
    };
    let fill = |world: &mut World| {
        spawn(world, BodyDef::fixed().position((fx!(0), fx!(-1))), super::rectangle(fx!(20), fx!(1)));
        let mut before = None;
        for i in 0..6 {
            let at = BodyDef::dynamic().position((Fx::from_num(i), fx!(3)));
            let id = spawn(world, at, ball(fx!(0.4)).restitution(fx!(0.5)));
            if let Some(before) = before {
                let hinge = JointDef::new(before, id, Revolute::new()).anchor_a((fx!(1), fx!(0)));
                world.add_joint(&hinge).expect("valid");
            }
            before = Some(id);
        }
    };
    let mut config = Config::default();
    settings(&mut config);
    let mut made = World::new(config).expect("valid");
    fill(&mut made);
    let mut changed = World::default();
    set(&mut changed, settings);
    fill(&mut changed);
    for _ in 0..120 {
        run(&mut made, 1);
        run(&mut changed, 1);
        assert_eq!(made.state_hash(), changed.state_hash());
    }
}

/// The combined material of touching shapes is cached, including the restitution threshold.
#[test]
fn a_new_threshold_of_restitution_applies_to_shapes_in_contact() {
    let rebounds = |changed: bool| {
        let (mut world, _) = world_with_floor();
        let at = BodyDef::dynamic().position((fx!(0), fx!(0.5)));
        let resting = spawn(&mut world, at, ball(fx!(0.5)).restitution(fx!(1)));
        run(&mut world, 10);
        if changed {
            set(&mut world, |config| config.solver.restitution_threshold = fx!(0.1));
        }
        // The ball touches the floor, and hits it within this tick.
        world.set_velocity(resting, Vec2::new(fx!(0), fx!(-0.7)), fx!(0)).expect("valid");
        run(&mut world, 1);
        world.body(resting).expect("there").velocity().y
    };
    assert!(rebounds(false) < fx!(0.1), "{}", rebounds(false));
    assert!(rebounds(true) > fx!(0.5), "{}", rebounds(true));
}

#[test]
fn only_what_changes_the_balance_wakes() {
    let wakes = |change: fn(&mut Config)| {
        let (mut world, boxes) = stack(4);
        run(&mut world, 120);
        assert!(is_asleep(&world, boxes[0]));
        set(&mut world, change);
        !is_asleep(&world, boxes[0])
    };
    assert!(wakes(|config| config.gravity.x = fx!(1)));
    assert!(wakes(|config| config.tick_rate = 61));
    assert!(wakes(|config| config.solver.sub_steps = 5));
    assert!(wakes(|config| config.solver.iterations = 2));
    assert!(wakes(|config| config.solver.joint_hertz = fx!(50)));
    assert!(wakes(|config| {
        config.solver.contact =
            ContactTuning::Soft { hertz: fx!(20), damping_ratio: fx!(10), push_speed: fx!(3) };
    }));
    assert!(wakes(|config| config.sleeping = false));
    assert!(!wakes(|_| {}));
    assert!(!wakes(|config| config.hit_speed = fx!(5)));
    assert!(!wakes(|config| config.continuous = false));
    assert!(!wakes(|config| config.fat_margin = fx!(0.2)));
    assert!(!wakes(|config| config.speculative_distance = fx!(0.03)));
    assert!(!wakes(|config| config.solver.speed_max = fx!(300)));
    assert!(!wakes(|config| config.solver.restitution_threshold = fx!(2)));
}

#[test]
fn without_sleeping_nothing_falls_asleep_until_it_is_switched_on_again() {
    let (mut world, boxes) = stack(4);
    set(&mut world, |config| config.sleeping = false);
    run(&mut world, 120);
    assert!(!is_asleep(&world, boxes[0]));
    set(&mut world, |config| config.sleeping = true);
    run(&mut world, 120);
    assert!(is_asleep(&world, boxes[0]));
}

#[test]
fn a_lower_speed_limit_slows_down() {
    let mut world = super::weightless();
    let fast = spawn(&mut world, BodyDef::dynamic().velocity((fx!(80), fx!(0))), ball(fx!(0.5)));
    run(&mut world, 1);
    set(&mut world, |config| config.solver.speed_max = fx!(20));
    run(&mut world, 1);
    let speed = world.body(fast).expect("there").velocity().x;
    assert!((speed - fx!(20)).abs() < fx!(0.001), "{speed}");
}

#[test]
fn settings_are_part_of_a_snapshot() {
    let (mut world, _) = stack(4);
    let (before, hash) = (world.save(), world.state_hash());
    set(&mut world, |config| (config.solver.sub_steps, config.continuous) = (9, false));
    assert_ne!(world.state_hash(), hash);
    let changed = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    assert_eq!(changed.config().solver.sub_steps, 9);
    world.restore(&before);
    assert_eq!((world.state_hash(), world.config().solver.sub_steps), (hash, 4));
}

/// A change of the sub-steps converts the impulses of joints, which rounds them. The solver's caches must not keep
/// impulses from before the conversion.
#[test]
fn settings_that_change_and_change_back_within_a_tick_leave_nothing_in_the_caches() {
    let (mut world, _) = world_with_floor();
    let mut last = spawn(&mut world, BodyDef::fixed().position((fx!(0), fx!(9))), square(fx!(0.1)));
    for x in 1..6 {
        let plank = spawn(&mut world, BodyDef::dynamic().position((Fx::from(x), fx!(9))), square(fx!(0.3)));
        let anchor = (Fx::from(x) - fx!(0.5), fx!(9));
        let hinge = world.joint_at(last, plank, Revolute::new(), anchor).expect("both are there");
        world.add_joint(&hinge).expect("valid");
        last = plank;
    }
    run(&mut world, 60);
    for sub_steps in [5, 7, 8, 16] {
        let before = *world.config();
        set(&mut world, |config| config.solver.sub_steps = sub_steps);
        set(&mut world, |config| *config = before);
        let mut copy = World::from_bytes(&world.to_bytes()).expect("just written");
        run(&mut world, 5);
        run(&mut copy, 5);
        assert_eq!(world.state_hash(), copy.state_hash(), "4, {sub_steps} and 4 sub-steps");
    }
}

/// A kinematic body reaches its target in the next tick, even if the tick rate has changed. Its velocity fits the new
/// length of the tick.
#[test]
fn a_target_is_reached_at_another_tick_rate() {
    for rate in [30u32, 120] {
        let mut world = super::weightless();
        let id = super::spawn(&mut world, BodyDef::kinematic(), square(fx!(0.5)));
        world.move_to(id, (fx!(0.5), fx!(-0.25)), Angle::from_radians(fx!(0.1))).expect("in reach");
        set(&mut world, |config| config.tick_rate = rate);
        assert_eq!(world.validate(), Ok(()));
        let body = world.body(id).expect("there");
        let (speed, turning) = (fx!(0.5) * i64::from(rate), fx!(0.1) * i64::from(rate));
        assert!(
            (body.velocity() - Vec2::new(speed, -speed / 2)).length() < fx!(0.001),
            "{}",
            body.velocity()
        );
        assert!((body.angular_velocity() - turning).abs() < fx!(0.001), "{}", body.angular_velocity());
    }
}

/// A lower tick rate or speed limit is refused if a kinematic body is faster than the new limit, and changes nothing.
#[test]
fn settings_that_make_a_kinematic_body_too_fast_are_refused() {
    type Change = fn(&mut Config);
    let rate: Change = |config| (config.tick_rate, config.solver.sub_steps) = (20, 4);
    let speed: Change = |config| config.solver.speed_max = fx!(300);
    let defs = [
        BodyDef::kinematic().velocity((fx!(300.01), fx!(0))),
        BodyDef::kinematic().velocity((fx!(220), fx!(-220))),
        BodyDef::kinematic().angular_velocity(fx!(-75.01)),
    ];
    for change in [rate, speed] {
        for def in defs {
            let mut world = super::weightless();
            let id = spawn(&mut world, def, square(fx!(0.5)));
            let (before, mut config) = (world.state_hash(), *world.config());
            change(&mut config);
            let refused = world.set_config(&config);
            let is_clear = |error| matches!(error, WorldError::SpeedOutOfRange { max, .. } if max == 300);
            assert!(refused.is_err_and(is_clear), "{refused:?}");
            assert_eq!(world.state_hash(), before);
            let slower = |v: Vec2<Fx>| Vec2::new(v.x / 2, v.y / 2);
            let body = world.body(id).expect("there");
            let (velocity, turning) = (slower(body.velocity()), body.angular_velocity() / 2);
            world.set_velocity(id, velocity, turning).expect("slow enough");
            set(&mut world, change);
        }
    }
    // A tick limits the speed of dynamic bodies.
    let mut world = super::weightless();
    spawn(&mut world, BodyDef::dynamic().velocity((fx!(390), fx!(0))), square(fx!(0.5)));
    spawn(&mut world, BodyDef::kinematic().velocity((fx!(300), fx!(0))), square(fx!(0.5)));
    set(&mut world, rate);
}

/// A target in reach at 60 ticks per second is out of reach at 120 if its distance is more than 400 m/s allow.
#[test]
fn a_tick_rate_at_which_a_target_is_out_of_reach_is_refused() {
    let mut world = super::weightless();
    let id = spawn(&mut world, BodyDef::kinematic(), square(fx!(0.5)));
    world.move_to(id, (fx!(4), fx!(0)), Angle::ZERO).expect("in reach");
    let config = Config { tick_rate: 120, ..*world.config() };
    let refused = world.set_config(&config);
    assert!(matches!(refused, Err(WorldError::SpeedOutOfRange { .. })), "{refused:?}");
    set(&mut world, |config| config.tick_rate = 90);
    run(&mut world, 1);
    assert_eq!(world.body(id).expect("there").position(), Vec2::new(fx!(4), fx!(0)));
}

/// A dynamic body may be above the speed limit until the next tick. As a kinematic body it is within the limit at once.
#[test]
fn a_fast_body_that_becomes_kinematic_is_slowed_to_the_limit() {
    let mut world = super::weightless();
    let id = spawn(&mut world, BodyDef::dynamic(), square(fx!(0.5)));
    let mass = world.body(id).expect("there").mass();
    world.apply_impulse_to_centre(id, (mass * 400, -mass * 300)).expect("dynamic");
    assert!(world.body(id).expect("there").velocity().length() > fx!(499));
    world.set_kind(id, BodyKind::Kinematic).expect("valid");
    let velocity = world.body(id).expect("there").velocity();
    assert!((velocity - Vec2::new(fx!(320), fx!(-240))).length() < fx!(0.001), "{velocity}");
    assert!(velocity.length() <= fx!(400), "{velocity}");
    assert_eq!(world.validate(), Ok(()));
}
