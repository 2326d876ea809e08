//! Bodies at rest fall asleep, are not simulated, and wake when something affects them.

use lockstep2d::body::{BodyDef, BodyId, BodySettings, Filter, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{Config, Section, World};

use super::{ball, is_asleep, rectangle, run, shape_of, spawn, square, world_with_floor};

/// Three boxes asleep on a floor, the lowest first.
fn sleeping_stack() -> (World, BodyId, [BodyId; 3]) {
    let (mut world, floor) = world_with_floor();
    let boxes = [fx!(0.5), fx!(1.5), fx!(2.5)]
        .map(|y| spawn(&mut world, BodyDef::dynamic().position((fx!(0), y)), square(fx!(0.5))));
    run(&mut world, 120);
    assert!(boxes.iter().all(|id| is_asleep(&world, *id)));
    (world, floor, boxes)
}

/// Expects that all boxes of a sleeping stack are awake a tick after a change.
fn wakes(change: impl FnOnce(&mut World, BodyId, [BodyId; 3])) -> World {
    let (mut world, floor, boxes) = sleeping_stack();
    change(&mut world, floor, boxes);
    assert_eq!(world.validate(), Ok(()));
    run(&mut world, 1);
    for (_, body) in world.bodies().filter(|(_, body)| body.is_dynamic()) {
        assert!(!body.is_asleep());
    }
    world
}

/// Expects that ticks change only the tick counter, and simulate no bodies.
fn assert_still(world: &mut World, ticks: u32) {
    let before = world.digest();
    let places: Vec<_> = world.bodies().map(|(_, body)| (body.position(), body.angle())).collect();
    run(world, ticks);
    assert_eq!(before.differing(&world.digest()), [Section::World], "expected only the tick to change");
    let after: Vec<_> = world.bodies().map(|(_, body)| (body.position(), body.angle())).collect();
    assert_eq!(places, after);
    assert_eq!((world.stats().bodies, world.stats().pairs, world.stats().contacts), (0, 0, 0));
    assert!(world.events().moved.is_empty());
}

#[test]
fn a_stack_sleeps_after_half_a_second_at_rest() {
    let (mut world, _) = world_with_floor();
    let lower = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(0.5))), square(fx!(0.5)));
    let upper = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(1.5))), square(fx!(0.5)));
    run(&mut world, 29);
    assert!(!is_asleep(&world, lower) && !is_asleep(&world, upper));
    let mut told = Vec::new();
    for _ in 0..15 {
        run(&mut world, 1);
        told.extend(world.events().moved.iter().filter(|event| event.fell_asleep).map(|event| event.body));
    }
    assert_eq!(told, [lower, upper], "expected both bodies to fall asleep once");
    assert_eq!(world.awake_body_count(), 0);
    let island = world.body(lower).expect("there").island();
    assert_eq!(island, world.body(upper).expect("there").island());
    run(&mut world, 1);
    assert_still(&mut world, 100);
}

#[test]
fn a_sleeping_world_goes_on_sleeping_after_a_restore() {
    let (world, ..) = sleeping_stack();
    let mut world = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    run(&mut world, 1);
    assert_still(&mut world, 10);
}

#[test]
fn pushing_wakes() {
    let (up, zero) = (Vec2::new(fx!(0), fx!(1)), Vec2::ZERO);
    wakes(|world, _, [a, ..]| world.apply_force(a, up, zero).expect("valid"));
    wakes(|world, _, [_, b, _]| world.apply_force_to_centre(b, up).expect("valid"));
    wakes(|world, _, [.., c]| world.apply_torque(c, fx!(1)).expect("valid"));
    wakes(|world, _, [a, ..]| world.apply_impulse(a, up, zero).expect("valid"));
    wakes(|world, _, [_, b, _]| world.apply_impulse_to_centre(b, up).expect("valid"));
    wakes(|world, _, [.., c]| world.apply_angular_impulse(c, fx!(1)).expect("valid"));
    wakes(|world, _, [a, ..]| world.set_velocity(a, zero, fx!(0)).expect("valid"));
    wakes(|world, _, [a, ..]| world.set_transform(a, Vec2::new(fx!(9), fx!(9)), Angle::ZERO).expect("valid"));
    wakes(|world, _, [a, ..]| world.wake(a).expect("valid"));
    wakes(|world, _, _| world.set_gravity(up).expect("valid"));
    wakes(|world, _, [.., c]| world.set_body(c, &BodySettings::default()).expect("valid"));
}

#[test]
fn waking_the_ground_wakes_what_touches_it() {
    wakes(|world, floor, _| world.wake(floor).expect("there"));
    for ground in [BodyDef::fixed(), BodyDef::kinematic()] {
        let mut world = World::default();
        let ground = spawn(&mut world, ground.position((fx!(0), fx!(-1))), super::rectangle(fx!(9), fx!(1)));
        let on_it = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(0.5))), square(fx!(0.5)));
        let other = spawn(&mut world, BodyDef::fixed().position((fx!(20), fx!(-1))), square(fx!(1)));
        let far = spawn(&mut world, BodyDef::dynamic().position((fx!(20), fx!(0.5))), square(fx!(0.5)));
        let hung = spawn(&mut world, BodyDef::dynamic().position((fx!(-30), fx!(0))), square(fx!(0.5)));
        let rope = JointDef::new(ground, hung, Revolute::new()).anchor_a((fx!(-30), fx!(1)));
        world.add_joint(&rope).expect("valid");
        run(&mut world, 90);
        assert!([on_it, far, hung].iter().all(|&id| is_asleep(&world, id)));
        world.wake(ground).expect("there");
        assert_eq!([on_it, far, hung].map(|id| is_asleep(&world, id)), [false, true, false]);
        run(&mut world, 90);
        world.wake(other).expect("there");
        assert_eq!([on_it, far, hung].map(|id| is_asleep(&world, id)), [true, false, true]);
    }
}

/// A body that has never been awake has no contacts.
#[test]
fn waking_the_ground_wakes_what_was_asleep_from_the_start() {
    let (mut world, floor) = world_with_floor();
    let def = |x: Fx, y: Fx| BodyDef::dynamic().position((x, y)).asleep();
    let resting = spawn(&mut world, def(fx!(0), fx!(0.5)), square(fx!(0.5)));
    let floating = spawn(&mut world, def(fx!(3), fx!(0.6)), square(fx!(0.5)));
    run(&mut world, 3);
    world.wake(floor).expect("there");
    assert_eq!([resting, floating].map(|body| is_asleep(&world, body)), [false, true]);
}

#[test]
fn joining_and_parting_wakes() {
    let world = wakes(|world, floor, [.., top]| {
        world
            .add_joint(&JointDef::new(floor, top, Revolute::new()).anchor_a((fx!(0), fx!(3.5))))
            .expect("valid");
    });
    let joint = world.joints().next().expect("one").0;
    let mut world = world;
    run(&mut world, 120);
    assert_eq!(world.awake_body_count(), 0);
    world.remove_joint(joint).expect("there");
    assert_eq!(world.awake_body_count(), 3);
}

#[test]
fn a_support_that_goes_wakes_what_rests_on_it() {
    let shape = |world: &World, body| shape_of(world, body);
    let fell = |world: World| {
        let mut world = world;
        run(&mut world, 60);
        let highest = world.bodies().filter(|(_, body)| body.is_dynamic()).map(|(_, b)| b.position().y).max();
        assert!(highest.expect("some") < fx!(0), "expected the stack to fall");
    };
    fell(wakes(|world, floor, _| world.despawn(floor).expect("there")));
    fell(wakes(|world, floor, _| world.remove_shape(shape(world, floor)).expect("there")));
    fell(wakes(|world, floor, _| world.disable(floor).expect("there")));
    let far = Vec2::new(fx!(0), fx!(-900));
    fell(wakes(|world, floor, _| world.set_transform(floor, far, Angle::ZERO).expect("there")));
    let nothing = Filter { mask: 0, ..Filter::default() };
    fell(wakes(|world, floor, _| world.set_filter(shape(world, floor), nothing).expect("there")));
    let small = ball(fx!(0.1)).geometry;
    wakes(|world, floor, _| world.set_geometry(shape(world, floor), small).expect("there"));
    fell(wakes(|world, floor, _| {
        let id = shape(world, floor);
        let def = world.shape(id).expect("there").def().sensor();
        world.set_shape(id, &def).expect("valid");
    }));
    // The other boxes wake when the lowest one is despawned.
    wakes(|world, _, [lowest, ..]| world.despawn(lowest).expect("there"));
}

#[test]
fn a_body_that_comes_wakes_what_it_touches() {
    let (mut world, _, boxes) = sleeping_stack();
    spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(6))), ball(fx!(0.3)));
    let woken = (0..120).find(|_| {
        run(&mut world, 1);
        !is_asleep(&world, boxes[0])
    });
    // A fall of 2.7 m takes 0.73 s.
    assert!(woken.is_some_and(|tick| (40..46).contains(&tick)), "{woken:?}");
    assert!(boxes.iter().all(|id| !is_asleep(&world, *id)), "expected the whole stack to wake");
}

#[test]
fn a_body_that_passes_by_wakes_nothing() {
    let (mut world, _, boxes) = sleeping_stack();
    spawn(&mut world, BodyDef::dynamic().position((fx!(0.9), fx!(6))), ball(fx!(0.3)));
    run(&mut world, 60);
    assert!(boxes.iter().all(|id| is_asleep(&world, *id)));
}

/// A box asleep on a kinematic platform.
fn sleeper_on_platform() -> (World, BodyId, BodyId) {
    let mut world = World::default();
    let platform = spawn(&mut world, BodyDef::kinematic(), rectangle(fx!(3), fx!(0.5)));
    let rider = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(1))), square(fx!(0.5)));
    run(&mut world, 120);
    assert!(is_asleep(&world, rider));
    (world, platform, rider)
}

#[test]
fn a_platform_that_begins_to_move_wakes_its_rider_and_keeps_it_awake() {
    for by_target in [false, true] {
        let (mut world, platform, rider) = sleeper_on_platform();
        // This speed is below the default sleep speed of 0.05 m/s.
        let creep = fx!(0.03);
        for tick in 1..=120 {
            if by_target {
                let place = Vec2::new(creep * tick / 60, Fx::ZERO);
                world.move_to(platform, place, Angle::ZERO).expect("valid");
            } else if tick == 1 {
                world.set_velocity(platform, Vec2::new(creep, Fx::ZERO), fx!(0)).expect("valid");
            }
            run(&mut world, 1);
            assert!(!is_asleep(&world, rider), "by target {by_target}, tick {tick}");
        }
        let carried = world.body(rider).expect("there").position().x;
        assert!((carried - fx!(0.06)).abs() < fx!(0.005), "{carried}");
        world.set_velocity(platform, Vec2::ZERO, fx!(0)).expect("valid");
        run(&mut world, 60);
        assert!(is_asleep(&world, rider), "expected the box to sleep again");
    }
}

/// The anchor of a resting pendulum moves or is disabled.
#[test]
fn what_hangs_from_a_body_wakes_when_it_moves() {
    let hung = |anchor: BodyDef| {
        let mut world = World::default();
        let anchor = world.spawn(&anchor, &[]).expect("valid");
        let bob = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(-2))), ball(fx!(0.3)));
        world
            .add_joint(&JointDef::new(anchor, bob, Revolute::new()).anchor_b((fx!(0), fx!(2))))
            .expect("valid");
        run(&mut world, 60);
        assert!(is_asleep(&world, bob));
        (world, anchor, bob)
    };
    let (mut world, anchor, bob) = hung(BodyDef::kinematic());
    world.set_velocity(anchor, Vec2::new(fx!(0.01), fx!(0)), fx!(0)).expect("valid");
    for _ in 0..60 {
        run(&mut world, 1);
        assert!(!is_asleep(&world, bob));
    }
    let (mut world, anchor, bob) = hung(BodyDef::kinematic());
    world.move_to(anchor, Vec2::new(fx!(0.1), fx!(0)), Angle::ZERO).expect("valid");
    assert!(!is_asleep(&world, bob));
    let (mut world, anchor, bob) = hung(BodyDef::fixed());
    world.set_transform(anchor, Vec2::new(fx!(1), fx!(0)), Angle::ZERO).expect("valid");
    assert!(!is_asleep(&world, bob));
    let (mut world, anchor, bob) = hung(BodyDef::fixed());
    world.disable(anchor).expect("valid");
    assert!(!is_asleep(&world, bob));
}

#[test]
fn a_body_that_may_not_sleep_keeps_its_island_awake() {
    let (mut world, _) = world_with_floor();
    let at = |x, y| BodyDef::dynamic().position((x, y));
    let below = spawn(&mut world, at(fx!(0), fx!(0.5)), square(fx!(0.5)));
    let mut insomniac = at(fx!(0), fx!(1.5));
    insomniac.settings.may_sleep = false;
    let insomniac = spawn(&mut world, insomniac, square(fx!(0.5)));
    let elsewhere = spawn(&mut world, at(fx!(5), fx!(0.5)), square(fx!(0.5)));
    run(&mut world, 120);
    assert!(!is_asleep(&world, below) && !is_asleep(&world, insomniac) && is_asleep(&world, elsewhere));
    world.set_body(insomniac, &BodySettings::default()).expect("valid");
    run(&mut world, 60);
    assert!(is_asleep(&world, below));
}

#[test]
fn each_body_has_its_own_threshold() {
    let mut world = super::weightless();
    let mut drifting = |y, sleep_speed| {
        let mut def = BodyDef::dynamic().position((fx!(0), y)).velocity((fx!(0.2), fx!(0)));
        def.settings.sleep_speed = sleep_speed;
        spawn(&mut world, def, ball(fx!(0.5)))
    };
    let [lively, sleepy, never] =
        [drifting(fx!(0), fx!(0.05)), drifting(fx!(5), fx!(0.3)), drifting(fx!(10), fx!(0))];
    run(&mut world, 30);
    assert!(!is_asleep(&world, lively) && is_asleep(&world, sleepy) && !is_asleep(&world, never));
    world.set_velocity(never, Vec2::ZERO, fx!(0)).expect("valid");
    run(&mut world, 60);
    assert!(!is_asleep(&world, never), "a sleep speed of 0 must prevent sleep, even at rest");
}

#[test]
fn in_a_world_without_sleep_nobody_sleeps() {
    let config = Config { sleeping: false, ..Config::default() };
    let mut world = World::new(config).expect("valid");
    spawn(&mut world, BodyDef::fixed().position((fx!(0), fx!(-1))), rectangle(fx!(9), fx!(1)));
    let id = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(0.5))).asleep(), square(fx!(0.5)));
    run(&mut world, 90);
    world.sleep(id).expect("nothing to do");
    assert!(!is_asleep(&world, id));
}

#[test]
fn a_body_may_be_put_to_sleep_in_the_air_with_all_that_it_touches() {
    let (mut world, _) = world_with_floor();
    let flying = BodyDef::dynamic().position((fx!(0), fx!(20))).velocity((fx!(1), fx!(1)));
    let flying = spawn(&mut world, flying, ball(fx!(0.5)));
    world.apply_force_to_centre(flying, Vec2::new(fx!(5), fx!(5))).expect("valid");
    world.sleep(flying).expect("dynamic");
    assert!(is_asleep(&world, flying));
    run(&mut world, 1);
    assert_still(&mut world, 10);

    let (mut world, floor, boxes) = sleeping_stack();
    assert!(world.sleep(floor).is_err());
    world.wake(boxes[0]).expect("there");
    world.sleep(boxes[2]).expect("dynamic");
    assert!(
        boxes.iter().all(|id| is_asleep(&world, *id)),
        "expected the whole stack to sleep before the next tick"
    );
    world.wake(boxes[0]).expect("there");
    world = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    run(&mut world, 2);
    let mut restored = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    restored.sleep(boxes[1]).expect("a world without manifolds");
    world.sleep(boxes[1]).expect("dynamic");
    assert_eq!(world.state_hash(), restored.state_hash());
    assert_eq!(world.validate(), Ok(()));
}

/// Each box of the row sleeps in its own island.
#[test]
fn a_row_of_sleepers_wakes_in_one_tick() {
    let mut world = super::weightless();
    let at = |x: i64| BodyDef::dynamic().position((Fx::from_num(x), fx!(0)));
    let row: Vec<_> = (0..500).map(|x| spawn(&mut world, at(x).asleep(), square(fx!(0.5)))).collect();
    run(&mut world, 1);
    assert_eq!(world.stats().bodies, 0);
    world.set_velocity(row[0], Vec2::new(fx!(1), fx!(0)), fx!(0)).expect("valid");
    run(&mut world, 1);
    assert_eq!(world.stats().bodies, 500);
}

/// The support of a resting box is removed, while another body keeps their island awake. At 240 Hz, after the first
/// tick of its fall, the box is slower than its sleep speed. If the count of the box's ticks at rest were not
/// restarted, the box would fall asleep in the air.
#[test]
fn a_body_that_loses_its_support_does_not_fall_asleep_in_the_air() {
    type Edit = fn(&mut World, BodyId) -> Result<(), WorldError>;
    let edits: [Edit; 6] = [
        World::despawn,
        World::disable,
        |world, body| world.set_transform(body, (fx!(30), fx!(0.5)), Angle::ZERO),
        |world, body| world.remove_shape(shape_of(world, body)),
        |world, body| {
            let (shape, filter) = (shape_of(world, body), Filter { mask: 0, ..Filter::default() });
            world.set_filter(shape, filter)
        },
        |world, body| {
            let shape = shape_of(world, body);
            let def = *world.shape(shape).expect("there").def();
            world.set_shape(shape, &ShapeDef { geometry: square(fx!(0.1)).geometry, ..def })
        },
    ];
    for (tick_rate, (number, edit)) in
        [60, 240].into_iter().flat_map(|rate| edits.iter().enumerate().map(move |edit| (rate, edit)))
    {
        let mut world = World::new(Config { tick_rate, ..Config::default() }).expect("valid");
        spawn(&mut world, BodyDef::fixed().position((fx!(0), fx!(-1))), rectangle(fx!(50), fx!(1)));
        let lower = BodyDef::dynamic().position((fx!(0), fx!(0.5))).never_sleeps();
        let lower = spawn(&mut world, lower, square(fx!(0.5)));
        let upper = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(1.5))), square(fx!(0.5)));
        run(&mut world, 2 * tick_rate);
        assert!(!is_asleep(&world, upper));
        edit(&mut world, lower).expect("valid");
        run(&mut world, 5 * tick_rate);
        let y = world.body(upper).expect("there").position().y;
        assert!(y < fx!(0.71), "edit {number} at {tick_rate} Hz: the box is at {y} m");
    }
}

/// The player keeps the seesaw down, and is in motion in every tick. After the player's jump, the seesaw begins to turn
/// more slowly than its sleep speed.
#[test]
fn a_seesaw_turns_back_when_the_player_leaves() {
    let mut world = World::default();
    let post = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let weight = square(fx!(0.3)).offset((fx!(-2.7), fx!(0))).density(fx!(0.1));
    let board = world.spawn(&BodyDef::dynamic(), &[rectangle(fx!(3), fx!(0.1)), weight]).expect("valid");
    let hinge = JointDef::new(post, board, Revolute::new().limit(fx!(-0.25), fx!(0.25)));
    world.add_joint(&hinge).expect("valid");
    let def = BodyDef::dynamic().position((fx!(2), fx!(0.7))).lock_rotation().never_sleeps();
    let player = spawn(&mut world, def, rectangle(fx!(0.3), fx!(0.5)).friction(fx!(2)));
    run(&mut world, 240);
    assert!(world.body(board).expect("there").angle().to_radians() < fx!(-0.24));
    world.set_velocity(player, (fx!(6), fx!(6)), fx!(0)).expect("there");
    run(&mut world, 600);
    assert!(world.body(board).expect("there").angle().to_radians() > fx!(0.24));
}
