//! Sensors report every shape that crosses them within a tick, in the order of the crossings.
//!
//! The oracle moves a [`Probe`] with the visitor's shape along the visitor's path, while the sensors stand still. It
//! samples whether probe and sensor overlap, and finds the times of changes by bisection.

use lockstep2d::body::{BodyDef, BodyId, BodyKind, Chain, Geometry, MassSource, Polygon, ShapeDef, ShapeId};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2};
use lockstep2d::world::{Probe, QueryFilter, SensorEvent, World};

use super::{run, shape_of, spawn, sweep, weightless};

/// Position in metres at time 0, velocity in m/s and angular velocity in rad/s.
struct Path {
    start: Vec2<Fx>,
    velocity: Vec2<Fx>,
    angular: Fx,
}

impl Path {
    /// Probe with the pose at `time`, in ticks.
    fn probe(&self, geometry: Geometry, time: Fx) -> Probe {
        let seconds = time / 60;
        let at = self.start + self.velocity.scale(seconds);
        let turned = Angle::from_radians(self.angular.saturating_mul(seconds));
        Probe::new(geometry, at).expect("valid").turned(turned)
    }
}

/// Random geometry of a sensor, about the origin of its body.
fn gate(rng: &mut Rng) -> Geometry {
    let turned = |half: Fx, rng: &mut Rng| {
        Rot::from_angle(Angle::from_radians(rng.range(fx!(-0.5), fx!(0.5))))
            .apply_wide(Vec2::new(Fx::ZERO, half))
    };
    match rng.below(6) {
        0 => Polygon::rectangle(fx!(0.005), fx!(1.5)).expect("valid").into(),
        1 => Polygon::rectangle(rng.range(fx!(0.1), fx!(0.7)), fx!(1.2)).expect("valid").into(),
        2 => Geometry::circle(rng.range(fx!(0.6), fx!(1))).expect("valid"),
        3 => {
            let half = turned(fx!(1.2), rng);
            Geometry::segment(-half, half).expect("valid")
        }
        4 => {
            let half = turned(fx!(1), rng);
            Geometry::capsule(-half, half, fx!(0.1)).expect("valid")
        }
        _ => {
            let top = turned(fx!(1.2), rng);
            let points = [-top, top, Vec2::new(fx!(-0.2), fx!(3))];
            let link = Chain::new(&points).one_sided().links().expect("valid").remove(0);
            link.geometry
        }
    }
}

fn visitor(rng: &mut Rng) -> Geometry {
    match rng.below(4) {
        0 => Geometry::circle(rng.range(fx!(0.05), fx!(0.4))).expect("valid"),
        1 => Polygon::rectangle(fx!(0.3), fx!(0.1)).expect("valid").into(),
        2 => Polygon::square(rng.range(fx!(0.05), fx!(0.3))).expect("valid").into(),
        _ => Geometry::capsule(Vec2::new(fx!(-0.2), fx!(0)), Vec2::new(fx!(0.2), fx!(0)), fx!(0.1))
            .expect("valid"),
    }
}

/// Times in ticks at which a path enters (`true`) or leaves (`false`) a sensor that stands still.
fn visits(world: &World, sensor: ShapeId, geometry: Geometry, path: &Path, end: Fx) -> Vec<(Fx, bool)> {
    let filter = QueryFilter { sensors: true, ..QueryFilter::default() };
    let inside = |time: Fx| world.overlap_shape(&path.probe(geometry, time), filter).contains(&sensor);
    let step = (fx!(0.02) * 60 / path.velocity.length()).min(fx!(0.05));
    let (mut time, mut changes) = (Fx::ZERO, Vec::<(Fx, bool)>::new());
    let mut was = inside(time);
    while time < end {
        let next = time + step;
        let is = inside(next);
        if is != was {
            let (mut before, mut after) = (time, next);
            while after - before > fx!(0.000001) {
                let middle = before + (after - before) / 2;
                if inside(middle) == was { before = middle } else { after = middle }
            }
            match changes.last() {
                // A visitor that leaves and returns within a tick has no events.
                Some(&(left, false)) if is && Fx::floor(left) == after.floor() => drop(changes.pop()),
                _ => changes.push((after, is)),
            }
        }
        (time, was) = (next, is);
    }
    changes
}

#[test]
fn a_thousand_crossings_are_noticed_in_order() {
    let cases: Vec<u64> = (0..sweep::size(10_000, 1000)).collect();
    sweep::for_each(cases, check_course);
}

/// A visitor flies through three sensors, or the sensors fly over the visitor.
fn check_course(case: u64) {
    let mut rng = Rng::new(case);
    let speed = rng.range(fx!(3), fx!(399));
    let geometry = visitor(&mut rng);
    let angular = if rng.chance(1, 3) { rng.range(fx!(-60), fx!(60)) } else { Fx::ZERO };
    let start = Vec2::new(fx!(-4), rng.range(fx!(-0.4), fx!(0.4)));
    let path = Path { start, velocity: Vec2::new(speed, Fx::ZERO), angular };
    let gates: Vec<Geometry> = (0..3).map(|_| gate(&mut rng)).collect();
    let place = |index: usize| Vec2::new(Fx::from_num(2 * index), Fx::ZERO);
    let ticks = (fx!(14) * 60 / speed).ceil();

    let mut still = weightless();
    let sensors: Vec<ShapeId> = (0..3)
        .map(|index| {
            let def = BodyDef::fixed().position(place(index));
            let id = spawn(&mut still, def, ShapeDef::new(gates[index]).sensor());
            shape_of(&still, id)
        })
        .collect();
    let mut expected: Vec<(Fx, usize, bool)> = Vec::new();
    for (index, &sensor) in sensors.iter().enumerate() {
        let changes = visits(&still, sensor, geometry, &path, ticks);
        expected.extend(changes.into_iter().map(|(time, begins)| (time, index, begins)));
    }
    expected.sort_unstable();

    // Links and segments have no mass, so that their bodies are fixed or kinematic.
    let (sensor_speed, kind) = match rng.below(3) {
        0 => (Fx::ZERO, BodyKind::Fixed),
        1 => (speed / 2, BodyKind::Kinematic),
        _ => (speed, BodyKind::Kinematic),
    };
    let mut world = weightless();
    let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.5) };
    let flying = BodyDef::dynamic().mass(mass).position(start);
    let flying = flying.velocity((speed - sensor_speed, fx!(0))).angular_velocity(angular);
    spawn(&mut world, flying, ShapeDef::new(geometry));
    let bodies: Vec<BodyId> = (0..3)
        .map(|index| {
            let def = BodyDef::new(kind).position(place(index)).velocity((-sensor_speed, fx!(0)));
            spawn(&mut world, def, ShapeDef::new(gates[index]).sensor())
        })
        .collect();
    let index_of = |world: &World, event: &SensorEvent| {
        bodies.iter().position(|&body| shape_of(world, body) == event.sensor).expect("one of the three")
    };
    let mut told: Vec<(Fx, usize, bool)> = Vec::new();
    let mut tick = Fx::ZERO;
    while tick < ticks {
        run(&mut world, 1);
        let events = world.events();
        for (list, begins) in [(&events.sensor_begin, true), (&events.sensor_end, false)] {
            let times = list.iter().map(|event| (tick + event.fraction, index_of(&world, event), begins));
            told.extend(times);
        }
        tick += Fx::ONE;
    }
    told.sort_unstable();
    let order =
        |list: &[(Fx, usize, bool)]| list.iter().map(|&(_, gate, begins)| (gate, begins)).collect::<Vec<_>>();
    assert_eq!(
        order(&told),
        order(&expected),
        "case {case} at {speed} m/s: {told:?} instead of {expected:?}"
    );
    for &(time, gate, begins) in &told {
        let at = path.probe(geometry, time);
        let depth = still.probe_distance(&at, sensors[gate]).expect("there").distance.abs();
        assert!(depth < fx!(0.0001), "case {case} at {speed} m/s: {time} of {gate} {begins}: {depth} m");
    }
}

/// A slanted wall deflects a ball to a place outside of the ball's fat AABB.
#[test]
fn a_deflected_visitor_is_noticed_in_the_same_tick() {
    let mut rng = Rng::new(5);
    let (mut crossed, mut entered) = (0, 0);
    for case in 0..200 {
        let mut world = weightless();
        let wall = super::rectangle(fx!(6), fx!(1)).restitution(fx!(1)).friction(fx!(0));
        let wall_def = BodyDef::fixed().position((fx!(2), fx!(-2))).angle(Angle::EIGHTH);
        spawn(&mut world, wall_def, wall);
        // The wall's surface passes near the origin at 45 degrees: the ball leaves upwards.
        let speed = rng.range(fx!(200), fx!(390));
        let start = Vec2::new(rng.range(fx!(-6), fx!(-2)), fx!(0));
        let def = BodyDef::dynamic().position(start).velocity((speed, fx!(0)));
        let flying = spawn(&mut world, def, super::ball(fx!(0.2)).restitution(fx!(1)).friction(fx!(0)));
        // The gate is outside of the ball's fat AABB of the first tick, which covers the straight flight of that tick.
        let height = rng.range(fx!(1), fx!(3));
        let gate = super::rectangle(fx!(8), rng.range(fx!(0.01), fx!(0.5))).sensor();
        let gate = spawn(&mut world, BodyDef::fixed().position((fx!(-2), height)), gate);
        let gate = shape_of(&world, gate);
        for tick in 0..6 {
            let before = world.body(flying).expect("there").position();
            let was_inside = !world.sensor_overlaps(gate).is_empty();
            run(&mut world, 1);
            let after = world.body(flying).expect("there").position();
            let filter = QueryFilter { sensors: true, ..QueryFilter::default() };
            // The oracle tests a thousand points of the path.
            let inside = |point: Vec2<Fx>| {
                let probe = Probe::new(Geometry::circle(fx!(0.2)).expect("valid"), point).expect("valid");
                world.overlap_shape(&probe, filter).contains(&gate)
            };
            let on_way = |i: i64| before + (after - before).scale(Fx::from_num(i) / 1000);
            let (met, is_inside) = ((0..=1000).any(|i| inside(on_way(i))), inside(after));
            let counts = (world.events().sensor_begin.len(), world.events().sensor_end.len());
            let expected = match (was_inside, met, is_inside) {
                (false, true, true) => (1, 0),
                (false, true, false) => (1, 1),
                (true, _, false) => (0, 1),
                (true, _, true) | (false, false, _) => (0, 0),
            };
            assert_eq!(counts, expected, "case {case}, tick {tick}, {before:?} to {after:?}");
            assert_eq!(!world.sensor_overlaps(gate).is_empty(), is_inside, "case {case}, tick {tick}");
            let again = World::from_bytes(&world.to_bytes()).expect("its own bytes");
            assert_eq!(again.sensor_overlaps(gate), world.sensor_overlaps(gate));
            let is_deflected = (after - before).y > fx!(0.5) && before.y < fx!(0.2);
            crossed += usize::from(is_deflected && counts == (1, 1));
            entered += usize::from(is_deflected && counts == (1, 0));
        }
    }
    assert!(crossed > 20 && entered > 5, "{crossed} crossed and {entered} entered after a deflection");
}

#[test]
fn sensors_notice_sensors_that_let_them() {
    let zone = || super::square(fx!(1)).sensor();
    let seeing = || super::square(fx!(1)).sensor_of_sensors();
    let mut hidden = zone();
    hidden.events.sensor = false;
    let count = |a: ShapeDef, b: ShapeDef| {
        let mut world = weightless();
        spawn(&mut world, BodyDef::fixed(), a);
        let other = spawn(&mut world, BodyDef::kinematic().position((fx!(1), fx!(0))), b);
        run(&mut world, 1);
        let overlaps: Vec<_> = world.shapes().map(|(id, _)| world.sensor_overlaps(id).len()).collect();
        let begun = world.events().sensor_begin.len();
        assert_eq!(overlaps.iter().sum::<usize>(), begun);
        world.despawn(other).expect("there");
        run(&mut world, 1);
        assert_eq!(world.events().sensor_end.len(), begun, "as many ends as beginnings");
        overlaps
    };
    assert_eq!(count(zone(), zone()), [0, 0]);
    assert_eq!(count(seeing(), zone()), [1, 0]);
    assert_eq!(count(zone(), seeing()), [0, 1]);
    assert_eq!(count(seeing(), seeing()), [1, 1]);
    assert_eq!(count(seeing(), hidden), [0, 0]);
    // A sensor without the switch still reports solid visitors. On a solid shape the switch has no effect.
    assert_eq!(count(zone(), super::square(fx!(1))), [1, 0]);
    assert_eq!(count(zone(), ShapeDef { sensor: false, ..seeing() }), [1, 0]);
}

#[test]
fn switching_the_detection_of_sensors_begins_and_ends_overlaps() {
    let mut world = weightless();
    let zone = spawn(&mut world, BodyDef::fixed(), super::square(fx!(1)).sensor());
    spawn(&mut world, BodyDef::dynamic(), super::square(fx!(1)).sensor());
    let zone = shape_of(&world, zone);
    let def = *world.shape(zone).expect("there").def();
    run(&mut world, 1);
    assert_eq!(world.events().sensor_begin.len(), 0);
    world.set_shape(zone, &def.sensor_of_sensors()).expect("valid");
    run(&mut world, 1);
    assert_eq!((world.events().sensor_begin.len(), world.events().sensor_end.len()), (1, 0));
    world.set_shape(zone, &def).expect("valid");
    run(&mut world, 1);
    assert_eq!((world.events().sensor_begin.len(), world.events().sensor_end.len()), (0, 1));
}

/// A visitor that has left in this tick is not listed as inside.
#[test]
fn overlaps_are_those_of_the_end_of_the_tick() {
    let mut world = weightless();
    let zone = spawn(&mut world, BodyDef::fixed(), super::square(fx!(1)).sensor());
    let zone = shape_of(&world, zone);
    let def = BodyDef::dynamic().position((fx!(-3), fx!(0))).velocity((fx!(6), fx!(0)));
    let visitor = spawn(&mut world, def, super::ball(fx!(0.25)));
    for _ in 0..90 {
        run(&mut world, 1);
        let x = world.body(visitor).expect("there").position().x;
        assert_eq!(!world.sensor_overlaps(zone).is_empty(), x.abs() <= fx!(1.25), "at {x}");
    }
}
