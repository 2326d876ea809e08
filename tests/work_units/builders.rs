//! Commands for worlds with many bodies of one kind.

use lockstep2d::body::{BodyDef, BodyId, Polygon, ShapeDef};
use lockstep2d::codec;
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::JointDef;
use lockstep2d::world::{BodyPose, Command, Config};

/// Handle of the first occupant of a slot.
pub(super) fn identifier<H: serde::de::DeserializeOwned>(slot: u32) -> H {
    codec::decode(&u64::from(slot).to_le_bytes()).expect("a handle")
}

pub(super) fn body(slot: u32) -> BodyId {
    identifier::<BodyId>(slot)
}

pub(super) fn square(side: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::square(side).expect("a square"))
}

pub(super) fn octagon() -> ShapeDef {
    let one = fx!(0.5);
    let some = fx!(0.25);
    let points = [
        (one, some),
        (some, one),
        (-some, one),
        (-one, some),
        (-one, -some),
        (-some, -one),
        (some, -one),
        (one, -some),
    ];
    ShapeDef::new(Polygon::new(&points.map(|(x, y)| Vec2::new(x, y))).expect("an octagon"))
}

pub(super) fn spawn(body: BodyDef, shapes: Vec<ShapeDef>) -> Command {
    Command::Spawn { body, shapes }
}

pub(super) fn each(body: BodyDef, shape: ShapeDef, positions: impl Iterator<Item = (Fx, Fx)>) -> Command {
    let pose = |(x, y)| BodyPose { position: Vec2::new(x, y), angle: Angle::ZERO };
    Command::SpawnEach { body, shapes: vec![shape], poses: positions.map(pose).collect() }
}

/// Places of a square grid with `side` rows and columns, `gap` metres apart.
pub(super) fn grid(side: i64, gap: Fx) -> impl Iterator<Item = (Fx, Fx)> {
    (0..side * side).map(move |number| (gap * (number % side), gap * (number / side)))
}

/// Two bodies with `count` joints between them.
pub(super) fn joined(count: usize, joint: JointDef) -> Vec<Command> {
    let ball = || spawn(BodyDef::dynamic(), vec![square(fx!(0.5))]);
    vec![ball(), ball(), Command::AddJointEach { joint, ends: vec![(body(0), body(1)); count] }]
}

pub(super) fn still() -> Config {
    Config { gravity: Vec2::ZERO, ..Config::default() }
}
