//! Columns, plates on discs, arches and a house of cards stand and fall asleep.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, PI, Rot, Unit, Vec2};
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

/// Expects that all bodies fall asleep within a minute, and that until then no body moves to a side by more than
/// `sideways` metres or sinks by more than `sink` metres.
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

/// The boxes are exactly above each other, or each is shifted to a side by up to 1 cm. A contact gives way by up to
/// 0.72 mm for each box above it, so the top of `n` boxes sinks by up to `n^2 / 2` times 0.72 mm.
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

/// Only the rounded borders touch, not the polygons inside them. Each tick then chooses anew which of the two touching
/// faces is the reference face of the manifold.
#[test]
fn a_column_of_a_hundred_rounded_boxes_stands() {
    let radii = [fx!(0.02), fx!(0.05), fx!(0.1)].into_iter();
    let cases = radii.flat_map(|radius| [30, 60, 90, 120, 240].map(|rate| (radius, rate)));
    let cases = cases.flat_map(|case| [60, 80, 100].map(|count| (case, count)));
    sweep::for_each(sweep::sample(cases, 4), |((radius, rate), count): ((Fx, u32), i32)| {
        let mut world = world_at(rate);
        let half = fx!(0.5) - radius;
        let rounded = Polygon::rectangle(half, half).and_then(|polygon| polygon.rounded(radius));
        let rounded = ShapeDef::new(rounded.expect("valid"));
        for i in 0..count {
            let place = Vec2::new(fx!(0), Fx::from(i) + fx!(0.5));
            world.spawn(&BodyDef::dynamic().position(place), &[rounded]).expect("valid");
        }
        // Contacts are softer at a low tick rate, so each gives way more.
        let give = if rate < 60 { fx!(0.0015) } else { fx!(0.00036) };
        let sink = give * i64::from(count * count) + fx!(0.02);
        expect_stands(&format!("{count} boxes of radius {radius} at {rate} Hz"), world, fx!(0.05), sink);
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

/// E. Catto's house of cards. A card is 40 cm by 2 mm and leans at 25 degrees.
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

/// Builds a semicircular arch of wedges with a mean radius of 4 m. `thickness` is a multiple of this radius.
fn spawn_arch(world: &mut World, stones: u32, thickness: Fx) {
    for stone in 0..stones {
        let place = |number: u32, radius: Fx| {
            let angle = Angle::from_radians(PI * i64::from(number) / i64::from(stones));
            Rot::from_angle(angle).apply(Vec2::<Unit>::X).widen().scale(radius)
        };
        let (inner, outer) = (fx!(4) - thickness * 2, fx!(4) + thickness * 2);
        let corners =
            [place(stone, inner), place(stone, outer), place(stone + 1, outer), place(stone + 1, inner)];
        let stone = ShapeDef::new(Polygon::hull(&corners).expect("valid")).friction(fx!(0.9));
        world.spawn(&BodyDef::dynamic(), &[stone]).expect("valid");
    }
}

/// An arch stands if its thickness is more than 0.1075 of its mean radius and stones do not slide (M. Milankovitch,
/// "Theorie der Druckkurven", 1907).
#[test]
fn an_arch_stands_if_it_is_thick_enough() {
    let thick = [7u32, 9, 15].map(|stones| [fx!(0.13), fx!(0.2), fx!(0.3)].map(|part| (stones, part)));
    let cases =
        thick.into_iter().flatten().flat_map(|(stones, part)| [60, 120].map(|rate| (stones, part, rate)));
    sweep::for_each(sweep::sample(cases, 5), |(stones, part, rate): (u32, Fx, u32)| {
        let mut world = world_at(rate);
        spawn_arch(&mut world, stones, part);
        expect_stands(&format!("{stones} stones, {part} thick, at {rate} Hz"), world, fx!(0.05), fx!(0.06));
    });
    for stones in [9, 15] {
        let mut world = world_at(60);
        spawn_arch(&mut world, stones, fx!(0.09));
        for _ in 0..60 * 20 {
            world.step();
        }
        let top = world.bodies().map(|(_, body)| body.centre_of_mass().y).max().expect("there");
        assert!(top < fx!(2), "an arch of {stones} stones is too thin to stand: its top is at {top} m");
    }
}

/// E. Catto's arch: 17 stones that carry four planks.
#[test]
fn an_arch_carries_planks() {
    const INNER: [(Fx, Fx); 9] = [
        (fx!(16), fx!(0)),
        (fx!(14.93803712795643), fx!(5.133601056842984)),
        (fx!(13.79871746027416), fx!(10.24928069555078)),
        (fx!(12.56252963284711), fx!(15.34107019122473)),
        (fx!(11.20040987372525), fx!(20.39856541571217)),
        (fx!(9.66521217819836), fx!(25.40369899225096)),
        (fx!(7.87179930638133), fx!(30.3179337000085)),
        (fx!(5.635199558196225), fx!(35.03820717801641)),
        (fx!(2.405937953536585), fx!(39.09554102558315)),
    ];
    const OUTER: [(Fx, Fx); 9] = [
        (fx!(24), fx!(0)),
        (fx!(22.33619528222415), fx!(6.02299846205841)),
        (fx!(20.54936888969905), fx!(12.00964361211476)),
        (fx!(18.60854610798073), fx!(17.9470321677465)),
        (fx!(16.46769273811807), fx!(23.81367936585418)),
        (fx!(14.05325025774858), fx!(29.57079353071012)),
        (fx!(11.23551045834022), fx!(35.13775818285372)),
        (fx!(7.752568160730571), fx!(40.30450679009583)),
        (fx!(3.016931552701656), fx!(44.28891593799322)),
    ];
    let place = |(x, y): (Fx, Fx), side: i64| Vec2::new(x / 4 * side, y / 4);
    for rate in [60, 120] {
        let mut world = world_at(rate);
        let mut stone = |corners: [Vec2<Fx>; 4]| {
            let shape = ShapeDef::new(Polygon::hull(&corners).expect("valid"));
            world.spawn(&BodyDef::dynamic(), &[shape]).expect("valid");
        };
        for side in [1, -1] {
            for i in 0..8 {
                let corners = [INNER[i], OUTER[i], OUTER[i + 1], INNER[i + 1]];
                stone(corners.map(|corner| place(corner, side)));
            }
        }
        stone([place(INNER[8], 1), place(OUTER[8], 1), place(OUTER[8], -1), place(INNER[8], -1)]);
        for i in 0..4 {
            let y = OUTER[8].1 / 4 + fx!(0.5) + Fx::from(i);
            let plank = rectangle(fx!(2), fx!(0.5));
            world.spawn(&BodyDef::dynamic().position((fx!(0), y)), &[plank]).expect("valid");
        }
        expect_stands(&format!("an arch with planks at {rate} Hz"), world, fx!(0.05), fx!(0.35));
    }
}
