//! `stats`: statistics of every tick of a replay.

use std::path::PathBuf;

use clap::Args;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Step, VerifiedReplay};

use crate::console::Console;
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::figures;
use crate::files::Shown;
use crate::panics;

/// Play a replay and print figures of its ticks: work, bodies, contacts and so on
#[derive(Args, Debug)]
#[command(
    after_help = "Work is the cost of a tick in work units: the game's estimate before the tick, and what the world \
                        counts during it. Faults are results that were clamped. Figures of tick t are of the state \
                        after t ticks, and of the step that led to it.\n\nExit code: 0 when all of it was played, 1 \
                        when it cannot be played to its end, 2 for wrong usage, or a file that cannot be read."
)]
pub(crate) struct Arguments {
    /// The replay
    pub(super) file: PathBuf,
    /// Print a line of JSON for each tick, instead of the largest and mean values
    #[arg(long)]
    json: bool,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let refused = CommandError::replay(&arguments.file);
    let bytes = context.load(&arguments.file)?;
    let mut replay = VerifiedReplay::<G>::open(&bytes, context.limits()).map_err(&refused)?;
    let mut summary = Summary::default();
    let failed = loop {
        let work_before = replay.work();
        match replay.step() {
            Ok(Step::Ticked) => panics::played(replay.tick()),
            Ok(Step::Ended) => break None,
            Err(verdict) => break Some(verdict),
        }
        let mut figures = vec![("work", replay.work() - work_before)];
        figures.extend(replay.world().into_iter().flat_map(figures::of));
        if arguments.json {
            context.console.line(line(replay.tick(), replay.game().state_hash(), &figures))?;
        }
        summary.add(replay.tick(), &figures);
    };
    if !arguments.json {
        let (file, ticks) = (Shown(&arguments.file), summary.ticks);
        // No hash is printed after a step that failed, because the game no longer has the state of the last valid tick.
        let state = match failed {
            None => format!(", state {}", replay.game().state_hash()),
            Some(_) => String::new(),
        };
        context.console.line(format_args!("{file}: {ticks} ticks{state}"))?;
        summary.print(&mut context.console)?;
    }
    failed.map_or(Ok(Exit::Success), |verdict| Err(refused(verdict)))
}

/// Formats a line of JSON. The names of the figures contain no characters that JSON would escape.
fn line(tick: u64, hash: StateHash, figures: &[(&str, u64)]) -> String {
    let mut line = format!("{{\"tick\":{tick},\"hash\":\"{hash}\"");
    line.extend(figures.iter().map(|(name, value)| format!(",\"{name}\":{value}")));
    line + "}"
}

#[derive(Default)]
struct Summary {
    ticks: u64,
    figures: Vec<Figure>,
}

struct Figure {
    name: &'static str,
    total: u128,
    largest: u64,
    /// The first tick with the largest value.
    tick: u64,
}

impl Summary {
    fn add(&mut self, tick: u64, figures: &[(&'static str, u64)]) {
        if self.figures.is_empty() {
            let figure = |&(name, _): &(_, u64)| Figure { name, total: 0, largest: 0, tick };
            self.figures = figures.iter().map(figure).collect();
        }
        self.ticks += 1;
        for (figure, (_, value)) in self.figures.iter_mut().zip(figures) {
            figure.total += u128::from(*value);
            if *value > figure.largest {
                (figure.largest, figure.tick) = (*value, tick);
            }
        }
    }

    fn print(&self, console: &mut Console<'_>) -> Result<(), CommandError> {
        if self.figures.is_empty() {
            return Ok(());
        }
        console.line(format_args!("{:14} {:>12} {:>14} {:>9}", "", "largest", "mean", "at tick"))?;
        for Figure { name, total, largest, tick } in &self.figures {
            let tenths = total * 10 / u128::from(self.ticks.max(1));
            let mean = format!("{}.{}", tenths / 10, tenths % 10);
            let tick = if *largest > 0 { tick.to_string() } else { "-".into() };
            let name = name.replace('_', " ");
            console.line(format_args!("{name:14} {largest:>12} {mean:>14} {tick:>9}"))?;
        }
        Ok(())
    }
}
