//! Measures the cost of rollback: a save and a hash in every tick, and a restore followed by a resimulation.

use anyhow::{Result, anyhow};
use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Config, World};
use lockstep2d_scenes::Builder;
use serde::Serialize;

use crate::measure::timed;
use crate::script::{Event, Script};
use crate::stats::median;

/// Number of ticks of a rollback.
const TICKS: usize = 8;
const TIMES: usize = 5;

#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    pub scene: String,
    /// CPU time of a step in ms, averaged over the ticks that are rolled back.
    pub step_ms: f64,
    /// CPU time of a save, in ms.
    pub save_ms: f64,
    /// CPU time of a hash, in ms.
    pub hash_ms: f64,
    /// CPU time of a restore, in ms.
    pub restore_ms: f64,
    /// CPU time of a save and a hash, in percent of a step.
    pub save_and_hash_percent: f64,
    /// CPU time of a restore and 8 ticks with saves and hashes, as a multiple of the time of a step.
    pub rollback_steps: f64,
    /// Number of bytes of a save that are not shared with the world.
    pub save_bytes: usize,
    /// `save_bytes` divided by the number of dynamic bodies.
    pub save_bytes_per_body: f64,
    /// Length of `World::to_bytes`, in bytes.
    pub file_bytes: usize,
}

/// Memory of a save per object, in bytes.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Bytes {
    /// Bytes per dynamic body with one shape and without contacts.
    pub body: f64,
    /// Bytes per pair of shapes with contact points.
    pub contact: f64,
    /// Bytes per hinge.
    pub joint: f64,
}

pub fn cost(name: &str, steps: Option<u64>) -> Result<Cost> {
    let script = Script::of_scene(name, steps)?;
    let mut world = built(&script)?;
    let (before, last) = script.ticks.split_at(script.steps().saturating_sub(TICKS));
    before.iter().try_for_each(|events| advance(&mut world, events))?;

    let start = world.save();
    let mut saves = vec![start.clone(); TICKS];
    let (mut save, mut hash, mut restore) = (Vec::new(), Vec::new(), Vec::new());
    let (mut steps, mut rollback) = (vec![Vec::new(); TICKS], Vec::new());
    for _ in 0..TIMES {
        let (restoring, ()) = timed(|| world.restore(&start));
        restore.push(restoring);
        let mut resimulating = 0.0;
        for (tick, events) in last.iter().enumerate() {
            execute(&mut world, events)?;
            let (stepping, ()) = timed(|| world.step());
            // Like a game, keeps one save for each tick of the rollback window, and reuses the memory of these saves.
            let (saving, ()) = timed(|| world.save_into(&mut saves[tick]));
            let (hashing, _) = timed(|| world.state_hash());
            resimulating += stepping + saving + hashing;
            steps[tick].push(stepping);
            save.push(saving);
            hash.push(hashing);
        }
        rollback.push(restoring + resimulating);
    }
    // The median is taken for each tick, because ticks differ: some create bodies or joints.
    let step_ms = steps.iter().map(|times| median(times)).sum::<f64>() / TICKS as f64;
    let [save_ms, hash_ms, restore_ms] = [&save, &hash, &restore].map(|times| median(times));
    let save_bytes = save_bytes(&world);
    let dynamic = world.bodies().filter(|(_, body)| body.is_dynamic()).count();
    Ok(Cost {
        scene: name.into(),
        step_ms,
        save_ms,
        hash_ms,
        restore_ms,
        save_and_hash_percent: (save_ms + hash_ms) / step_ms * 100.0,
        rollback_steps: median(&rollback) / step_ms,
        save_bytes,
        save_bytes_per_body: save_bytes as f64 / dynamic.max(1) as f64,
        file_bytes: world.to_bytes().len(),
    })
}

fn built(script: &Script) -> Result<World> {
    let mut world = World::new(script.config).map_err(|error| anyhow!("{error}"))?;
    execute(&mut world, &script.setup)?;
    Ok(world)
}

fn execute(world: &mut World, events: &[Event]) -> Result<()> {
    for (command, _) in events {
        world.execute(command).map_err(|error| anyhow!("{error}"))?;
    }
    Ok(())
}

fn advance(world: &mut World, events: &[Event]) -> Result<()> {
    execute(world, events)?;
    world.step();
    Ok(())
}

/// Number of bytes of a save that are not shared with the world.
fn save_bytes(world: &World) -> usize {
    world.save().rollback_bytes()
}

/// Measures the bytes in three kinds of worlds: with bodies only, with bodies and contacts, and with bodies and joints.
pub fn bytes() -> Result<Bytes> {
    let few = save_bytes(&scattered(1000)?) as f64;
    let many = save_bytes(&scattered(9000)?) as f64;
    let body = (many - few) / 8000.0;
    let rest_of = |name: &str| -> Result<(f64, World)> {
        let script = Script::of_scene(name, Some(4))?;
        let mut world = built(&script)?;
        script.ticks.iter().try_for_each(|events| advance(&mut world, events))?;
        Ok((save_bytes(&world) as f64 - body * world.body_count() as f64, world))
    };
    let (contacts, world) = rest_of("large_pyramid")?;
    let contact =
        contacts / world.contacts().filter(|contact| !contact.manifold.points().is_empty()).count() as f64;
    let (joints, world) = rest_of("joint_grid")?;
    Ok(Bytes { body, contact, joint: joints / world.joint_count() as f64 })
}

/// A world of boxes 10 m apart, after one step.
fn scattered(count: u32) -> Result<World> {
    let mut scene = Builder::new(Config { gravity: Vec2::ZERO, ..Config::default() });
    let fill = |scene: &mut Builder| {
        let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
        let places =
            (0..count).map(|i| Vec2::new(Fx::from_num(10 * (i % 100)), Fx::from_num(10 * (i / 100))));
        scene.spawn_each(BodyDef::dynamic(), &[square], places)
    };
    fill(&mut scene).map_err(|error| anyhow!("{error}"))?;
    let script = Script::of_setup(scene.finish(), 1)?;
    let mut world = built(&script)?;
    world.step();
    Ok(world)
}

pub fn head() -> String {
    format!(
        "{:14} {:>8} {:>8} {:>8} {:>10} {:>11} {:>14} {:>11} {:>11} {:>10}",
        "scene",
        "step ms",
        "save ms",
        "hash ms",
        "restore ms",
        "save+hash %",
        "8 ticks, steps",
        "save bytes",
        "per body",
        "file bytes"
    )
}

pub fn row(cost: &Cost) -> String {
    format!(
        "{:14} {:8.2} {:8.3} {:8.3} {:10.3} {:11.1} {:14.2} {:11} {:11.0} {:10}",
        cost.scene,
        cost.step_ms,
        cost.save_ms,
        cost.hash_ms,
        cost.restore_ms,
        cost.save_and_hash_percent,
        cost.rollback_steps,
        cost.save_bytes,
        cost.save_bytes_per_body,
        cost.file_bytes
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rollback_of_eight_ticks_costs_at_least_them() {
        let cost = cost("tumbler", Some(40)).unwrap();
        assert!(cost.rollback_steps > 6.0 && cost.save_and_hash_percent > 0.0, "{cost:?}");
        assert!(cost.file_bytes > 2026 * 100, "{cost:?}");
    }

    #[test]
    fn bytes_are_told_apart() {
        let bytes = bytes().unwrap();
        assert_eq!(bytes.body, 52.0);
        // The sum also contains 8 bytes for each contact without points, but is divided by the number of contacts with
        // points.
        assert!((88.0..90.0).contains(&bytes.contact), "{bytes:?}");
        // A joint takes a byte of flags, 4 bytes for its whole turns, and 4 bytes for each impulse that is not 0.
        assert!((5.0..=13.0).contains(&bytes.joint), "{bytes:?}");
    }
}
