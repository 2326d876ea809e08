//! Which of many differing bodies everything began with.
//!
//! In the tick in which a body gets a wrong velocity, it passes it on to all that it touches: dozens of bodies differ, and
//! the largest difference need not be where it began. So the list is put in order of how much the motion differs, and
//! then it is tried: if one flipped bit in the last state that was right leads to exactly the wrong state, that bit it was.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::comparison::{Explanation, Thing};
use crate::body::BodyId;
use crate::hash::StateHash;
use crate::inspect::Difference;
use crate::lockstep::Game;
use crate::world::Motion;

/// Most work units that are spent on trying: some ten seconds.
const WORK_MAX: u64 = 400_000_000;

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
        let bits = |value: &Option<crate::inspect::Value>| value.as_ref().and_then(|value| value.bits());
        bits(&difference.a).zip(bits(&difference.b)).map_or(0, |(a, b)| a.abs_diff(b))
    };
    thing.differences.iter().filter(is_motion).map(units).sum()
}

/// The bit that explains everything, if there is one. Its body and field are put first.
pub(super) fn explain<G: Game>(
    wrong: &WrongTick<G>,
    mut game: G,
    things: &mut Vec<Thing>,
) -> Option<Explanation> {
    game.load(&wrong.before);
    let mut left = WORK_MAX / game.work(&wrong.inputs).max(1);
    let bodies: BTreeMap<String, BodyId> =
        game.world_mut()?.bodies().map(|(id, _)| (format!("body {id}"), id)).collect();
    for at in 0..things.len() {
        let key = things[at].path.rsplit('.').next();
        let Some(&body) = key.and_then(|key| bodies.get(key)) else {
            continue;
        };
        for motion in Motion::ALL {
            for bit in 0..32 {
                game.load(&wrong.before);
                if game.world_mut()?.flip_bit(body, motion, bit).is_err() {
                    continue;
                }
                left = left.checked_sub(1)?;
                game.step(&wrong.inputs);
                if game.state_hash() != wrong.wrong {
                    continue;
                }
                let mut thing = things.remove(at);
                thing.differences.sort_by_key(|difference| difference.field().name() != motion.name());
                let (path, field) = (thing.path.clone(), motion.name());
                things.insert(0, thing);
                return Some(Explanation { tick: wrong.tick, path, field, bit });
            }
        }
    }
    None
}
