//! Hinges: pendulums, rods, chains and grids.

use alloc::vec::Vec;

use super::Scene;
use super::builder::{Builder, build, rectangle, sleepless, weightless};
use lockstep2d::body::{BodyDef, BodyId, Filter, Geometry, MassSource, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rot, Vec2, fx_mul};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::Config;

/// Returns the shape with a filter by which it collides with nothing.
fn ghost(shape: ShapeDef) -> ShapeDef {
    shape.filter(Filter { category: 2, mask: 0, group: 0 })
}

pub(super) const PENDULUM: Scene =
    Scene::new("pendulum", 600, "a rod of 1 m swings by 0.1 rad with the period of theory", |_| {
        build(Config::default(), |scene| {
            let pivot = scene.spawn(BodyDef::fixed(), &[])?;
            let angle = Angle::from_radians(fx!(0.1));
            let hanging = Rot::from_angle(angle).apply_wide(Vec2::new(fx!(0), fx!(-0.5)));
            let rod = rectangle(fx!(0.02), fx!(0.5))?.density(fx!(25));
            let body = BodyDef::dynamic().position(hanging).angle(angle);
            let rod = scene.spawn(body, &[ghost(rod)])?;
            scene.joint(JointDef::new(pivot, rod, Revolute::new()).anchor_b((fx!(0), fx!(0.5))))?;
            Ok(())
        })
    });

pub(super) const SPINNING_ROD: Scene =
    Scene::new("spinning_rod", 600, "a rod of 1 m, pinned at its end, starts at 20 rad/s", |_| rod(fx!(0.5)));

pub(super) const LONG_ARM: Scene = Scene::new(
    "long_arm",
    600,
    "the same rod with its pin 16 radii of gyration away: 92 m/s on a circle",
    // The arm is 16 radii of gyration long: 16 / sqrt(12) m.
    |_| rod(fx!(4.618802153517)),
);

/// A rod of 1 m and 1 kg that rotates at 20 rad/s. It is pinned `arm` metres from its centre.
fn rod(arm: Fx) -> lockstep2d::lockstep::SandboxSetup {
    build(weightless(), |scene| {
        let pivot = scene.spawn(BodyDef::fixed(), &[])?;
        let shape = rectangle(fx!(0.5), fx!(0.02))?;
        let omega = fx!(20);
        // The radius of gyration of a thin rod of 1 m is 1 / sqrt(12) m.
        let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.288675134595) };
        let body = BodyDef::dynamic().position((arm, fx!(0))).velocity((fx!(0), fx_mul(omega, arm)));
        let rod = scene.spawn(body.angular_velocity(omega).mass(mass), &[ghost(shape)])?;
        scene.joint(JointDef::new(pivot, rod, Revolute::new()).anchor_b((-arm, fx!(0))))?;
        Ok(())
    })
}

pub(super) const CHAIN: Scene =
    Scene::new("chain", 900, "100 links with a hundredfold weight at the end, released horizontally", |_| {
        build(Config::default(), |scene| {
            let anchor = scene.spawn(BodyDef::fixed(), &[])?;
            let link = ghost(rectangle(fx!(0.5), fx!(0.125))?);
            let last = row(scene, anchor, link, fx!(0), 100)?;
            // A link weighs 0.25 kg, and this square 25 kg.
            let weight = ghost(rectangle(fx!(2.5), fx!(2.5))?);
            let body = scene.spawn(BodyDef::dynamic().position((fx!(102.5), fx!(0))), &[weight])?;
            scene.joint(pin(last, body).anchor_a((fx!(0.5), fx!(0))).anchor_b((fx!(-2.5), fx!(0))))?;
            Ok(())
        })
    })
    .golden(400);

pub(super) const BRIDGE: Scene =
    Scene::new("bridge", 900, "ten boxes fall on a bridge of 50 planks between two posts", |_| {
        build(Config::default(), |scene| {
            let post = |x| Ok::<_, WorldError>([rectangle(fx!(0.5), fx!(1))?.offset((x, fx!(0)))]);
            let left = scene.spawn(BodyDef::fixed().position((fx!(-25), fx!(0))), &post(fx!(-0.5))?)?;
            let right = scene.spawn(BodyDef::fixed().position((fx!(25), fx!(0))), &post(fx!(0.5))?)?;
            let last = row(scene, left, rectangle(fx!(0.5), fx!(0.125))?, fx!(-25), 50)?;
            scene.joint(pin(last, right).anchor_a((fx!(0.5), fx!(0))))?;
            let places = (0..10).map(|i| Vec2::new(Fx::from_num(4 * i - 18), fx!(2)));
            scene.spawn_each(BodyDef::dynamic(), &[rectangle(fx!(0.5), fx!(0.5))?], places)?;
            Ok(())
        })
    })
    .golden(300);

/// A hinge between the origins of two bodies.
fn pin(a: BodyId, b: BodyId) -> JointDef {
    JointDef::new(a, b, Revolute::new())
}

/// Adds a horizontal row of `count` pieces, each 1 m long, from `x` to the right. Hinges connect neighbouring pieces,
/// and the first piece with the origin of `start`. Returns the last piece.
fn row(scene: &mut Builder, start: BodyId, piece: ShapeDef, x: Fx, count: i32) -> Result<BodyId, WorldError> {
    let places = (0..count).map(|i| Vec2::new(x + Fx::from_num(i) + fx!(0.5), fx!(0)));
    let pieces = scene.spawn_each(BodyDef::dynamic(), &[piece], places)?;
    let (first, last) = (pieces[0], pieces[pieces.len() - 1]);
    scene.joint(pin(start, first).anchor_b((fx!(-0.5), fx!(0))))?;
    let joint = pin(first, last).anchor_a((fx!(0.5), fx!(0))).anchor_b((fx!(-0.5), fx!(0)));
    scene.joint_each(joint, neighbours(&pieces))?;
    Ok(last)
}

/// Pairs each body with the next one.
fn neighbours(ids: &[BodyId]) -> Vec<(BodyId, BodyId)> {
    ids.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

pub(super) const JOINT_GRID: Scene =
    Scene::new("joint_grid", 500, "a cloth of 100 x 100 discs and 19 794 hinges hangs from seven", |_| {
        build(sleepless(), fill_grid)
    })
    .golden(50);

fn fill_grid(scene: &mut Builder) -> Result<(), WorldError> {
    let filter = Filter { category: 2, mask: !2, group: 0 };
    let disc = ShapeDef::new(Geometry::circle(fx!(0.4))?).filter(filter);
    let place = |k: i32, i: i32| Vec2::new(Fx::from_num(k), Fx::from_num(-i));
    let is_held = |k: i32| (47..=53).contains(&k);
    let mut columns: Vec<Vec<BodyId>> = Vec::new();
    for k in 0..100 {
        let top = if is_held(k) { BodyDef::fixed() } else { BodyDef::dynamic() };
        let mut column = scene.spawn_each(top, &[disc], [place(k, 0)])?;
        column.extend(scene.spawn_each(BodyDef::dynamic(), &[disc], (1..100).map(|i| place(k, i)))?);
        columns.push(column);
    }
    let down: Vec<_> = columns.iter().flat_map(|column| neighbours(column)).collect();
    let joint = pin(down[0].0, down[0].1).anchor_a((fx!(0), fx!(-0.5))).anchor_b((fx!(0), fx!(0.5)));
    scene.joint_each(joint, down)?;
    let mut across = Vec::new();
    for (k, pair) in (1..).zip(columns.windows(2)) {
        // A joint between two fixed discs is not needed.
        let from = usize::from(is_held(k) && is_held(k - 1));
        across.extend(pair[0].iter().copied().zip(pair[1].iter().copied()).skip(from));
    }
    let joint = pin(across[0].0, across[0].1).anchor_a((fx!(0.5), fx!(0))).anchor_b((fx!(-0.5), fx!(0)));
    scene.joint_each(joint, across)?;
    Ok(())
}
