//! Counts the instructions of a step with callgrind. The counts depend neither on caches nor on the load of the
//! machine.

use std::process::Command;

use anyhow::{Context, Result, anyhow, ensure};
use serde::Serialize;

use crate::engine::Kind;
use crate::growth::{Plan, World};
use crate::script::Script;
use crate::stats::power;

#[derive(Clone, Debug, Serialize)]
pub struct Growth {
    pub world: &'static str,
    /// Points in the order of the sizes.
    pub points: Vec<Point>,
    /// Exponent `p` of the fit `n^p`.
    pub p: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct Point {
    /// Number of dynamic bodies.
    pub bodies: usize,
    /// Number of instructions of a step, in millions.
    pub millions: f64,
}

/// Counts the instructions of the timed steps: the difference between a full run and a run without the timed steps.
pub fn measure(world: World, plan: &Plan) -> Result<Growth> {
    let mut points = Vec::new();
    for &size in &plan.sizes {
        let (bodies, start) = count(world, size, plan.untimed)?;
        let (_, end) = count(world, size, plan.untimed + plan.steps)?;
        points.push(Point { bodies, millions: (end - start) / plan.steps as f64 / 1e6 });
    }
    let p = power(&points.iter().map(|point| (point.bodies as f64, point.millions)).collect::<Vec<_>>());
    Ok(Growth { world: world.name, points, p })
}

/// Runs [`step`] under callgrind. Returns the numbers of dynamic bodies and of instructions.
fn count(world: World, size: u32, steps: u64) -> Result<(usize, f64)> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(std::env::current_exe()?)
        .args(["step", world.name, &size.to_string(), &steps.to_string()])
        .output()
        .context("cannot start valgrind: is it installed?")?;
    let log = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{} of {size}: {log}", world.name);
    let bodies = String::from_utf8_lossy(&output.stdout).trim().parse()?;
    let collected = log.lines().find_map(|line| line.split_once("Collected : "));
    let (_, collected) =
        collected.with_context(|| format!("callgrind reported no instruction count: {log}"))?;
    Ok((bodies, collected.trim().parse()?))
}

/// Steps a world, and returns its number of dynamic bodies.
pub fn step(world: World, size: u32, steps: u64, kind: Kind) -> Result<usize> {
    let setup = (world.setup)(size).map_err(|error| anyhow!("{} of {size}: {error}", world.name))?;
    let mut engine = kind.build(&Script::of_setup(setup, 0)?, 1)?;
    (0..steps).for_each(|_| engine.step());
    Ok(engine.bodies().iter().filter(|body| body.dynamic).count())
}

pub fn table(growths: &[Growth]) -> String {
    let mut text = format!("{:9} {:>6}  million instructions per step (bodies)\n", "world", "p");
    for Growth { world, points, p } in growths {
        let point = |point: &Point| format!("{:.1} ({})", point.millions, point.bodies);
        let points: Vec<_> = points.iter().map(point).collect();
        text += &format!("{world:9} {p:6.3}  {}\n", points.join("  "));
    }
    text
}
