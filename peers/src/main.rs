//! The benchmark scenes side by side in lockstep2d, Box2D 3.2 and rapier2d. `README.md` has the commands, and
//! `docs/PERFORMANCE.md` of the repository the method and the results.

mod box2d;
mod compare;
mod engine;
mod measure;
mod ours;
mod rapier;
mod script;
mod stats;
mod table;
#[cfg(test)]
mod tests;

use anyhow::Result;
use clap::Parser;
use clap::builder::PossibleValuesParser;
use compare::Plan;
use indicatif::{ProgressBar, ProgressStyle};

/// Runs the ten benchmark scenes in lockstep2d, Box2D 3.2 (AVX2) and rapier2d (enhanced-determinism).
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(flatten)]
    scenes: ScenesArguments,
}

#[derive(clap::Args)]
struct ScenesArguments {
    /// Only these scenes, repeated or separated by commas
    #[arg(long = "scene", value_delimiter = ',', value_parser = PossibleValuesParser::new(script::SCENES))]
    scenes: Vec<String>,
    /// Runs of each engine in turn
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Threads of each engine; ratios are of CPU time with one, and of time on the clock with more
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=32))]
    threads: u16,
    /// At most this many steps of each scene, for a quick look
    #[arg(long, value_parser = clap::value_parser!(u64).range(2..))]
    steps: Option<u64>,
    /// Lines of JSON instead of tables: one for each scene, and a summary
    #[arg(long)]
    json: bool,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    compare_scenes(&arguments.scenes)
}

fn compare_scenes(arguments: &ScenesArguments) -> Result<()> {
    let plan =
        Plan { rounds: arguments.rounds.into(), threads: arguments.threads.into(), steps: arguments.steps };
    let names: Vec<&str> = match &arguments.scenes[..] {
        [] => script::SCENES.into(),
        some => some.iter().map(String::as_str).collect(),
    };
    let progress = progress(plan.runs() * names.len() as u64)?;
    if !arguments.json {
        println!("{}", table::times_head());
    }
    let mut results = Vec::new();
    for name in names {
        let result = compare::scene(name, plan, &progress)?;
        let row = if arguments.json { compare::line(&result)? } else { table::times(&result) };
        progress.suspend(|| println!("{row}"));
        for why in &result.missing {
            progress.suspend(|| eprintln!("{name}: without {why}"));
        }
        results.push(result);
    }
    progress.finish_and_clear();
    let summary = compare::summary(&results);
    if arguments.json {
        println!("{}", compare::line(&summary)?);
    } else {
        println!("{}\n\n{}\n{}", table::summary(&summary), table::ends(&results), table::keeping(&results));
    }
    Ok(())
}

/// A bar on stderr, if that is a terminal.
fn progress(length: u64) -> Result<ProgressBar> {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} runs, {eta} left  {msg}")?;
    Ok(ProgressBar::new(length).with_style(style))
}
