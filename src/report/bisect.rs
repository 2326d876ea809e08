//! [`bisect`]: finds the tick at which a trajectory diverges from the running engine's, or from another replay's.

use alloc::format;

use super::compare::{CompareError, compare_worlds, survey};
use super::comparison::Comparison;
use super::evidence::Evidence;
use super::replay_comparison;
use super::replayed::{self, Effort};
use crate::lockstep::Game;
use crate::replay::Limits;

/// Finds the first tick at which two trajectories differ, the stage of that tick, and the differences, with the
/// probable origin first. Equal inputs are played once, with a save and a hash per tick. The total cost, including the
/// search for a single bit flip that explains all differences, is less than playing all ticks three times.
///
/// Without `b`, the other trajectory is the one that the running engine computes from the same inputs. A replay shows
/// only between which of its checkpoints the trajectories diverge. A [`Trace`](super::Trace) of these ticks, made by
/// the engine that wrote the replay, shows the exact tick. So does a desync report, for the last seconds before the
/// desync.
///
/// With `b`, the files are recordings of the same match on two machines, or two replays of any setups and inputs. Their
/// inputs are simulated until a difference is found. Two snapshots are compared without a simulation.
///
/// # Errors
/// [`CompareError`] when the files cannot be compared or played.
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
