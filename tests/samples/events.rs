//! Samples of Box2D's group "Events". The sample "Joint" of this group is in `joints.rs`.

use lockstep2d::body::{BodyDef, Chain, EventSwitches, Filter, MassSource, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::solver::{Prismatic, Revolute};
use lockstep2d::world::{Explosion, SensorChange};

use super::{Stage, ball, capsule, line, near, num, rect, rounded, square};

/// Sample "Sensor Funnel".
#[test]
fn a_funnel_empties_into_its_sensor() {
    let mut stage = Stage::new();
    let outline = [
        at!(-17, 31),
        at!(17, 31),
        at!(17, 17),
        at!(8, 12),
        at!(17, 12),
        at!(17, -1),
        at!(8, -6),
        at!(17, -6),
        at!(17, -13),
        at!(3.6, -23),
        at!(3.6, -31),
        at!(-3.6, -31),
        at!(-3.6, -23),
        at!(-17, -13),
        at!(-17, -6),
        at!(-8, -6),
        at!(-17, -1),
        at!(-17, 12),
        at!(-8, 12),
        at!(-17, 17),
    ];
    let mut shapes = Chain::new(&outline).closed().links().expect("valid");
    shapes.iter_mut().for_each(|link| *link = link.friction(fx!(0.2)));
    shapes.push(rect(fx!(4), fx!(1)).offset(at!(0, -30.5)).sensor());
    let ground = stage.spawn(BodyDef::fixed(), &shapes);
    for (y, speed) in [(fx!(14), fx!(2)), (fx!(0), fx!(-2)), (fx!(-14), fx!(2))] {
        let place = Vec2::new(Fx::ZERO, y);
        let paddle = stage.add(place, rect(fx!(6), fx!(0.5)).friction(fx!(0.1)).restitution(fx!(1)));
        stage.join_at(ground, paddle, Revolute::new().motor(speed, fx!(200)), place);
    }
    let (mut dropped, mut caught) = (0, 0);
    for tick in 0..2400 {
        if tick % 30 == 0 && dropped < 20 {
            stage.add(Vec2::new(num(if dropped % 2 == 0 { -15 } else { 15 }), fx!(29.5)), ball(fx!(0.7)));
            dropped += 1;
        }
        stage.world.step();
        let begins = stage.world.events().sensor_begin.clone();
        for event in begins {
            let body = stage.world.shape(event.visitor).expect("not removed yet").body();
            stage.world.despawn(body).expect("reported once");
            caught += 1;
        }
    }
    assert_eq!((dropped, caught), (20, 20));
    // Only the funnel and its three paddles are left.
    assert_eq!(stage.world.body_count(), 4);
}

/// Sample "Sensor Bookend". The overlap of a sensor and a visitor ends when one of them leaves, is disabled or is
/// removed.
#[test]
fn every_begin_has_its_end() {
    for ending in 0..5 {
        let mut stage = Stage::with_floor();
        let switches = EventSwitches { detect_sensors: true, ..EventSwitches::default() };
        let fixed = stage.fixed(at!(-2, 1), square(fx!(1)).sensor().events(switches));
        let carrier = [rounded(fx!(1), fx!(1), fx!(0.5)).sensor().events(switches), square(fx!(0.5))];
        let carrier = stage.spawn(BodyDef::dynamic().position(at!(-1, 0.5)).never_sleeps(), &carrier);
        let visitor =
            stage.spawn(BodyDef::dynamic().position(at!(-2.3, 1)).never_sleeps(), &[ball(fx!(0.3))]);
        let (mut open, mut seen) = (Vec::new(), 0);
        let mut watch = |stage: &mut Stage| {
            let changes: Vec<_> = stage.world.events().sensor_changes().collect();
            for change in changes {
                match change {
                    SensorChange::Begin(event) => {
                        assert!(!open.contains(&(event.sensor, event.visitor)), "begun twice: {event:?}");
                        open.push((event.sensor, event.visitor));
                        seen += 1;
                    }
                    SensorChange::End(event) => {
                        let at = open.iter().position(|&pair| pair == (event.sensor, event.visitor));
                        open.remove(at.expect("an end has a begin"));
                    }
                }
            }
            // Two overlapping sensors report each other, so either both events are open or neither is.
            let mutual = open.iter().filter(|(sensor, visitor)| {
                let is_sensor = |id| stage.world.shape(id).is_some_and(|shape| shape.is_sensor());
                is_sensor(*sensor) && is_sensor(*visitor)
            });
            assert!([0, 2].contains(&mutual.count()) || ending > 0);
        };
        stage.run_and(60, &mut watch);
        match ending {
            0 => {
                stage.world.set_velocity(visitor, at!(20, 5), fx!(0)).expect("valid");
                stage.world.set_velocity(carrier, at!(-20, 5), fx!(0)).expect("valid");
            }
            1 => [visitor, carrier].into_iter().for_each(|id| stage.world.disable(id).expect("there")),
            2 => stage.world.disable(fixed).expect("there"),
            3 => [visitor, carrier].into_iter().for_each(|id| stage.world.despawn(id).expect("there")),
            _ => stage.world.despawn(fixed).expect("there"),
        }
        stage.run_and(60, &mut watch);
        let of_fixed = |pair: &&(_, _)| stage.world.shape(pair.0).is_some_and(|shape| shape.body() == fixed);
        assert!(seen >= 4, "the ball, the box, and each sensor the other: {seen}");
        assert_eq!(open.iter().filter(of_fixed).count(), 0, "ending {ending}: {open:?}");
    }
}

/// Sample "Foot Sensor".
#[test]
fn a_foot_sensor_knows_the_ground() {
    let mut stage = Stage::new();
    let (ground, player, foot) = (1, 2, 4);
    let filter = |category, mask| Filter { category, mask, group: 0 };
    let points: Vec<_> = (0..20).map(|i| Vec2::new(num(10 - i), Fx::ZERO)).collect();
    let chain = Chain::new(&points).one_sided().filter(filter(ground, player | foot)).links().expect("valid");
    stage.spawn(BodyDef::fixed(), &chain);
    let body = capsule(at!(0, -0.5), at!(0, 0.5), fx!(0.5)).friction(fx!(0.3)).filter(filter(player, ground));
    let sole = rect(fx!(0.5), fx!(0.25)).offset(at!(0, -1)).sensor().filter(filter(foot, ground));
    let player = stage.spawn(BodyDef::dynamic().position(at!(0.5, 1)).lock_rotation(), &[body, sole]);
    let sole = *stage.world.shapes_of(player).last().expect("two shapes");
    stage.run(60);
    // The sole is centred on a link, and both are 1 m wide. So the sole overlaps this link, and perhaps its neighbours.
    let under = stage.world.sensor_overlaps(sole).len();
    assert!((1..=3).contains(&under), "{under} links");
    stage.world.set_velocity(player, at!(0, 5), fx!(0)).expect("valid");
    let mut in_the_air = 0;
    stage.run_and(90, |stage| {
        let lifted = stage.place(player).y > fx!(1.3);
        assert!(!lifted || stage.world.sensor_overlaps(sole).is_empty());
        in_the_air += i32::from(lifted);
    });
    // A jump at 5 m/s is above 0.3 m for sqrt(25 - 6) / 5 seconds.
    assert!((50..=54).contains(&in_the_air), "{in_the_air} ticks");
    assert!(!stage.world.sensor_overlaps(sole).is_empty());
}

/// Sample "Contact". A part of the player that touches the wall is lost.
#[test]
fn what_touches_the_player_becomes_a_part_of_it() {
    let mut stage = Stage::weightless();
    let room = [at!(10, -10), at!(-10, -10), at!(-10, 10), at!(10, 10)];
    let wall = stage.spawn(BodyDef::fixed(), &Chain::new(&room).closed().links().expect("valid"));
    let player = stage.spawn(BodyDef::dynamic().velocity(at!(5, 0)).bullet(), &[ball(fx!(1))]);
    let core = stage.shape(player);
    let quiet = EventSwitches { contact: false, ..EventSwitches::default() };
    for i in 0..3 {
        stage.add(Vec2::new(num(3 + 2 * i), fx!(0.3)), rect(fx!(0.4), fx!(0.6)).events(quiet));
    }
    let start = stage.energy();
    let (mut attached, mut lost, mut heaviest) = (0, 0, Fx::ZERO);
    for _ in 0..600 {
        stage.world.step();
        let begun = stage.world.events().contact_begin.clone();
        for event in begun {
            let of = |id| stage.world.shape(id).map(|shape| shape.body());
            let (Some(a), Some(b)) = (of(event.shape_a), of(event.shape_b)) else { continue };
            assert!(a == player || b == player, "only the player reports contacts");
            let (own, other) = if a == player { (event.shape_a, b) } else { (event.shape_b, a) };
            if other == wall && own != core {
                stage.world.remove_shape(own).expect("there");
                lost += 1;
            } else if other != wall {
                let debris = *stage.world.shape(stage.shape(other)).expect("there").def();
                let offset = stage.body(player).transform().apply_inverse(stage.place(other));
                stage.world.despawn(other).expect("there");
                let part = ShapeDef { offset, events: EventSwitches::default(), ..debris };
                stage.world.add_shape(player, &part).expect("valid");
                attached += 1;
            }
        }
        heaviest = heaviest.max(stage.body(player).mass());
    }
    assert_eq!((attached, stage.world.body_count()), (3, 2));
    near(heaviest, lockstep2d::math::PI + fx!(2.88), fx!(0.01));
    assert_eq!(stage.world.shapes_of(player).len(), 4 - lost);
    assert!(lost > 0, "expected the bulk to meet a wall");
    assert!(stage.energy() < start + fx!(0.1));
}

/// Sample "Body Move".
#[test]
fn moves_are_reported_until_sleep() {
    let mut stage = Stage::with_floor();
    let shapes = [
        ball(fx!(0.35)).rolling_resistance(fx!(0.1)),
        square(fx!(0.35)),
        capsule(at!(-0.25, 0), at!(0.25, 0), fx!(0.25)),
    ];
    let bodies: Vec<_> = (0..12)
        .zip(shapes.iter().cycle())
        .map(|(i, &shape)| stage.add(Vec2::new(num(i) - fx!(6), num(3 + i % 4)), shape))
        .collect();
    let mut fell_asleep = Vec::new();
    stage.run_and(900, |stage| {
        for event in &stage.world.events().moved {
            let body = stage.body(event.body);
            assert_eq!((event.position, event.angle), (body.position(), body.angle()));
            assert_eq!(event.fell_asleep, body.is_asleep());
            if event.fell_asleep {
                fell_asleep.push(event.body);
            }
        }
    });
    fell_asleep.sort();
    fell_asleep.dedup();
    assert_eq!(fell_asleep, bodies, "expected each body to fall asleep");
    stage
        .world
        .explode(&Explosion { radius: fx!(10), ..Explosion::new(at!(0, -5), fx!(10)) })
        .expect("valid");
    stage.run(1);
    assert!(stage.world.events().moved.len() >= 6, "expected the explosion to move some");
}

/// Sample "Sensor Types".
#[test]
fn sensors_of_every_kind_of_body_detect() {
    let (ground, sensor, default) = (2, 4, 1);
    let filter = |category, mask| Filter { category, mask, group: 0 };
    let mut stage = Stage::new();
    let wall = |a, b| line(a, b).filter(filter(ground, default));
    stage.spawn(
        BodyDef::fixed(),
        &[wall(at!(-6, 0), at!(6, 0)), wall(at!(-6, 0), at!(-6, 4)), wall(at!(6, 0), at!(6, 4))],
    );
    let eye = square(fx!(1)).sensor().filter(filter(sensor, u64::MAX));
    let fixed = stage.fixed(at!(-3, 0.8), eye);
    let kinematic = stage.spawn(BodyDef::kinematic().velocity((fx!(0), fx!(0.1))), &[eye]);
    let dynamic = stage.spawn(
        BodyDef::dynamic().position(at!(3, 1)),
        &[eye, square(fx!(0.8)).filter(filter(default, !sensor))],
    );
    let eyes = [fixed, kinematic, dynamic].map(|id| stage.shape(id));
    let def = BodyDef::dynamic().position(at!(-5, 0.5)).velocity(at!(5, 0)).angular_velocity(fx!(-10));
    let visitor = stage.spawn(def, &[ball(fx!(0.5)).filter(filter(default, ground | default | sensor))]);
    let visitor = stage.shape(visitor);
    let mut order = Vec::new();
    stage.run_and(120, |stage| {
        for event in &stage.world.events().sensor_begin {
            if event.visitor == visitor {
                order.push(event.sensor);
            }
        }
    });
    assert_eq!(order, eyes);
    // The sensor does not report the solid part of its own body. It does not report the ground either, whose mask
    // excludes the sensor.
    assert_eq!(stage.world.sensor_overlaps(eyes[2]).iter().filter(|&&id| id != visitor).count(), 0);
}

/// Sample "Persistent Contact". The contact force equals the weight.
#[test]
fn a_rolling_ball_keeps_touching() {
    let mut stage = Stage::new();
    let mut points: Vec<_> = (0..20).map(|i| Vec2::new(num(10 - i), Fx::ZERO)).collect();
    points.extend([at!(-9, 10), at!(10, 10)]);
    stage.spawn(BodyDef::fixed(), &Chain::new(&points).closed().links().expect("valid"));
    let def = BodyDef::dynamic().position(at!(-8, 0.5)).velocity(at!(2, 0)).angular_velocity(fx!(-4));
    let body = stage.spawn(def, &[ball(fx!(0.5))]);
    let (mut begun, mut ended) = (0, 0);
    stage.run_and(300, |stage| {
        begun += stage.world.events().contact_begin.len();
        ended += stage.world.events().contact_end.len();
        assert!(begun > ended, "expected the ball to touch at any time");
        if stage.world.tick() > 30 {
            let load: Fx = stage
                .world
                .contacts_of(body)
                .flat_map(|contact| contact.forces().map(|(_, force)| force.normal).collect::<Vec<_>>())
                .sum();
            near(load, stage.body(body).mass() * 10, fx!(0.4));
        }
    });
    assert!(begun > 5, "expected one link after the other, {begun}");
}

/// Sample "Sensor Hits".
#[test]
fn a_fast_ball_hits_every_sensor_in_order() {
    for speed in [200, 250, 300, 399] {
        for bullet in [false, true] {
            let mut stage = Stage::new();
            let ground = stage.floor();
            let eye = rect(fx!(0.1), fx!(5)).sensor();
            let fixed = stage.fixed(at!(-10, 6), eye);
            let kinematic =
                stage.spawn(BodyDef::kinematic().position(at!(0, 6)).velocity(at!(0.5, 0)), &[eye]);
            let solid = square(fx!(0.2)).offset(at!(0, -5.4));
            let dynamic = stage.spawn(BodyDef::dynamic().position(at!(10, 6)), &[eye, solid]);
            let slider = Prismatic::new().motor(fx!(-0.5), fx!(100000));
            stage.join_at(ground, dynamic, slider, at!(10, 6));
            let def = BodyDef::dynamic()
                .position(at!(-26.7, 6))
                .velocity(Vec2::new(num(speed), Fx::ZERO))
                .gravity_scale(fx!(0));
            stage.spawn(if bullet { def.bullet() } else { def }, &[ball(fx!(0.25))]);
            let eyes = [fixed, kinematic, dynamic].map(|id| stage.shape(id));
            let mut changes = Vec::new();
            stage.run_and(30, |stage| {
                changes.extend(stage.world.events().sensor_changes().map(|change| match change {
                    SensorChange::Begin(event) => (true, event.sensor),
                    SensorChange::End(event) => (false, event.sensor),
                }));
            });
            let expected: Vec<_> = eyes.iter().flat_map(|&id| [(true, id), (false, id)]).collect();
            assert_eq!(changes, expected, "{speed} m/s");
        }
    }
}

/// Sample "Projectile Event".
#[test]
fn a_projectile_explodes_on_impact() {
    let mut stage = Stage::with_floor();
    let stack: Vec<_> = (0..8)
        .map(|i| stage.add(Vec2::new(fx!(8), num(i) + fx!(0.5)), rounded(fx!(0.5), fx!(0.5), fx!(0.05))))
        .collect();
    stage.run(120);
    let shot = BodyDef::dynamic().position(at!(-5, 4)).velocity(at!(60, 2)).bullet();
    let shot = stage.spawn(shot, &[ball(fx!(0.25))]);
    let mut at = None;
    for _ in 0..60 {
        stage.run(1);
        let touching = stage.world.contacts_of(shot).find(|contact| contact.touching);
        let Some(point) = touching.and_then(|contact| contact.manifold.points().first().copied()) else {
            continue;
        };
        let centre = stage.place(shot);
        stage.world.despawn(shot).expect("there");
        stage.world.explode(&Explosion::new(centre, fx!(20))).expect("valid");
        at = Some((centre, point));
        break;
    }
    let (centre, _) = at.expect("a hit");
    // The projectile hits after a quarter of a tick. For the rest of the tick, it pushes the box ahead by 0.75 / 60 s x
    // 60 m/s x 0.2 / 1.2 = 0.125 m, where 0.2 / 1.2 is the projectile's share of the mass.
    assert!(centre.x > fx!(7.2) && centre.x < fx!(7.25) + fx!(0.125), "exploded at {centre:?}");
    assert!(stage.world.body(shot).is_none());
    stage.run(180);
    assert!(stage.place(stack[7]).y < fx!(7), "the top is at {}", stage.place(stack[7]).y);
}

/// Sample "Circle Impulse": a circle of 1 kg at 25 m/s.
#[test]
fn a_hit_reports_its_speed() {
    for (restitution, returned) in [(fx!(0), fx!(0)), (fx!(0.25), fx!(6.25))] {
        let mut stage = Stage::weightless();
        stage.fixed(Vec2::ZERO, line(at!(-10, 0), at!(10, 0)));
        let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.17678) };
        let events = EventSwitches { hit: true, ..EventSwitches::default() };
        let shape = ball(fx!(0.25)).friction(fx!(0)).restitution(restitution).events(events);
        let def = BodyDef::dynamic().position(at!(0, 5.5)).velocity(at!(0, -25)).mass(mass);
        let body = stage.spawn(def, &[shape]);
        let mut hits = Vec::new();
        stage.run_and(60, |stage| hits.extend(stage.world.events().hits.iter().copied()));
        assert_eq!(hits.len(), 1, "{hits:?}");
        near(hits[0].approach_speed, fx!(25), fx!(0.001));
        near(hits[0].impulse, fx!(25) + returned, fx!(0.01));
        assert!(hits[0].point.length() < fx!(0.01), "{:?}", hits[0].point);
        near(stage.velocity(body).y, returned, fx!(0.01));
    }
}
