use alloc::vec::Vec;

use crate::body::Pose;
use crate::collision::Sweep;
use crate::math::Aabb;
use crate::world::events::Events;
use crate::world::stats::StepStats;

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

/// Output of a thread that predicts motion. Aligned, so that no two threads write the same cache line.
#[derive(Clone, Debug, Default)]
#[repr(align(128))]
pub(crate) struct Predicted {
    /// Slots of the shapes that move in this tick. The next tick reads them to reset their motion.
    pub(crate) moving: Vec<u32>,
    pub(crate) outgrown: Vec<Outgrown>,
    /// Slots of bodies with a shape in the range of another thread.
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

#[derive(Clone, Copy, Debug)]
pub(crate) struct Outgrown {
    pub(crate) shape: u32,
    pub(crate) fat: Aabb,
    pub(crate) is_active: bool,
}

/// Output of a thread that moves bodies. Aligned like [`Predicted`].
#[derive(Clone, Debug, Default)]
#[repr(align(128))]
pub(crate) struct Finalised {
    /// Kinematic bodies in their first tick at rest, after which they are inactive.
    pub(crate) settled: Vec<u32>,
    /// Shapes that have left their fat box.
    pub(crate) left_boxes: Vec<u32>,
    /// Fast bodies that are swept against fixed bodies only.
    pub(crate) swept: Vec<SweptBody>,
    /// Slots and poses of the bodies in `swept`, after they were swept.
    pub(crate) moved: Vec<(u32, Pose)>,
    /// Number of impacts of the bodies in `swept`, if several threads share the tick. A tick on one thread counts them
    /// directly in the statistics.
    pub(crate) impacts: u32,
    /// Bodies to be swept against fixed and kinematic bodies, once the kinematic bodies have been moved.
    pub(crate) relative: Vec<SweptBody>,
    pub(crate) bullets: Vec<SweptBody>,
    /// Slots and new poses of bodies with a shape in the range of another thread. These bodies have not been moved yet.
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

/// Buffers for continuous collision and sensors, valid within a tick.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sweeps {
    /// Poses at the start of the tick, in the order of the awake set.
    pub(crate) starts: Vec<Pose>,
    /// Bodies to be swept against kinematic bodies.
    pub(crate) relative: Vec<SweptBody>,
    /// Bullets, which are swept after all other bodies have been moved.
    pub(crate) bullets: Vec<SweptBody>,
    /// Shapes that have left their fat box, if there may be sensors.
    pub(crate) left_boxes: Vec<u32>,
}

/// A body that may be fast and has not been moved yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweptBody {
    pub(crate) slot: u32,
    pub(crate) sweep: Sweep,
    /// The pose that the solver has computed.
    pub(crate) end: Pose,
    /// Whether the body is fast by its own motion. Otherwise it may still be fast relative to a kinematic body.
    pub(crate) is_fast: bool,
}
