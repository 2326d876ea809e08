//! Counters of the last tick, for tuning and tests. They are not part of the state.

/// The phases of a tick, in order; see [`super::World::step_observed`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Phase {
    /// Fat boxes, pairs of them, and what they wake.
    BroadPhase,
    /// Manifolds.
    NarrowPhase,
    /// Constraints.
    Prepare,
    /// Sub-steps and restitution.
    Solve,
    /// Contact events, poses, sweeps of fast bodies.
    Finalise,
    /// Islands that fall asleep.
    Sleep,
    /// Events and counters.
    Report,
}

impl Phase {
    /// All phases, in order.
    pub const ALL: [Phase; 7] = [
        Phase::BroadPhase,
        Phase::NarrowPhase,
        Phase::Prepare,
        Phase::Solve,
        Phase::Finalise,
        Phase::Sleep,
        Phase::Report,
    ];
}

/// What the last tick did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct StepStats {
    /// Bodies that were simulated: those awake, and kinematic ones.
    pub bodies: u32,
    /// Joints that were solved.
    pub joints: u32,
    /// Pairs of shapes whose fat boxes overlap.
    pub pairs: u32,
    /// Pairs with contact points.
    pub contacts: u32,
    /// Contact points.
    pub points: u32,
    /// Contact points that continue one of the tick before, and its impulse.
    pub points_kept: u32,
    /// Contact points that pushed in the tick before and are gone, although their shapes still have contact.
    pub points_lost: u32,
    /// Pairs of polygons whose separating axis of the tick before was still one. Two small boxes are never among them.
    pub axis_hits: u32,
    /// Pairs of polygons that got the whole test.
    pub axis_searches: u32,
    /// Fast bodies that were stopped on their way; see [`crate::body::Continuous`].
    pub impacts: u32,
    /// Clamps that changed a result.
    pub faults: u64,
}
