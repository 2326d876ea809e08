//! Which of many differing bodies everything began with.
//!
//! In the tick in which a body gets a wrong velocity, it passes it on to all that it touches: dozens of bodies differ, and
//! the largest difference need not be where it began. So the list is put in order of how much the motion differs, and
//! then it is tried: if one flipped bit in the last state that was right leads to exactly the wrong state, that bit it was.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::comparison::{Comparison, Explanation, Thing};
use super::evidence::Said;
use super::phases::TickPhases;
use super::stage::Stage;
use crate::inspect::{Difference, InspectError, Value, differences, fields};
use crate::lockstep::Game;
use crate::world::Motion;

/// Most work units that are spent on trying, if the limits allow as many: some ten seconds.
pub(super) const WORK_MAX: u64 = 400_000_000;
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
    pub(super) wrong: Said,
    /// How the tick went there, if that is known.
    pub(super) phases: Option<TickPhases>,
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
        Motion::SPEEDS.iter().any(|motion| difference.field().name() == motion.name())
    };
    let units = |difference: &Difference| both_bits(difference).map_or(0, |(a, b)| a.abs_diff(b));
    thing.differences.iter().filter(is_motion).map(units).sum()
}

/// The bits of two numbers that differ; `None` if one is missing or no number.
fn both_bits(difference: &Difference) -> Option<(i128, i128)> {
    let bits = |value: &Option<Value>| value.as_ref().and_then(|value| value.bits());
    bits(&difference.a).zip(bits(&difference.b))
}

/// The bit in which two numbers differ, if it is a single one.
pub(super) fn flipped_bit(difference: &Difference) -> Option<u32> {
    let (a, b) = both_bits(difference)?;
    let changed = a ^ b;
    // The sign stands in all bits above a number's own.
    let is_sign = changed.leading_ones() + changed.trailing_zeros() == i128::BITS;
    (changed.count_ones() == 1 || is_sign).then(|| changed.trailing_zeros())
}

/// Looks for the bit that explains everything, and puts its body and field first.
pub(super) fn explain<G: Game>(
    wrong: &WrongTick<G>,
    mut game: G,
    work: u64,
    found: &mut Comparison,
) -> Result<(), InspectError> {
    let is_known = found.tick == Some(wrong.tick + 1);
    let mut all = found.things.iter().flat_map(|thing| &thing.differences);
    if let (Some(only), None) = (all.next(), all.next())
        && is_known
        && flipped_bit(only).is_some()
    {
        // The bit is there to be seen.
        return Ok(());
    }
    let suspects = if is_known { suspects(&found.things) } else { everybody(&mut game, &wrong.before) };
    let Some(culprit) = search(wrong, &mut game, suspects, work) else {
        return Ok(());
    };
    let Suspect { path, motion, bit, when, .. } = culprit;
    if is_known {
        found.things.sort_by_key(|thing| thing.path != path);
        let first = &mut found.things[0].differences;
        first.sort_by_key(|difference| difference.field().name() != motion.name());
    }
    // As it was before it flipped, and as it became.
    game.load(&wrong.before);
    if when == When::After {
        game.step(&wrong.inputs);
    }
    let was = fields(&game.save())?;
    flip(&mut game, &path, motion, bit);
    let differences = differences(&was, &fields(&game.save())?);
    let (tick, stage) = match when {
        When::Before => (wrong.tick, Stage::BeforeStep),
        When::After => (wrong.tick + 1, Stage::AfterStep),
    };
    let path = differences.first().and_then(|first| first.field().thing()).map_or(path, String::from);
    found.stage.get_or_insert(stage);
    found.explanation = Some(Explanation { tick, path, bit, differences });
    Ok(())
}

/// On which side of a tick a bit may have flipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum When {
    Before,
    After,
}

/// A bit that may have flipped.
struct Suspect {
    path: String,
    motion: Motion,
    bit: u32,
    when: When,
    /// How far from the difference that is seen, in powers of two times 256: the lower, the sooner it is tried.
    distance: u32,
}

/// Every bit of the bodies that differ. Most of a flip stays in its number, as long as nothing else is hit hard by it.
fn suspects(things: &[Thing]) -> Vec<Suspect> {
    let mut suspects = Vec::new();
    for thing in things.iter().filter(|thing| handle(&thing.path).is_some()) {
        for motion in Motion::ALL {
            let of_motion = |difference: &&Difference| difference.field().name() == motion.name();
            let difference = thing.differences.iter().find(of_motion).and_then(both_bits);
            let size = log2(difference.map_or(0, |(a, b)| a.abs_diff(b)));
            suspects.extend((0..motion.bits()).map(|bit| Suspect {
                path: thing.path.clone(),
                motion,
                bit,
                when: When::Before,
                distance: size.map_or(u32::MAX, |size| size.abs_diff(bit << 8)),
            }));
        }
    }
    suspects.sort_by_key(|suspect| suspect.distance);
    suspects
}

/// The logarithm of a number to base 2, times 256, within 25 units; of 0 there is none.
fn log2(number: u128) -> Option<u32> {
    let whole = number.checked_ilog2()?;
    // Behind the leading one, as if the logarithm were straight between powers of two.
    let fraction = number << (127 - whole) << 1 >> 120;
    Some((whole << 8) + u32::try_from(fraction).unwrap_or(0))
}

/// Every bit of every body, before and after the tick.
fn everybody<G: Game>(game: &mut G, before: &G::Save) -> Vec<Suspect> {
    game.load(before);
    let Some(world) = game.world_mut() else {
        return Vec::new();
    };
    let paths: Vec<String> = world.bodies().map(|(id, _)| format!("body {id}")).collect();
    let mut suspects = Vec::new();
    for when in [When::After, When::Before] {
        for path in &paths {
            for motion in Motion::ALL {
                let of_bit = |bit| Suspect { path: path.clone(), motion, bit, when, distance: 0 };
                suspects.extend((0..motion.bits()).map(of_bit));
            }
        }
    }
    suspects
}

/// The first suspect that leads to the wrong state.
fn search<G: Game>(wrong: &WrongTick<G>, game: &mut G, suspects: Vec<Suspect>, work: u64) -> Option<Suspect> {
    game.load(&wrong.before);
    let step_work = game.work(&wrong.inputs).max(TRY_WORK);
    game.step(&wrong.inputs);
    let right = game.save();
    let mut left = work;
    suspects.into_iter().find(|suspect| {
        // A state is loaded and hashed as well.
        let loading = step_work / 2;
        let price = if suspect.when == When::Before { step_work + loading } else { loading };
        // Whoever comes cheaper may still be tried.
        let Some(rest) = left.checked_sub(price) else {
            return false;
        };
        let Suspect { path, motion, bit, when, .. } = suspect;
        game.load(if *when == When::Before { &wrong.before } else { &right });
        if flip(game, path, *motion, *bit).is_none() {
            return false;
        }
        left = rest;
        if *when == When::Before {
            game.step(&wrong.inputs);
        }
        wrong.wrong.is(game.state_hash())
    })
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
