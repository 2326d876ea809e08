//! Finds the stage of a tick in which two trajectories diverged, and the differences at the start of the step. The
//! search needs phase digests of the diverged side.

use alloc::string::String;

use super::candidate::{self, WrongTick};
use super::comparison::{Comparison, Explanation};
use super::phases::TickPhases;
use super::stage::Stage;
use crate::inspect::{Difference, InspectError, differences, fields};
use crate::lockstep::Game;

pub(super) fn find<G: Game>(
    wrong: &WrongTick<G>,
    theirs: &TickPhases,
    game: &mut G,
    found: &mut Comparison,
) -> Result<(), InspectError> {
    game.load(&wrong.before);
    let before = game.world_mut().cloned();
    let ours = TickPhases::of(game, &wrong.inputs);
    found.stage = ours.parting(theirs);
    if found.stage != Some(Stage::BeforeStep) {
        return Ok(());
    }
    let Some((ours, theirs)) = before.and_then(|before| ours.start(&before).zip(theirs.start(&before)))
    else {
        return Ok(());
    };
    let differences = differences(&fields(&ours.save())?, &fields(&theirs.save())?);
    found.explanation = flipped_bit(wrong, &differences)?;
    found.began = candidate::subjects(differences);
    Ok(())
}

/// The bit in which two states differ, if there is exactly one.
fn flipped_bit<G: Game>(
    wrong: &WrongTick<G>,
    differences: &[Difference],
) -> Result<Option<Explanation>, InspectError> {
    // The angular velocity is derived from the stored spin, and bounding boxes from the motion of a body, so a flipped
    // bit changes these fields as well.
    let derived = ["angular_velocity", "fat.lower.x", "fat.lower.y", "fat.upper.x", "fat.upper.y"];
    let stored = |difference: &&Difference| !derived.contains(&difference.field().name());
    let mut stored = differences.iter().filter(stored);
    let (Some(only), None) = (stored.next(), stored.next()) else {
        return Ok(None);
    };
    let Some(bit) = candidate::flipped_bit(only) else {
        return Ok(None);
    };
    // The place of the world in the game's save is unknown here, so only the ends of the paths are compared.
    let place = only.field().subject().unwrap_or(only.field().section());
    let saved = fields(&wrong.before)?;
    let path = saved.iter().filter_map(|field| field.subject()).find(|path| path.ends_with(place));
    let path = path.map_or_else(|| String::from(place), String::from);
    let mut differences = differences.to_vec();
    differences.sort_by_key(|difference| difference != only);
    Ok(Some(Explanation { tick: wrong.tick, path, bit, differences }))
}
