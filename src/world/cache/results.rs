//! Events and statistics of a tick, and the buffers of continuous collision.

use alloc::vec::Vec;

use crate::body::Pose;
use crate::collision::Sweep;
use crate::world::events::Events;
use crate::world::stats::StepStats;

/// Events and statistics of the last tick.
#[derive(Clone, Debug, Default)]
pub(crate) struct TickResults {
    pub(crate) events: Events,
    pub(crate) stats: StepStats,
}

impl TickResults {
    pub(crate) fn clear(&mut self) {
        self.events.clear();
        self.stats = StepStats::default();
    }
}

/// Buffers for continuous collision. Their contents are only valid within a tick.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sweeps {
    /// Poses of the bodies of the awake set at the start of the tick, in the order of the set.
    pub(crate) starts: Vec<Pose>,
    /// Bodies that are swept against kinematic bodies, and wait until these have been moved.
    pub(crate) relative: Vec<SweptBody>,
    /// Bullets that wait until all other bodies have been moved.
    pub(crate) bullets: Vec<SweptBody>,
    /// Shapes that have left their fat box within the tick, if there may be sensors.
    pub(crate) left_boxes: Vec<u32>,
}

/// A body that may be fast and has not been moved yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweptBody {
    pub(crate) slot: u32,
    pub(crate) sweep: Sweep,
    /// The pose to which the solver has moved it.
    pub(crate) end: Pose,
    /// Whether it is fast, not only perhaps relative to a kinematic body.
    pub(crate) is_fast: bool,
}
