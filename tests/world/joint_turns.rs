//! Whole turns of a joint whose definition changes.

use lockstep2d::body::{BodyDef, BodyId, JointId};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{JointDef, JointKind, Motor, Prismatic, Rack, Revolute, Weld};
use lockstep2d::world::World;

use super::{ball, rectangle, run, spawn, weightless};

/// A disc with its centre 1 m from a hinge. A motor has turned the disc about the hinge by more than 6 turns.
fn turned() -> (World, [BodyId; 2], JointId) {
    let mut world = weightless();
    let axle = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let disc = spawn(&mut world, BodyDef::dynamic().position((fx!(1), fx!(0))), ball(fx!(0.5)));
    let motor = Revolute::new().motor(fx!(10), fx!(1000));
    let def = JointDef::new(axle, disc, motor).anchor_b((fx!(-1), fx!(0)));
    let joint = world.add_joint(&def).expect("valid");
    run(&mut world, 240);
    assert!(world.joint_angle(joint).expect("there") > fx!(38));
    (world, [axle, disc], joint)
}

fn motion(world: &World, id: BodyId) -> (Vec2<Fx>, Angle, Vec2<Fx>, Fx) {
    let body = world.body(id).expect("there");
    (body.position(), body.angle(), body.velocity(), body.angular_velocity())
}

#[test]
fn a_joint_of_another_kind_starts_without_whole_turns() {
    let spring = Motor::new().angular_spring(fx!(5), fx!(1), Fx::MAX);
    let kinds: [JointKind; 4] =
        [Weld::rigid().into(), Prismatic::new().into(), spring.into(), Revolute::new().into()];
    for kind in kinds {
        let (mut world, [axle, disc], joint) = turned();
        if matches!(kind, JointKind::Revolute(_)) {
            let weld = JointDef { kind: Weld::rigid().into(), ..*world.joint(joint).expect("there").def() };
            world.set_joint(joint, &weld).expect("valid");
        }
        let mut fresh = world.clone();
        let def = JointDef::new(axle, disc, kind).anchor_b((fx!(-1), fx!(0)));
        world.set_joint(joint, &def).expect("valid");
        fresh.remove_joint(joint).expect("there");
        let fresh_joint = fresh.add_joint(&def).expect("valid");
        for tick in 0..60 {
            world.step();
            fresh.step();
            assert_eq!(motion(&world, disc), motion(&fresh, disc), "{kind:?}, tick {tick}");
        }
        assert_eq!(world.joint_angle(joint), fresh.joint_angle(fresh_joint));
    }
}

#[test]
fn a_weld_at_the_pose_of_a_turned_hinge_stops_it() {
    let (mut world, [axle, disc], joint) = turned();
    let weld = world.joint_at(axle, disc, Weld::rigid(), Vec2::ZERO).expect("there");
    let place = world.body(disc).expect("there").position();
    world.set_joint(joint, &weld).expect("valid");
    for tick in 0..60 {
        world.step();
        let moved = (world.body(disc).expect("there").position() - place).length();
        assert!(moved < fx!(0.1), "tick {tick}: {moved} m");
    }
    assert!(world.joint_error(joint).expect("there") < fx!(0.001));
}

#[test]
fn a_hinge_that_changes_keeps_its_whole_turns() {
    let (mut world, [axle, disc], joint) = turned();
    let before = world.joint_angle(joint);
    let def = JointDef::new(axle, disc, Revolute::new().spring(fx!(1), fx!(1), fx!(40)));
    world.set_joint(joint, &def.anchor_a((fx!(0.1), fx!(0)))).expect("valid");
    assert_eq!(world.joint_angle(joint), before);
}

#[test]
fn a_rolled_rack_keeps_its_place_when_it_is_fitted_or_changed() {
    let mut world = weightless();
    let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let pinion = spawn(&mut world, BodyDef::dynamic(), ball(fx!(0.5)));
    world.add_joint(&JointDef::new(ground, pinion, Revolute::new().motor(fx!(5), fx!(1000)))).expect("valid");
    let bar = BodyDef::dynamic().position((fx!(0.5), fx!(0)));
    let bar = spawn(&mut world, bar, rectangle(fx!(0.1), fx!(3)));
    let slide = world.joint_along(ground, bar, Prismatic::new(), (fx!(0.5), fx!(0)), (fx!(0), fx!(1)));
    world.add_joint(&slide.expect("there")).expect("valid");
    let rack = JointDef::new(pinion, bar, Rack::new(fx!(0.5))).angle_b(Angle::QUARTER);
    let rack = world.add_joint(&world.fit_joint(&rack).expect("valid")).expect("valid");
    run(&mut world, 240);
    let rolled = *world.joint(rack).expect("there").def();
    let fitted = world.fit_joint(&rolled).expect("valid");
    assert!((fitted.frame_b.anchor - rolled.frame_b.anchor).length() > fx!(9), "it has rolled three turns");
    // A new definition may move the anchor of the rack by a millimetre. The joint then keeps its count of whole turns,
    // so that the rack does not jump.
    let moved = rolled.anchor_b(rolled.frame_b.anchor + Vec2::new(fx!(0.001), fx!(0.001)));
    for def in [fitted, rolled.user_data(7), moved] {
        let mut world = world.clone();
        world.set_joint(rack, &def).expect("valid");
        for tick in 0..60 {
            let error = world.joint_error(rack).expect("there");
            assert!(error < fx!(0.01), "tick {tick}: {error} m, {def:?}");
            world.step();
        }
        let speed = world.body(bar).expect("there").velocity().length();
        assert!((speed - fx!(2.5)).abs() < fx!(0.05), "{speed} m/s, {def:?}");
    }
}
