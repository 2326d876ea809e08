#[cfg(test)]
mod tests;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::stage::Stage;
use crate::hash::StateHash;
use crate::lockstep::Game;
use crate::world::{Phase, Snapshot, World};

/// Maximum number of phase digests per tick in a report.
pub const PHASE_DIGESTS_MAX: usize = 1024;

/// Digests of the phases of a tick: see [`World::phase_digests`](crate::world::World::phase_digests).
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::report::{TickPhases, Trace};
/// let mut trace = Trace::<Sandbox>::start(&SandboxSetup::default(), 10)?;
/// (0..30).try_for_each(|_| trace.step(&[vec![]]))?;
/// let report = trace.report();
/// // The last tick: the start and the seven phases of its step.
/// let (tick, TickPhases { digests, .. }) = report.phases().last().expect("the last ticks");
/// assert_eq!((*tick, digests.len()), (30, 8));
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TickPhases {
    /// For each step of the world: the digest at its start, then one after each phase. At most [`PHASE_DIGESTS_MAX`].
    pub digests: Vec<StateHash>,
    /// The world at the start of its last step in this tick, stored as differences from its bytes after the previous
    /// tick.
    start: Vec<Patch>,
    /// Length in bytes of the world at the start of this step.
    start_length: u64,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Patch {
    at: u64,
    bytes: Vec<u8>,
}

/// Maximum number of consecutive equal bytes within a patch.
const GAP: usize = 16;

impl TickPhases {
    /// Plays a tick and records its phases. A game without a world has no phases.
    pub(super) fn of<G: Game>(game: &mut G, inputs: &[G::Input]) -> Self {
        let Some(world) = game.world_mut() else {
            game.step(inputs);
            return TickPhases::default();
        };
        let before = world.to_bytes();
        world.log_phases();
        game.step(inputs);
        let Some(world) = game.world_mut() else {
            return TickPhases::default();
        };
        let digests = world.phase_digests().iter().take(PHASE_DIGESTS_MAX).map(|logged| logged.digest);
        let digests = digests.collect();
        let start = world.step_start().map(bytes_of).unwrap_or_default();
        world.stop_logging_phases();
        TickPhases { digests, start: patches(&before, &start), start_length: start.len() as u64 }
    }

    /// Length of the patches in a report, in bytes.
    pub(super) fn start_bytes(&self) -> usize {
        self.start.iter().map(|patch| 16 + patch.bytes.len()).sum()
    }

    /// Length of this record in a report, with its tick, in bytes.
    pub(super) fn bytes(&self) -> usize {
        32 + 16 * self.digests.len() + self.start_bytes()
    }

    /// Drops the world at the start of the step. The digests remain and still show the stage.
    pub(super) fn forget_start(&mut self) {
        (self.start, self.start_length) = (Vec::new(), 0);
    }

    /// Restores the world at the start of the step from the world after the previous tick, if the bytes are valid.
    pub(super) fn start(&self, before: &World) -> Option<World> {
        let mut bytes = before.to_bytes();
        let patched: usize = self.start.iter().map(|patch| patch.bytes.len()).sum();
        let length = usize::try_from(self.start_length).ok()?;
        if length > bytes.len() + patched {
            return None;
        }
        bytes.resize(length, 0);
        for patch in &self.start {
            let at = usize::try_from(patch.at).ok()?;
            let end = at.checked_add(patch.bytes.len())?;
            bytes.get_mut(at..end)?.copy_from_slice(&patch.bytes);
        }
        World::from_bytes(&bytes).ok()
    }

    /// The stage in which another trajectory with the same start diverged; `None` if digests are missing.
    pub(super) fn parting(&self, other: &Self) -> Option<Stage> {
        if self.digests.is_empty() || other.digests.is_empty() {
            return None;
        }
        let Some(first) = self.digests.iter().zip(&other.digests).position(|(a, b)| a != b) else {
            return Some(Stage::AfterStep);
        };
        // A game may step its world several times in a tick. Each step has the same number of digests.
        Some(match Phase::ALL.get((first % (Phase::ALL.len() + 1)).wrapping_sub(1)) {
            Some(phase) => Stage::Phase(*phase),
            None => Stage::BeforeStep,
        })
    }
}

fn bytes_of(snapshot: &Snapshot) -> Vec<u8> {
    let mut world = World::default();
    world.restore(snapshot);
    world.to_bytes()
}

fn patches(old: &[u8], new: &[u8]) -> Vec<Patch> {
    let differs = |at: usize| old.get(at) != new.get(at);
    let mut patches = Vec::new();
    let mut at = 0;
    while at < new.len() {
        if !differs(at) {
            at += 1;
            continue;
        }
        let (start, mut end) = (at, at + 1);
        while at < new.len() && at < end + GAP {
            at += 1;
            if at < new.len() && differs(at) {
                end = at + 1;
            }
        }
        patches.push(Patch { at: start as u64, bytes: new[start..end].to_vec() });
    }
    patches
}
