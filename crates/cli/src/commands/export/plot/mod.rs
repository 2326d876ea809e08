//! `export --plot`: energy, overlap, contact points, awake bodies and joint gaps over time.
#![expect(
    clippy::disallowed_types,
    clippy::float_arithmetic,
    reason = "nothing drawn flows back into a simulation"
)]
#![expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "pixels")]

mod axis;
mod chart;
mod curve;

use lockstep2d::lockstep::Game;
use lockstep2d::world::World;

use super::{Arguments, Output, Replay};
use crate::console::Console;
use crate::context::CommandResult;
use crate::energy::Measures;
use crate::figures;

use axis::Unit;
use chart::{Chart, Panel};
use curve::Curve;

/// Colours of curves. People with red-green colour blindness can distinguish the colours of the energy panel.
const BLUE: &str = "#1f5f9e";
const ORANGE: &str = "#d95f0e";
const INK: &str = "#333333";
const RED: &str = "#c62828";
const GREEN: &str = "#2e7d32";
const PURPLE: &str = "#8e24aa";

pub(super) fn write<G: Game>(
    mut replay: Replay<'_, G>,
    arguments: &Arguments,
    console: &mut Console<'_>,
) -> CommandResult {
    let (first, last) = replay.range(arguments)?;
    let mut panels = panels(first, last);
    let (mut joints, mut ticks) = (0, first..=last);
    let hash = loop {
        let Some(tick) = ticks.next() else { break replay.verified.game().state_hash() };
        replay.play_to(tick)?;
        let world = replay.world()?;
        joints = world.joint_count().max(joints);
        for (curve, value) in panels.iter_mut().flat_map(|panel| &mut panel.curves).zip(values(world)) {
            curve.add(tick, value);
        }
    };
    // Only differences of potential energy matter, so its curve and that of the total are shifted until the lowest
    // potential energy is 0.
    if let [potential, _, total] = &mut panels[0].curves[..] {
        let lowest = potential.lowest();
        [potential, total].into_iter().for_each(|curve| curve.shift(-lowest));
    }
    if joints == 0 {
        panels.pop();
    }
    let name = arguments.file.file_name().unwrap_or_default().to_string_lossy();
    let rate = replay.verified.game().tick_rate().max(1);
    let title = format!("{name} · ticks {first} to {last} at {rate} a second · {hash}");
    let (width, height) = (arguments.width.unwrap_or(chart::WIDTH), arguments.height);
    let document = Chart { title, panels, first, last, rate, width, height }.svg();
    Output::write(arguments, console, |output| output.line(document.trim_end()))
}

/// The panels without their values. The panel of joints comes last, because it is removed for worlds without joints.
fn panels(first: u64, last: u64) -> Vec<Panel> {
    let curve = |name, colour| Curve::new(name, colour, first, last);
    let panel = |title, unit, curves| Panel { title, unit, curves };
    vec![
        panel(
            "energy",
            Unit::Energy,
            vec![curve("potential", BLUE), curve("kinetic", ORANGE), curve("total", INK)],
        ),
        panel("deepest overlap", Unit::Length, vec![curve("overlap", RED)]),
        panel("contact points", Unit::Count, vec![curve("points", RED)]),
        panel("awake bodies", Unit::Count, vec![curve("awake", GREEN)]),
        panel("widest joint gap", Unit::Length, vec![curve("gap", PURPLE)]),
    ]
}

/// Values of all curves, in the order of the panels and their curves.
fn values(world: &World) -> [f64; 7] {
    let Measures { kinetic, potential, overlap, gap } = Measures::of(world);
    let figures = figures::of(world);
    let figure =
        |wanted| figures.iter().find(|(name, _)| *name == wanted).map_or(0.0, |(_, value)| *value as f64);
    [potential, kinetic, potential + kinetic, overlap, figure("points"), figure("awake"), gap]
}
