//! [`Engine`]: the interface that the benchmark uses to drive an engine and to read its state.

use anyhow::{Result, bail};
use lockstep2d::body::{BodyDef, BodyId, Polygon, ShapeDef};
use lockstep2d::math::{Angle, Fx, Length, Vec2};
use lockstep2d::solver::JointDef;
use lockstep2d::world::{BodyPose, Command, Outcome};
use serde::Serialize;

use crate::box2d::Box2d;
use crate::ours::Ours;
use crate::rapier::Rapier;
use crate::script::{Event, Script};

/// The engines, in the order of a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// lockstep2d.
    Ours,
    /// Box2D 3.2 with AVX2.
    Box2d,
    /// rapier2d with `enhanced-determinism`.
    Rapier,
}

impl Kind {
    /// All engines, in the order of a round.
    pub const ALL: [Kind; 3] = [Kind::Ours, Kind::Box2d, Kind::Rapier];

    /// Name of the engine.
    pub const fn name(self) -> &'static str {
        match self {
            Kind::Ours => "lockstep2d",
            Kind::Box2d => "Box2D",
            Kind::Rapier => "rapier2d",
        }
    }

    /// Builds a world with the scene's setup.
    pub fn build(self, script: &Script, threads: usize) -> Result<Box<dyn Engine>> {
        let mut engine: Box<dyn Engine> = match self {
            Kind::Ours => Box::new(Ours::new(&script.config, threads)?),
            Kind::Box2d => Box::new(Box2d::new(&script.config, threads)?),
            Kind::Rapier => Box::new(Rapier::new(&script.config, threads)?),
        };
        for event in &script.setup {
            engine.apply(event)?;
        }
        Ok(engine)
    }
}

/// State of a body that every engine can report.
#[derive(Clone, Copy, Debug)]
pub struct BodyState {
    /// Whether the body is dynamic.
    pub dynamic: bool,
    /// Whether the body is enabled and not asleep.
    pub awake: bool,
    /// Mass in kg.
    pub mass: f64,
    /// Centre of mass in metres.
    pub centre: [f64; 2],
    /// Velocity of the centre of mass, in m/s.
    pub velocity: [f64; 2],
}

/// Number of objects in a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Bodies of all kinds.
    pub bodies: usize,
    /// Shapes; each link of a chain counts.
    pub shapes: usize,
    /// Joints.
    pub joints: usize,
}

/// Contacts of a world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contacts {
    /// Pairs of shapes with contact points.
    pub pairs: usize,
    /// Deepest penetration in metres as found by the engine's last step, or 0.
    pub deepest: f64,
}

/// Contents of a world, for checking that the engines simulate the same scene.
#[derive(Clone, Copy, Debug)]
pub struct Inventory {
    /// Number of objects.
    pub counts: Counts,
    /// Total mass of all dynamic bodies, in kg.
    pub mass: f64,
}

impl Inventory {
    /// Returns the inventory of a world.
    pub fn of(engine: &dyn Engine) -> Self {
        let bodies = engine.bodies();
        let mass = bodies.iter().filter(|body| body.dynamic).map(|body| body.mass).sum();
        Inventory { counts: engine.counts(), mass }
    }

    /// Returns whether another world has the same counts, and the same mass within 0.5 %: engines approximate the mass
    /// of rounded corners.
    pub fn is_like(&self, other: &Inventory) -> bool {
        self.counts == other.counts && (self.mass - other.mass).abs() <= 0.005 * self.mass
    }
}

/// The operations that build a scene in an engine other than lockstep2d.
pub trait Builder {
    /// The engine's name.
    const NAME: &str;

    /// Creates a body with its shapes at a pose, under the id that lockstep2d gave it.
    fn spawn(&mut self, id: BodyId, body: &BodyDef, shapes: &[ShapeDef], pose: BodyPose) -> Result<()>;

    /// Creates a joint between two bodies, A first.
    fn join(&mut self, joint: &JointDef, bodies: (BodyId, BodyId)) -> Result<()>;

    /// Removes a body.
    fn despawn(&mut self, body: BodyId) -> Result<()>;

    /// Enables a body.
    fn enable(&mut self, body: BodyId) -> Result<()>;

    /// Gives a kinematic body the velocity that moves it to a pose within a tick.
    fn move_to(&mut self, body: BodyId, position: Vec2<Fx>, angle: Angle) -> Result<()>;
}

/// Executes a recorded command in another engine.
pub fn build<B: Builder>(builder: &mut B, event: &Event) -> Result<()> {
    match event {
        (Command::Spawn { body, shapes }, Outcome::Body(id)) => {
            builder.spawn(*id, body, shapes, BodyPose { position: body.position, angle: body.angle })
        }
        (Command::SpawnEach { body, shapes, poses }, Outcome::Bodies(ids)) => {
            ids.iter().zip(poses).try_for_each(|(id, pose)| builder.spawn(*id, body, shapes, *pose))
        }
        (Command::AddJoint { joint }, _) => builder.join(joint, joint.bodies()),
        (Command::AddJointEach { joint, ends }, _) => {
            ends.iter().try_for_each(|ends| builder.join(joint, *ends))
        }
        (Command::Despawn { body }, _) => builder.despawn(*body),
        (Command::Enable { body }, _) => builder.enable(*body),
        (Command::MoveTo { body, position, angle }, _) => builder.move_to(*body, *position, *angle),
        (other, _) => bail!("the {} adapter does not support {other:?}", B::NAME),
    }
}

/// Number of saves that an engine keeps: the start of a rollback frame and its eight ticks.
pub const SAVES: usize = 9;

/// World in one of the engines.
pub trait Engine {
    /// Executes a recorded command. Bodies that it creates are registered under the handles that lockstep2d gave them.
    fn apply(&mut self, event: &Event) -> Result<()>;

    /// Advances by one step with the scene's configuration: 1/60 s in 4 sub-steps.
    fn step(&mut self);

    /// Returns every body that is not fixed, in the order of lockstep2d's slots.
    fn bodies(&self) -> Vec<BodyState>;

    /// Returns the number of objects.
    fn counts(&self) -> Counts;

    /// Returns the contacts.
    fn contacts(&self) -> Contacts;

    /// Returns the largest distance between the two anchors of a joint, in metres; `None` without joints.
    fn joint_gap(&self) -> Option<f64>;

    /// Saves the world in one of [`SAVES`] slots, and reuses the memory of the save that was there.
    fn save(&mut self, slot: usize);

    /// Size of the saved world as a file, in bytes.
    fn saved_bytes(&self, slot: usize) -> usize;

    /// Memory of the save in a slot that is not shared with the world, in bytes. A save of Box2D or rapier2d shares
    /// none: it has the size of the file.
    fn held_bytes(&self, slot: usize) -> usize {
        self.saved_bytes(slot)
    }

    /// Restores the world saved in a slot.
    fn restore(&mut self, slot: usize) -> Result<()>;

    /// Returns the checksum of a tick that has just been saved in a slot: the hash of the state if the engine has one,
    /// otherwise the XXH3-128 of the save.
    fn checksum(&self, slot: usize) -> u128;

    /// Returns a hash of all state that influences later steps; `None` if the engine has none.
    fn hash(&self) -> Option<u128>;
}

/// Converts a fixed-point number to a float.
pub fn float(x: Fx) -> f64 {
    x.to_num()
}

/// Converts a vector to floats.
pub fn floats(v: Vec2<Fx>) -> [f64; 2] {
    [float(v.x), float(v.y)]
}

/// Converts a vector to single precision, with which Box2D and rapier2d compute.
pub fn singles(v: Vec2<Fx>) -> [f32; 2] {
    [v.x.to_num(), v.y.to_num()]
}

/// Returns the corners of a polygon, moved by an offset.
pub fn corners(polygon: &Polygon, offset: Vec2<Fx>) -> Vec<[f32; 2]> {
    let moved = |vertex: &Vec2<Length>| singles(vertex.widen() + offset);
    polygon.vertices().iter().map(moved).collect()
}

/// Map from lockstep2d's body handles, by slot, to the handles of another engine.
pub struct Slots<T>(Vec<Option<T>>);

impl<T: Copy> Slots<T> {
    /// Creates an empty map.
    pub const fn new() -> Self {
        Slots(Vec::new())
    }

    /// Sets the value of a body.
    pub fn insert(&mut self, id: BodyId, value: T) {
        let index = id.index() as usize;
        if self.0.len() <= index {
            self.0.resize(index + 1, None);
        }
        self.0[index] = Some(value);
    }

    /// Returns the value of a body.
    pub fn get(&self, id: BodyId) -> Result<T> {
        let found = self.0.get(id.index() as usize).copied().flatten();
        found.ok_or_else(|| anyhow::anyhow!("no body {id}"))
    }

    /// Removes and returns the value of a body.
    pub fn remove(&mut self, id: BodyId) -> Result<T> {
        let value = self.get(id)?;
        self.0[id.index() as usize] = None;
        Ok(value)
    }

    /// Returns all values, in slot order.
    pub fn iter(&self) -> impl Iterator<Item = T> {
        self.0.iter().copied().flatten()
    }
}
