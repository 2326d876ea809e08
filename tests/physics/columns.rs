//! Things that stand: columns, plates on discs, an arch and a house of cards stand for ever, and fall asleep.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{Config, World};

use crate::sweep;

fn world_at(tick_rate: u32) -> World {
    let mut world = World::new(Config { tick_rate, ..Config::default() }).expect("valid");
    let floor = ShapeDef::new(Polygon::rectangle(fx!(40), fx!(1)).expect("valid")).friction(fx!(0.7));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
    world
}

fn rectangle(half_width: Fx, half_height: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(half_width, half_height).expect("valid"))
}

/// Simulates a minute, or until all bodies sleep. Expects that they sleep in the end, and that no body has left its
/// place by more than `sideways`, nor sunk by more than `sink`.
fn expect_stands(name: &str, mut world: World, sideways: Fx, sink: Fx) {
    let places: Vec<_> = world.bodies().map(|(id, body)| (id, body.position())).collect();
    for _ in 0..world.config().tick_rate * 60 {
        world.step();
        if world.awake_body_count() == 0 {
            break;
        }
    }
    for (id, place) in places {
        let moved = world.body(id).expect("there").position() - place;
        assert!(moved.x.abs() <= sideways, "{name}: body {id} is {} m aside", moved.x);
        assert!(moved.y >= -sink, "{name}: body {id} has sunk by {} m", -moved.y);
    }
    assert_eq!((world.awake_body_count(), world.faults()), (0, 0), "{name}");
}

/// Boxes of 1 m exactly above each other, and with offsets of up to a centimetre. Soft contacts give way by
/// `g / omega^2` for each box above, so that the top of `n` boxes sinks by `n^2 / 2` times 0.28 mm.
#[test]
fn a_column_of_a_hundred_boxes_stands() {
    let counts = [10, 40, 60, 80, 100].into_iter();
    let cases =
        counts.flat_map(|count| [60, 120].map(|rate| [false, true].map(|offset| (count, rate, offset))));
    sweep::for_each(sweep::sample(cases.flatten(), 3), |(count, rate, offset): (i32, u32, bool)| {
        let mut world = world_at(rate);
        for i in 0..count {
            let aside = [fx!(0), fx!(0.01), fx!(-0.005), fx!(0.003)][i.unsigned_abs() as usize % 4];
            let place = Vec2::new(if offset { aside } else { fx!(0) }, Fx::from(i) + fx!(0.5));
            world
                .spawn(&BodyDef::dynamic().position(place), &[rectangle(fx!(0.5), fx!(0.5))])
                .expect("valid");
        }
        let sink = fx!(0.00036) * i64::from(count * count) + fx!(0.02);
        expect_stands(&format!("{count} boxes at {rate} Hz"), world, fx!(0.05), sink);
    });
}

#[test]
fn plates_on_discs_stand() {
    for (count, rate) in [(5, 60), (15, 60), (15, 120)] {
        let mut world = world_at(rate);
        let mut y = Fx::ZERO;
        for _ in 0..count {
            for x in [fx!(-0.8), fx!(0.8)] {
                let disc = ShapeDef::new(Geometry::circle(fx!(0.2)).expect("valid"));
                world.spawn(&BodyDef::dynamic().position((x, y + fx!(0.2))), &[disc]).expect("valid");
            }
            let plate = rectangle(fx!(1.2), fx!(0.1));
            world.spawn(&BodyDef::dynamic().position((fx!(0), y + fx!(0.5))), &[plate]).expect("valid");
            y += fx!(0.6);
        }
        expect_stands(&format!("{count} plates at {rate} Hz"), world, fx!(0.05), fx!(0.4));
    }
}

/// E. Catto's house of cards: cards of 40 cm and 2 mm, leaning at 25 degrees.
#[test]
fn a_house_of_cards_stands() {
    for rate in [60, 120] {
        let mut world = world_at(rate);
        let mut card = |x: Fx, y: Fx, degrees: Fx| {
            let def = BodyDef::dynamic().position((x, y)).angle(Angle::from_degrees(degrees));
            world.spawn(&def, &[rectangle(fx!(0.001), fx!(0.2)).friction(fx!(0.7))]).expect("valid");
        };
        let (mut first, mut y) = (fx!(0), fx!(0.18));
        for count in (1..=5).rev() {
            let mut x = first;
            for i in 0..count {
                if i + 1 < count {
                    card(x + fx!(0.25), y + fx!(0.185), fx!(90));
                }
                card(x, y, fx!(-25));
                card(x + fx!(0.175), y, fx!(25));
                x += fx!(0.35);
            }
            y += fx!(0.37);
            first += fx!(0.175);
        }
        expect_stands(&format!("cards at {rate} Hz"), world, fx!(0.05), fx!(0.08));
    }
}
