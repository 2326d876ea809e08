//! Hinges: pendulums, rods, chains and grids.

use alloc::vec::Vec;

use super::Scene;
use super::builder::{build, rectangle, weightless};
use crate::body::{BodyDef, Filter, Geometry, MassSource, ShapeDef};
use crate::fx;
use crate::math::{Angle, Fx, Rot, Vec2, fx_mul};
use crate::solver::{JointDef, Revolute};
use crate::world::Config;

/// A shape that collides with nothing.
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
            let body = BodyDef::dynamic().position(hanging.x, hanging.y).angle(angle);
            let rod = scene.spawn(body, &[ghost(rod)])?;
            scene.joint(JointDef::new(pivot, rod, Revolute::new()).anchor_b(fx!(0), fx!(0.5)))?;
            Ok(())
        })
    });

pub(super) const SPINNING_ROD: Scene =
    Scene::new("spinning_rod", 600, "a rod of 1 m, pinned at its end, starts at 20 rad/s", |_| rod(fx!(0.5)));

pub(super) const LONG_ARM: Scene = Scene::new(
    "long_arm",
    600,
    "the same rod with its pin 16 radii of gyration away: 92 m/s on a circle",
    // 16 / sqrt(12)
    |_| rod(fx!(4.618802153517)),
);

/// A rod of 1 m and 1 kg whose pin is `arm` metres from its centre, at 20 rad/s, without gravity.
fn rod(arm: Fx) -> crate::lockstep::SandboxSetup {
    build(weightless(), |scene| {
        let pivot = scene.spawn(BodyDef::fixed(), &[])?;
        let shape = rectangle(fx!(0.5), fx!(0.02))?;
        let omega = fx!(20);
        // k = 1 / sqrt(12): a thin rod.
        let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.288675134595) };
        let body = BodyDef::dynamic().position(arm, fx!(0)).velocity(fx!(0), fx_mul(omega, arm));
        let rod = scene.spawn(body.angular_velocity(omega).mass(mass), &[ghost(shape)])?;
        scene.joint(JointDef::new(pivot, rod, Revolute::new()).anchor_b(-arm, fx!(0)))?;
        Ok(())
    })
}

pub(super) const CHAIN: Scene =
    Scene::new("chain", 900, "100 links with a hundredfold weight at the end, released horizontally", |_| {
        build(Config::default(), |scene| {
            let mut last = scene.spawn(BodyDef::fixed(), &[])?;
            let link = ghost(rectangle(fx!(0.5), fx!(0.125))?);
            let mut anchor = fx!(0);
            for i in 0..100 {
                let x = Fx::from_num(i) + fx!(0.5);
                let body = scene.spawn(BodyDef::dynamic().position(x, fx!(0)), &[link])?;
                scene.joint(
                    JointDef::new(last, body, Revolute::new())
                        .anchor_a(anchor, fx!(0))
                        .anchor_b(fx!(-0.5), fx!(0)),
                )?;
                (last, anchor) = (body, fx!(0.5));
            }
            // A link weighs 0.25 kg, and this 25: a square of 2.5 m, pinned at its edge.
            let weight = ghost(rectangle(fx!(2.5), fx!(2.5))?);
            let body = scene.spawn(BodyDef::dynamic().position(fx!(102.5), fx!(0)), &[weight])?;
            scene.joint(
                JointDef::new(last, body, Revolute::new())
                    .anchor_a(anchor, fx!(0))
                    .anchor_b(fx!(-2.5), fx!(0)),
            )?;
            Ok(())
        })
    });

pub(super) const JOINT_GRID: Scene =
    Scene::new("joint_grid", 500, "a cloth of 100 x 100 discs and 19 800 hinges hangs from seven", |_| {
        build(Config::default(), |scene| {
            let filter = Filter { category: 2, mask: !2, group: 0 };
            let disc = ShapeDef::new(Geometry::circle(fx!(0.4))?).filter(filter);
            let mut ids = Vec::new();
            for k in 0..100 {
                for i in 0..100 {
                    let held = i == 0 && (47..=53).contains(&k);
                    let body = if held { BodyDef::fixed() } else { BodyDef::dynamic() };
                    let body = scene.spawn(body.position(Fx::from_num(k), Fx::from_num(-i)), &[disc])?;
                    if i > 0 {
                        let above = ids[ids.len() - 1];
                        let joint = JointDef::new(above, body, Revolute::new());
                        scene.joint(joint.anchor_a(fx!(0), fx!(-0.5)).anchor_b(fx!(0), fx!(0.5)))?;
                    }
                    // Two held discs side by side have nothing to join.
                    let left_held = i == 0 && (48..=53).contains(&k);
                    if k > 0 && !left_held {
                        let left = ids[ids.len() - 100];
                        let joint = JointDef::new(left, body, Revolute::new());
                        scene.joint(joint.anchor_a(fx!(0.5), fx!(0)).anchor_b(fx!(-0.5), fx!(0)))?;
                    }
                    ids.push(body);
                }
            }
            Ok(())
        })
    });
