//! Finds the body in which a difference originated, among many bodies that differ.
//!
//! A body with a wrong velocity affects the bodies that it touches in the same tick, so the body with the largest
//! difference need not be the origin. Therefore the search restores the last correct state, flips a single bit in the
//! speed or pose of one of the differing bodies, and plays the tick. It starts with the bits whose value is closest to
//! the observed difference. If no differing body is known, the search tries the bits of all bodies, first in the state
//! after the tick, then in the state before it. A flip that leads to exactly the wrong state is the explanation.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::comparison::{Comparison, Explanation, Subject};
use super::evidence::Said;
use super::phases::TickPhases;
use super::stage::Stage;
use crate::body::{BodyId, Handle};
use crate::inspect::{Difference, InspectError, Value, differences, fields};
use crate::lockstep::Game;
use crate::replay::{Limits, play_within};
use crate::world::BodyField;

/// Maximum work units that [`compare`](super::compare::compare) spends on bit flips: about ten seconds.
pub(super) const WORK_MAX: u64 = 400_000_000;
/// Minimum work units that a step is charged with. Loading and hashing a state is charged with half of a step.
const TRY_WORK: u64 = 1000;

pub(super) struct WrongTick<G: Game> {
    /// Number of ticks up to the last correct state.
    pub(super) tick: u64,
    pub(super) before: G::Save,
    /// The inputs of the tick that leads to the wrong state.
    pub(super) inputs: Vec<G::Input>,
    /// Hash of the wrong state, as stated by the side that diverged.
    pub(super) wrong: Said,
    pub(super) phases: Option<TickPhases>,
}

/// Groups differences by subject. The subject with the largest difference of velocities comes first.
pub(super) fn subjects(differences: Vec<Difference>) -> Vec<Subject> {
    let mut subjects: Vec<Subject> = Vec::new();
    let mut places = BTreeMap::new();
    for difference in differences {
        let field = difference.field();
        let path = field.subject().unwrap_or(field.section());
        let at = *places.entry(String::from(path)).or_insert(subjects.len());
        if at == subjects.len() {
            let section = field.section().into();
            subjects.push(Subject { path: path.into(), section, differences: Vec::new() });
        }
        subjects[at].differences.push(difference);
    }
    subjects.sort_by_key(|subject| core::cmp::Reverse(disturbance(subject)));
    subjects
}

/// Sum of the differences of a body's velocities, each in units of its last bit; 0 for a subject that is no body.
fn disturbance(subject: &Subject) -> u128 {
    let is_motion = |difference: &&Difference| {
        BodyField::SPEEDS.iter().any(|field| difference.field().name() == field.name())
    };
    let units = |difference: &Difference| both_bits(difference).map_or(0, |(a, b)| a.abs_diff(b));
    subject.differences.iter().filter(is_motion).map(units).sum()
}

/// The bits of both values of a difference, if both are numbers.
fn both_bits(difference: &Difference) -> Option<(i128, i128)> {
    let bits = |value: &Option<Value>| value.as_ref().and_then(|value| value.bits());
    bits(&difference.a).zip(bits(&difference.b))
}

pub(super) fn flipped_bit(difference: &Difference) -> Option<u32> {
    let (a, b) = both_bits(difference)?;
    let changed = a ^ b;
    // A flipped sign bit also changes all bits above the width of the number.
    let is_sign = changed.leading_ones() + changed.trailing_zeros() == i128::BITS;
    (changed.count_ones() == 1 || is_sign).then(|| changed.trailing_zeros())
}

/// Searches for the bit flip that explains the differences, and moves the body with that bit to the front of
/// `found.subjects`.
pub(super) fn explain<G: Game>(
    wrong: &WrongTick<G>,
    mut game: G,
    work: u64,
    found: &mut Comparison,
) -> Result<(), InspectError> {
    let is_known = found.tick == Some(wrong.tick + 1);
    let mut all = found.subjects.iter().flat_map(|subject| &subject.differences);
    if let (Some(only), None) = (all.next(), all.next())
        && is_known
        && flipped_bit(only).is_some()
    {
        // The difference already shows the flipped bit.
        return Ok(());
    }
    let candidates = if is_known { candidates(&found.subjects) } else { Vec::new() };
    let Some(culprit) = search(wrong, &mut game, candidates, work) else {
        return Ok(());
    };
    let Candidate { body, field, bit, when } = culprit;
    if is_known {
        found.subjects.sort_by_key(|subject| handle(&subject.path) != Some(body));
        // There may be no subject: the states of a report may be equal although their hashes differ.
        if let Some(first) = found.subjects.first_mut() {
            first.differences.sort_by_key(|difference| difference.field().name() != field.name());
        }
    }
    // The flip explains the difference between the states before and after it.
    game.load(&wrong.before);
    if when == When::After {
        game.step(&wrong.inputs);
    }
    let was = fields(&game.save())?;
    let path = game.world_mut().map_or_else(String::new, |world| format!("body {}", world.body_label(body)));
    flip(&mut game, body, field, bit);
    let differences = differences(&was, &fields(&game.save())?);
    let (tick, stage) = match when {
        When::Before => (wrong.tick, Stage::BeforeStep),
        When::After => (wrong.tick + 1, Stage::AfterStep),
    };
    let path = differences.first().and_then(|first| first.field().subject()).map_or(path, String::from);
    found.stage.get_or_insert(stage);
    found.explanation = Some(Explanation { tick, path, bit, differences });
    Ok(())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum When {
    Before,
    After,
}

struct Candidate {
    body: BodyId,
    field: BodyField,
    bit: u32,
    when: When,
}

impl Candidate {
    fn all_of(body: BodyId, when: When) -> impl Iterator<Item = Self> {
        let of_field =
            move |field: BodyField| (0..field.bits()).map(move |bit| Candidate { body, field, bit, when });
        BodyField::ALL.into_iter().flat_map(of_field)
    }
}

/// The bits that may have been flipped before the tick: all bits of the speeds and poses of those bodies whose states
/// differ after the tick. A flipped bit changes its number by the value of the bit, and unless the body collides strongly,
/// most of this change is still in the same number after the tick. Bits whose value is closest to the difference of their
/// number therefore come first.
fn candidates(subjects: &[Subject]) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    for subject in subjects {
        let Some(body) = handle(&subject.path) else { continue };
        let size = |field: BodyField| {
            let of_field = |difference: &&Difference| difference.field().name() == field.name();
            let difference = subject.differences.iter().find(of_field).and_then(both_bits);
            log2(difference.map_or(0, |(a, b)| a.abs_diff(b)))
        };
        let sizes = BodyField::ALL.map(|field| (field, size(field)));
        candidates.extend(Candidate::all_of(body, When::Before).map(|candidate| {
            let size = sizes.iter().find(|(field, _)| *field == candidate.field).and_then(|(_, size)| *size);
            // 256 |log2(value of the bit / observed difference)|. Fields without a difference come last.
            (size.map_or(u32::MAX, |size| size.abs_diff(candidate.bit << 8)), candidate)
        }));
    }
    candidates.sort_by_key(|(distance, _)| *distance);
    candidates.into_iter().map(|(_, candidate)| candidate).collect()
}

/// Approximate base-2 logarithm of a number times 256; `None` for 0.
fn log2(number: u128) -> Option<u32> {
    let whole = number.checked_ilog2()?;
    // The bits after the leading one interpolate linearly between powers of two.
    let fraction = number << (127 - whole) << 1 >> 120;
    Some((whole << 8) + u32::try_from(fraction).unwrap_or(0))
}

/// The bodies whose bits [`World::flip_bit`](crate::world::World::flip_bit) can flip.
fn loose_bodies<G: Game>(game: &mut G) -> Vec<BodyId> {
    let Some(world) = game.world_mut() else {
        return Vec::new();
    };
    let bodies = world.bodies();
    let loose = bodies.filter(|(_, body)| body.is_dynamic() && body.is_enabled() && !body.is_asleep());
    loose.map(|(id, _)| id).collect()
}

/// Returns the first candidate that leads to the wrong state. Spends at most `work` units. If `candidates` is empty,
/// tries the bits of all bodies, first after the tick, then before it. The body with the flipped bit need not be one of
/// the bodies that differ: the step may have corrected this body, so that only its contacts differ.
fn search<G: Game>(
    wrong: &WrongTick<G>,
    game: &mut G,
    candidates: Vec<Candidate>,
    work: u64,
) -> Option<Candidate> {
    game.load(&wrong.before);
    let everybody = candidates.is_empty();
    let before = if everybody { loose_bodies(game) } else { Vec::new() };
    let mut left = u64::MAX;
    play(wrong, game, &mut left);
    let step_work = u64::MAX - left;
    let after = if everybody { loose_bodies(game) } else { Vec::new() };
    let right = game.save();
    let of_bodies = [(When::After, after), (When::Before, before)]
        .into_iter()
        .flat_map(|(when, bodies)| bodies.into_iter().flat_map(move |body| Candidate::all_of(body, when)));
    let loading = step_work / 2;
    left = work;
    // Which state the game has: before or after the tick. `None` if one of its bits is flipped.
    let mut loaded = None;
    for candidate in candidates.into_iter().chain(of_bodies) {
        let Candidate { body, field, bit, when } = candidate;
        let simulating = if when == When::Before { step_work } else { 0 };
        if left < loading {
            break;
        }
        // A cheaper candidate may still fit into the budget.
        if left < loading + simulating {
            continue;
        }
        if loaded != Some(when) {
            left -= loading;
            game.load(if when == When::Before { &wrong.before } else { &right });
            loaded = Some(when);
        }
        if flip(game, body, field, bit).is_none() {
            left = left.saturating_sub(1);
            continue;
        }
        loaded = None;
        if when == When::Before && !play(wrong, game, &mut left) {
            continue;
        }
        if wrong.wrong.is(game.state_hash()) {
            return Some(candidate);
        }
    }
    None
}

/// Plays the tick with at most `left` work units, and subtracts the units that it took. Returns whether `left` was
/// enough.
fn play<G: Game>(wrong: &WrongTick<G>, game: &mut G, left: &mut u64) -> bool {
    let limits = Limits { tick_work: *left, total_work: *left, ..Limits::default() };
    let mut spent = 0;
    let played = play_within(game, &wrong.inputs, &limits, &mut spent, G::step);
    *left = left.saturating_sub(spent.max(TRY_WORK));
    played.is_ok()
}

/// The body that a path names.
fn handle(path: &str) -> Option<BodyId> {
    let (_, label) = path.rsplit_once("body ")?;
    // A name may follow the handle.
    let handle = label.split(' ').next()?;
    let (slot, generation) = handle.split_once('v')?;
    Some(BodyId::from_parts(slot.parse().ok()?, generation.parse().ok()?))
}

/// Flips a bit of a body's speed or pose. If `World::flip_bit` refuses the flip, returns `None` and changes nothing.
fn flip<G: Game>(game: &mut G, body: BodyId, field: BodyField, bit: u32) -> Option<()> {
    game.world_mut()?.flip_bit(body, field, bit).ok()
}
