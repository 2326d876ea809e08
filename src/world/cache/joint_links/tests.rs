use super::*;
use crate::body::{BodyDef, Geometry, ShapeDef};
use crate::fx;
use crate::math::Rng;
use crate::solver::{JointDef, Weld};
use crate::world::{Config, World};

#[test]
fn joints_are_those_that_name_the_body() {
    let mut world = World::new(Config::default()).unwrap();
    let disc = ShapeDef::new(Geometry::circle(fx!(1)).unwrap());
    let mut bodies: Vec<_> = (0..9).map(|_| world.spawn(&BodyDef::dynamic(), &[disc]).unwrap()).collect();
    let mut rng = Rng::new(1);
    for round in 0..2000 {
        let pick = |rng: &mut Rng| bodies[rng.below(9) as usize];
        let (a, b) = (pick(&mut rng), pick(&mut rng));
        if a != b && rng.chance(1, 2) {
            world.add_joint(&JointDef::new(a, b, Weld::rigid())).unwrap();
        } else if let Some(&joint) = world.scratch.joint_links.of(&world.state, a).first() {
            world.remove_joint(joint).unwrap();
        }
        if round % 50 == 0 {
            world.despawn(a).unwrap();
            let place = bodies.iter().position(|&body| body == a).unwrap();
            bodies[place] = world.spawn(&BodyDef::dynamic(), &[disc]).unwrap();
        }
        for &body in &bodies {
            let named = |bodies: (BodyId, BodyId)| bodies.0 == body || bodies.1 == body;
            let joints = world.state.joints.iter();
            let expected: Vec<_> =
                joints.filter(|(_, joint)| named(joint.def().bodies())).map(|at| at.0).collect();
            assert_eq!(world.scratch.joint_links.of(&world.state, body), expected);
            assert_eq!(JointLinks::new(&world.state).of(&world.state, body), expected);
        }
    }
}
