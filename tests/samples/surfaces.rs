//! Samples of Box2D's group "Shapes": materials, explosions and wind.

use lockstep2d::body::{Area, BodyDef, Chain, Material, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_div, fx_mul, widen};
use lockstep2d::solver::{JointDef, Revolute, Weld};
use lockstep2d::world::Explosion;

use super::{Stage, ball, line, near, num, rect, rounded, square};

/// Sample "Restitution". A bounce reaches up to `e^2 h`.
#[test]
fn a_bounce_returns_the_square_of_the_restitution() {
    for shape in [ball(fx!(0.5)), square(fx!(0.5))] {
        for tenths in [0, 3, 5, 8, 10] {
            let mut stage = Stage::with_floor();
            let restitution = num(tenths) / 10;
            let body = stage.add(at!(0, 10.5), shape.restitution(restitution));
            let (mut bounced, mut highest) = (false, fx!(0));
            stage.run_and(280, |stage| {
                let going_up = stage.velocity(body).y >= 0;
                bounced |= going_up;
                if bounced {
                    highest = highest.max(stage.place(body).y - fx!(0.5));
                }
                // The bounce is no higher than the start if no energy is added.
                assert!(!bounced || highest < fx!(10.02), "{highest} m");
            });
            near(highest, fx_mul(restitution, restitution) * 10, fx!(0.25));
        }
    }
}

/// Sample "Friction". A box stays if `mu > tan(angle)`, and otherwise slides with `g (sin - mu cos)`.
#[test]
fn friction_decides_who_stays_on_the_slope() {
    let angle = Angle::from_radians(fx!(-0.25));
    let (down, cos) = (-widen(angle.sin()), widen(angle.cos()));
    for percent in [75, 50, 35, 10, 0] {
        let mut stage = Stage::new();
        let slope = rect(fx!(100), fx!(1)).offset(at!(0, -1)).friction(fx!(0.2));
        stage.spawn(BodyDef::fixed().angle(angle), &[slope]);
        let friction = num(percent) / 100;
        let def = BodyDef::dynamic().angle(angle).position(Vec2::new(down, cos).scale(fx!(0.5)));
        let body = stage.spawn(def, &[square(fx!(0.5)).density(fx!(25)).friction(friction)]);
        stage.run(120);
        // The combined friction is the geometric mean, sqrt(0.2 friction).
        let mixed = lockstep2d::math::sqrt(friction / 5).expect("not negative");
        let pull = (down - fx_mul(mixed, cos)) * 10;
        let expected = if pull > 0 { pull * 2 } else { Fx::ZERO };
        near(stage.velocity(body).length(), expected, fx!(0.05));
    }
}

/// Sample "Rolling Resistance". A ball gets as far as `v^2 / 2 a` with `a = 2/3 c g`.
#[test]
fn rolling_resistance_decides_how_far_a_ball_gets() {
    for i in [2, 5, 10, 15] {
        let mut stage = Stage::new();
        stage.fixed(Vec2::ZERO, line(at!(-40, 0), at!(40, 0)));
        let resistance = num(i) / 50;
        let def = BodyDef::dynamic().position(at!(-39.5, 0.5)).velocity(at!(5, 0)).angular_velocity(fx!(-10));
        let body = stage.spawn(def, &[ball(fx!(0.5)).rolling_resistance(resistance)]);
        stage.run(1200);
        let expected = fx_div(fx!(25) * 3, resistance * 40).expect("positive");
        near(stage.place(body).x + fx!(39.5), expected, expected / 20 + fx!(0.1));
    }
}

/// Sample "Conveyor Belt".
#[test]
fn a_belt_carries_boxes_and_drops_them_at_its_end() {
    let mut stage = Stage::with_floor();
    let belt = rounded(fx!(10), fx!(0.5), fx!(0.25)).friction(fx!(0.8)).surface_speed(fx!(2));
    stage.fixed(at!(-5, 5), belt);
    let place = |i: i32| Vec2::new(num(2 * i - 10), fx!(6.01));
    let boxes: Vec<_> = (0..5).map(|i| stage.add(place(i), square(fx!(0.5)))).collect();
    stage.run(120);
    for &id in &boxes {
        near(stage.velocity(id).x, fx!(2), fx!(0.01));
        near(stage.place(id).y, fx!(6), fx!(0.02));
    }
    stage.run(900);
    assert!(boxes.iter().all(|&id| stage.place(id).x > fx!(4.5) && stage.place(id).y < fx!(3)));
}

/// Sample "Tangent Speed".
#[test]
fn each_link_of_a_chain_has_its_own_speed() {
    let mut stage = Stage::new();
    let points: Vec<_> = (0..6).map(|i| Vec2::new(num(i) * 10, Fx::ZERO)).collect();
    let speeds = [fx!(1), fx!(2), fx!(3), fx!(-4), fx!(-5)];
    let materials = speeds.map(|surface_speed| Material { surface_speed, ..Material::default() });
    let chain = Chain::new(&points).materials(&materials).links().expect("valid");
    stage.spawn(BodyDef::fixed(), &chain);
    let boxes: Vec<_> =
        (0..5).map(|i| stage.add(Vec2::new(num(10 * i + 5), fx!(0.5)), square(fx!(0.5)))).collect();
    // The fastest box reaches 5 m/s after 0.83 s, when it is 2.1 m from the middle of its link.
    stage.run(60);
    for (&id, speed) in boxes.iter().zip(speeds) {
        near(stage.velocity(id).x, speed, fx!(0.02));
    }
}

/// Sample "Explosion". After the explosion, the welds turn the balls.
#[test]
fn an_explosion_pushes_a_ring_evenly_and_welds_pull_it_back() {
    let mut stage = Stage::weightless();
    let ground = stage.spawn(BodyDef::fixed(), &[]);
    let weld = Weld::rigid().angular(fx!(0.5), fx!(0.7)).linear(fx!(0.5), fx!(0.7));
    let mut ring = Vec::new();
    for i in 0..12 {
        let place = Angle::from_turns(num(i) / 12).direction().widen().scale(fx!(8));
        let body = stage.add(place, ball(fx!(0.5)));
        let joint = stage.join(JointDef::new(ground, body, weld).anchor_a(place));
        ring.push((body, joint, place));
    }
    let blast = Explosion { radius: fx!(7), falloff: fx!(3), ..Explosion::new(Vec2::ZERO, fx!(10)) };
    stage.world.explode(&blast).expect("valid");
    // The nearest point of a ball is at 7.5 m, which is 0.5 m within the falloff of 3 m. The impulse is 10 N s/m times
    // (1 - 0.5 / 3), times the ball's width of 1 m.
    let speed = fx_div(fx!(25 / 3), stage.body(ring[0].0).mass()).expect("positive");
    for &(body, _, place) in &ring {
        near(stage.velocity(body).length(), speed, fx!(0.01));
        near(stage.velocity(body).dot(place), speed * 8, fx!(0.1));
    }
    for tick in 0..600 {
        let angle = Angle::from_turns(num(tick) / 360);
        for &(_, joint, _) in &ring {
            let mut def = *stage.world.joint(joint).expect("there").def();
            def.frame_a.angle = angle;
            stage.world.set_joint(joint, &def).expect("valid");
        }
        stage.run(1);
    }
    // The welds turn their target by a sixth of a turn per second.
    let turn = lockstep2d::math::PI / 3;
    for &(body, _, place) in &ring {
        near(stage.place(body).distance(place), fx!(0), fx!(0.01));
        near(stage.body(body).angular_velocity(), turn, fx!(0.01));
    }
}

/// Sample "Box Restitution".
#[test]
fn boxes_on_boxes_make_no_energy() {
    for tenths in [0, 2, 5, 8, 10] {
        let mut stage = Stage::new();
        stage.fixed(Vec2::ZERO, line(at!(-20, 0), at!(20, 0)));
        let crate_ = square(fx!(0.5)).restitution(num(tenths) / 10);
        stage.add(at!(0, 1), crate_);
        let upper = stage.add(at!(0, 4), crate_);
        let start = stage.energy();
        stage.run_and(600, |stage| {
            let energy = stage.energy();
            assert!(energy < start + start / 100, "e {tenths}/10: {energy} J of {start} J");
        });
        if tenths == 0 {
            near(stage.place(upper).y, fx!(1.5), fx!(0.01));
        }
    }
}

/// Sample "Wind". A chain leans by `atan(c u / g)` in a wind `u` that drags with the rate `c`.
#[test]
fn a_chain_leans_in_the_wind() {
    for shape in
        [ball(fx!(0.1)), rect(fx!(0.025), fx!(0.125)), super::capsule(at!(0, -0.1), at!(0, 0.1), fx!(0.025))]
    {
        let mut stage = Stage::new();
        let wind = Area::new().flow(at!(6, 0)).drag(fx!(0.5), fx!(0.5));
        let air = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(20)).expect("valid")).area(wind);
        let ground = stage.fixed(Vec2::ZERO, air);
        let (mut before, mut top) = (ground, at!(0, 2.1));
        let mut links = Vec::new();
        for _ in 0..8 {
            let def = BodyDef::dynamic().position(top - at!(0, 0.1)).never_sleeps();
            let link = stage.spawn(def, &[shape.density(fx!(20))]);
            stage.join_at(before, link, Revolute::new(), top);
            (before, top) = (link, top - at!(0, 0.2));
            links.push(link);
        }
        stage.run(1800);
        // Gravity accelerates the links at 10 m/s², and the wind at 3 m/s² to the side.
        for &link in &links {
            near(stage.angle(link), fx!(0.29146), fx!(0.01));
        }
    }
}
