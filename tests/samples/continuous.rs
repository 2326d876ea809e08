//! Samples of Box2D's group "Continuous".

use lockstep2d::body::{BodyDef, Chain, EventSwitches, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{JointDef, Revolute, SolverSettings};
use lockstep2d::world::Config;

use super::{Stage, ball, capsule, degrees, hull, line, near, num, pill, rect, rounded, square};

/// Four walls of a room of 20 m by 20 m, with its middle at the origin.
fn room(change: impl Fn(ShapeDef) -> ShapeDef) -> [ShapeDef; 4] {
    let (a, b, c, d) = (at!(-10, -10), at!(10, -10), at!(10, 10), at!(-10, 10));
    [line(a, b), line(b, c), line(c, d), line(d, a)].map(change)
}

/// Sample "Bounce House", without friction. A ball keeps its speed, and no shape gains energy.
#[test]
fn a_bullet_bounces_in_a_room() {
    for (shape, is_ball) in
        [(ball(fx!(0.5)), true), (pill(fx!(0.5), fx!(0.25)), false), (rect(fx!(2), fx!(0.1)), false)]
    {
        let mut stage = Stage::weightless();
        stage.spawn(BodyDef::fixed(), &room(|wall| wall));
        let events = EventSwitches { hit: true, ..EventSwitches::default() };
        let shape = shape.restitution(fx!(1)).friction(fx!(0)).events(events);
        let body = stage.spawn(BodyDef::dynamic().velocity(at!(10, 20)).bullet(), &[shape]);
        let (start, mut hits) = (stage.energy(), 0);
        stage.run_and(1200, |stage| {
            let place = stage.place(body);
            assert!(place.x.abs() < fx!(10) && place.y.abs() < fx!(10), "{place:?}");
            assert!(stage.energy() < start + start / 50, "{} J of {start}", stage.energy());
            hits += stage.world.events().hits.len();
        });
        if is_ball {
            near(stage.velocity(body).length(), fx!(22.3607), fx!(0.02));
            // In 20 s, the ball moves 200 m along one axis and 400 m along the other. It has 19 m of room along each.
            assert!((29..=33).contains(&hits), "{hits} hits");
        }
    }
}

/// Sample "Bounce Humans", under gravity that turns.
#[test]
fn ragdolls_stay_in_a_room_of_bumpers() {
    let mut stage = Stage::of_scene("ragdoll");
    let fixed: Vec<_> =
        stage.world.bodies().filter(|(_, body)| !body.is_dynamic()).map(|(id, _)| id).collect();
    fixed.into_iter().for_each(|id| stage.world.despawn(id).expect("there"));
    let bouncy = |wall: ShapeDef| wall.restitution(fx!(1.3)).friction(fx!(0.1));
    let (low, high) = (at!(-30, -20), at!(30, 40));
    let (b, d) = (Vec2::new(high.x, low.y), Vec2::new(low.x, high.y));
    stage.spawn(BodyDef::fixed(), &[line(low, b), line(b, high), line(high, d), line(d, low)].map(bouncy));
    for tick in 0..600 {
        let turn = Angle::from_radians(num(tick) / 120).direction().widen();
        stage.world.set_gravity(turn.scale(fx!(10))).expect("in range");
        stage.world.step();
    }
    for (_, body) in stage.world.bodies().filter(|(_, body)| body.is_dynamic()) {
        let place = body.position();
        assert!(place.x.abs() < fx!(31) && place.y > fx!(-21) && place.y < fx!(41), "{place:?}");
    }
}

/// Sample "Chain Drop".
#[test]
fn a_thrown_ball_lands_on_a_chain() {
    let points = [at!(-10, -8), at!(10, -8), at!(10, -5), at!(-10, -5)];
    for speed in [42, 80, 200, 390] {
        for offset in 0..10 {
            let mut stage = Stage::new();
            stage.spawn(BodyDef::fixed(), &Chain::new(&points).closed().links().expect("valid"));
            let place = Vec2::new(Fx::ZERO, fx!(9.9) + num(offset) / 10);
            let body = stage.throw(place, Vec2::new(Fx::ZERO, num(-speed)), ball(fx!(0.5)));
            stage.run(120);
            near(stage.place(body).y, fx!(-4.5), fx!(0.01));
        }
    }
}

/// Samples "Chain Slide" and "Segment Slide".
#[test]
fn a_fast_ball_follows_the_floor_to_the_wall() {
    let mut points = Vec::new();
    points.extend((0..20).map(|i| Vec2::new(num(20 - 2 * i), fx!(0))));
    points.extend((0..20).map(|i| Vec2::new(fx!(-20), num(i))));
    points.extend((0..20).map(|i| Vec2::new(num(2 * i - 20), fx!(20))));
    points.extend((0..20).map(|i| Vec2::new(fx!(20), num(20 - i))));
    let chain = Chain::new(&points).closed().links().expect("valid");
    let segments = vec![line(at!(-20, 0), at!(20, 0)), line(at!(20, 0), at!(20, 10))];
    for ground in [chain, segments] {
        let mut stage = Stage::new();
        stage.spawn(BodyDef::fixed(), &ground);
        let body = stage.throw(at!(-19.4, 0.5), at!(100, 0), ball(fx!(0.5)).friction(fx!(0)));
        stage.run_and(180, |stage| {
            near(stage.place(body).y, fx!(0.5), fx!(0.02));
            assert!(stage.place(body).x < fx!(19.51), "{:?}", stage.place(body));
        });
        near(stage.place(body).x, fx!(19.5), fx!(0.02));
    }
}

/// Sample "Skinny Box", with a box behind the plank.
#[test]
fn a_spinning_plank_does_not_go_through() {
    for shape in [rect(fx!(2), fx!(0.05)), capsule(at!(0, -1), at!(0, 1), fx!(0.1))] {
        for spin in [-50, -37, -20, -3, 0, 11, 29, 50] {
            let mut stage = Stage::new();
            let ground = [line(at!(-500, 0), at!(500, 0)), rect(fx!(0.1), fx!(1)).offset(at!(0, 1))];
            stage.spawn(BodyDef::fixed(), &ground.map(|shape| shape.friction(fx!(0.9))));
            let def =
                BodyDef::dynamic().position(at!(0, 8)).velocity(at!(0, -100)).angular_velocity(num(spin));
            let body = stage.spawn(def, &[shape.friction(fx!(0.9))]);
            let behind = BodyDef::dynamic().position(at!(0.3, 10)).velocity(at!(0, -50));
            let behind = stage.spawn(behind, &[square(fx!(0.25))]);
            stage.run(240);
            for id in [body, behind] {
                assert!(stage.place(id).y > fx!(0), "spin {spin}: {:?}", stage.place(id));
            }
        }
    }
}

/// Sample "Ghost Bumps".
#[test]
fn seams_do_not_bump() {
    let points: Vec<_> = (0..12).map(|i| Vec2::new(num(8 * i - 40), Fx::ZERO)).collect();
    let chain = Chain::new(&points).links().expect("valid");
    let tiles: Vec<_> =
        (0..11).map(|i| rect(fx!(4), fx!(0.25)).offset(Vec2::new(num(8 * i - 36), fx!(-0.25)))).collect();
    let shapes =
        [ball(fx!(0.5)), pill(fx!(0.5), fx!(0.5)), square(fx!(0.5)), rounded(fx!(0.5), fx!(0.5), fx!(0.1))];
    for ground in [chain, tiles] {
        for shape in shapes {
            let mut stage = Stage::new();
            stage.spawn(
                BodyDef::fixed(),
                &ground.iter().map(|shape| shape.friction(fx!(0))).collect::<Vec<_>>(),
            );
            let body = stage.throw(at!(-35, 0.5), at!(12, 0), shape.friction(fx!(0)));
            stage.run_and(300, |stage| {
                near(stage.velocity(body).x, fx!(12), fx!(0.001));
                near(stage.place(body).y, fx!(0.5), fx!(0.01));
            });
        }
    }
}

/// Samples "Speculative Fallback" and "Speculative Sliver".
#[test]
fn slivers_stay_above() {
    let mut stage = Stage::new();
    let wedge = [at!(-2, 4), at!(2, 4), at!(2, 4.1), at!(-0.5, 4.2), at!(-2, 4.2)];
    stage.spawn(BodyDef::fixed(), &[line(at!(-10, 0), at!(10, 0)), hull(&wedge)]);
    let plank = stage.throw(at!(8, 12), at!(0, -100), rect(fx!(2), fx!(0.05)).offset(at!(-8, 0)));
    stage.run_and(30, |stage| {
        assert!(stage.body(plank).centre_of_mass().y > fx!(4), "{:?}", stage.body(plank).centre_of_mass());
    });

    let mut stage = Stage::new();
    stage.fixed(Vec2::ZERO, line(at!(-10, 0), at!(10, 0)));
    let sliver = stage.throw(at!(0, 12), at!(0, -100), hull(&[at!(-2, 0), at!(-1, 0), at!(2, 0.5)]));
    stage.run_and(300, |stage| assert!(stage.body(sliver).centre_of_mass().y > fx!(0)));
    assert!(stage.body(sliver).is_asleep());
}

/// Samples "Speculative Ghost" and "Pixel Imperfect". A body passes a corner millimetres or centimetres away.
#[test]
fn what_passes_by_is_not_touched() {
    let mut stage = Stage::new();
    stage.spawn(
        BodyDef::fixed(),
        &[line(at!(-10, 0), at!(10, 0)), rect(fx!(1), fx!(0.1)).offset(at!(0, 0.9))],
    );
    let def = BodyDef::dynamic().position(at!(0.015, 2.515)).velocity(at!(7.5, -7.5)).gravity_scale(fx!(0));
    let body = stage.spawn(def, &[square(fx!(0.25))]);
    // After 0.169 s the box is level with the edge and 3 cm beside it. After 0.302 s it is at the floor.
    stage.run_and(17, |stage| assert_eq!(stage.velocity(body), at!(7.5, -7.5)));
    near(stage.place(body).y, fx!(0.39), fx!(0.00001));

    let mut stage = Stage::new();
    stage.fixed(at!(5.83333333, 5), rect(fx!(0.66666667), fx!(0.33333333)).friction(fx!(0)));
    let def = BodyDef::dynamic().position(at!(6.66666667, 9.16666667)).gravity_scale(fx!(0)).lock_rotation();
    let shape = rounded(fx!(0.16333333), fx!(0.16333333), fx!(0.03)).friction(fx!(0));
    let body = stage.spawn(def.velocity(at!(0, -5)), &[shape]);
    stage.run_and(120, |stage| {
        assert_eq!(stage.velocity(body), at!(0, -5));
        assert_eq!(stage.place(body).x, fx!(6.66666667));
    });
}

/// Sample "Restitution Threshold": `v' = v - 2 (v.n) n`.
#[test]
fn a_slow_graze_is_reflected() {
    let solver = SolverSettings { restitution_threshold: fx!(0.1), ..SolverSettings::default() };
    let mut stage = Stage::of(Config { solver, gravity: Vec2::ZERO, ..Config::default() });
    let angle = degrees(70);
    stage.spawn(BodyDef::fixed().angle(angle), &[rect(fx!(1.6), fx!(0.17)).friction(fx!(0))]);
    let shape = ball(fx!(0.16)).friction(fx!(0)).restitution(fx!(1));
    let def = BodyDef::dynamic().position(at!(-0.4, 3)).velocity(at!(0, -2.9)).lock_rotation();
    let body = stage.spawn(def, &[shape]);
    stage.run(120);
    // The left side faces up: its normal is at 160 degrees, and v.n = -2.9 sin(160) = -0.99 m/s.
    let normal = degrees(160).direction().widen();
    let speed = normal.y.saturating_mul(fx!(-2.9));
    let expected = at!(0, -2.9) - normal.scale(speed * 2);
    assert!(
        stage.velocity(body).distance(expected) < fx!(0.01),
        "{:?}, not {expected:?}",
        stage.velocity(body)
    );
}

/// Sample "Drop".
#[test]
fn thin_tiles_stop_what_drops_on_them() {
    let tiles: Vec<_> =
        (0..41).map(|i| rect(fx!(0.125), fx!(0.05)).offset(Vec2::new(num(i - 20) / 4, Fx::ZERO))).collect();
    for shape in [ball(fx!(0.1)), pill(fx!(0.3), fx!(0.05)), square(fx!(0.2)), rect(fx!(0.4), fx!(0.02))] {
        for speed in [20, 60, 150, 390] {
            let mut stage = Stage::new();
            stage.spawn(BodyDef::fixed(), &tiles);
            let def = BodyDef::dynamic().position(at!(0.06, 4)).angle(degrees(30));
            let body = stage.spawn(def.velocity(Vec2::new(Fx::ZERO, num(-speed))), &[shape]);
            stage.run_and(60, |stage| {
                assert!(stage.place(body).y > fx!(0.05), "{speed} m/s: {:?}", stage.place(body))
            });
        }
    }
}

/// Sample "Safety Factor". Contacts are created before the shapes touch, so slow bodies need no continuous collision
/// detection.
#[test]
fn a_dropped_box_does_not_sink_in() {
    for height in (1..=80).map(|step| num(step) / 40) {
        for tilt in [Angle::ZERO, degrees(7), degrees(45)] {
            let mut stage = Stage::with_floor();
            let axis = tilt.direction().widen();
            let lowest = (axis.x.abs() + axis.y.abs()) / 2;
            let place = Vec2::new(Fx::ZERO, height + lowest);
            stage.spawn(BodyDef::dynamic().position(place).angle(tilt), &[square(fx!(0.5))]);
            stage.run_and(90, |stage| {
                let overlap = stage.world.deepest_overlap();
                // The bound is the slop of Box2D, 5 mm, plus 1 mm. With default settings, contacts of this engine have
                // no slop.
                assert!(overlap < fx!(0.006), "{overlap} m after {height} m");
            });
        }
    }
}

/// Sample "Pinball".
#[test]
fn flippers_throw_the_ball_up() {
    let mut stage = Stage::new();
    let cabinet = [at!(-8, 6), at!(-8, 20), at!(8, 20), at!(8, 6), at!(0, -2)];
    let ground = stage.spawn(BodyDef::fixed(), &Chain::new(&cabinet).closed().links().expect("valid"));
    let flipper = |stage: &mut Stage, x: Fx| {
        let place = Vec2::new(x, Fx::ZERO);
        let body =
            stage.spawn(BodyDef::dynamic().position(place).never_sleeps(), &[rect(fx!(1.75), fx!(0.2))]);
        let outwards = if x < 0 { fx!(0.0873) } else { fx!(0.5236) };
        let kind = Revolute::new().limit(outwards - fx!(0.6109), outwards).motor(fx!(0), fx!(1000));
        stage.join(JointDef::new(ground, body, kind).anchor_a(place))
    };
    let (left, right) = (flipper(&mut stage, fx!(-2)), flipper(&mut stage, fx!(2)));
    let ball = stage.spawn(BodyDef::dynamic().position(at!(0.5, 15)).bullet(), &[ball(fx!(0.2))]);
    let (mut rested, mut highest) = (false, Fx::ZERO);
    for tick in 0..1200 {
        let pressed = tick % 60 > 40;
        let speed = if pressed { fx!(20) } else { fx!(-10) };
        stage.world.set_joint_motor_speed(left, speed).expect("a motor");
        stage.world.set_joint_motor_speed(right, -speed).expect("a motor");
        stage.run(1);
        let place = stage.place(ball);
        assert!(place.y < fx!(20) && place.y > place.x.abs() - fx!(2.01), "outside at {place:?}");
        rested |= place.y < fx!(3);
        if rested {
            highest = highest.max(place.y);
        }
    }
    assert!(highest > fx!(4), "expected a flipper to throw the ball up, it reached {highest} m");
}

/// Sample "Wedge".
#[test]
fn a_ball_rests_in_a_wedge() {
    for speed in [5, 40, 100] {
        let mut stage = Stage::new();
        stage.spawn(
            BodyDef::fixed(),
            &[line(at!(-4, 8), at!(0, 0)), line(at!(0, 0), at!(0, 8))].map(|wall| wall.friction(fx!(0.2))),
        );
        let body = stage.throw(
            at!(-0.45, 10.75),
            Vec2::new(Fx::ZERO, num(-speed)),
            ball(fx!(0.3)).friction(fx!(0.2)),
        );
        stage.run(1200);
        // The walls enclose an angle of atan(0.5) = 26.57 degrees. The centre is 0.3 m from the upright wall, and 0.3 m
        // / tan(13.28 degrees) above the lowest point.
        near(stage.place(body).x, fx!(-0.3), fx!(0.005));
        near(stage.place(body).y, fx!(1.271), fx!(0.02));
        assert!(stage.velocity(body).length() < fx!(0.01));
    }
}
