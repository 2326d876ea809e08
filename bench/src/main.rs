//! Compares lockstep2d with Box2D 3.2 and rapier2d. `README.md` describes the commands, and `docs/PERFORMANCE.md` the
//! method.

mod box2d;
mod compare;
mod engine;
mod growth;
mod instructions;
mod measure;
mod ours;
mod rapier;
mod rollback;
mod script;
mod small;
mod stats;
mod table;
#[cfg(test)]
mod tests;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use clap::builder::PossibleValuesParser;
use compare::Plan;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

/// Runs the ten benchmark scenes in lockstep2d, Box2D 3.2 (AVX2) and rapier2d (enhanced-determinism).
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    scenes: ScenesArguments,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Measures how the time of a step grows with the number of bodies
    Growth(GrowthArguments),
    /// Measures worlds of the size of games, and their rollback frames
    Small(SmallArguments),
    /// Steps one of the worlds of `growth` or `small`, to count its instructions with valgrind
    #[command(hide = true)]
    Step {
        world: String,
        bodies: u32,
        steps: u64,
        #[arg(value_enum, default_value_t = engine::Kind::Ours)]
        engine: engine::Kind,
    },
    /// Measures the cost of rollback in lockstep2d
    Rollback(RollbackArguments),
}

#[derive(clap::Args)]
struct GrowthArguments {
    /// Approximate numbers of bodies
    #[arg(long, value_delimiter = ',', default_values_t = [1000, 4000, 16000, 64000],
        value_parser = clap::value_parser!(u32).range(110..=250_000))]
    bodies: Vec<u32>,
    /// Number of timed steps
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..))]
    steps: u64,
    /// Number of steps before the timed ones
    #[arg(long, default_value_t = 60)]
    untimed: u64,
    /// Runs of each engine, interleaved
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Count the instructions of lockstep2d in one slow round under valgrind, instead of timing all engines
    #[arg(long, conflicts_with = "rounds")]
    instructions: bool,
    /// Print lines of JSON instead of a table
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
struct SmallArguments {
    /// Measure only these worlds, repeated or separated by commas
    #[arg(long = "world", value_delimiter = ',')]
    worlds: Vec<String>,
    /// Runs of each engine, interleaved
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Print lines of JSON instead of tables: one for each world and size, one for each frame, and a summary
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
struct RollbackArguments {
    /// Run only these scenes, repeated or separated by commas
    #[arg(long = "scene", value_delimiter = ',', value_parser = PossibleValuesParser::new(script::SCENES))]
    scenes: Vec<String>,
    /// Maximum number of steps of each scene, for a quick run
    #[arg(long, value_parser = clap::value_parser!(u64).range(9..))]
    steps: Option<u64>,
    /// Print lines of JSON instead of a table
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
struct ScenesArguments {
    /// Run only these scenes, repeated or separated by commas
    #[arg(long = "scene", value_delimiter = ',', value_parser = PossibleValuesParser::new(script::SCENES))]
    scenes: Vec<String>,
    /// Runs of each engine, interleaved
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Threads of each engine; ratios compare CPU time with one thread, and wall-clock time with more
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=32))]
    threads: u16,
    /// Maximum number of steps of each scene, for a quick run
    #[arg(long, value_parser = clap::value_parser!(u64).range(2..))]
    steps: Option<u64>,
    /// Print lines of JSON instead of tables: one for each scene, and a summary
    #[arg(long)]
    json: bool,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    match &arguments.command {
        None => compare_scenes(&arguments.scenes),
        Some(Command::Growth(arguments)) => measure_growth(arguments),
        Some(Command::Small(arguments)) => measure_small(arguments),
        Some(Command::Step { world, bodies, steps, engine }) => {
            let mut worlds = growth::WORLDS.into_iter().chain(small::all().map(|(world, _)| world));
            let world = worlds.find(|known| known.name == world);
            let world = world.context("the world should be one of the worlds of `growth` or `small`")?;
            println!("{}", instructions::step(world, *bodies, *steps, *engine)?);
            Ok(())
        }
        Some(Command::Rollback(arguments)) => measure_rollback(arguments),
    }
}

/// The named scenes, or all scenes if none is named.
fn names(some: &[String]) -> Vec<&str> {
    if some.is_empty() { script::SCENES.into() } else { some.iter().map(String::as_str).collect() }
}

fn compare_scenes(arguments: &ScenesArguments) -> Result<()> {
    let plan =
        Plan { rounds: arguments.rounds.into(), threads: arguments.threads.into(), steps: arguments.steps };
    let names = names(&arguments.scenes);
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

fn measure_growth(arguments: &GrowthArguments) -> Result<()> {
    let plan = growth::Plan {
        sizes: arguments.bodies.clone(),
        steps: arguments.steps,
        untimed: arguments.untimed,
        rounds: arguments.rounds.into(),
    };
    if arguments.instructions {
        return count_instructions(&plan, arguments.json);
    }
    let runs = growth::WORLDS.len() * plan.sizes.len() * plan.rounds * engine::Kind::ALL.len();
    let progress = progress(runs as u64)?;
    let mut growths = Vec::new();
    for world in growth::WORLDS {
        growths.extend(growth::measure(world, &plan, &progress)?);
    }
    progress.finish_and_clear();
    print_growths(&growths, growth::table, arguments.json)
}

/// Prints lines of JSON or a table.
fn print_growths<T: Serialize>(growths: &[T], table: fn(&[T]) -> String, json: bool) -> Result<()> {
    if !json {
        print!("{}", table(growths));
        return Ok(());
    }
    for growth in growths {
        println!("{}", compare::line(growth)?);
    }
    Ok(())
}

fn count_instructions(plan: &growth::Plan, json: bool) -> Result<()> {
    let progress = progress(growth::WORLDS.len() as u64)?;
    let mut growths = Vec::new();
    for world in growth::WORLDS {
        growths.push(instructions::measure(world, plan)?);
        progress.inc(1);
    }
    progress.finish_and_clear();
    print_growths(&growths, instructions::table, json)
}

fn measure_small(arguments: &SmallArguments) -> Result<()> {
    let rounds = usize::from(arguments.rounds);
    let chosen =
        |name: &str| arguments.worlds.is_empty() || arguments.worlds.iter().any(|world| world == name);
    let worlds: Vec<_> = small::all().filter(|(world, _)| chosen(world.name)).collect();
    let frames: Vec<_> = small::frames().filter(|(world, _)| chosen(world.name)).collect();
    ensure!(!worlds.is_empty(), "no such world: {}", arguments.worlds.join(", "));
    let progress = progress(((worlds.len() + frames.len()) * rounds * engine::Kind::ALL.len()) as u64)?;
    if !arguments.json {
        println!("{}", small::head());
    }
    let mut cells = Vec::new();
    for (world, size) in worlds {
        let cell = small::cell(world, size, rounds, &progress)?;
        let row = if arguments.json { compare::line(&cell)? } else { small::row(&cell) };
        progress.suspend(|| println!("{row}"));
        cells.push(cell);
    }
    let summary = small::summary(&cells);
    if !arguments.json {
        progress.suspend(|| println!("{}\n\n{}", small::summary_rows(&summary), small::frame_head()));
    }
    for (world, size) in frames {
        let frame = small::frame(world, size, rounds, &progress)?;
        let row = if arguments.json { compare::line(&frame)? } else { small::frame_row(&frame) };
        progress.suspend(|| println!("{row}"));
    }
    progress.finish_and_clear();
    if arguments.json {
        println!("{}", compare::line(&summary)?);
    }
    Ok(())
}

fn measure_rollback(arguments: &RollbackArguments) -> Result<()> {
    let bytes = rollback::bytes()?;
    if !arguments.json {
        println!("{}", rollback::head());
    }
    for name in names(&arguments.scenes) {
        let cost = rollback::cost(name, arguments.steps)?;
        println!("{}", if arguments.json { compare::line(&cost)? } else { rollback::row(&cost) });
    }
    let rollback::Bytes { body, contact, joint } = bytes;
    if arguments.json {
        println!("{}", serde_json::json!({ "summary": true, "bytes_of_a_save_per": bytes }));
    } else {
        println!("A save has {body:.0} bytes per body, {contact:.0} per contact and {joint:.0} per joint.");
    }
    Ok(())
}

/// Progress bar, shown if stderr is a terminal.
fn progress(length: u64) -> Result<ProgressBar> {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} runs, {eta} left  {msg}")?;
    Ok(ProgressBar::new(length).with_style(style))
}
