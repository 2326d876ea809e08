//! A rollback frame: restore, then eight times step, save and hash.

use std::hint::black_box;

use anyhow::Result;
use indicatif::ProgressBar;
use serde::Serialize;

use super::{UNTIMED, dynamic, script};
use crate::engine::{Engine, Kind, SAVES};
use crate::growth::World;
use crate::measure::timed;
use crate::stats::median;

/// Rollback frames in a round.
const FRAMES: usize = 20;

/// Cost of a rollback frame of a world.
#[derive(Clone, Debug, Serialize)]
pub struct Frame {
    /// Name of the world.
    pub world: &'static str,
    /// Number of dynamic bodies.
    pub bodies: usize,
    /// CPU time of a frame of lockstep2d in microseconds, median of the rounds.
    pub frame_us: f64,
    /// Median of the rounds' ratios of the frame to Box2D's.
    pub vs_box2d: f64,
    /// Median of the rounds' ratios of the frame to rapier2d's.
    pub vs_rapier: f64,
    /// CPU time of saves and hashes in lockstep2d, in percent of a restore and
    /// eight steps.
    pub save_and_hash_percent: f64,
    /// CPU time of saves and hashes in Box2D, in percent of its restore and steps.
    pub box2d_save_and_hash_percent: f64,
    /// CPU time of saves and hashes in rapier2d, in percent of its restore and steps.
    pub rapier_save_and_hash_percent: f64,
}

/// Measures the rollback frame of a world.
pub fn frame(world: World, size: u32, rounds: usize, progress: &ProgressBar) -> Result<Frame> {
    let script = script(world, size)?;
    let mut engines = Vec::new();
    for kind in Kind::ALL {
        let mut engine = kind.build(&script, 1)?;
        (0..UNTIMED).for_each(|_| engine.step());
        engines.push(engine);
    }
    let mut frames: [Vec<f64>; 3] = Default::default();
    let mut keeping: [Vec<f64>; 3] = Default::default();
    for round in 1..=rounds {
        for kind in Kind::ALL {
            progress.set_message(format!("frame, {} of {size}: {}, round {round}", world.name, kind.name()));
            let engine = &mut *engines[kind as usize];
            let (frame, percent) = measure(engine)?;
            frames[kind as usize].push(frame);
            keeping[kind as usize].push(percent);
            progress.inc(1);
        }
    }
    let ratio = |other: usize| {
        median(&frames[0].iter().zip(&frames[other]).map(|(ours, other)| ours / other).collect::<Vec<_>>())
    };
    let [ours, box2d, rapier] = keeping.each_ref().map(|percents| median(percents));
    Ok(Frame {
        world: world.name,
        bodies: dynamic(&*engines[0]),
        frame_us: median(&frames[0]),
        vs_box2d: ratio(1),
        vs_rapier: ratio(2),
        save_and_hash_percent: ours,
        box2d_save_and_hash_percent: box2d,
        rapier_save_and_hash_percent: rapier,
    })
}

/// Returns the mean time of a frame in microseconds, and the time of its saves and hashes in percent of the rest.
///
/// Slot 0 has the start of the frame, which is the same for all frames, and the others have its ticks. Saves are timed
/// as the difference to frames without them, because a clock takes as long as the save of a small world.
fn measure(engine: &mut dyn Engine) -> Result<(f64, f64)> {
    engine.save(0);
    let (bare, done) = timed(|| frames(engine, |_, _| {}));
    done?;
    let (full, done) = timed(|| {
        frames(engine, |engine, slot| {
            engine.save(slot);
            black_box(engine.checksum(slot));
        })
    });
    done?;
    engine.restore(0)?;
    Ok((full * 1e3 / FRAMES as f64, (full - bare) / bare * 100.0))
}

fn frames(engine: &mut dyn Engine, after_step: impl Fn(&mut dyn Engine, usize)) -> Result<()> {
    for _ in 0..FRAMES {
        engine.restore(0)?;
        for slot in 1..SAVES {
            engine.step();
            after_step(engine, slot);
        }
    }
    Ok(())
}

/// Returns the column heads of [`frame_row`].
pub fn frame_head() -> String {
    format!(
        "{:10} {:>6} {:>9} {:>9} {:>9}  save and hash, % of the rest: {:>5} {:>6} {:>7}",
        "frame", "bodies", "ours us", "vs Box2D", "vs rapier", "ours", "Box2D", "rapier"
    )
}

/// Formats the cost of a frame as a table row.
pub fn frame_row(frame: &Frame) -> String {
    format!(
        "{:10} {:6} {:9.1} {:9.2} {:9.2} {:34.1} {:6.1} {:7.1}",
        frame.world,
        frame.bodies,
        frame.frame_us,
        frame.vs_box2d,
        frame.vs_rapier,
        frame.save_and_hash_percent,
        frame.box2d_save_and_hash_percent,
        frame.rapier_save_and_hash_percent
    )
}
