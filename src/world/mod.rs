//! The world: bodies, shapes and joints that advance tick by tick.
//!
//! | folder | content |
//! |---|---|
//! | `step` | one tick, one file for each stage |
//! | `edit` | changes between ticks: creation, removal, setters, forces, commands |
//! | `query` | rays, casts, overlaps, characters |
//! | `view` | read-only views of contacts, joints, islands and the surroundings of a body; the cost of a tick |
//! | `snapshot` | saving, restoring, bytes, digests, validation |
//! | `islands` | waking and putting to sleep, for the step and for edits |
//! | `cache` | caches, buffers and results of the last tick |
//!
//! `tests/layers.rs` lists which of these folders each folder may use.

mod cache;
mod config;
mod derived;
mod edit;
mod events;
mod islands;
mod movement;
mod query;
mod snapshot;
mod state;
mod stats;
mod step;
#[cfg(test)]
mod tests;
mod timestep;
mod view;

pub use config::Config;
pub use edit::{BodyField, BodyPose, Command, Explosion, Outcome};
pub use events::{ContactEvent, Events, HitEvent, JointEvent, MoveEvent, SensorChange, SensorEvent};
pub use query::{
    CastHit, ClosestPoints, Displacement, InitialOverlap, Moved, Mover, MoverPlane, MoverState, Probe,
    ProbeHit, QueryFilter, RayHit, TimeOfImpact, clip_velocity, solve_planes,
};
pub use snapshot::{PhaseDigest, Section, Snapshot, SnapshotError, Violation, WorldDigest};
pub use stats::{Phase, StepStats};
pub use timestep::FixedTimestep;
pub(crate) use view::AddedWork;
pub use view::{ContactForce, ContactView, SolverColour};

use alloc::vec::Vec;

use crate::body::{Body, BodyId, BodyKind, JointId, Shape, ShapeId, WorldError};
use crate::collision::BroadPhaseKind;
use crate::math::{Aabb, Rng};
pub use crate::solver::Backend;
use crate::solver::{Joint, Machine};
#[cfg(feature = "parallel")]
use crate::threads::{Sharing, Threads};
use cache::Scratch;
use snapshot::{HashedState, PhaseLog};
use state::State;

/// A physics world.
///
/// [`World::state_hash`], [`World::save`] and [`World::to_bytes`] cover all state that influences later ticks. The same
/// edits in the same order give the same hash after every tick on every machine.
///
/// ```
/// use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, world::{Config, World}};
///
/// let mut world = World::new(Config::default())?;
/// let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1))?);
/// world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor])?;
/// let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?);
/// let ball = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(10))), &[ball])?;
/// for _ in 0..300 {
///     world.step();
/// }
/// let height = world.body(ball).expect("still there").position().y;
/// assert!((height - fx!(0.5)).abs() < fx!(0.001));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug)]
#[doc(alias = "physics world")]
pub struct World {
    state: HashedState,
    scratch: Scratch,
    /// Digests of the state after each phase of a tick, if they are recorded.
    phases: Option<PhaseLog>,
}

impl Default for World {
    /// An empty world with the default settings.
    fn default() -> Self {
        World::of(State::new(Config::default()), BroadPhaseKind::default())
    }
}

impl World {
    /// An empty world.
    ///
    /// # Errors
    /// [`WorldError::Setting`] or [`WorldError::CountSetting`] if a setting is out of range.
    pub fn new(config: Config) -> Result<Self, WorldError> {
        config.validate()?;
        Ok(World::of(State::new(config), BroadPhaseKind::default()))
    }

    /// The state must be valid.
    fn of(mut state: State, broad_phase: BroadPhaseKind) -> Self {
        state.keep_pages();
        let scratch = Scratch::new(broad_phase, &state);
        World { state: HashedState::new(state), scratch, phases: None }
    }

    /// The settings.
    #[must_use]
    pub const fn config(&self) -> &Config {
        &self.state.get().config
    }

    /// Number of ticks since the world was created.
    #[must_use]
    pub const fn tick(&self) -> u64 {
        self.state.get().tick
    }

    /// Number of results of the solver that were clamped to their range since the world was created, plus one for every
    /// tick in which [`Config::pair_limit`] left pairs out.
    #[must_use]
    pub const fn faults(&self) -> u64 {
        self.state.get().faults
    }

    /// Returns a body, or `None` if it is not in the world.
    #[doc(alias = "rigid body")]
    #[must_use]
    pub fn body(&self, id: BodyId) -> Option<&Body> {
        self.state.bodies.get(id)
    }

    /// Returns a shape, or `None` if it is not in the world.
    #[doc(alias = "collider")]
    #[must_use]
    pub fn shape(&self, id: ShapeId) -> Option<&Shape> {
        self.state.shapes.get(id)
    }

    /// Returns the body of a shape, or `None` if the shape is not in the world.
    #[must_use]
    pub fn body_of(&self, shape: ShapeId) -> Option<BodyId> {
        Some(self.shape(shape)?.body())
    }

    /// Returns a joint, or `None` if it is not in the world.
    #[must_use]
    pub fn joint(&self, id: JointId) -> Option<&Joint> {
        self.state.joints.get(id)
    }

    /// Returns all bodies in slot order.
    pub fn bodies(&self) -> impl Iterator<Item = (BodyId, &Body)> {
        self.state.bodies.iter()
    }

    /// Returns all shapes in slot order.
    pub fn shapes(&self) -> impl Iterator<Item = (ShapeId, &Shape)> {
        self.state.shapes.iter()
    }

    /// Returns all joints in slot order.
    pub fn joints(&self) -> impl Iterator<Item = (JointId, &Joint)> {
        self.state.joints.iter()
    }

    /// Number of bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.state.bodies.len()
    }

    /// Number of shapes.
    #[must_use]
    pub fn shape_count(&self) -> usize {
        self.state.shapes.len()
    }

    /// Number of joints.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.state.joints.len()
    }

    /// Number of bodies that a tick simulates: enabled bodies that are kinematic, or dynamic and awake.
    #[must_use]
    pub fn awake_body_count(&self) -> usize {
        let is_simulated = |body: &Body| body.enabled && body.kind() != BodyKind::Fixed && !body.is_asleep();
        self.state.bodies.iter().filter(|(_, body)| is_simulated(body)).count()
    }

    /// Number of pairs of shapes with overlapping fat boxes. Counts only pairs that may collide, and pairs in which one
    /// shape is a sensor that detects the other shape. At least one of the two bodies must be dynamic and awake, or
    /// kinematic and not yet at rest for a whole tick. The next tick adds the pairs of new and moved shapes.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        self.state.contacts.len()
    }

    /// The events of the last tick.
    #[must_use]
    pub const fn events(&self) -> &Events {
        &self.scratch.results.events
    }

    /// Statistics of the last tick.
    #[must_use]
    pub const fn stats(&self) -> &StepStats {
        &self.scratch.results.stats
    }

    /// The world's random number generator, which is part of the state.
    pub fn rng(&mut self) -> &mut Rng {
        &mut self.state.rng
    }

    /// Returns the boxes of the inner nodes of the broad phase's trees, each with its depth, for tools. Empty if the
    /// broad phase is not a [`BroadPhaseKind::Tree`].
    #[must_use]
    pub fn broad_phase_boxes(&self) -> Vec<(Aabb, u32)> {
        self.scratch.shapes.broad_phase().inner_boxes()
    }

    /// Rebuilds every cache without changing any hash. [`World::events`], [`World::contacts`] and [`World::stats`] are
    /// empty until the next tick.
    pub fn clear_scratch(&mut self) {
        self.set_broad_phase(self.scratch.shapes.broad_phase().kind());
    }

    /// Sets the algorithm that finds overlapping fat boxes, and calls [`World::clear_scratch`].
    pub fn set_broad_phase(&mut self, kind: BroadPhaseKind) {
        self.scratch.rebuild(kind, &self.state);
    }

    /// Largest number of threads that share a tick.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.scratch.solver.threads.count()
    }

    /// Sets the largest number of threads that share a tick; 0 counts as 1. Does not change any hash. Returns whether
    /// the threads could be created; if not, nothing changes. Needs the feature `parallel`.
    ///
    /// The world measures ticks with all threads and ticks with the calling thread alone, and mostly uses the faster of
    /// the two. During a tick, waiting threads spin instead of sleeping, so each of them keeps a processor busy. A tick
    /// uses the calling thread alone if the previous tick simulated fewer than 256 bodies, or if a clone of the world
    /// is using the shared threads.
    #[cfg(feature = "parallel")]
    pub fn set_threads(&mut self, count: usize) -> bool {
        self.start_threads(count, Sharing::Adaptive)
    }

    /// Like [`World::set_threads`], but without comparing times. For tests and measurements. Needs the feature
    /// `parallel`.
    #[cfg(feature = "parallel")]
    pub fn force_threads(&mut self, count: usize) -> bool {
        self.start_threads(count, Sharing::Always)
    }

    #[cfg(feature = "parallel")]
    fn start_threads(&mut self, count: usize, sharing: Sharing) -> bool {
        let threads = Threads::new(count, sharing);
        threads.map(|threads| self.scratch.solver.threads = threads).is_some()
    }

    /// The instruction set that the solver uses: the best one of this machine, or the one that [`World::set_backend`]
    /// has set.
    #[must_use]
    pub fn backend(&self) -> Backend {
        self.scratch.solver.machine.backend()
    }

    /// Sets the instruction set that the solver uses. Does not change any hash. Returns false and changes nothing if
    /// `backend` is not in [`Backend::available`].
    #[doc(alias = "SIMD")]
    pub fn set_backend(&mut self, backend: Backend) -> bool {
        let machine = Machine::new(backend);
        machine.inspect(|&machine| self.scratch.solver.machine = machine).is_some()
    }
}
