//! Which of many differing bodies everything began with.
//!
//! In the tick in which a body gets a wrong velocity, it passes it on to all that it touches: dozens of bodies differ, and
//! the largest difference need not be where it began. So the list is put in order of how much the motion differs, and
//! then it is tried: if one flipped bit in the last state that was right leads to exactly the wrong state, that bit it was.

use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;

use super::comparison::{Explanation, Thing};
use crate::hash::StateHash;
use crate::inspect::{Difference, InspectError, Value, differences, fields};
use crate::lockstep::Game;
use crate::replay::Limits;
use crate::world::Motion;

/// Most work units that are spent on trying, if the limits allow as many: some ten seconds.
const WORK_MAX: u64 = 400_000_000;
/// Work units that a try costs at least, as the state is loaded and hashed.
const TRY_WORK: u64 = 1000;

/// A tick that has gone wrong on one side.
pub(super) struct WrongTick<G: Game> {
    /// The last tick that was right, and the state after it.
    pub(super) tick: u64,
    pub(super) before: G::Save,
    /// The inputs that led from it to the wrong one.
    pub(super) inputs: Vec<G::Input>,
    /// What came of them on the side that is to blame.
    pub(super) wrong: StateHash,
}

/// Puts things into sections and bodies, those whose motion differs most first.
pub(super) fn things(differences: Vec<Difference>) -> Vec<Thing> {
    let mut things: Vec<Thing> = Vec::new();
    let mut places = BTreeMap::new();
    for difference in differences {
        let field = difference.field();
        let path = field.thing().unwrap_or(field.section());
        let at = *places.entry(String::from(path)).or_insert(things.len());
        if at == things.len() {
            let section = field.section().into();
            things.push(Thing { path: path.into(), section, differences: Vec::new() });
        }
        things[at].differences.push(difference);
    }
    things.sort_by_key(|thing| core::cmp::Reverse(disturbance(thing)));
    things
}

/// By how many units the motion of a body differs; 0 of everything else.
fn disturbance(thing: &Thing) -> u128 {
    let is_motion = |difference: &&Difference| {
        Motion::ALL.iter().any(|motion| difference.field().name() == motion.name())
    };
    let units = |difference: &Difference| {
        let bits = |value: &Option<Value>| value.as_ref().and_then(|value| value.bits());
        bits(&difference.a).zip(bits(&difference.b)).map_or(0, |(a, b)| a.abs_diff(b))
    };
    thing.differences.iter().filter(is_motion).map(units).sum()
}

/// The bit that explains everything, if there is one. Its body and field are put first.
pub(super) fn explain<G: Game>(
    wrong: &WrongTick<G>,
    mut game: G,
    things: &mut Vec<Thing>,
    limits: &Limits,
) -> Result<Option<Explanation>, InspectError> {
    let work = WORK_MAX.min(limits.total_work);
    let Some((at, motion, bit)) = search(wrong, &mut game, things, work) else {
        return Ok(None);
    };
    let mut thing = things.remove(at);
    thing.differences.sort_by_key(|difference| difference.field().name() != motion.name());
    let path = thing.path.clone();
    things.insert(0, thing);
    // As it was before the tick, and as it became.
    game.load(&wrong.before);
    let was = fields(&game.save())?;
    flip(&mut game, &path, motion, bit);
    let differences = differences(&was, &fields(&game.save())?);
    Ok(Some(Explanation { tick: wrong.tick, path, bit, differences }))
}

/// The place in the list, the number and the bit that lead to the wrong state.
fn search<G: Game>(
    wrong: &WrongTick<G>,
    game: &mut G,
    things: &[Thing],
    work: u64,
) -> Option<(usize, Motion, u32)> {
    game.load(&wrong.before);
    let mut left = work / game.work(&wrong.inputs).max(TRY_WORK);
    let is_body = |thing: &&Thing| handle(&thing.path).is_some();
    for (at, thing) in things.iter().enumerate().filter(|(_, thing)| is_body(thing)) {
        for motion in Motion::ALL {
            for bit in 0..32 {
                left = left.checked_sub(1)?;
                game.load(&wrong.before);
                if flip(game, &thing.path, motion, bit).is_none() {
                    continue;
                }
                game.step(&wrong.inputs);
                if game.state_hash() == wrong.wrong {
                    return Some((at, motion, bit));
                }
            }
        }
    }
    None
}

/// Slot and generation of a body, from its path.
fn handle(path: &str) -> Option<(u32, u32)> {
    let (_, handle) = path.rsplit_once("body ")?;
    let (slot, generation) = handle.split_once('v')?;
    Some((slot.parse().ok()?, generation.parse().ok()?))
}

/// Flips a bit of the body of that path, if there is one and it can have that speed.
fn flip<G: Game>(game: &mut G, path: &str, motion: Motion, bit: u32) -> Option<()> {
    let handle = handle(path)?;
    let world = game.world_mut()?;
    let body = world.bodies().map(|(id, _)| id);
    let body = { body }.find(|id| (id.index(), id.generation()) == handle)?;
    world.flip_bit(body, motion, bit).ok()
}
