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

/// Number of frames in a round.
const FRAMES: usize = 20;

#[derive(Clone, Debug, Serialize)]
pub struct Frame {
    pub world: &'static str,
    /// Number of dynamic bodies.
    pub bodies: usize,
    /// CPU time of a frame of lockstep2d in microseconds, median of the rounds.
    pub frame_us: f64,
    /// Median ratio to Box2D.
    pub vs_box2d: f64,
    /// Median ratio to rapier2d.
    pub vs_rapier: f64,
    pub ours: Saving,
    pub box2d: Saving,
    pub rapier: Saving,
}

/// Cost of the saves and hashes of an engine.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Saving {
    /// CPU time of a save and its hash in microseconds.
    pub us: f64,
    /// CPU time of the saves and hashes in percent of a restore and eight steps.
    pub percent: f64,
    /// Memory of a save in bytes.
    pub bytes: usize,
}

struct Round {
    /// CPU time of a frame in microseconds.
    frame_us: f64,
    saving: Saving,
}

pub fn frame(world: World, size: u32, rounds: usize, progress: &ProgressBar) -> Result<Frame> {
    let script = script(world, size)?;
    let mut engines = Vec::new();
    for kind in Kind::ALL {
        let mut engine = kind.build(&script, 1)?;
        (0..UNTIMED).for_each(|_| engine.step());
        engines.push(engine);
    }
    let mut measured: [Vec<Round>; 3] = Default::default();
    for round in 1..=rounds {
        for kind in Kind::ALL {
            progress.set_message(format!("frame, {} of {size}: {}, round {round}", world.name, kind.name()));
            measured[kind as usize].push(measure(&mut *engines[kind as usize])?);
            progress.inc(1);
        }
    }
    let times =
        measured.each_ref().map(|rounds| rounds.iter().map(|round| round.frame_us).collect::<Vec<_>>());
    let ratio = |other: usize| {
        median(&times[0].iter().zip(&times[other]).map(|(ours, other)| ours / other).collect::<Vec<_>>())
    };
    let [ours, box2d, rapier] = measured.each_ref().map(|rounds| saving(rounds));
    Ok(Frame {
        world: world.name,
        bodies: dynamic(&*engines[0]),
        frame_us: median(&times[0]),
        vs_box2d: ratio(1),
        vs_rapier: ratio(2),
        ours,
        box2d,
        rapier,
    })
}

/// Medians of the rounds. All rounds save the same ticks, so the saves have the same sizes in each round.
fn saving(rounds: &[Round]) -> Saving {
    let of = |part: fn(&Saving) -> f64| {
        median(&rounds.iter().map(|round| part(&round.saving)).collect::<Vec<_>>())
    };
    Saving {
        us: of(|saving| saving.us),
        percent: of(|saving| saving.percent),
        bytes: rounds.last().map_or(0, |round| round.saving.bytes),
    }
}

/// Measures frames. Slot 0 has the save before the first tick of a frame, and slot `n` the save after its `n`th tick.
/// The time of saves and hashes is the difference between frames with and without them, because reading the clock takes
/// as long as saving a small world.
fn measure(engine: &mut dyn Engine) -> Result<Round> {
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
    let saving = Saving {
        us: (full - bare) * 1e3 / (FRAMES * (SAVES - 1)) as f64,
        percent: (full - bare) / bare * 100.0,
        bytes: engine.held_bytes(SAVES - 1),
    };
    engine.restore(0)?;
    Ok(Round { frame_us: full * 1e3 / FRAMES as f64, saving })
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

pub fn frame_head() -> String {
    format!(
        "{:10} {:>6} {:>9} {:>9} {:>9}  a save and its hash: ours, Box2D, rapier\n{:47}  {:>20} {:>21} {:>24}",
        "frame", "bodies", "ours us", "vs Box2D", "vs rapier", "", "us", "% of the rest", "bytes of the save"
    )
}

pub fn frame_row(frame: &Frame) -> String {
    let [ours, box2d, rapier] = [frame.ours, frame.box2d, frame.rapier];
    format!(
        "{:10} {:6} {:9.1} {:9.2} {:9.2}  {:6.1} {:6.1} {:6.1}  {:6.1} {:6.1} {:6.1}  {:7} {:7} {:8}",
        frame.world,
        frame.bodies,
        frame.frame_us,
        frame.vs_box2d,
        frame.vs_rapier,
        ours.us,
        box2d.us,
        rapier.us,
        ours.percent,
        box2d.percent,
        rapier.percent,
        ours.bytes,
        box2d.bytes,
        rapier.bytes
    )
}
