//! Events and statistics of a tick, the buffers of the threads that predict and move bodies, and those of continuous
//! collision.

use alloc::vec::Vec;

use crate::body::Pose;
use crate::collision::Sweep;
use crate::math::Aabb;
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

/// The output of a thread that predicts the motion of its bodies. Aligned, so that no two threads write the same cache
/// line.
#[derive(Clone, Debug, Default)]
#[repr(align(128))]
pub(crate) struct Predicted {
    /// Slots of the shapes whose motion was predicted. They are kept until the next tick.
    pub(crate) moving: Vec<u32>,
    pub(crate) outgrown: Vec<Outgrown>,
    /// Slots of the bodies with a shape in the range of another thread.
    pub(crate) others: Vec<u32>,
}

impl Predicted {
    pub(crate) fn clear(&mut self) {
        let Predicted { moving, outgrown, others } = self;
        moving.clear();
        outgrown.clear();
        others.clear();
    }
}

/// A shape that needs a new fat box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outgrown {
    /// Slot of the shape.
    pub(crate) shape: u32,
    pub(crate) fat: Aabb,
    /// Whether its body is active.
    pub(crate) is_active: bool,
}

/// The output of a thread that moves its bodies to the poses of the solver. Aligned like [`Predicted`].
#[derive(Clone, Debug, Default)]
#[repr(align(128))]
pub(crate) struct Finalised {
    /// Kinematic bodies in their first tick at rest, after which they are inactive.
    pub(crate) settled: Vec<u32>,
    /// Shapes that have left their fat box.
    pub(crate) left_boxes: Vec<u32>,
    /// Fast bodies that only fixed bodies can stop.
    pub(crate) swept: Vec<SweptBody>,
    /// Poses of the bodies of `swept` after their sweep.
    pub(crate) moved: Vec<(u32, Pose)>,
    /// Number of the bodies of `swept` that an impact has stopped.
    pub(crate) impacts: u32,
    /// Bodies that may be fast relative to kinematic bodies.
    pub(crate) relative: Vec<SweptBody>,
    /// Fast bullets.
    pub(crate) bullets: Vec<SweptBody>,
    /// Bodies with a shape in the range of another thread, and their poses. They have not been moved.
    pub(crate) others: Vec<(u32, Pose)>,
}

impl Finalised {
    pub(crate) fn clear(&mut self) {
        let Finalised { settled, left_boxes, swept, moved, impacts, relative, bullets, others } = self;
        settled.clear();
        left_boxes.clear();
        swept.clear();
        moved.clear();
        *impacts = 0;
        relative.clear();
        bullets.clear();
        others.clear();
    }
}

/// Buffers for continuous collision and for sensors. Their contents are only valid within a tick.
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
    /// The pose to which the solver has moved the body.
    pub(crate) end: Pose,
    /// Whether the body's displacement and rotation make it fast. If not, it may still be fast relative to a kinematic
    /// body.
    pub(crate) is_fast: bool,
}
