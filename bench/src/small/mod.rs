//! Measures worlds of the size of games: the time of a step, and the time of a rollback frame.

mod frame;
mod worlds;

use anyhow::{Result, anyhow, ensure};
use indicatif::ProgressBar;
use lockstep2d::world::Config;
use serde::Serialize;

use crate::engine::{Engine, Inventory, Kind};
use crate::growth::World;
use crate::measure::timed;
use crate::script::Script;
use crate::stats::{geometric_mean, median};

pub use frame::{frame, frame_head, frame_row};

/// Worlds that are measured at every size.
pub const WORLDS: [World; 9] = [
    World { name: "boxes", setup: worlds::boxes },
    World { name: "polygons", setup: worlds::polygons },
    World { name: "balls", setup: worlds::balls },
    World { name: "capsules", setup: worlds::capsules },
    World { name: "mixed", setup: worlds::mixed },
    World { name: "ragdolls", setup: worlds::ragdolls },
    World { name: "drum", setup: worlds::drum },
    World { name: "cars", setup: worlds::cars },
    World { name: "bridges", setup: worlds::bridges },
];
/// Worlds that are measured at one size.
pub const SINGLE: [(World, u32); 2] = [
    (World { name: "ragdoll", setup: worlds::ragdolls }, 6),
    (World { name: "stack", setup: worlds::stack }, 10),
];
/// Approximate numbers of bodies.
pub const SIZES: [u32; 4] = [6, 24, 96, 384];
/// Number of steps before the timed ones.
const UNTIMED: usize = 120;
const TIMED: usize = 480;

/// Default settings, without sleeping.
fn config() -> Config {
    Config { sleeping: false, ..Config::default() }
}

#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    pub world: &'static str,
    /// Number of dynamic bodies.
    pub bodies: usize,
    /// CPU time of a step of lockstep2d in microseconds, median of the rounds.
    pub us: f64,
    /// CPU time of a step of Box2D in microseconds.
    pub box2d_us: f64,
    /// CPU time of a step of rapier2d in microseconds.
    pub rapier_us: f64,
    /// Median ratio to Box2D.
    pub vs_box2d: f64,
    /// Median ratio to rapier2d.
    pub vs_rapier: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct Summary {
    /// Always true. Distinguishes the summary from the line of a cell.
    pub summary: bool,
    /// Geometric mean of the ratios to Box2D.
    pub geomean_vs_box2d: Option<f64>,
    /// Geometric mean of the ratios to rapier2d.
    pub geomean_vs_rapier: Option<f64>,
    /// Largest ratio to Box2D.
    pub worst_vs_box2d: Option<f64>,
    /// Largest ratio to rapier2d.
    pub worst_vs_rapier: Option<f64>,
}

/// Worlds and their approximate numbers of bodies.
pub fn all() -> impl Iterator<Item = (World, u32)> {
    WORLDS.into_iter().flat_map(|world| SIZES.map(|size| (world, size))).chain(SINGLE)
}

/// Worlds whose rollback frame is measured.
pub fn frames() -> impl Iterator<Item = (World, u32)> {
    let [boxes, polygons, _, _, mixed, ragdolls, ..] = WORLDS;
    [boxes, polygons, mixed, ragdolls].into_iter().flat_map(|world| [24, 150, 400].map(|size| (world, size)))
}

/// Measures every engine, in interleaved rounds.
pub fn cell(world: World, size: u32, rounds: usize, progress: &ProgressBar) -> Result<Cell> {
    let script = script(world, size)?;
    let mut times: [Vec<f64>; 3] = Default::default();
    let mut worlds = Vec::new();
    for round in 1..=rounds {
        for kind in Kind::ALL {
            progress.set_message(format!("{} of {size}: {}, round {round}", world.name, kind.name()));
            let mut engine = kind.build(&script, 1)?;
            (0..UNTIMED).for_each(|_| engine.step());
            let (ms, ()) = timed(|| (0..TIMED).for_each(|_| engine.step()));
            times[kind as usize].push(ms * 1e3 / TIMED as f64);
            worlds.push(Inventory::of(&*engine));
            progress.inc(1);
        }
    }
    let like = worlds.iter().all(|other| worlds[0].is_like(other));
    ensure!(like, "{} of {size}: the engines have different worlds: {:?}", world.name, &worlds[..3]);
    let ratio = |other: usize| {
        median(&times[0].iter().zip(&times[other]).map(|(ours, other)| ours / other).collect::<Vec<_>>())
    };
    let [us, box2d_us, rapier_us] = times.each_ref().map(|times| median(times));
    let bodies = dynamic(&*Kind::Ours.build(&script, 1)?);
    Ok(Cell { world: world.name, bodies, us, box2d_us, rapier_us, vs_box2d: ratio(1), vs_rapier: ratio(2) })
}

fn script(world: World, size: u32) -> Result<Script> {
    let setup = (world.setup)(size).map_err(|error| anyhow!("{} of {size}: {error}", world.name))?;
    Script::of_setup(setup, 0)
}

fn dynamic(engine: &dyn Engine) -> usize {
    engine.bodies().iter().filter(|body| body.dynamic).count()
}

pub fn summary(cells: &[Cell]) -> Summary {
    let of = |part: fn(&Cell) -> f64| cells.iter().map(part).collect::<Vec<_>>();
    let (box2d, rapier) = (of(|cell| cell.vs_box2d), of(|cell| cell.vs_rapier));
    let worst = |ratios: &[f64]| ratios.iter().copied().max_by(f64::total_cmp);
    Summary {
        summary: true,
        geomean_vs_box2d: geometric_mean(&box2d),
        geomean_vs_rapier: geometric_mean(&rapier),
        worst_vs_box2d: worst(&box2d),
        worst_vs_rapier: worst(&rapier),
    }
}

pub fn head() -> String {
    format!(
        "{:10} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "world", "bodies", "ours us", "Box2D us", "rapier us", "vs Box2D", "vs rapier"
    )
}

pub fn row(cell: &Cell) -> String {
    format!(
        "{:10} {:6} {:9.1} {:9.1} {:9.1} {:9.2} {:9.2}",
        cell.world, cell.bodies, cell.us, cell.box2d_us, cell.rapier_us, cell.vs_box2d, cell.vs_rapier
    )
}

pub fn summary_rows(summary: &Summary) -> String {
    let optional = |value: Option<f64>| value.map_or_else(|| "-".into(), |value| format!("{value:.2}"));
    format!(
        "{:46} {:>9} {:>9}\n{:46} {:>9} {:>9}",
        "geometric mean",
        optional(summary.geomean_vs_box2d),
        optional(summary.geomean_vs_rapier),
        "worst",
        optional(summary.worst_vs_box2d),
        optional(summary.worst_vs_rapier)
    )
}
