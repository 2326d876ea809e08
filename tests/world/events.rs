//! Hit, contact and move events, in the documented order.

use lockstep2d::body::{Body, BodyDef, Continuous, EventSwitches, ShapeDef, ShapeId};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::Backend;
use lockstep2d::world::{Config, ContactEvent, HitEvent, World};

use super::{
    ball, capsule, is_asleep, rectangle, run, shape_of, spawn, square, weightless, world_with_floor,
};

fn hitting(shape: ShapeDef) -> ShapeDef {
    shape.events(EventSwitches { hit: true, ..EventSwitches::default() })
}

fn hits(world: &mut World, ticks: u32) -> Vec<HitEvent> {
    let mut hits = Vec::new();
    for _ in 0..ticks {
        run(world, 1);
        hits.extend(&world.events().hits);
    }
    hits
}

#[test]
fn a_hit_tells_where_how_fast_and_which_way() {
    let mut world = weightless();
    let left = BodyDef::dynamic().position((fx!(-2), fx!(0))).velocity((fx!(6), fx!(0)));
    let left = spawn(&mut world, left, hitting(ball(fx!(0.5))).restitution(fx!(1)));
    let right = BodyDef::dynamic().position((fx!(2), fx!(0))).velocity((fx!(-3), fx!(0)));
    let right = spawn(&mut world, right, ball(fx!(0.5)).restitution(fx!(1)));
    let told = hits(&mut world, 120);
    assert_eq!(told.len(), 1, "{told:?}");
    let hit = told[0];
    assert_eq!((hit.shape_a, hit.shape_b), (shape_of(&world, left), shape_of(&world, right)));
    assert!((hit.approach_speed - fx!(9)).abs() < fx!(0.0001), "{}", hit.approach_speed);
    assert!(hit.normal.x > fx!(0.9999) && hit.normal.y.abs() < fx!(0.001), "{:?}", hit.normal);
    // The balls close a gap of 3 m at 9 m/s, while the left one moves 2 m. They meet at x = 0.5 m, up to the motion of
    // one tick.
    assert!((hit.point.x - fx!(0.5)).abs() < fx!(0.2) && hit.point.y.abs() < fx!(0.01), "{:?}", hit.point);
}

#[test]
fn a_hit_on_a_moving_wall_counts_the_wall_and_only_the_normal() {
    let mut world = weightless();
    spawn(&mut world, BodyDef::kinematic().velocity((fx!(0), fx!(2))), rectangle(fx!(50), fx!(0.5)));
    let thrown = BodyDef::dynamic().position((fx!(0), fx!(4))).velocity((fx!(7), fx!(-3)));
    spawn(&mut world, thrown, hitting(ball(fx!(0.5))));
    let told = hits(&mut world, 60);
    assert_eq!(told.len(), 1);
    assert!((told[0].approach_speed - fx!(5)).abs() < fx!(0.001), "{}", told[0].approach_speed);
    assert!(
        told[0].normal.y > fx!(0.9999),
        "expected a normal from the wall, which is A: {:?}",
        told[0].normal
    );
}

/// A hit at the speed v has an impulse of (1 + e) v times the reduced mass, wherever in the tick the bodies meet. A box
/// that lands flat has two contact points.
#[test]
fn a_hit_tells_the_impulse_of_the_whole_tick() {
    let wall = (BodyDef::fixed(), rectangle(fx!(50), fx!(0.5)), None);
    let block = (BodyDef::dynamic(), square(fx!(0.5)).density(fx!(3)), Some(fx!(3)));
    let cases = [fx!(2), fx!(25), fx!(100)]
        .into_iter()
        .flat_map(|speed| [fx!(0), fx!(0.25), fx!(1)].map(|restitution| (speed, restitution)));
    for (speed, restitution) in cases {
        for phase in 0..32 {
            for ((target, area, heavy), shape) in [wall, block]
                .into_iter()
                .flat_map(|target| [square(fx!(0.5)), ball(fx!(0.5))].map(|s| (target, s)))
            {
                let mut world = weightless();
                spawn(&mut world, target.position((fx!(0), fx!(-0.5))), area.restitution(fx!(0)));
                let start = fx!(1) + speed / 60 * phase / 32;
                let def = BodyDef::dynamic().position((fx!(0), start)).velocity((fx!(0), -speed));
                let thrown = spawn(&mut world, def, hitting(shape).restitution(restitution).density(fx!(1)));
                let mass = world.body(thrown).expect("there").mass();
                let share = heavy.map_or(fx!(1), |heavy| heavy / (heavy + mass));
                let told = hits(&mut world, 40);
                let [hit] = told[..] else { panic!("{speed} m/s, phase {phase}: {told:?}") };
                let impulse = hit.impulse / (mass * share * speed);
                let wanted = fx!(1) + restitution;
                assert!(
                    (impulse - wanted).abs() < fx!(0.001),
                    "{speed} m/s, {restitution}, {phase}: {impulse}"
                );
            }
        }
    }
}

#[test]
fn slow_or_unwanted_hits_are_not_told() {
    let thrown = |speed: Fx, shape: ShapeDef, hit_speed: Fx| {
        let config = Config { gravity: Vec2::ZERO, hit_speed, ..Config::default() };
        let mut world = World::new(config).expect("valid");
        spawn(&mut world, BodyDef::fixed(), rectangle(fx!(5), fx!(1)));
        spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(2))).velocity((fx!(0), -speed)), shape);
        hits(&mut world, 120).len()
    };
    assert_eq!(thrown(fx!(2), hitting(ball(fx!(0.5))), fx!(1)), 1);
    assert_eq!(thrown(fx!(2), ball(fx!(0.5)), fx!(1)), 0, "hit events are off by default");
    assert_eq!(
        thrown(fx!(2), hitting(ball(fx!(0.5))), fx!(2.1)),
        0,
        "the speed is below the world's threshold"
    );
    assert_eq!(thrown(fx!(0.9), hitting(ball(fx!(0.5))), fx!(1)), 0);
}

#[test]
fn contact_events_may_be_switched_off_and_on() {
    let silent = EventSwitches { contact: false, ..EventSwitches::default() };
    let landing = |floor: ShapeDef, shape: ShapeDef| {
        let mut world = World::default();
        spawn(&mut world, BodyDef::fixed().position((fx!(0), fx!(-1))), floor);
        let id = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(0.6))), shape);
        let mut told = 0;
        for _ in 0..60 {
            run(&mut world, 1);
            told += world.events().contact_begin.len();
        }
        (world, id, told)
    };
    let (floor, shape) = (rectangle(fx!(5), fx!(1)), square(fx!(0.5)));
    assert_eq!(landing(floor, shape).2, 1);
    assert_eq!(landing(floor.events(silent), shape).2, 1, "events of one shape are enough");
    assert_eq!(landing(floor, shape.events(silent)).2, 1);
    let (mut world, id, told) = landing(floor.events(silent), shape.events(silent));
    assert_eq!(told, 0);

    // Switching events on reports the begin of a contact. Switching them off reports its end.
    let id = shape_of(&world, id);
    world.set_shape(id, &shape).expect("valid");
    run(&mut world, 1);
    assert_eq!((world.events().contact_begin.len(), world.events().contact_end.len()), (1, 0));
    world.set_shape(id, &shape.events(silent)).expect("valid");
    run(&mut world, 1);
    assert_eq!((world.events().contact_begin.len(), world.events().contact_end.len()), (0, 1));
}

#[test]
fn moves_are_told_in_slot_order_of_what_moved() {
    let (mut world, floor) = world_with_floor();
    let falling = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(9))), ball(fx!(0.5)));
    let still = spawn(&mut world, BodyDef::kinematic().position((fx!(5), fx!(9))), ball(fx!(0.5)));
    let turning = BodyDef::kinematic().position((fx!(9), fx!(9))).angular_velocity(fx!(1));
    let turning = spawn(&mut world, turning, ball(fx!(0.5)));
    run(&mut world, 3);
    let told: Vec<_> = world.events().moved.iter().map(|event| event.body).collect();
    assert_eq!(told, [falling, turning]);
    for event in &world.events().moved {
        let body = world.body(event.body).expect("there");
        assert_eq!((event.position, event.angle, event.fell_asleep), (body.position(), body.angle(), false));
    }
    world.move_to(still, Vec2::new(fx!(5.1), fx!(9)), Angle::ZERO).expect("valid");
    run(&mut world, 1);
    assert_eq!(world.events().moved[1].body, still);
    assert_eq!(world.events().moved[1].position, Vec2::new(fx!(5.1), fx!(9)));
    assert!(world.events().moved.iter().all(|event| event.body != floor));
}

/// A bar that turns by 90 degrees in a tick meets a puck that rests beyond the speculative distance, and carries it.
#[test]
fn a_body_that_a_turning_bar_carries_has_moved() {
    let mut world = weightless();
    let bar = BodyDef::kinematic().angular_velocity(fx!(95));
    let bar = spawn(&mut world, bar, rectangle(fx!(3), fx!(0.05)));
    let puck = BodyDef::dynamic().position((fx!(0), fx!(2))).continuous(Continuous::Kinematic);
    let puck = spawn(&mut world, puck, ball(fx!(0.1)));
    run(&mut world, 1);
    let position = world.body(puck).expect("there").position();
    assert!(position.x < fx!(-0.1), "the bar should carry the puck: {position:?}");
    let told: Vec<_> = world.events().moved.iter().map(|event| event.body).collect();
    assert_eq!(told, [bar, puck]);
}

#[test]
fn lists_are_sorted_and_the_same_when_simulated_again() {
    let (mut world, _) = world_with_floor();
    for i in 0..40 {
        let (x, y) = (Fx::from_num(i % 8) - fx!(4), Fx::from_num(i / 8) * fx!(1.3) + fx!(1));
        let def = BodyDef::dynamic().position((x, y)).velocity((fx!(0), fx!(-3)));
        let id = spawn(&mut world, def, hitting(ball(fx!(0.45))));
        world.add_shape(id, &square(fx!(0.6)).sensor().density(fx!(0))).expect("valid");
    }
    for _ in 0..60 {
        let before = world.save();
        run(&mut world, 1);
        let told = world.events().clone();
        assert!(told.contact_begin.is_sorted() && told.contact_end.is_sorted());
        assert!(told.sensor_begin.is_sorted() && told.sensor_end.is_sorted());
        let pair = |hit: &HitEvent| ContactEvent { shape_a: hit.shape_a, shape_b: hit.shape_b };
        assert!(told.hits.is_sorted_by_key(pair) && told.moved.is_sorted_by_key(|event| event.body));
        let after = world.state_hash();
        world.restore(&before);
        assert_eq!(world.events().moved.len(), 0, "a restored world has no events");
        run(&mut world, 1);
        assert_eq!((world.events(), world.state_hash()), (&told, after));
    }
}

/// Hit events do not affect motion, and are equal with every backend.
#[test]
fn hits_change_nothing_but_themselves() {
    let fall = |wanted: bool| {
        let (mut world, _) = world_with_floor();
        for i in 0..60i32 {
            let (x, y) = (Fx::from_num(i % 8) - fx!(4), Fx::from_num(i / 8) * fx!(1.3) + fx!(1));
            let def = BodyDef::dynamic().position((x, y)).velocity((fx!(0), fx!(-9)));
            let shape = match i % 3 {
                0 => square(fx!(0.45)).restitution(fx!(0.3)),
                1 => ball(fx!(0.45)),
                _ => capsule(fx!(0.3), fx!(0.2)),
            };
            spawn(&mut world, def, if wanted { hitting(shape) } else { shape });
        }
        world
    };
    let (mut silent, mut telling) = (fall(false), fall(true));
    let mut others: Vec<_> = Backend::available()
        .map(|backend| {
            let mut world = telling.clone();
            assert!(world.set_backend(backend));
            world
        })
        .collect();
    let mut hits = 0;
    for tick in 0..120 {
        run(&mut silent, 1);
        run(&mut telling, 1);
        for ((_, silent), (_, telling)) in silent.bodies().zip(telling.bodies()) {
            let motion = |body: &Body| (body.transform(), body.velocity(), body.angular_velocity());
            assert_eq!(motion(silent), motion(telling), "tick {tick}");
        }
        for world in &mut others {
            run(world, 1);
            assert_eq!(world.events(), telling.events(), "{:?}, tick {tick}", world.backend());
        }
        hits += telling.events().hits.len();
        assert!(telling.events().hits.iter().all(|hit| hit.impulse > fx!(0)));
    }
    assert!(hits > 100, "{hits} hits");
}

/// The approach speed is measured at the time of the impact. A spin about the point of contact does not change it.
#[test]
fn a_hit_of_a_spinning_ball_has_the_speed_along_the_normal() {
    for spin in [fx!(-40), fx!(0), fx!(40)] {
        for phase in 0..8i64 {
            let mut world = weightless();
            spawn(&mut world, BodyDef::fixed().position((fx!(0), fx!(-1))), rectangle(fx!(50), fx!(1)));
            let def = BodyDef::dynamic().position((fx!(0), fx!(1) + fx!(0.01) * phase));
            let def = def.velocity((fx!(20), fx!(-5))).angular_velocity(spin);
            spawn(&mut world, def, hitting(ball(fx!(0.5))).friction(fx!(0)));
            let told = hits(&mut world, 30);
            assert_eq!(told.len(), 1, "spin {spin}, phase {phase}");
            let speed = told[0].approach_speed;
            assert!((speed - fx!(5)).abs() < fx!(0.01), "spin {spin}, phase {phase}: {speed} m/s");
        }
    }
}

/// Three boxes on a slope move equally, whether or not the contact events of one box are switched in every tick.
#[test]
fn switching_events_changes_no_motion() {
    let play = |switches: bool, floor_reports: bool| {
        let mut world = World::default();
        let floor = rectangle(fx!(20), fx!(1));
        let silent = EventSwitches { contact: false, ..EventSwitches::default() };
        let floor = if floor_reports { floor } else { floor.events(silent) };
        let slope = Angle::from_degrees(fx!(40));
        spawn(&mut world, BodyDef::fixed().angle(slope), floor);
        let at = |x: Fx| BodyDef::dynamic().position((x, fx!(3) + x));
        let boxes = [fx!(0), fx!(1.5), fx!(3)].map(|x| spawn(&mut world, at(x), square(fx!(0.5))));
        run(&mut world, 60);
        let mut told = [0; 2];
        for tick in 0..60 {
            let id = shape_of(&world, boxes[1]);
            let mut def = *world.shape(id).expect("there").def();
            def.events.contact ^= switches;
            world.set_shape(id, &def).expect("valid");
            assert_eq!(world.validate(), Ok(()));
            run(&mut world, 1);
            let events = world.events();
            told[0] += events.contact_begin.len() + events.contact_end.len();
            let is_other = |pair: &&ContactEvent| pair.shape_a != id && pair.shape_b != id;
            told[1] += events.contact_begin.iter().chain(&events.contact_end).filter(is_other).count();
            if tick == 30 {
                world = World::from_bytes(&world.to_bytes()).expect("its own bytes");
            }
        }
        (boxes.map(|id| world.body(id).map(|body| (body.position(), body.velocity(), body.angle()))), told)
    };
    for floor_reports in [true, false] {
        let (plain, told) = (play(false, floor_reports), play(true, floor_reports));
        assert_eq!(plain.0, told.0);
    }
    assert_eq!(play(false, true).1, play(true, true).1, "one shape that reports the pair is enough");
    assert!(play(false, false).1[0] < play(true, false).1[0], "each switch begins or ends contacts");
}

/// A ball that was at rest on the floor and now rises by a centimetre: the pair touches until the gap exceeds the
/// speculative distance.
fn barely_touching(events: EventSwitches) -> (World, ShapeId) {
    let mut world = weightless();
    let silent = EventSwitches { contact: false, ..EventSwitches::default() };
    spawn(&mut world, BodyDef::fixed().position((fx!(0), fx!(-1))), rectangle(fx!(5), fx!(1)).events(silent));
    let def = BodyDef::dynamic().position((fx!(0), fx!(0.5))).never_sleeps();
    let id = spawn(&mut world, def, ball(fx!(0.5)).events(events));
    run(&mut world, 2);
    world.set_transform(id, (fx!(0), fx!(0.51)), Angle::ZERO).expect("there");
    run(&mut world, 1);
    let id = shape_of(&world, id);
    (world, id)
}

/// Numbers of begins and ends in a tick, and whether the contact touches.
fn tick(world: &mut World) -> (usize, usize, bool) {
    run(world, 1);
    let touches = world.contacts().any(|contact| contact.touching);
    (world.events().contact_begin.len(), world.events().contact_end.len(), touches)
}

#[test]
fn events_that_are_switched_on_tell_of_all_pairs_that_touch() {
    let on = EventSwitches::default();
    let off = EventSwitches { contact: false, ..on };
    let switch = |world: &mut World, id: ShapeId, events: EventSwitches| {
        let def = *world.shape(id).expect("there").def();
        world.set_shape(id, &def.events(events)).expect("valid");
        assert_eq!(world.validate(), Ok(()));
    };
    let (mut world, id) = barely_touching(off);
    assert_eq!(tick(&mut world), (0, 0, true));
    switch(&mut world, id, on);
    let mut copy = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    assert_eq!(tick(&mut world), (1, 0, true));
    assert_eq!(tick(&mut copy), (1, 0, true));
    assert_eq!(tick(&mut world), (0, 0, true));
    switch(&mut world, id, off);
    assert_eq!(tick(&mut world), (0, 1, true), "the pair still touches, but has no events");
    assert_eq!(tick(&mut world), (0, 0, true));

    // A switch that is set and reset between two ticks has no events.
    switch(&mut world, id, on);
    switch(&mut world, id, off);
    assert_eq!(tick(&mut world), (0, 0, true));
    switch(&mut world, id, on);
    assert_eq!(tick(&mut world), (1, 0, true));
    switch(&mut world, id, off);
    switch(&mut world, id, on);
    assert_eq!(tick(&mut world), (0, 0, true));

    // A pair that parts before its begin was told has neither event, whether it leaves or is removed.
    let body = world.body_of(id).expect("there");
    switch(&mut world, id, off);
    assert_eq!(tick(&mut world), (0, 1, true));
    for height in [fx!(0.6), fx!(30)] {
        let mut away = World::from_bytes(&world.to_bytes()).expect("its own bytes");
        switch(&mut away, id, on);
        away.set_transform(body, (fx!(0), height), Angle::ZERO).expect("there");
        assert_eq!(tick(&mut away), (0, 0, false), "{height}");
        assert_eq!(tick(&mut away), (0, 0, false), "{height}");
    }
    let mut removed = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    switch(&mut removed, id, on);
    removed.despawn(body).expect("there");
    assert_eq!(tick(&mut removed), (0, 0, false));

    // A pair of bodies that are put to sleep is told as well.
    let mut sleeping = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    switch(&mut sleeping, id, on);
    sleeping.sleep(body).expect("dynamic");
    assert_eq!(tick(&mut sleeping), (1, 0, false));
    assert!(is_asleep(&sleeping, body));
    sleeping.wake(body).expect("there");
    assert_eq!(tick(&mut sleeping), (0, 0, true));

    // An end is told although the pair was removed after its events were switched off.
    switch(&mut world, id, on);
    assert_eq!(tick(&mut world), (1, 0, true));
    switch(&mut world, id, off);
    world.despawn(body).expect("there");
    assert_eq!(tick(&mut world), (0, 1, false));
}
