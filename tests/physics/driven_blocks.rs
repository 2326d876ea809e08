//! Motors of joints that are solved together in one block.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::Fx;
use lockstep2d::solver::{Distance, JointDef, Revolute};
use lockstep2d::world::{Config, World};

/// A boom of 5 m with 50 kg at its end is held by a strut. The motor of the strut extends it, with at most 100 kN. If
/// motors were solved before the block, not with it, the strut would become shorter by 0.4 m.
#[test]
fn a_strut_lifts_a_loaded_boom() {
    let mut world = World::new(Config::default()).expect("valid");
    let wall = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let capsule = Geometry::capsule((fx!(-2.5), fx!(0)), (fx!(2.5), fx!(0)), fx!(0.15)).expect("valid");
    let boom = BodyDef::dynamic().position((fx!(2.5), fx!(0)));
    let boom = world.spawn(&boom, &[ShapeDef::new(capsule)]).expect("valid");
    let square = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.5)).expect("valid")).density(fx!(50));
    let load = world.spawn(&BodyDef::dynamic().position((fx!(5), fx!(0))), &[square]).expect("valid");
    let pivot = JointDef::new(wall, boom, Revolute::new()).anchor_b((fx!(-2.5), fx!(0)));
    world.add_joint(&pivot).expect("valid");
    world.add_joint(&JointDef::new(boom, load, Revolute::new()).anchor_a((fx!(2.5), fx!(0)))).expect("valid");
    let strut = Distance::new().motor(fx!(0.1), fx!(100000));
    let strut = JointDef::new(wall, boom, strut).anchor_a((fx!(0.5), fx!(-2))).anchor_b((fx!(-2), fx!(0)));
    let strut = world.add_joint(&strut).expect("valid");
    for second in 1..=5 {
        for _ in 0..60 {
            world.step();
        }
        let length = world.joint_length(strut).expect("there");
        let wanted = fx!(2) + Fx::from_num(second) / 10;
        assert!((length - wanted).abs() < fx!(0.02), "{second} s: {length} m instead of {wanted} m");
    }
}
