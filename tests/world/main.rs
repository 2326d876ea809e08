//! Public behaviour of `World`.

mod churn;
mod crossings;
mod equality;
mod events;
mod far;
mod impulses;
mod joint_batches;
mod joint_edits;
mod joint_turns;
mod largest;
mod locks;
mod lost_support;
mod massless;
mod names;
mod phases;
mod rollback;
mod sensors;
mod setters;
mod settings;
mod sleep_edits;
mod sleeping;
mod woken_crowd;

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef, ShapeId};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Config, World};
use lockstep2d_tests::sweep;

fn square(half: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::square(half).expect("valid"))
}

fn rectangle(half_width: Fx, half_height: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(half_width, half_height).expect("valid"))
}

fn ball(radius: Fx) -> ShapeDef {
    ShapeDef::new(Geometry::circle(radius).expect("valid"))
}

fn capsule(half_length: Fx, radius: Fx) -> ShapeDef {
    let (a, b) = (Vec2::new(-half_length, Fx::ZERO), Vec2::new(half_length, Fx::ZERO));
    ShapeDef::new(Geometry::capsule(a, b, radius).expect("valid"))
}

/// World with a floor whose surface is at height 0.
fn world_with_floor() -> (World, BodyId) {
    let mut world = World::default();
    let floor = BodyDef::fixed().position((fx!(0), fx!(-1)));
    let floor = world.spawn(&floor, &[rectangle(fx!(50), fx!(1))]).expect("valid");
    (world, floor)
}

fn weightless() -> World {
    World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid")
}

fn spawn(world: &mut World, def: BodyDef, shape: ShapeDef) -> BodyId {
    world.spawn(&def, &[shape]).expect("valid")
}

fn shape_of(world: &World, body: BodyId) -> ShapeId {
    world.body(body).expect("there").shapes()[0]
}

fn is_asleep(world: &World, body: BodyId) -> bool {
    world.body(body).expect("there").is_asleep()
}

/// Simulates ticks, and validates the invariants after each one.
fn run(world: &mut World, ticks: u32) {
    for _ in 0..ticks {
        world.step();
        assert_eq!(world.validate(), Ok(()));
    }
}
