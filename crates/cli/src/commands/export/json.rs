//! States as lines of JSON.

mod value;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use serde::Serialize;

use super::{Output, Replay};
use crate::console::json_text;
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

/// A line of JSON with the tick, the state hash and the save. The tick comes first, so that the beginning of a long
/// line shows it.
pub(super) fn line<S: Serialize>(tick: u64, hash: StateHash, save: &S) -> Result<String, CommandError> {
    let state = value::json(save).map_err(|error| CommandError::State { why: error.to_string() })?;
    Ok(format!("{{\"tick\":{tick},\"hash\":\"{hash}\",\"state\":{}}}", json_text(&state)))
}
