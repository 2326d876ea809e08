//! Bodies whose centre of mass or origin is at the edge of the world.

use lockstep2d::body::{BodyDef, BodyKind, Geometry, MassSource, ShapeDef, WORLD_EXTENT_MAX};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Vec2};
use lockstep2d::world::World;

use super::{caches_decide_nothing, weightless};

#[test]
fn a_body_put_back_inside_the_world_takes_its_shapes_along() {
    // The origin is at the edge of the world, and the centre of mass is 10 m beyond it. The first tick puts the centre
    // of mass back to the edge, although the body has no velocity.
    let mut world = weightless();
    let mass = MassSource::Given { mass: fx!(1), centre: Vec2::new(fx!(10), fx!(0)), gyration: fx!(1) };
    let body = BodyDef::dynamic().position((WORLD_EXTENT_MAX, fx!(0))).mass(mass);
    world.spawn(&body, &[ShapeDef::new(Geometry::circle(fx!(1)).unwrap())]).unwrap();
    caches_decide_nothing(&mut world, 3);
}

#[test]
fn a_target_on_a_locked_axis_at_the_edge_of_the_world_is_valid() {
    let mut world = weightless();
    let mass = MassSource::Given { mass: fx!(1), centre: Vec2::new(fx!(-5), fx!(0)), gyration: fx!(1) };
    let edge = Vec2::new(WORLD_EXTENT_MAX, fx!(0));
    let body = BodyDef::dynamic().position(edge).mass(mass).velocity((fx!(60), fx!(0)));
    let body = world.spawn(&body, &[]).unwrap();
    // The centre of mass stops at the edge. The origin is then 5 m beyond it.
    (0..10).for_each(|_| world.step());
    world.set_kind(body, BodyKind::Kinematic).unwrap();
    let mut settings = *world.body(body).unwrap().settings();
    settings.locks.x = true;
    world.set_body(body, &settings).unwrap();
    world.move_to(body, edge + Vec2::new(fx!(0), fx!(1)), Angle::ZERO).unwrap();
    assert_eq!(world.validate(), Ok(()));
    assert_eq!(World::from_bytes(&world.to_bytes()).unwrap().state_hash(), world.state_hash());
    caches_decide_nothing(&mut world, 3);
}
