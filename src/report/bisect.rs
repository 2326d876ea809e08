use alloc::format;

use super::compare::{CompareError, compare_worlds, survey};
use super::comparison::Comparison;
use super::evidence::Evidence;
use super::replay_comparison;
use super::replayed::{self, Effort};
use crate::lockstep::Game;
use crate::replay::Limits;

/// Finds the first tick at which two trajectories (sequences of states) differ, the stage of that tick in which they
/// diverge, and the differences, with the probable origin first. The search costs about two or three times as much as
/// playing all ticks once.
///
/// Without `b`, the running engine simulates the inputs of `a`, and the states of this simulation are the second
/// trajectory. If `a` is a replay, the result is the pair of checkpoints between which the trajectories diverge. The
/// exact tick can be found only if `a` is a desync report, or a report of a [`Trace`](super::Trace) by the engine that
/// wrote the replay.
///
/// With `b`, the files are reports or replays of one match from two machines, or any two replays. Two snapshots are
/// compared without a simulation.
///
/// # Errors
/// [`CompareError`] if the files cannot be compared or played.
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
        replayed::run::<G>(&known, limits, Effort::Bounded, &mut found)?;
    } else {
        replay_comparison::run::<G>(&known, limits, &mut found)?;
    }
    if let (Some(last), Some(first)) = (found.last_equal, found.first_different)
        && last + 1 < first
    {
        found.notes.push(format!(
            "the ticks between {last} and {first} are unknown: a trace of them, from the program that wrote \
                 the replay, narrows the difference down"
        ));
    }
    Ok(found)
}
