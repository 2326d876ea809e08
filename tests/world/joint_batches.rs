//! Joint batches that are kept between ticks give results equal to those of new batches.

use lockstep2d::body::{BodyDef, BodyId, BodyKind, MassSource};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::solver::{
    Distance, JointDef, JointKind, Motor, Prismatic, Revolute, Threshold, ThresholdAction, Weld, Wheel,
};
use lockstep2d::world::World;

use super::{ball, world_with_floor};

fn random_kind(rng: &mut Rng) -> JointKind {
    let turning = || Revolute::new().limit(fx!(-0.5), fx!(0.5)).spring(fx!(3), fx!(0.5), fx!(0));
    match rng.below(9) {
        0 => turning().into(),
        1 => turning().motor(fx!(2), fx!(5)).into(),
        2 => Weld::rigid().into(),
        3 => Prismatic::new().into(),
        4 => Distance::rod(fx!(1)).into(),
        5 => Wheel::new().into(),
        6 => Motor::new().into(),
        _ => Revolute::new().into(),
    }
}

/// Dynamic, kinematic and fixed bodies with joints of all kinds.
fn net(rng: &mut Rng) -> World {
    let (mut world, floor) = world_with_floor();
    let mut bodies = vec![floor];
    for i in 0..60 {
        let place = (Fx::from_num(i % 10), Fx::from_num(3 + i / 10));
        let def = match rng.below(10) {
            0 => BodyDef::kinematic().angular_velocity(fx!(1)),
            1 => BodyDef::fixed(),
            _ => BodyDef::dynamic(),
        };
        bodies.push(world.spawn(&def.position(place), &[ball(fx!(0.3))]).expect("valid"));
    }
    for _ in 0..90 {
        add_joint(&mut world, &bodies, rng);
    }
    world
}

fn add_joint(world: &mut World, bodies: &[BodyId], rng: &mut Rng) {
    let mut pick = || bodies[rng.below(u32::try_from(bodies.len()).expect("few")) as usize];
    let (a, b) = (pick(), pick());
    let (Some(body_a), Some(body_b)) = (world.body(a), world.body(b)) else { return };
    let anchor = body_a.transform().apply_inverse(body_b.position());
    let mut def = JointDef::new(a, b, random_kind(rng)).anchor_a(anchor);
    if body_a.kind() == BodyKind::Fixed && rng.chance(1, 2) {
        // A is moved but the anchor stays in place, so that it is far from A's origin.
        let offset = Vec2::new(fx!(1000), fx!(-300));
        let position = body_a.position() - offset;
        let angle = body_a.angle();
        def = def.anchor_a(anchor + offset);
        world.set_transform(a, position, angle).expect("valid");
    }
    if rng.chance(1, 3) {
        def = def.softness(fx!(10) * i64::from(1 + rng.below(3)), fx!(1));
    }
    let _refused_to_itself = world.add_joint(&def);
}

fn given(rng: &mut Rng) -> MassSource {
    let centre = Vec2::new(rng.range(fx!(-0.1), fx!(0.1)), fx!(0));
    MassSource::Given { mass: rng.range(fx!(1), fx!(9)), centre, gyration: rng.range(fx!(0.2), fx!(1)) }
}

/// Makes a random change, which may invalidate prepared joints, and adds a joint.
fn change(world: &mut World, rng: &mut Rng) {
    let bodies: Vec<BodyId> = world.bodies().map(|(id, _)| id).collect();
    let joints: Vec<_> = world.joints().map(|(id, joint)| (id, *joint.def())).collect();
    let body = bodies[rng.below(u32::try_from(bodies.len()).expect("few")) as usize];
    let (joint, mut def) = joints[rng.below(u32::try_from(joints.len()).expect("few")) as usize];
    let _may_be_refused = match rng.below(10) {
        0 => world.set_mass(body, given(rng)).is_ok(),
        1 => world.set_kind(body, BodyKind::Kinematic).is_ok(),
        2 => world.set_kind(body, BodyKind::Dynamic).is_ok(),
        3 => {
            def.kind = random_kind(rng);
            world.set_joint(joint, &def).is_ok()
        }
        4 => {
            def.threshold = Threshold { force: Some(fx!(900)), torque: None, action: ThresholdAction::Break };
            world.set_joint(joint, &def).is_ok()
        }
        5 => world.remove_joint(joint).is_ok(),
        6 => world.sleep(body).is_ok(),
        7 => world.set_gravity(Vec2::new(rng.range(fx!(-3), fx!(3)), fx!(-9))).is_ok(),
        8 => world.disable(body).is_ok(),
        _ => world.enable(body).is_ok(),
    };
    add_joint(world, &bodies, rng);
}

#[test]
fn joints_that_go_on_are_those_that_are_prepared_anew() {
    let mut rng = Rng::new(4);
    for _ in 0..6 {
        let mut world = net(&mut rng);
        let mut anew = world.clone();
        let mut saved = world.save();
        for tick in 0..150 {
            // In most ticks nothing changes, and the batches of the last tick are used again.
            if rng.below(4) == 0 {
                let mut same = rng.clone();
                change(&mut world, &mut rng);
                change(&mut anew, &mut same);
            }
            match rng.below(30) {
                0 => saved = world.save(),
                1 => {
                    world.restore(&saved);
                    anew.restore(&saved);
                }
                _ => {}
            }
            anew.clear_scratch();
            world.step();
            anew.step();
            assert_eq!(world.state_hash(), anew.state_hash(), "tick {tick}");
        }
    }
}
