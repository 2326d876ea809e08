//! Gears whose two wheels turn about the same point: they have no pitch point, and do not conserve angular momentum.

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2, fx_div};
use lockstep2d::solver::{Gear, JointDef, Revolute};
use lockstep2d::world::World;

/// B is fixed, or a brake holds it. The torque on B is the torque on A times the ratio of the teeth, which may be
/// negative.
#[test]
fn torques_are_in_the_ratio_of_the_teeth() {
    for teeth in [[1, -12], [1, 12], [12, -1], [5, 7]] {
        for [radius_a, radius_b] in [[fx!(0.5), fx!(1)], [fx!(1), fx!(0.5)]] {
            for is_fixed in [false, true] {
                let mut world = World::default();
                world.set_gravity(Vec2::ZERO).expect("valid");
                let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
                let wheel = |world: &mut World, def: BodyDef, radius: Fx| {
                    let disc = ShapeDef::new(Geometry::circle(radius).expect("valid"));
                    world.spawn(&def.never_sleeps(), &[disc]).expect("valid")
                };
                let a = wheel(&mut world, BodyDef::dynamic(), radius_a);
                let b = if is_fixed { BodyDef::fixed() } else { BodyDef::dynamic() };
                let b = wheel(&mut world, b, radius_b);
                world.add_joint(&JointDef::new(ground, a, Revolute::new())).expect("valid");
                if !is_fixed {
                    let brake = Revolute::new().motor(fx!(0), Fx::MAX);
                    world.add_joint(&JointDef::new(ground, b, brake)).expect("valid");
                }
                let gear = JointDef::new(a, b, Gear::new(teeth[0], teeth[1]));
                let gear = world.add_joint(&world.fit_joint(&gear).expect("valid")).expect("valid");
                for _ in 0..120 {
                    world.apply_torque(a, fx!(6)).expect("valid");
                    world.step();
                }
                // The gear exerts -6 N m on A.
                let expected = fx_div(fx!(-6) * i64::from(teeth[1]), Fx::from_num(teeth[0])).expect("not 0");
                let (force, torque) = world.joint_force(gear).expect("there");
                let off = (torque - expected).abs();
                let case = format!("{teeth:?}, {radius_a} m, {radius_b} m, fixed {is_fixed}");
                assert!(off < expected.abs() / 100, "{case}: {torque} N m instead of {expected}");
                assert!(force.length() < fx!(0.01), "{case}: {force:?} N");
            }
        }
    }
}
