//! Measures a run of an engine: the time of its steps, its end state, and the cost of saving.

use std::time::Instant;

use anyhow::Result;
use serde::Serialize;

use crate::engine::{Engine, Kind};
use crate::script::Script;
use crate::stats::median;

/// Times in ms per step. The untimed first steps are left out.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    /// CPU time of the calling thread.
    pub cpu: f64,
    pub wall: f64,
    /// CPU time of the commands between steps.
    pub commands: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct EndState {
    /// Height of the highest dynamic body, in metres.
    pub top: f64,
    /// Height of the lowest dynamic body, in metres. Shows whether a body falls through the floor.
    pub bottom: f64,
    /// Deepest penetration of the last step, in mm.
    pub deepest_mm: f64,
    /// Mean speed of dynamic bodies in m/s. Sleeping bodies count as 0.
    pub mean_speed: f64,
    /// Largest speed of a dynamic body, in m/s.
    pub max_speed: f64,
    /// Number of pairs of shapes with contact points.
    pub contacts: usize,
    /// Largest distance between the anchors of a joint, in mm.
    pub joint_gap_mm: Option<f64>,
    /// Number of awake dynamic bodies.
    pub awake: usize,
}

/// Cost of saving, restoring and hashing the end state.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Keeping {
    /// CPU time of a save, in ms.
    pub save_ms: f64,
    /// CPU time of a restore, in ms.
    pub restore_ms: f64,
    /// CPU time of a hash, in ms, if the engine has one.
    pub hash_ms: Option<f64>,
    /// Size of the world as a file, in bytes.
    pub bytes: usize,
    /// `bytes` divided by the number of bodies that are not fixed.
    pub bytes_per_body: f64,
}

/// CPU time of the calling thread, in ms.
pub fn thread_ms() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is to a valid timespec.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
}

/// Returns the CPU time of a function in ms, and its result.
pub fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = thread_ms();
    let result = work();
    (thread_ms() - start, result)
}

/// Steps a world to the end of the script.
pub fn run(kind: Kind, script: &Script, threads: usize) -> Result<(Times, Box<dyn Engine>)> {
    let mut engine = kind.build(script, threads)?;
    let mut sum = Times { cpu: 0.0, wall: 0.0, commands: 0.0 };
    for (tick, events) in script.ticks.iter().enumerate() {
        let (commands, applied) = timed(|| events.iter().try_for_each(|event| engine.apply(event)));
        applied?;
        let clock = Instant::now();
        let (cpu, ()) = timed(|| engine.step());
        let wall = clock.elapsed().as_secs_f64() * 1e3;
        if tick >= script.untimed {
            sum = Times { cpu: sum.cpu + cpu, wall: sum.wall + wall, commands: sum.commands + commands };
        }
    }
    let steps = script.steps().saturating_sub(script.untimed).max(1) as f64;
    let times = Times { cpu: sum.cpu / steps, wall: sum.wall / steps, commands: sum.commands / steps };
    Ok((times, engine))
}

pub fn end_state(engine: &dyn Engine) -> EndState {
    let bodies = engine.bodies();
    let dynamic: Vec<_> = bodies.iter().filter(|body| body.dynamic).collect();
    let speeds: Vec<f64> = dynamic
        .iter()
        .map(|body| if body.awake { body.velocity[0].hypot(body.velocity[1]) } else { 0.0 })
        .collect();
    let heights = || dynamic.iter().map(|body| body.centre[1]);
    let contacts = engine.contacts();
    EndState {
        top: heights().fold(f64::NEG_INFINITY, f64::max),
        bottom: heights().fold(f64::INFINITY, f64::min),
        deepest_mm: contacts.deepest * 1e3,
        mean_speed: speeds.iter().sum::<f64>() / speeds.len().max(1) as f64,
        max_speed: speeds.iter().copied().fold(0.0, f64::max),
        contacts: contacts.pairs,
        joint_gap_mm: engine.joint_gap().map(|gap| gap * 1e3),
        awake: dynamic.iter().filter(|body| body.awake).count(),
    }
}

/// Cost of saving, restoring and hashing the current state: medians of five repetitions.
pub fn keeping(engine: &mut dyn Engine) -> Result<Keeping> {
    let (mut save, mut restore, mut hash) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..5 {
        save.push(timed(|| engine.save(0)).0);
        let (ms, restored) = timed(|| engine.restore(0));
        restored?;
        restore.push(ms);
        if let (ms, Some(_)) = timed(|| engine.hash()) {
            hash.push(ms);
        }
    }
    let bytes = engine.saved_bytes(0);
    Ok(Keeping {
        save_ms: median(&save),
        restore_ms: median(&restore),
        hash_ms: (!hash.is_empty()).then(|| median(&hash)),
        bytes,
        bytes_per_body: bytes as f64 / engine.bodies().len().max(1) as f64,
    })
}
