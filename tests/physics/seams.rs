//! At the seams of flush blocks there are no ghost collisions, although each pair of shapes is solved separately.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::World;

use crate::sweep;

#[derive(Clone, Copy, Debug)]
enum Ground {
    OneBody,
    ManyBodies,
    Segments,
}

/// Adds a thousand blocks or segments of half a metre, with tops at height 0.
fn ground(world: &mut World, ground: Ground) {
    let block = ShapeDef::new(Polygon::square(fx!(0.25)).expect("valid"));
    let x = |i: i32| Fx::from_num(i) / 2 - fx!(5);
    let blocks: Vec<_> = match ground {
        Ground::OneBody | Ground::ManyBodies => (0..1000).map(|i| block.offset((x(i), fx!(-0.25)))).collect(),
        Ground::Segments => {
            let line = |i| Geometry::segment(Vec2::new(x(i), fx!(0)), Vec2::new(x(i + 1), fx!(0)));
            (0..1000).map(|i| ShapeDef::new(line(i).expect("valid"))).collect()
        }
    };
    match ground {
        Ground::ManyBodies => {
            for (i, _) in blocks.iter().enumerate() {
                let at = x(i32::try_from(i).expect("few"));
                world.spawn(&BodyDef::fixed().position((at, fx!(-0.25))), &[block]).expect("valid");
            }
        }
        Ground::OneBody | Ground::Segments => {
            world.spawn(&BodyDef::fixed(), &blocks).expect("valid");
        }
    }
}

/// Largest vertical speed in m/s, and distance travelled in m, during 20 s.
fn slide(kind: Ground, shape: ShapeDef, height: Fx, speed: Fx) -> (Fx, Fx) {
    let mut world = World::default();
    ground(&mut world, kind);
    let def = BodyDef::dynamic().position((fx!(0), height)).velocity((speed, fx!(0)));
    let body = world.spawn(&def, &[shape]).expect("valid");
    let mut fastest = Fx::ZERO;
    for _ in 0..1200 {
        world.step();
        fastest = fastest.max(world.body(body).expect("there").velocity().y.abs());
    }
    assert_eq!(world.faults(), 0);
    (fastest, world.body(body).expect("there").position().x)
}

fn movers() -> [(&'static str, ShapeDef); 4] {
    let square =
        |half, radius| Polygon::square(half).and_then(|square| square.rounded(radius)).expect("valid");
    let end = Vec2::new(fx!(0.7), fx!(0));
    [
        ("box", ShapeDef::new(square(fx!(0.5), fx!(0)))),
        ("rounded box", ShapeDef::new(square(fx!(0.4), fx!(0.1)))),
        ("ball", ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"))),
        ("pill", ShapeDef::new(Geometry::capsule(-end, end, fx!(0.5)).expect("valid"))),
    ]
}

/// A sampled run plays 36 of the 240 cases. Each ground, mover, friction, speed and depth occurs among them.
#[test]
fn everything_slides_over_flush_blocks() {
    let mut cases = Vec::new();
    for kind in [Ground::OneBody, Ground::ManyBodies, Ground::Segments] {
        for mover in movers() {
            for friction in [fx!(0), fx!(0.2)] {
                for speed in [fx!(0.3), fx!(1), fx!(3), fx!(6), fx!(10)] {
                    cases.extend([fx!(0), fx!(0.003)].map(|sunk| (kind, mover, friction, speed, sunk)));
                }
            }
        }
    }
    sweep::for_each(sweep::sample(cases, 7), |(kind, (name, shape), friction, speed, sunk)| {
        let (fastest, way) = slide(kind, shape.friction(friction), fx!(0.5) - sunk, speed);
        assert!(
            fastest < fx!(0.2),
            "{kind:?} {name} at {speed} m/s, friction {friction}, sunk {sunk}: {fastest} m/s, {way} m"
        );
    });
}

/// The ghost-collision filter leaves real collisions alone: that of two thin plates, and that of a box with a step of 2
/// cm.
#[test]
fn thin_plates_and_low_steps_are_not_passed_by() {
    let mut world = World::default();
    let floor = ShapeDef::new(Polygon::rectangle(fx!(50), fx!(1)).expect("valid")).friction(fx!(0));
    let step = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.01)).expect("valid"));
    let step = step.offset((fx!(-20), fx!(1.01)));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor, step]).expect("valid");
    let plate = ShapeDef::new(Polygon::rectangle(fx!(0.2), fx!(0.003)).expect("valid")).friction(fx!(0));
    let slide = |world: &mut World, shape, x, y, speed| {
        let def = BodyDef::dynamic().position((x, y)).velocity((speed, fx!(0)));
        world.spawn(&def, &[shape]).expect("valid")
    };
    let first = slide(&mut world, plate, fx!(0), fx!(0.003), fx!(2));
    let second = slide(&mut world, plate, fx!(3), fx!(0.003), fx!(0));
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid")).friction(fx!(0));
    let third = slide(&mut world, square, fx!(-15), fx!(0.5), fx!(-2));
    for _ in 0..180 {
        world.step();
    }
    let velocity = |id| world.body(id).expect("there").velocity();
    assert!(velocity(first).distance(velocity(second)) < fx!(0.1), "{:?}", velocity(second));
    assert!((velocity(second).x - fx!(1)).abs() < fx!(0.05), "{:?}", velocity(second));
    assert!(
        world.body(third).expect("there").position().x > fx!(-18.51),
        "expected a step of 2 cm to stop the box"
    );
}
