//! The description of a report of a divergence.

use lockstep2d::lockstep::Game;
use lockstep2d::report::{DesyncReport, Group};
use serde_json::{Value as Json, json};

use super::replay::Summary;
use super::{Arguments, shown};
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::Shown;
use crate::identity::mismatch;

pub(super) fn print<G: Game>(
    report: &DesyncReport,
    arguments: &Arguments,
    context: &mut Context<'_, G>,
) -> CommandResult {
    let replay = match report.replay() {
        [] => None,
        bytes => {
            Some(Summary::read::<G>(bytes, context.limits()).map_err(CommandError::replay(&arguments.file))?)
        }
    };
    let console = &mut context.console;
    let exit = replay.as_ref().map_or(Exit::Success, Summary::exit);
    if arguments.json {
        console.json(&document::<G>(report, arguments, replay.as_ref()))?;
        return Ok(exit);
    }
    let (name, version) = report.rules();
    let (semantics, players, tick) = (report.semantics, report.players(), report.tick());
    console.line(format_args!("{}: report of a divergence", Shown(&arguments.file)))?;
    console.line(format_args!(
        "engine semantics {semantics}, rules {} version {version}",
        shown(&format!("{name:?}"))
    ))?;
    if let Some(why) = mismatch::<G>(semantics, name, version) {
        console.line(format_args!("this program cannot play it: {}", shown(&why.to_string())))?;
    }
    console.line(format_args!("players {players}, seats of the writer {:?}", report.seats()))?;
    console.line(format_args!("states differed at tick {tick}"))?;
    for Group { hash, seats } in report.groups() {
        console.line(format_args!("  seats {seats:?}: {hash}"))?;
    }
    let ticks = |ticks: &[u64]| match ticks {
        [first, .., last] => format!(", ticks {first} to {last}"),
        [only] => format!(", tick {only}"),
        [] => String::new(),
    };
    let known: Vec<u64> = report.history().iter().map(|(tick, _)| *tick).collect();
    let saved: Vec<u64> = report.saves().iter().map(|(tick, _)| *tick).collect();
    let bytes: usize = report.saves().iter().map(|(_, save)| save.len()).sum();
    console.line(format_args!("state hashes {}{}", known.len(), ticks(&known)))?;
    console.line(format_args!("saves {}{}, {bytes} bytes", saved.len(), ticks(&saved)))?;
    match replay {
        Some(summary) => summary.print("replay in it", arguments, console)?,
        None => console.line("no replay in it")?,
    }
    Ok(exit)
}

fn document<G: Game>(report: &DesyncReport, arguments: &Arguments, replay: Option<&Summary>) -> Json {
    let (name, version) = report.rules();
    let groups: Vec<Json> = report
        .groups()
        .iter()
        .map(|group| json!({"hash": group.hash.to_string(), "seats": group.seats}))
        .collect();
    let history: Vec<Json> =
        report.history().iter().map(|(tick, hash)| json!({"tick": tick, "hash": hash.to_string()})).collect();
    let saves: Vec<Json> =
        report.saves().iter().map(|(tick, save)| json!({"tick": tick, "bytes": save.len()})).collect();
    json!({
        "file": arguments.file.display().to_string(),
        "kind": "report",
        "semantics": report.semantics,
        "rules": {"name": name, "version": version},
        "unverifiable": mismatch::<G>(report.semantics, name, version).map(|why| why.to_string()),
        "players": report.players(),
        "seats": report.seats(),
        "tick": report.tick(),
        "groups": groups,
        "history": history,
        "saves": saves,
        "replay": replay.map(Summary::document),
    })
}
