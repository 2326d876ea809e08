//! A box stays if `tan(angle)` is below the friction coefficient, and otherwise slides with `a = g (sin - mu cos)`.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_mul, widen};
use lockstep2d::world::World;

/// Distance in m travelled in `seconds`, and final speed in m/s.
fn slide(degrees: Fx, friction: Fx, seconds: i64, ground: Ground) -> (Fx, Fx) {
    let angle = Angle::from_degrees(degrees);
    let (sin, cos) = (widen(angle.sin()), widen(angle.cos()));
    let mut world = World::default();
    let ramp = match ground {
        Ground::Block => ShapeDef::new(Polygon::rectangle(fx!(100), fx!(0.5)).expect("valid")),
        Ground::Line => ShapeDef::new(
            Geometry::segment(Vec2::new(fx!(-5000), fx!(0.5)), Vec2::new(fx!(5000), fx!(0.5)))
                .expect("valid"),
        ),
    };
    world.spawn(&BodyDef::fixed().angle(angle), &[ramp.friction(friction)]).expect("valid");
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid")).friction(friction);
    let start = Vec2::new(cos, sin).scale(fx!(80)) + Vec2::new(-sin, cos);
    let body = world.spawn(&BodyDef::dynamic().position(start).angle(angle), &[square]).expect("valid");
    for _ in 0..60 * seconds {
        world.step();
    }
    assert_eq!(world.faults(), 0);
    let body = world.body(body).expect("still there");
    (body.position().distance(start), body.velocity().length())
}

#[derive(Clone, Copy)]
enum Ground {
    Block,
    Line,
}

#[test]
fn a_box_stays_below_the_angle_of_friction() {
    for ground in [Ground::Block, Ground::Line] {
        for degrees in [fx!(10), fx!(25), fx!(30.5)] {
            let (distance, speed) = slide(degrees, fx!(0.6), 10, ground);
            assert!(
                distance < fx!(0.005) && speed < fx!(0.0001),
                "{degrees} degrees: {distance} m, {speed} m/s"
            );
        }
    }
}

#[test]
fn a_box_slides_with_the_textbook_acceleration_above_it() {
    for ground in [Ground::Block, Ground::Line] {
        for (degrees, friction) in [(fx!(35), fx!(0.6)), (fx!(25), fx!(0.3)), (fx!(20), fx!(0))] {
            let angle = Angle::from_degrees(degrees);
            let (sin, cos) = (widen(angle.sin()), widen(angle.cos()));
            let acceleration = (sin - fx_mul(friction, cos)) * 10;
            let (_, speed) = slide(degrees, friction, 5, ground);
            let expected = acceleration * 5;
            let error = (speed - expected).abs();
            assert!(error < expected / 100, "{degrees} degrees: {speed} m/s, expected {expected}");
        }
    }
}
