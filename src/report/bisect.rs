//! [`bisect`]: where a course leaves the running engine's, or another replay's.

use alloc::format;

use super::compare::{CompareError, compare_worlds, survey};
use super::comparison::Comparison;
use super::duel;
use super::evidence::Evidence;
use super::rerun::{self, Effort};
use crate::lockstep::Game;
use crate::replay::Limits;

/// Finds the first tick at which a course leaves another one, the stage of that tick, and what differs then, the thing to
/// blame first. That costs a save and a hash of each tick beyond playing it once; with the search for a single bit that could
/// explain all of it, less than playing everything three times.
///
/// Without `b`, the other course is that of the running engine with the same inputs. A replay tells only between which of
/// its checkpoints that was left; the [`Trace`](super::Trace) of these ticks, from the engine that has written it, tells
/// the rest. A desync report is such a trace of the last seconds.
///
/// With `b`, both are the same match on two machines, or two replays of whatever setups and inputs: those are played
/// again, until the states differ.
///
/// # Errors
/// [`CompareError`] when there is nothing to compare or to play.
pub fn bisect<G: Game>(
    a: &Evidence,
    b: Option<&Evidence>,
    limits: &Limits,
) -> Result<Comparison, CompareError> {
    if let (Evidence::World(a), Some(Evidence::World(b))) = (a, b) {
        return compare_worlds(a, b);
    }
    let (known, mut found) = survey::<G>(a, b, limits)?;
    if found.setup.is_empty() && found.input.is_none() {
        rerun::run::<G>(&known, limits, Effort::Bounded, &mut found)?;
    } else {
        duel::run::<G>(&known, limits, &mut found)?;
    }
    if let (Some(last), Some(first)) = (found.last_equal, found.first_different)
        && last + 1 < first
    {
        found.notes.push(format!(
                "nothing is known of the ticks between {last} and {first}: their trace, from the program that wrote \
                 the replay, tells the rest"
            ));
    }
    Ok(found)
}
