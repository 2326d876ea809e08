use alloc::vec::Vec;

use super::rollback::Snapshot;
use crate::hash::StateHash;
use crate::world::stats::Phase;

/// Digest after a phase of a tick. Two runs diverge in the first phase whose digests differ.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::{BodyField, World}};
/// use lockstep2d::world::{Phase, PhaseDigest};
/// # let mut a = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let body = a.spawn(&BodyDef::dynamic(), &[square])?;
/// # let mut b = a.clone();
/// [&mut a, &mut b].into_iter().for_each(|world| { world.log_phases(); world.step(); });
/// // Two runs of a tick that should be equal: each has a digest of the start and of every phase.
/// let first_difference = a.phase_digests().iter().zip(b.phase_digests()).find(|(a, b)| a != b);
/// assert_eq!(first_difference, None);
/// let phases: Vec<_> = a.phase_digests().iter().map(|PhaseDigest { phase, .. }| *phase).collect();
/// assert_eq!((phases.len(), phases[0], phases[1]), (8, None, Some(Phase::BroadPhase)));
/// # let _ = (body, BodyField::ALL);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhaseDigest {
    /// The phase, or `None` for the beginning of the tick.
    pub phase: Option<Phase>,
    /// Digest of the state at the end of the phase. After [`Phase::NarrowPhase`] it includes the manifolds, and after
    /// [`Phase::Prepare`] and [`Phase::Solve`] the velocities and displacements that only the solver has so far.
    pub digest: StateHash,
}

/// The recording that [`World::log_phases`](crate::world::World::log_phases) has started.
#[derive(Clone, Debug, Default)]
pub(crate) struct PhaseLog {
    pub(crate) digests: Vec<PhaseDigest>,
    /// The state at the start of the last recorded tick, or `None` before the first one.
    pub(crate) start: Option<Snapshot>,
}
