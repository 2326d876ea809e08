//! Impulses and motors whose velocity exceeds the formats.

use lockstep2d::body::BodyDef;
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::solver::{JointDef, Motor};
use lockstep2d::world::Explosion;

use super::{ball, spawn, square, weightless};

fn direction_is(v: Vec2<Fx>, expected: (Fx, Fx)) {
    let sine = v.normalized().expect("fast").widen().cross(Vec2::from(expected));
    assert!(sine.abs() < fx!(0.0001) && v.x > fx!(0), "{v:?} is not along {expected:?}");
}

#[test]
fn a_light_body_moves_in_the_direction_of_its_impulse() {
    for radius in [fx!(0.05), fx!(0.01)] {
        let mut world = weightless();
        let id = spawn(&mut world, BodyDef::dynamic(), ball(radius));
        world.apply_impulse_to_centre(id, (fx!(10), fx!(5))).expect("there");
        direction_is(world.body(id).expect("there").velocity(), (fx!(0.894427), fx!(0.447214)));
        world.step();
        direction_is(world.body(id).expect("there").velocity(), (fx!(0.894427), fx!(0.447214)));
    }
}

#[test]
fn light_debris_flies_away_from_an_explosion() {
    let mut world = weightless();
    let id = spawn(&mut world, BodyDef::dynamic().position((fx!(1.2), fx!(0.5))), ball(fx!(0.05)));
    world.explode(&Explosion::new(Vec2::ZERO, fx!(500))).expect("valid");
    direction_is(world.body(id).expect("there").velocity(), (fx!(0.923077), fx!(0.384615)));
}

#[test]
fn a_motor_pushes_in_the_direction_of_its_velocity() {
    let mut world = weightless();
    let wall = spawn(&mut world, BodyDef::fixed(), ball(fx!(0.1)));
    let id = spawn(&mut world, BodyDef::dynamic().position((fx!(2), fx!(0))), ball(fx!(0.5)));
    let motor = Motor::new().linear((fx!(2000), fx!(1000)), fx!(10));
    world.add_joint(&JointDef::new(wall, id, motor)).expect("valid");
    world.step();
    direction_is(world.body(id).expect("there").velocity(), (fx!(0.894427), fx!(0.447214)));
}

/// A force keeps its line of action when the centre of mass moves: here onto that line.
#[test]
fn a_force_acts_at_its_point_although_the_mass_changes() {
    let mut world = weightless();
    let id = spawn(&mut world, BodyDef::dynamic(), square(fx!(0.5)));
    world.apply_force(id, (fx!(0), fx!(10)), (fx!(0.5), fx!(0))).expect("there");
    world.add_shape(id, &square(fx!(0.5)).offset((fx!(1), fx!(0)))).expect("valid");
    world.step();
    let body = world.body(id).expect("there");
    assert!((body.velocity().y - fx!(5) / 60).abs() < fx!(0.0001), "{}", body.velocity().y);
    assert!(body.angular_velocity().abs() < fx!(0.0001), "{}", body.angular_velocity());
}
