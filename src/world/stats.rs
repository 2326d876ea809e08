/// The phases of a tick, in order; see [`super::World::step_observed`].
///
/// ```
/// use lockstep2d::world::{Phase, World};
/// # let mut world = World::default();
/// // A profiler: the engine reports the beginning of each phase, and the game reads the clock.
/// let mut marks = vec![];
/// world.step_observed(|phase| marks.push((phase, std::time::Instant::now())));
/// assert!(marks.iter().map(|(phase, _)| *phase).eq(Phase::ALL));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Phase {
    /// Refits fat boxes, updates pairs, wakes islands that active bodies touch.
    BroadPhase,
    /// Finds manifolds.
    NarrowPhase,
    /// Prepares constraints, and applies areas.
    Prepare,
    /// Runs the sub-steps and restitution.
    Solve,
    /// Reports contacts, moves bodies, sweeps fast bodies, reports sensors, checks joint thresholds.
    Finalise,
    /// Puts islands to sleep.
    Sleep,
    /// Reports moves and statistics.
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

/// Statistics of the last tick.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::World};
/// use lockstep2d::world::StepStats;
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-0.5))), &[square])?;
/// # world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[square])?;
/// world.step();
/// // Text of a debug overlay.
/// let StepStats { bodies, contacts, points, .. } = world.stats();
/// assert_eq!(format!("{bodies} bodies, {contacts} contacts, {points} points"), "1 bodies, 1 contacts, 2 points");
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct StepStats {
    /// Number of simulated bodies: enabled bodies that are kinematic, or dynamic and awake.
    pub bodies: u32,
    /// Number of solved joints, without those that broke in the tick.
    pub joints: u32,
    /// Number of pairs of shapes: see [`World::pair_count`](super::World::pair_count).
    pub pairs: u32,
    /// Number of pairs with contact points. Pairs with a sensor do not count.
    pub contacts: u32,
    /// Number of contact points.
    pub points: u32,
    /// Number of contact points that existed in the previous tick and start with the impulse of that tick (warm start).
    pub points_kept: u32,
    /// Number of contact points that had an impulse in the previous tick and are gone, although their shapes still
    /// touch.
    pub points_lost: u32,
    /// Number of pairs of shapes that are known to be apart because the separating axis of an earlier tick still
    /// separates them.
    pub axis_hits: u32,
    /// Number of pairs of shapes for which separating axes were searched, because no cached axis separated them.
    pub axis_searches: u32,
    /// Number of fast bodies that continuous collision has stopped; see [`crate::body::Continuous`].
    pub impacts: u32,
    /// Number of results that were out of range and were clamped, plus 1 if [`super::Config::pair_limit`] left pairs
    /// out.
    pub faults: u64,
}
