//! Sensors report overlaps and never collide.

use lockstep2d::body::{BodyDef, BodyId, EventSwitches, Filter, ShapeDef, ShapeId};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{SensorEvent, World};

use super::{ball, is_asleep, rectangle, run, shape_of, spawn, square, weightless, world_with_floor};

/// Sensor and visitor.
type Visit = (ShapeId, ShapeId);

/// Events of several ticks.
#[derive(Debug, Default, PartialEq)]
struct Log {
    begun: Vec<Visit>,
    ended: Vec<Visit>,
}

impl Log {
    fn of(world: &mut World, ticks: u32) -> Self {
        let mut log = Log::default();
        for _ in 0..ticks {
            run(world, 1);
            let visits = |events: &[SensorEvent]| -> Vec<Visit> {
                events.iter().map(|event| (event.sensor, event.visitor)).collect()
            };
            log.begun.extend(visits(&world.events().sensor_begin));
            log.ended.extend(visits(&world.events().sensor_end));
        }
        log
    }

    fn counts(&self) -> (usize, usize) {
        (self.begun.len(), self.ended.len())
    }
}

fn visit(world: &World, sensor: BodyId, visitor: BodyId) -> Visit {
    (shape_of(world, sensor), shape_of(world, visitor))
}

fn zone() -> ShapeDef {
    square(fx!(1)).sensor()
}

#[test]
fn a_visitor_that_passes_through_is_noticed_and_not_touched() {
    for (def, kind) in [(BodyDef::fixed(), "fixed"), (BodyDef::kinematic(), "kinematic")] {
        let mut world = weightless();
        let sensor = spawn(&mut world, def, zone());
        for visitor in [BodyDef::dynamic(), BodyDef::kinematic()] {
            let visitor = visitor.position((fx!(-3), fx!(0))).velocity((fx!(4), fx!(0)));
            let visitor = spawn(&mut world, visitor, ball(fx!(0.25)));
            let log = Log::of(&mut world, 120);
            let event = visit(&world, sensor, visitor);
            assert_eq!(log, Log { begun: vec![event], ended: vec![event] }, "{kind}");
            let body = world.body(visitor).expect("there");
            assert_eq!(body.velocity(), Vec2::new(fx!(4), fx!(0)), "{kind}");
            assert!(world.events().contact_begin.is_empty() && world.events().contact_end.is_empty());
            world.despawn(visitor).expect("there");
        }
    }
}

#[test]
fn a_moving_sensor_notices_all_kinds() {
    for kind in [BodyDef::kinematic(), BodyDef::dynamic().mass(mass())] {
        for visitor in
            [BodyDef::fixed(), BodyDef::kinematic(), BodyDef::dynamic(), BodyDef::dynamic().asleep()]
        {
            let mut world = weightless();
            let visitor = spawn(&mut world, visitor, ball(fx!(0.25)));
            let sensor = kind.position((fx!(-3), fx!(0))).velocity((fx!(4), fx!(0)));
            let sensor = spawn(&mut world, sensor, zone());
            let event = visit(&world, sensor, visitor);
            assert_eq!(Log::of(&mut world, 120), Log { begun: vec![event], ended: vec![event] });
        }
    }
}

/// Mass that does not depend on the size of a sensor.
fn mass() -> lockstep2d::body::MassSource {
    lockstep2d::body::MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(1) }
}

#[test]
fn fixed_bodies_and_sensors_are_not_noticed() {
    let mut world = weightless();
    spawn(&mut world, BodyDef::fixed(), zone());
    spawn(&mut world, BodyDef::fixed(), ball(fx!(0.25)));
    spawn(&mut world, BodyDef::dynamic().velocity((fx!(0.1), fx!(0))).mass(mass()), zone());
    assert_eq!(
        Log::of(&mut world, 5).counts(),
        (1, 0),
        "expected one event, of the ball in the moving sensor"
    );
}

#[test]
fn kinematic_visitors_are_noticed_wherever_they_stop() {
    let mut world = weightless();
    let sensor = spawn(&mut world, BodyDef::fixed(), zone());
    let visitor = spawn(&mut world, BodyDef::kinematic().position((fx!(3), fx!(0))), ball(fx!(0.25)));
    let event = visit(&world, sensor, visitor);
    let (inside, outside) = (Vec2::ZERO, Vec2::new(fx!(3), fx!(0)));
    let begin = Log { begun: vec![event], ended: vec![] };
    let end = Log { begun: vec![], ended: vec![event] };
    assert_eq!(Log::of(&mut world, 10), Log::default());
    for _ in 0..2 {
        world.move_to(visitor, inside, Angle::ZERO).expect("valid");
        assert_eq!(Log::of(&mut world, 10), begin, "moved inside");
        world.move_to(visitor, outside, Angle::ZERO).expect("valid");
        assert_eq!(Log::of(&mut world, 10), end, "moved outside");
        world.set_transform(visitor, inside, Angle::ZERO).expect("valid");
        assert_eq!(Log::of(&mut world, 10), begin, "teleported inside");
        world.set_transform(visitor, outside, Angle::ZERO).expect("valid");
        assert_eq!(Log::of(&mut world, 10), end, "teleported outside");
        world.set_transform(sensor, outside, Angle::ZERO).expect("valid");
        assert_eq!(Log::of(&mut world, 10), begin, "the sensor was teleported over the visitor");
        world.set_transform(sensor, inside, Angle::ZERO).expect("valid");
        assert_eq!(Log::of(&mut world, 10), end, "the sensor was teleported back");
    }
    world.despawn(visitor).expect("there");
    let inside = spawn(&mut world, BodyDef::kinematic(), ball(fx!(0.25)));
    let event = visit(&world, sensor, inside);
    assert_eq!(Log::of(&mut world, 10).begun, [event], "spawned inside");
    world.set_kind(inside, lockstep2d::body::BodyKind::Fixed).expect("valid");
    assert_eq!(Log::of(&mut world, 10).ended, [event], "a pair of fixed bodies has no sensor events");
}

/// A box asleep on the floor inside a sensor.
fn sleeper_inside() -> (World, BodyId, BodyId, Visit) {
    let (mut world, _) = world_with_floor();
    let sensor = spawn(&mut world, BodyDef::kinematic().position((fx!(0), fx!(1.3))), zone());
    let visitor = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(0.5))), square(fx!(0.5)));
    let event = visit(&world, sensor, visitor);
    assert_eq!(Log::of(&mut world, 90), Log { begun: vec![event], ended: vec![] });
    assert!(is_asleep(&world, visitor));
    (world, sensor, visitor, event)
}

#[test]
fn a_sleeping_visitor_stays_inside() {
    let (mut world, _, visitor, event) = sleeper_inside();
    assert_eq!(Log::of(&mut world, 30), Log::default());
    world.wake(visitor).expect("there");
    assert_eq!(Log::of(&mut world, 60), Log::default(), "waking causes no sensor event");
    world.set_velocity(visitor, Vec2::new(fx!(0), fx!(9)), fx!(0)).expect("valid");
    assert_eq!(Log::of(&mut world, 20).ended, [event]);
}

#[test]
fn whatever_is_removed_ends_a_visit_once() {
    let ends = |change: fn(&mut World, BodyId, BodyId)| {
        for settle in [true, false] {
            let (mut world, sensor, visitor, event) = sleeper_inside();
            if !settle {
                world.wake(visitor).expect("there");
                run(&mut world, 1);
            }
            change(&mut world, sensor, visitor);
            let mut restored = World::from_bytes(&world.to_bytes()).expect("its own bytes");
            let log = Log::of(&mut world, 30);
            assert_eq!(log, Log { begun: vec![], ended: vec![event] });
            assert_eq!(Log::of(&mut restored, 30), log);
        }
    };
    ends(|world, sensor, _| world.despawn(sensor).expect("there"));
    ends(|world, _, visitor| world.despawn(visitor).expect("there"));
    ends(|world, sensor, _| world.disable(sensor).expect("there"));
    ends(|world, _, visitor| world.disable(visitor).expect("there"));
    ends(|world, sensor, _| world.remove_shape(shape_of(world, sensor)).expect("there"));
    ends(|world, sensor, _| {
        world.set_transform(sensor, Vec2::new(fx!(30), fx!(30)), Angle::ZERO).expect("valid")
    });
    ends(|world, sensor, _| {
        let nothing = Filter { mask: 0, ..Filter::default() };
        world.set_filter(shape_of(world, sensor), nothing).expect("valid");
    });
    ends(|world, _, visitor| {
        let shape = shape_of(world, visitor);
        let mut def = *world.shape(shape).expect("there").def();
        def.events.sensor = false;
        world.set_shape(shape, &def).expect("valid");
    });
}

#[test]
fn a_sensor_that_becomes_solid_pushes() {
    let mut world = weightless();
    let zone = spawn(&mut world, BodyDef::fixed(), zone());
    let visitor = spawn(&mut world, BodyDef::dynamic().position((fx!(0.9), fx!(0))), square(fx!(0.5)));
    let event = visit(&world, zone, visitor);
    assert_eq!(Log::of(&mut world, 10).begun, [event]);
    let shape = shape_of(&world, zone);
    let solid = ShapeDef { sensor: false, ..*world.shape(shape).expect("there").def() };
    world.set_shape(shape, &solid).expect("valid");
    run(&mut world, 1);
    assert_eq!((world.events().sensor_end.len(), world.events().contact_begin.len()), (1, 1));
    run(&mut world, 120);
    let x = world.body(visitor).expect("there").position().x;
    assert!(x > fx!(1.48), "expected the box to be pushed out; x = {x}");
    world.set_shape(shape, &solid.sensor()).expect("valid");
    run(&mut world, 1);
    assert_eq!(world.events().contact_end.len(), 1);
}

#[test]
fn filters_and_switches_hide_from_sensors() {
    let hidden = EventSwitches { sensor: false, ..EventSwitches::default() };
    let other = Filter { category: 2, ..Filter::default() };
    let noticed = |zone: ShapeDef, visitor: ShapeDef| {
        let mut world = weightless();
        spawn(&mut world, BodyDef::fixed(), zone);
        spawn(&mut world, BodyDef::dynamic(), visitor);
        Log::of(&mut world, 3).begun.len()
    };
    assert_eq!(noticed(zone(), ball(fx!(0.2))), 1);
    assert_eq!(noticed(zone(), ball(fx!(0.2)).events(hidden)), 0);
    assert_eq!(noticed(zone().filter(Filter { mask: 1, ..other }), ball(fx!(0.2)).filter(other)), 0);
    assert_eq!(noticed(zone().filter(Filter { mask: 2, ..other }), ball(fx!(0.2)).filter(other)), 1);
    // Contact and hit switches do not affect sensors.
    let silent = EventSwitches { contact: false, hit: false, ..EventSwitches::default() };
    assert_eq!(noticed(zone().events(silent), ball(fx!(0.2)).events(silent)), 1);
    assert_eq!(noticed(zone(), rectangle(fx!(30), Fx::ONE)), 1, "a visitor larger than the sensor");
}

/// Changing the switches of contact and hit events ends no visit. Changing `detect_sensors` does not either, because
/// the visitor is no sensor.
#[test]
fn a_switch_of_other_events_ends_no_visit() {
    let switches: [fn(&mut EventSwitches); 3] =
        [|events| events.contact = false, |events| events.hit = true, |events| events.detect_sensors = true];
    for switch in switches {
        for settle in [true, false] {
            let (mut world, sensor, visitor, _) = sleeper_inside();
            if !settle {
                world.wake(visitor).expect("there");
                run(&mut world, 1);
            }
            for id in [visitor, sensor] {
                let id = shape_of(&world, id);
                let mut def = *world.shape(id).expect("there").def();
                switch(&mut def.events);
                world.set_shape(id, &def).expect("valid");
                assert_eq!(world.validate(), Ok(()));
                let mut restored = World::from_bytes(&world.to_bytes()).expect("its own bytes");
                assert_eq!(Log::of(&mut world, 30), Log::default());
                assert_eq!(Log::of(&mut restored, 30), Log::default());
            }
        }
    }
}
