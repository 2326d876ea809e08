//! The world: bodies, shapes and joints that advance together, tick by tick.

mod adjust;
mod bytes;
mod change;
mod character;
mod command;
mod config;
mod contact_view;
mod contacts;
mod continuous;
mod digest;
mod events;
mod explosion;
mod fault;
mod island_view;
mod islands;
mod joint_links;
mod joint_view;
mod look_ahead;
mod manifolds;
mod mover_planes;
mod moves;
mod outlook;
mod pairs;
mod phases;
mod probe;
mod push;
mod query;
mod rollback;
mod scratch;
mod state;
mod stats;
mod step;
mod stress;
mod timestep;
mod validate;
mod view;

pub use bytes::SnapshotError;
pub use change::Place;
pub use character::{Moved, Mover, MoverState};
pub use command::{Command, Outcome};
pub use config::Config;
pub use contact_view::{ContactForce, ContactView, SolverColour};
use digest::Hashed;
pub use digest::{Section, WorldDigest};
pub use events::{ContactEvent, Events, HitEvent, JointEvent, MoveEvent, SensorEvent};
pub use explosion::Explosion;
pub use fault::Motion;
pub use mover_planes::{MoverPlane, clip_velocity, solve_planes};
use phases::Noted;
pub use phases::PhaseDigest;
pub use probe::Probe;
pub use query::{CastHit, Proximity, QueryFilter, RayHit};
pub use rollback::Snapshot;
pub use stats::{Phase, StepStats};
pub use timestep::FixedTimestep;
pub use validate::Violation;

use alloc::vec::Vec;

use crate::body::{Body, BodyId, BodyKind, JointId, Shape, ShapeId, WorldError};
use crate::collision::BroadPhaseKind;
use crate::math::{Aabb, Rng};
pub use crate::solver::Backend;
use crate::solver::{Joint, Machine};
#[cfg(feature = "parallel")]
use crate::threads::Threads;
use scratch::Scratch;
use state::State;

/// A physics world.
///
/// Everything that influences the future is its state, which is what [`World::state_hash`], [`World::save`] and
/// [`World::to_bytes`] see. The same changes in the same order give the same hash after every tick, on every
/// machine.
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
pub struct World {
    state: Hashed,
    scratch: Scratch,
    /// What each phase of the last tick has left behind, if somebody wants to know.
    phases: Option<Noted>,
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
    /// [`WorldError::Setting`] when a setting is out of range.
    pub fn new(config: Config) -> Result<Self, WorldError> {
        config.validate()?;
        Ok(World::of(State::new(config), BroadPhaseKind::default()))
    }

    fn of(mut state: State, broad_phase: BroadPhaseKind) -> Self {
        state.keep_pages();
        let scratch = Scratch::new(broad_phase, &state);
        World { state: Hashed::new(state), scratch, phases: None }
    }

    /// The settings.
    #[must_use]
    pub const fn config(&self) -> &Config {
        &self.state.get().config
    }

    /// `Solver::push_error` of the last tick.
    #[cfg(test)]
    pub(crate) fn push_error(&self) -> (i32, i32) {
        let Config { solver, gravity, tick_rate, .. } = &self.state.get().config;
        self.scratch.solver.clone().push_error(&crate::solver::Tuning::new(solver, *gravity, *tick_rate))
    }

    /// Ticks since the world was made.
    #[must_use]
    pub const fn tick(&self) -> u64 {
        self.state.get().tick
    }

    /// How often a clamp of the solver has changed a result since the world was made. It never goes back to 0,
    /// and is 0 as long as speeds, impulses and displacements stay in their ranges.
    #[must_use]
    pub const fn faults(&self) -> u64 {
        self.state.get().faults
    }

    /// A body, while it is in the world.
    #[must_use]
    pub fn body(&self, id: BodyId) -> Option<&Body> {
        self.state.bodies.get(id)
    }

    /// A shape, while it is in the world.
    #[must_use]
    pub fn shape(&self, id: ShapeId) -> Option<&Shape> {
        self.state.shapes.get(id)
    }

    /// A joint, while it is in the world.
    #[must_use]
    pub fn joint(&self, id: JointId) -> Option<&Joint> {
        self.state.joints.get(id)
    }

    /// All bodies in slot order.
    pub fn bodies(&self) -> impl Iterator<Item = (BodyId, &Body)> {
        self.state.bodies.iter()
    }

    /// All shapes in slot order.
    pub fn shapes(&self) -> impl Iterator<Item = (ShapeId, &Shape)> {
        self.state.shapes.iter()
    }

    /// All joints in slot order.
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

    /// Number of bodies that are simulated: those awake, and kinematic ones.
    #[must_use]
    pub fn awake_body_count(&self) -> usize {
        let works = |body: &Body| body.enabled && body.kind() != BodyKind::Fixed && !body.is_asleep();
        self.state.bodies.iter().filter(|(_, body)| works(body)).count()
    }

    /// Number of pairs of shapes near each other, one of them awake: what the next tick's cost depends on, with bodies and joints.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        self.state.contacts.len()
    }

    /// What happened in the last tick.
    #[must_use]
    pub const fn events(&self) -> &Events {
        &self.scratch.events
    }

    /// Counters of the last tick.
    #[must_use]
    pub const fn stats(&self) -> &StepStats {
        &self.scratch.stats
    }

    /// The world's random numbers: part of the state, so that a rollback rolls them back too.
    pub fn rng(&mut self) -> &mut Rng {
        &mut self.state.rng
    }

    /// The boxes in which the broad phase has put those of the shapes, each with its distance from the root: what queries
    /// and pairs have to descend through. A cache, so that it depends on the past, and a copy of this world may have
    /// others. Only [`BroadPhaseKind::Tree`] has any.
    #[must_use]
    pub fn broad_phase_boxes(&self) -> Vec<(Aabb, u32)> {
        self.scratch.broad_phase.inner_boxes()
    }

    /// Drops every cache. No hash changes by it: the next tick only takes longer.
    pub fn clear_scratch(&mut self) {
        self.set_broad_phase(self.scratch.broad_phase.kind());
    }

    /// Chooses how overlapping pairs are found. No hash changes by it.
    pub fn set_broad_phase(&mut self, kind: BroadPhaseKind) {
        let solver = self.scratch.solver.emptied();
        self.scratch = Scratch { solver, ..Scratch::new(kind, &self.state) };
    }

    /// How many threads share a tick.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.scratch.solver.threads.count()
    }

    /// Shares every tick among a number of threads, from 1. No hash changes by it. Returns whether they could be had; if
    /// not, nothing changes. It pays for thousands of bodies. Clones of the world use the same threads.
    #[cfg(feature = "parallel")]
    pub fn set_threads(&mut self, count: usize) -> bool {
        let threads = Threads::new(count);
        threads.map(|threads| self.scratch.solver.threads = threads).is_some()
    }

    /// How the solver computes: the best way that this machine has, unless [`World::set_backend`] chose another.
    #[must_use]
    pub fn backend(&self) -> Backend {
        self.scratch.solver.machine.backend()
    }

    /// Chooses how the solver computes. No hash changes by it. Returns whether this machine can; if not, nothing
    /// changes.
    pub fn set_backend(&mut self, backend: Backend) -> bool {
        let machine = Machine::new(backend);
        machine.inspect(|&machine| self.scratch.solver.machine = machine).is_some()
    }
}
