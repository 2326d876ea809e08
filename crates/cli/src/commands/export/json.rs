//! States as lines of JSON.

use lockstep2d::hash::StateHash;
use lockstep2d::inspect::{Field, fields};
use lockstep2d::lockstep::Game;
use serde::Serialize;
use serde_json::Value;

use super::{Output, Replay};
use crate::error::CommandError;

pub(super) fn write<G: Game>(
    mut replay: Replay<'_, G>,
    ticks: impl Iterator<Item = u64>,
    output: &mut Output<'_>,
) -> Result<(), CommandError> {
    for tick in ticks {
        replay.play_to(tick)?;
        let game = replay.verified.game();
        output.line(&line(tick, game.state_hash(), &game.save())?)?;
    }
    Ok(())
}

/// One line of JSON. The tick comes first, so that the beginning of a long line identifies it.
pub(super) fn line<S: Serialize>(tick: u64, hash: StateHash, save: &S) -> Result<String, CommandError> {
    let mut state =
        serde_json::to_value(save).map_err(|error| CommandError::State { why: error.to_string() })?;
    let mut numbers = fields(save)?;
    numbers.retain(|field| matches!(field.value, lockstep2d::inspect::Value::Fixed { .. }));
    numbers.sort_by(|a, b| a.path().cmp(b.path()));
    add_decimals(&mut state, &mut String::new(), &numbers);
    Ok(format!("{{\"tick\":{tick},\"hash\":\"{hash}\",\"state\":{state}}}"))
}

/// Adds a decimal number beside the bits of each fixed-point number. `numbers` are sorted by path.
fn add_decimals(value: &mut Value, path: &mut String, numbers: &[Field]) {
    let length = path.len();
    match value {
        Value::Object(entries) => {
            if entries.len() == 1
                && entries.contains_key("bits")
                && let Ok(found) = numbers.binary_search_by(|field| field.path().cmp(path))
            {
                let decimal = numbers[found].value.decimal();
                entries.extend(decimal.map(|decimal| ("decimal".into(), decimal.into())));
                return;
            }
            let is_single = entries.len() == 1;
            for (name, entry) in entries {
                push_name(path, name);
                // JSON nests the fields of an enum variant under the name of the variant. Paths do not contain this
                // name.
                if is_single && !is_beginning(path, numbers) {
                    path.truncate(length);
                }
                add_decimals(entry, path, numbers);
                path.truncate(length);
            }
        }
        Value::Array(elements) => {
            for (at, element) in elements.iter_mut().enumerate() {
                path.push_str(&format!("[{at}]"));
                add_decimals(element, path, numbers);
                path.truncate(length);
            }
        }
        _ => {}
    }
}

fn push_name(path: &mut String, name: &str) {
    if !path.is_empty() {
        path.push('.');
    }
    path.push_str(name);
}

fn is_beginning(path: &str, numbers: &[Field]) -> bool {
    let first = numbers.partition_point(|field| field.path() < path);
    numbers.get(first).is_some_and(|field| field.path().starts_with(path))
}
