//! States as lines of JSON.

use std::ops::RangeInclusive;

use lockstep2d::hash::StateHash;
use lockstep2d::inspect::{Field, fields};
use lockstep2d::lockstep::Game;
use serde::Serialize;
use serde_json::{Value, json};

use super::{Output, Replay};
use crate::error::CommandError;

/// Writes a line for each of some ticks.
pub(super) fn write<G: Game>(
    mut replay: Replay<'_, G>,
    ticks: RangeInclusive<u64>,
    output: &mut Output<'_>,
) -> Result<(), CommandError> {
    for tick in ticks {
        replay.play_to(tick)?;
        let game = replay.playback.game();
        output.line(&line(tick, game.state_hash(), &game.save())?)?;
    }
    Ok(())
}

fn line<S: Serialize>(tick: u64, hash: StateHash, save: &S) -> Result<String, CommandError> {
    let explain = |error: serde_json::Error| CommandError::State { why: error.to_string() };
    let mut state = serde_json::to_value(save).map_err(explain)?;
    let mut decimals: Vec<Field> =
        fields(save)?.into_iter().filter(|field| field.value.decimal().is_some()).collect();
    decimals.sort_by(|a, b| a.path().cmp(b.path()));
    add_decimals(&mut state, &mut String::new(), &decimals);
    Ok(json!({"tick": tick, "hash": hash.to_string(), "state": state}).to_string())
}

/// Puts a decimal beside the bits of each fixed-point number. `decimals` are sorted by their paths.
fn add_decimals(value: &mut Value, path: &mut String, decimals: &[Field]) {
    let length = path.len();
    match value {
        Value::Object(entries) => {
            if entries.len() == 1 && entries.contains_key("bits") {
                if let Ok(found) = decimals.binary_search_by(|field| field.path().cmp(path)) {
                    let decimal = decimals[found].value.decimal();
                    entries.extend(decimal.map(|decimal| ("decimal".into(), decimal.into())));
                    return;
                }
            }
            for (name, entry) in entries {
                if !path.is_empty() {
                    path.push('.');
                }
                path.push_str(name);
                add_decimals(entry, path, decimals);
                path.truncate(length);
            }
        }
        Value::Array(elements) => {
            for (at, element) in elements.iter_mut().enumerate() {
                path.push_str(&format!("[{at}]"));
                add_decimals(element, path, decimals);
                path.truncate(length);
            }
        }
        _ => {}
    }
}
