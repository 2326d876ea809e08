//! Runs a scene in every engine, in interleaved rounds, and compares the times.

use anyhow::{Context, Result, bail, ensure};
use indicatif::ProgressBar;
use serde::Serialize;

use crate::engine::{Inventory, Kind};
use crate::measure::{EndState, Keeping, Times, end_state, keeping, run};
use crate::script::Script;
use crate::stats::{geometric_mean, median, quartiles};

/// Number of steps of the warm-up run of each engine.
const WARM_UP: u64 = 20;

#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Number of runs of each engine.
    pub rounds: usize,
    /// Number of threads of each engine.
    pub threads: usize,
    /// Largest number of steps, or `None` for the whole scene.
    pub steps: Option<u64>,
}

impl Plan {
    /// Number of runs of a scene, including warm-ups, for the progress bar.
    pub fn runs(&self) -> u64 {
        ((self.rounds + 1) * Kind::ALL.len()) as u64
    }
}

/// A value for each engine.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Each<T> {
    pub ours: T,
    pub box2d: T,
    pub rapier: T,
}

/// Results of a scene, printed as one line of JSON. A ratio is lockstep2d's time divided by the other engine's time.
#[derive(Clone, Debug, Serialize)]
pub struct SceneResult {
    pub scene: String,
    /// Number of simulated steps. The first one is not timed.
    pub steps: usize,
    /// Number of runs of each engine.
    pub rounds: usize,
    /// Number of threads of each engine.
    pub threads: usize,
    /// Time per step in ms, median of the rounds. This is CPU time with one thread, and wall-clock time with more.
    pub ms: f64,
    /// Time per step of Box2D, measured like `ms`.
    pub box2d_ms: f64,
    /// Time per step of rapier2d, measured like `ms`.
    pub rapier_ms: Option<f64>,
    /// Median ratio to Box2D.
    pub vs_box2d: f64,
    /// First and third quartile of the ratios to Box2D.
    pub vs_box2d_quartiles: [f64; 2],
    /// Median ratio to rapier2d.
    pub vs_rapier: Option<f64>,
    /// First and third quartile of the ratios to rapier2d.
    pub vs_rapier_quartiles: Option<[f64; 2]>,
    /// Wall-clock time per step in ms.
    pub wall_ms: Each<Option<f64>>,
    /// CPU time of the commands between steps, in ms per step. No other value includes it.
    pub commands_ms: Each<Option<f64>>,
    /// State after the last step.
    pub end: Each<Option<EndState>>,
    /// Cost of saving, restoring and hashing a whole world.
    pub keeping: Each<Option<Keeping>>,
    /// Reasons why the results of an engine are missing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<String>,
}

/// Last line of JSON.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Summary {
    /// Always true. Distinguishes the summary from the line of a scene.
    pub summary: bool,
    pub scenes: usize,
    /// Geometric mean of the scenes' ratios to Box2D.
    pub geomean_vs_box2d: Option<f64>,
    /// Geometric mean of the scenes' ratios to rapier2d, over the scenes that rapier2d runs.
    pub geomean_vs_rapier: Option<f64>,
    /// Largest of the scenes' ratios to Box2D.
    pub worst_vs_box2d: Option<f64>,
}

#[derive(Default)]
struct Runs {
    times: Vec<Times>,
    end: Option<EndState>,
    keeping: Option<Keeping>,
}

impl Runs {
    /// Times that are compared: CPU times with one thread, wall-clock times with more.
    fn compared(&self, threads: usize) -> Vec<f64> {
        self.times.iter().map(|times| if threads == 1 { times.cpu } else { times.wall }).collect()
    }

    fn middle(&self, part: impl Fn(&Times) -> f64) -> Option<f64> {
        let values: Vec<_> = self.times.iter().map(part).collect();
        (!values.is_empty()).then(|| median(&values))
    }
}

/// Runs a scene in every engine.
pub fn scene(name: &str, plan: Plan, progress: &ProgressBar) -> Result<SceneResult> {
    let script = Script::of_scene(name, plan.steps)?;
    let warm_up = Script::of_scene(name, Some(WARM_UP.min(script.steps() as u64)))?;
    let mut missing = Vec::new();
    let (mut kinds, mut worlds) = (Vec::new(), Vec::new());
    for kind in Kind::ALL {
        progress.set_message(format!("{name}: {}, warming up", kind.name()));
        match run(kind, &warm_up, plan.threads) {
            Ok((_, engine)) => {
                worlds.push(Inventory::of(&*engine));
                kinds.push(kind);
            }
            Err(why) => missing.push(format!("{}: {why:#}", kind.name())),
        }
        progress.inc(1);
    }
    for (kind, world) in kinds.iter().zip(&worlds) {
        ensure!(worlds[0].is_like(world), "scene {name} in {}: {world:?}, not {:?}", kind.name(), worlds[0]);
    }
    let mut runs: [Runs; 3] = Default::default();
    for round in 1..=plan.rounds {
        for &kind in &kinds {
            progress.set_message(format!("{name}: {}, round {round} of {}", kind.name(), plan.rounds));
            let runs = &mut runs[kind as usize];
            let (times, mut engine) = run(kind, &script, plan.threads)?;
            runs.times.push(times);
            if round == plan.rounds {
                runs.end = Some(end_state(&*engine));
                runs.keeping = Some(keeping(&mut *engine)?);
            }
            progress.inc(1);
        }
    }
    result(name, plan, script.steps(), &runs, missing)
}

fn result(
    name: &str,
    plan: Plan,
    steps: usize,
    runs: &[Runs; 3],
    missing: Vec<String>,
) -> Result<SceneResult> {
    let [ours, box2d, rapier] = runs;
    let times = runs.each_ref().map(|runs| runs.compared(plan.threads));
    let ratios = |other: &[f64]| -> Vec<f64> {
        times[0].iter().zip(other).map(|(ours, other)| ours / other).collect()
    };
    let (to_box2d, to_rapier) = (ratios(&times[1]), ratios(&times[2]));
    let with_rapier = !to_rapier.is_empty();
    if times[0].is_empty() || times[1].is_empty() {
        bail!("scene {name}: {}", missing.join("; "));
    }
    let each = |part: fn(&Times) -> f64| Each {
        ours: ours.middle(part),
        box2d: box2d.middle(part),
        rapier: rapier.middle(part),
    };
    Ok(SceneResult {
        scene: name.into(),
        steps,
        rounds: plan.rounds,
        threads: plan.threads,
        ms: median(&times[0]),
        box2d_ms: median(&times[1]),
        rapier_ms: with_rapier.then(|| median(&times[2])),
        vs_box2d: median(&to_box2d),
        vs_box2d_quartiles: quartiles(&to_box2d),
        vs_rapier: with_rapier.then(|| median(&to_rapier)),
        vs_rapier_quartiles: with_rapier.then(|| quartiles(&to_rapier)),
        wall_ms: each(|times| times.wall),
        commands_ms: each(|times| times.commands),
        end: Each { ours: ours.end, box2d: box2d.end, rapier: rapier.end },
        keeping: Each { ours: ours.keeping, box2d: box2d.keeping, rapier: rapier.keeping },
        missing,
    })
}

pub fn summary(results: &[SceneResult]) -> Summary {
    let to_box2d: Vec<_> = results.iter().map(|result| result.vs_box2d).collect();
    let to_rapier: Vec<_> = results.iter().filter_map(|result| result.vs_rapier).collect();
    Summary {
        summary: true,
        scenes: results.len(),
        geomean_vs_box2d: geometric_mean(&to_box2d),
        geomean_vs_rapier: geometric_mean(&to_rapier),
        worst_vs_box2d: to_box2d.iter().copied().max_by(f64::total_cmp),
    }
}

pub fn line(value: &impl Serialize) -> Result<String> {
    serde_json::to_string(value).context("cannot write the result as JSON")
}
