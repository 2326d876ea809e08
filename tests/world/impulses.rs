//! Impulses, forces, springs and motors whose values exceed the ranges of the solver's number formats.

use lockstep2d::body::{Area, BodyDef, MassSource};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2, fx_div, fx_mul};
use lockstep2d::solver::{Distance, JointDef, Motor};
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

/// A force keeps its line of action when the centre of mass moves. Here, the centre of mass moves onto this line.
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

/// A force of 100 N, the limit of the spring, accelerates 1 kg for a tick, however hard the spring would pull without
/// it.
#[test]
fn a_long_spring_of_limited_force_pulls_along_its_direction() {
    for (hertz, scale, in_block) in [
        (fx!(30), 1, false),
        (fx!(30), 1, true),
        (fx!(60), 1000, false),
        (fx!(60), 1000, true),
        (fx!(1), 1_000_000, false),
    ] {
        let mut world = weightless();
        let wall = spawn(&mut world, BodyDef::fixed(), ball(fx!(0.1)));
        let place = (fx!(-100) * scale, fx!(-25) * scale);
        let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.4) };
        let id = spawn(&mut world, BodyDef::dynamic().position(place).mass(mass), ball(fx!(0.5)));
        let spring = Motor::new().linear_spring(hertz, fx!(1), fx!(100));
        world.add_joint(&JointDef::new(wall, id, spring)).expect("valid");
        if in_block {
            world.add_joint(&JointDef::new(wall, id, Distance::rope(fx!(1000000)))).expect("valid");
        }
        world.step();
        let v = world.body(id).expect("there").velocity();
        direction_is(v, (fx!(0.970143), fx!(0.242536)));
        let what = format!("{hertz} Hz, scale {scale}, in a block: {in_block}");
        assert!((v.length() - fx!(100 / 60)).abs() < fx!(0.0001), "{what}: {v:?}");
        assert_eq!(world.faults(), 0, "{what}");
    }
}

#[test]
fn a_motor_brakes_a_fast_body_along_the_difference_of_the_velocities() {
    let mut world = weightless();
    let wall = spawn(&mut world, BodyDef::fixed(), ball(fx!(0.1)));
    let start = Vec2::new(fx!(-390), fx!(-60));
    let id = spawn(&mut world, BodyDef::dynamic().velocity(start), ball(fx!(0.5)));
    let motor = Motor::new().linear((fx!(500), fx!(100)), fx!(10));
    world.add_joint(&JointDef::new(wall, id, motor)).expect("valid");
    world.step();
    // The target velocity of the motor differs from that of the body by (890, 160) m/s.
    direction_is(world.body(id).expect("there").velocity() - start, (fx!(0.984221), fx!(0.176939)));
    assert_eq!(world.faults(), 0);
}

/// The velocity is clamped to a length of 400 m/s, and keeps its direction.
#[test]
fn a_light_body_moves_in_the_direction_of_its_force() {
    for damping in [fx!(0), fx!(1), fx!(20)] {
        let mut world = weightless();
        let light = BodyDef::dynamic().linear_damping(damping);
        let pushed = spawn(&mut world, light, ball(fx!(0.01)));
        let blown = spawn(&mut world, light.position((fx!(100), fx!(0))), ball(fx!(0.01)));
        let wind = Area { force: Vec2::new(fx!(1000000), fx!(500000)), ..Area::new() };
        let wind = ball(fx!(20)).area(wind);
        spawn(&mut world, BodyDef::fixed().position((fx!(100), fx!(0))), wind);
        world.apply_force_to_centre(pushed, (fx!(600), fx!(300))).expect("there");
        world.step();
        for id in [pushed, blown] {
            let v = world.body(id).expect("there").velocity();
            direction_is(v, (fx!(0.894427), fx!(0.447214)));
            assert!((v.length() - fx!(400)).abs() < fx!(0.001), "{v:?} with damping {damping}");
        }
    }
}

/// An impulse `P` at an arm `r` gives the angular velocity `w = r P / (m k^2)`, with the radius of gyration `k`.
#[test]
fn very_heavy_and_very_light_bodies_are_turned_by_impulses() {
    for (mass, gyration, arm, impulse) in [
        (fx!(1000000), fx!(80), fx!(100), fx!(50000000)),
        (fx!(0.00001), fx!(0.002), fx!(0.005), fx!(1) / (1 << 26)),
        (fx!(2), fx!(0.5), fx!(0.25), fx!(3)),
    ] {
        for sign in [1, -1] {
            let mut world = weightless();
            let source = MassSource::Given { mass, centre: Vec2::ZERO, gyration };
            let id = spawn(&mut world, BodyDef::dynamic().mass(source), ball(fx!(0.01)));
            world.apply_impulse(id, (fx!(0), impulse * sign), (arm, fx!(0))).expect("there");
            // In this order of the factors, no product exceeds its format.
            let per_arm =
                fx_div(fx_mul(fx_div(arm, gyration).expect("not 0"), impulse), mass).expect("not 0");
            let expected = fx_div(per_arm, gyration).expect("not 0") * sign;
            let found = world.body(id).expect("there").angular_velocity();
            assert!((found - expected).abs() < expected.abs() / 1000, "{found} instead of {expected} rad/s");
        }
    }
}
