//! Snapshot files for [`World::from_bytes`].

use std::sync::LazyLock;

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::Vec2;
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{Config, World};

use super::attempt;
use crate::generator;
use crate::snapshots::repair;

/// Maximum cost of a tick, as counted by [`generator::cost`].
const COST_MAX: u64 = 1000;

/// Snapshots of five worlds: an empty one; two bodies that touch; the same bodies with a joint; the bodies asleep; the
/// upper body alone, with vacant slots of removed bodies.
static ORIGINALS: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let empty = World::new(Config::default()).expect("valid");
    let mut touching = empty.clone();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
    let square = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.5)).expect("valid"));
    let low = touching.spawn(&BodyDef::fixed(), &[square]).expect("valid");
    let high = touching.spawn(&BodyDef::dynamic().position((fx!(0), fx!(1))), &[ball]).expect("valid");
    touching.step();
    let mut jointed = touching.clone();
    let hinge = JointDef::new(low, high, Revolute::default()).anchor_a((fx!(0), fx!(1)));
    jointed.add_joint(&hinge).expect("valid");
    jointed.step();
    let mut asleep = touching.clone();
    while asleep.body(high).is_some_and(|body| !body.is_asleep()) && asleep.tick() < 300 {
        asleep.step();
    }
    let mut vacant = touching.clone();
    let line = Geometry::Segment { a: Vec2::ZERO, b: Vec2::new(fx!(1), fx!(0)) };
    let gone = vacant.spawn(&BodyDef::kinematic(), &[ShapeDef::new(line)]).expect("valid");
    vacant.despawn(gone).expect("the body exists");
    vacant.despawn(low).expect("the body exists");
    [empty, touching, jointed, asleep, vacant].map(|world| world.to_bytes()).to_vec()
});

/// Reads a world and, if it is valid, steps it at most twice. Returns whether it is valid.
///
/// # Panics
/// If a decoded world encodes to other bytes, breaks an invariant, or depends on its caches.
pub fn run(bytes: &[u8]) -> bool {
    let attempt = attempt(bytes, &ORIGINALS, |file| repair(file));
    let Ok(mut world) = World::from_bytes(&attempt.file) else { return false };
    assert_eq!(world.to_bytes(), attempt.file, "a state has one encoding");
    let mut bare = world.clone();
    for _ in 0..2 {
        if generator::cost(&world) > COST_MAX {
            break;
        }
        world.step();
        bare.clear_scratch();
        bare.step();
        assert_eq!(world.validate(), Ok(()), "a valid world stays valid");
        assert_eq!(world.state_hash(), bare.state_hash(), "a world must not depend on its caches");
    }
    true
}

/// The valid files, from which the tests write seeds.
pub fn originals() -> &'static [Vec<u8>] {
    &ORIGINALS
}
