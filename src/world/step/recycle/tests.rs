use crate::body::{BodyDef, Geometry, ShapeDef};
use crate::fx;
use crate::math::{Fx, Vec2, fx_mul};
use crate::solver::{Distance, JointDef, Spring};
use crate::world::{Config, World};

/// Whether the contact of two balls that a spring presses together keeps its manifold for a tick. Both turn at 2 rad/s,
/// and orbit each other at the given angular velocity.
fn keeps(orbit: Fx) -> bool {
    let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).unwrap();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap()).friction(fx!(0));
    let [a, b] = [fx!(-0.5), fx!(0.5)].map(|x| {
        let def = BodyDef::dynamic().position((x, fx!(0))).velocity((fx!(0), fx_mul(orbit, x)));
        world.spawn(&def.angular_velocity(fx!(2)), &[ball]).unwrap()
    });
    let spring = Spring { hertz: fx!(3), damping_ratio: fx!(1), target: fx!(0.2) };
    let spring = JointDef::new(a, b, Distance { spring: Some(spring), ..Distance::new() });
    world.add_joint(&JointDef { collide_connected: true, ..spring }).unwrap();
    (0..60).for_each(|_| world.step());
    let before = world.state.contacts[0];
    world.step();
    assert!(before.count > 0 && before.kept.can_be_kept());
    world.state.contacts[0].kept == before.kept
}

/// A manifold whose normal and arms are not turned with the bodies may be kept.
#[test]
fn balls_that_turn_keep_their_contact_only_if_they_slide_on_each_other() {
    assert!(keeps(fx!(0)));
    assert!(!keeps(fx!(2)));
}
