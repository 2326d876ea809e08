//! Samples of Box2D's group "Stacking".

use lockstep2d::body::{BodyDef, BodyId, EventSwitches};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};

use super::{Stage, ball, capsule, hull, line, near, num, pill, rect, rounded, square};

/// Sample "Single Box". The box slides by `v^2 / (2 mu g)`.
#[test]
fn a_box_slides_to_rest() {
    let mut stage = Stage::with_floor();
    let body = stage.throw(at!(0, 1), at!(5, 0), square(fx!(1)));
    stage.run(180);
    near(stage.place(body).x, fx!(25 / 12), fx!(0.05));
    near(stage.angle(body), fx!(0), fx!(0.001));
    assert!(stage.body(body).is_asleep());
}

/// Sample "Tilted Stack".
#[test]
fn a_stack_falls_when_it_leans_too_far() {
    for (lean, falls) in [(fx!(0.2), true), (fx!(0.05), false)] {
        let mut stage = Stage::with_floor();
        let crate_ = rounded(fx!(0.5), fx!(0.5), fx!(0.05)).friction(fx!(0.3));
        let place = |i: i32| Vec2::new(lean * i64::from(i), num(i) + fx!(0.5));
        let stack: Vec<_> = (0..10).map(|i| stage.add(place(i), crate_)).collect();
        stage.run(900);
        // The centre of mass of the upper nine boxes is five times `lean` to the side of the centre of the lowest box.
        let top = stage.place(stack[9]).y;
        assert_eq!(top < fx!(9), falls, "a lean of {lean} m: the top is at {top} m");
        assert!(stack.iter().all(|&id| stage.place(id).y > fx!(0.49)), "expected no box in the ground");
        assert!(stack.iter().all(|&id| stage.body(id).is_asleep()));
    }
}

/// Sample "Vertical Stack".
#[test]
fn a_vertical_stack_stands_until_it_is_shot_at() {
    let mut stage = Stage::with_floor();
    stage.fixed(Vec2::ZERO, line(at!(10, 0), at!(10, 20)));
    let crate_ = rounded(fx!(0.5), fx!(0.5), fx!(0.05)).friction(fx!(0.3));
    let shift = |i: i32| if i % 2 == 0 { fx!(-0.01) } else { fx!(0.01) };
    let place = |i: i32| Vec2::new(fx!(8) + shift(i), num(i) + fx!(0.5));
    let stack: Vec<_> = (0..12).map(|i| stage.add(place(i), crate_)).collect();
    stage.run(300);
    assert!(stack.iter().all(|&id| stage.body(id).is_asleep()));
    let top = *stack.last().expect("a stack");
    near(stage.place(top).y, fx!(11.5), fx!(0.1));
    let def = BodyDef::dynamic().position(at!(-25, 4)).velocity((fx!(200), fx!(0))).bullet();
    let bullet = stage.spawn(def, &[ball(fx!(0.25)).density(fx!(4))]);
    stage.run_and(300, |stage| assert!(stage.place(bullet).x < fx!(10), "expected the wall to stop it"));
    assert!(stage.place(top).y < fx!(11), "the top is at {}", stage.place(top).y);
}

/// Sample "Circle Stack".
#[test]
fn balls_on_an_axis_bounce_in_order() {
    let mut stage = Stage::with_gravity(at!(0, -20));
    let hits = EventSwitches { hit: true, ..EventSwitches::default() };
    let slippery =
        |shape: lockstep2d::body::ShapeDef| shape.friction(fx!(0)).restitution(fx!(0.8)).events(hits);
    let ground = stage.fixed(Vec2::ZERO, slippery(line(at!(-10, 0), at!(10, 0))));
    let density = |i: i32| num(1 + 4 * i);
    let place = |i: i32| Vec2::new(Fx::ZERO, fx!(0.75) + fx!(1.25) * i64::from(i));
    let balls: Vec<_> =
        (0..4).map(|i| stage.add(place(i), slippery(ball(fx!(0.5)).density(density(i))))).collect();
    let mut hits = Vec::new();
    stage.run_and(300, |stage| {
        let body = |shape| stage.world.shape(shape).expect("a shape").body();
        hits.extend(stage.world.events().hits.iter().map(|hit| (body(hit.shape_a), body(hit.shape_b))));
    });
    assert_eq!(hits.first(), Some(&(ground, balls[0])), "the lowest ball hits the ground first");
    assert!(balls.windows(2).all(|pair| hits.contains(&(pair[0], pair[1]))), "{hits:?}");
    assert!(balls.iter().all(|&id| stage.place(id).x == Fx::ZERO), "expected no push to the side");
    assert!(balls.windows(2).all(|pair| stage.place(pair[0]).y < stage.place(pair[1]).y));
}

/// Sample "Capsule Stack".
#[test]
fn lying_capsules_stack() {
    let mut stage = Stage::with_floor();
    let place = |i: i32| Vec2::new(Fx::ZERO, fx!(0.5) + fx!(0.75) * i64::from(i));
    let stack: Vec<_> = (0..20).map(|i| stage.add(place(i), pill(fx!(1), fx!(0.25)))).collect();
    stage.run(900);
    for (i, &id) in (0..).zip(&stack) {
        near(stage.place(id).y, fx!(0.25) + num(i) / 2, fx!(0.2));
        near(stage.place(id).x, fx!(0), fx!(0.02));
    }
}

/// Sample "Cliff".
#[test]
fn an_edge_does_not_kick() {
    for direction in [1, -1] {
        let mut stage = Stage::with_floor();
        stage.fixed(Vec2::ZERO, line(at!(-14, 4), at!(-8, 4)));
        stage.fixed(at!(0, 4), rect(fx!(3), fx!(0.5)));
        stage.fixed(Vec2::ZERO, capsule(at!(8.5, 4), at!(13.5, 4), fx!(0.5)));
        let mut bodies: Vec<(BodyId, Fx, Fx)> = Vec::new();
        for (middle, top) in [(fx!(-11), fx!(4)), (fx!(0), fx!(4.5)), (fx!(11), fx!(4.5))] {
            let shapes = [
                (fx!(2), fx!(0.25), pill(fx!(0.25), fx!(0.25)).friction(fx!(0.01))),
                (fx!(0), fx!(0.5), square(fx!(0.5)).friction(fx!(0.01))),
                (fx!(-2), fx!(0.5), ball(fx!(0.5)).friction(fx!(0.2))),
            ];
            for (offset, height, shape) in shapes {
                let x = middle + offset * i64::from(direction);
                let speed = fx!(2) * i64::from(direction);
                let start = Vec2::new(x, top + height);
                bodies.push((stage.throw(start, Vec2::new(speed, Fx::ZERO), shape), start.y, speed.abs()));
            }
        }
        stage.run_and(75, |stage| {
            for &(body, start, speed) in &bodies {
                assert!(stage.place(body).y < start + fx!(0.02), "rose to {}", stage.place(body).y);
                assert!(stage.velocity(body).x.abs() < speed + fx!(0.02), "{:?}", stage.velocity(body));
            }
        });
        // The capsules, which start a metre before the edge, have fallen.
        assert!([0, 3, 6].iter().all(|&i| stage.place(bodies[i].0).y < bodies[i].1 - fx!(0.5)));
    }
}

/// Sample "Arch".
#[test]
fn an_arch_carries_a_load() {
    // 17 blocks between radii of 4 and 6 m.
    let mut stage = Stage::with_floor();
    let corner = |radius: Fx, i: i32| {
        let turn = lockstep2d::math::Rot::from_angle(Angle::from_turns(num(i) / 34));
        turn.apply_wide(Vec2::new(radius, Fx::ZERO))
    };
    let block =
        |i: i32| hull(&[corner(fx!(4), i), corner(fx!(6), i), corner(fx!(6), i + 1), corner(fx!(4), i + 1)]);
    let blocks: Vec<_> = (0..17).map(|i| stage.add(Vec2::ZERO, block(i))).collect();
    let load = stage.add(at!(0, 6.5), rect(fx!(1), fx!(0.5)));
    stage.run(600);
    for &id in &blocks {
        assert!(stage.place(id).length() < fx!(0.1), "a block moved to {:?}", stage.place(id));
    }
    near(stage.place(load).y, fx!(6.5), fx!(0.1));
}

/// Sample "Double Domino".
#[test]
fn all_dominoes_fall() {
    let mut stage = Stage::with_floor();
    let dominoes: Vec<_> = (0..15)
        .map(|i| stage.add(Vec2::new(num(i) - fx!(7.5), fx!(0.5)), rect(fx!(0.125), fx!(0.5))))
        .collect();
    stage.world.apply_impulse(dominoes[0], at!(0.2, 0), at!(-7.5, 1)).expect("valid");
    stage.run(600);
    // Each domino leans on the next one, whose foot is a metre away.
    for &id in &dominoes {
        assert!(stage.angle(id) < fx!(-1), "a domino stands at {} rad", stage.angle(id));
    }
}

/// Sample "Confined".
#[test]
fn a_crowded_room_does_not_leak() {
    let mut stage = Stage::weightless();
    let side = |a, b| capsule(a, b, fx!(0.5));
    let (a, b, c, d) = (at!(-5.5, 0), at!(5.5, 0), at!(5.5, 10.5), at!(-5.5, 10.5));
    stage.spawn(BodyDef::fixed(), &[side(a, b), side(b, c), side(c, d), side(d, a)]);
    for i in 0..144 {
        let place = Vec2::new(num(i % 12) * 3 / 4 - fx!(4.1), num(i / 12) * 3 / 4 + fx!(1.2));
        stage.add(place, ball(fx!(0.5)));
    }
    stage.run(300);
    for (_, body) in stage.world.bodies().filter(|(_, body)| body.is_dynamic()) {
        let place = body.position();
        assert!(place.x.abs() < fx!(5.5) && place.y > fx!(0) && place.y < fx!(10.5), "{place:?}");
    }
}

/// Sample "Card House". A card is 2 mm thick.
#[test]
fn a_house_of_cards_stands() {
    let mut stage = Stage::new();
    stage.fixed(at!(0, -2), rect(fx!(40), fx!(2)).friction(fx!(0.7)));
    let card = rect(fx!(0.001), fx!(0.2)).friction(fx!(0.7));
    let mut cards = Vec::new();
    let mut put = |stage: &mut Stage, x: Fx, y: Fx, angle: i32| {
        let def = BodyDef::dynamic().position(Vec2::new(x, y)).angle(super::degrees(angle));
        cards.push((stage.spawn(def, &[card]), Vec2::new(x, y)));
    };
    for storey in 0..5 {
        let (left, y) = (num(storey) * 7 / 40, fx!(0.18) + num(storey) * 37 / 100);
        for pair in 0..5 - storey {
            let x = left + num(pair) * 35 / 100;
            if pair != 4 - storey {
                put(&mut stage, x + fx!(0.25), y + fx!(0.185), 90);
            }
            put(&mut stage, x, y, -25);
            put(&mut stage, x + fx!(0.175), y, 25);
        }
    }
    stage.run(600);
    for (id, start) in cards {
        assert!(
            stage.place(id).distance(start) < fx!(0.05),
            "a card went from {start:?} to {:?}",
            stage.place(id)
        );
    }
}
