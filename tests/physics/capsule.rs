//! Capsules rest, pile up, collide and roll as theory predicts.

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::World;

/// A capsule along the x axis, with round ends about (±half, 0).
fn pill(half: Fx, radius: Fx) -> ShapeDef {
    let end = Vec2::new(half, fx!(0));
    ShapeDef::new(Geometry::capsule(-end, end, radius).expect("valid"))
}

fn floor(world: &mut World) {
    let floor = ShapeDef::new(Polygon::rectangle(fx!(50), fx!(1)).expect("valid"));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
}

fn fall(world: &mut World, x: Fx, y: Fx, angle: Angle, shape: ShapeDef) -> BodyId {
    world.spawn(&BodyDef::dynamic().position((x, y)).angle(angle), &[shape]).expect("valid")
}

#[test]
fn a_capsule_lies_on_two_points_and_rests() {
    let mut world = World::default();
    floor(&mut world);
    let body = fall(&mut world, fx!(0), fx!(1.5), Angle::from_degrees(fx!(20)), pill(fx!(0.8), fx!(0.25)));
    // Keeps the last list that is not empty, because the world lists no contacts of sleeping bodies.
    let mut points = Vec::new();
    for _ in 0..600 {
        world.step();
        let counts: Vec<_> = world.contacts().map(|contact| contact.manifold.points().len()).collect();
        points = if counts.is_empty() { points } else { counts };
    }
    assert_eq!(points, [2]);
    let body = world.body(body).expect("still there");
    assert!((body.position().y - fx!(0.25)).abs() < fx!(0.002), "at {:?}", body.position());
    assert!(body.velocity().length() < fx!(0.0001) && body.angular_velocity().abs() < fx!(0.0001));
    assert_eq!(world.faults(), 0);
}

/// In 10 of 150 heaps (11 with semantics 24), one or two bodies keep rocking against a wall at 0.05 to 0.5 m/s. Four of
/// the 24 heaps may therefore be restless.
#[test]
fn capsules_pile_up_on_boxes_circles_and_segments() {
    let speeds: Vec<_> = (0..24)
        .map(|millimetres| {
            let world = heap(Fx::from_num(millimetres) / 1000);
            assert!(crate::deepest(&world) < fx!(0.01), "{} m deep", crate::deepest(&world));
            assert!(world.bodies().skip(1).all(|(_, body)| body.position().y > fx!(0.1)));
            assert_eq!(world.faults(), 0);
            crate::speed_max(&world)
        })
        .collect();
    let restless = speeds.iter().filter(|&&speed| speed > fx!(0.001)).count();
    assert!(restless <= 4 && speeds.iter().all(|&speed| speed < fx!(0.5)), "{speeds:?} m/s");
}

/// A heap of 40 bodies between two walls, after 20 seconds. `height` raises their initial positions.
fn heap(height: Fx) -> World {
    let mut world = World::default();
    let ends = [Vec2::new(fx!(-20), fx!(0)), Vec2::new(fx!(20), fx!(0))];
    let line = ShapeDef::new(Geometry::segment(ends[0], ends[1]).expect("valid"));
    let wall = |x| ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(20)).expect("valid")).offset((x, fx!(0)));
    world.spawn(&BodyDef::fixed(), &[line, wall(fx!(-3)), wall(fx!(3))]).expect("valid");
    let others = [
        pill(fx!(0.4), fx!(0.2)),
        ShapeDef::new(Geometry::circle(fx!(0.3)).expect("valid")),
        pill(fx!(0.1), fx!(0.3)),
        ShapeDef::new(Polygon::square(fx!(0.3)).expect("valid")),
    ];
    for i in 0..40i32 {
        let shape = others[i.unsigned_abs() as usize % 4];
        let angle = Angle::from_degrees(Fx::from_num(37 * i % 360));
        fall(&mut world, Fx::from_num(i % 5) - fx!(2), height + fx!(1) + Fx::from_num(i) / 4, angle, shape);
    }
    for _ in 0..1200 {
        world.step();
    }
    world
}

/// An elastic collision of equal masses in line. The capsules meet with their round ends.
#[test]
fn capsules_in_line_exchange_velocities() {
    let mut world =
        World::new(lockstep2d::world::Config { gravity: Vec2::ZERO, ..Default::default() }).expect("valid");
    let shape = pill(fx!(0.5), fx!(0.25)).restitution(fx!(1));
    let mover = BodyDef::dynamic().position((fx!(-3), fx!(0))).velocity((fx!(4), fx!(0)));
    let mover = world.spawn(&mover, &[shape]).expect("valid");
    let target = fall(&mut world, fx!(0), fx!(0), Angle::from_degrees(fx!(180)), shape);
    for _ in 0..60 {
        world.step();
    }
    let [mover, target] = [mover, target].map(|id| world.body(id).expect("still there").velocity());
    assert!(mover.length() < fx!(0.001), "{mover:?}");
    assert!(target.distance(Vec2::new(fx!(4), fx!(0))) < fx!(0.001), "{target:?}");
}

/// The capsule rests on one point at first, falls over, and rolls.
#[test]
fn a_capsule_that_leans_falls_over_to_that_side() {
    let mut world = World::default();
    floor(&mut world);
    let def = BodyDef::dynamic().position((fx!(0), fx!(1))).angle(Angle::from_degrees(fx!(85)));
    let body = world.spawn(&def, &[pill(fx!(0.75), fx!(0.25))]).expect("valid");
    for _ in 0..600 {
        world.step();
    }
    let body = world.body(body).expect("still there");
    assert!((body.position().y - fx!(0.25)).abs() < fx!(0.002), "at {:?}", body.position());
    assert!(body.position().x > fx!(0));
}
