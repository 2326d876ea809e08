//! [`Engine`]: the interface that drives an engine and reads its state.

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

/// Engines, in the order in which a round runs them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Ours,
    /// Box2D 3.2 with AVX2.
    Box2d,
    /// rapier2d with `enhanced-determinism`.
    Rapier,
}

impl Kind {
    pub const ALL: [Kind; 3] = [Kind::Ours, Kind::Box2d, Kind::Rapier];

    pub const fn name(self) -> &'static str {
        match self {
            Kind::Ours => "lockstep2d",
            Kind::Box2d => "Box2D",
            Kind::Rapier => "rapier2d",
        }
    }

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

#[derive(Clone, Copy, Debug)]
pub struct BodyState {
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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Number of bodies of all kinds.
    pub bodies: usize,
    /// Number of shapes. A chain counts once per link.
    pub shapes: usize,
    pub joints: usize,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contacts {
    /// Number of pairs of shapes with contact points.
    pub pairs: usize,
    /// Deepest penetration in metres in the engine's last step, or 0.
    pub deepest: f64,
}

/// Contents of a world, to check that the engines simulate the same scene.
#[derive(Clone, Copy, Debug)]
pub struct Inventory {
    pub counts: Counts,
    /// Total mass of all dynamic bodies, in kg.
    pub mass: f64,
}

impl Inventory {
    pub fn of(engine: &dyn Engine) -> Self {
        let bodies = engine.bodies();
        let mass = bodies.iter().filter(|body| body.dynamic).map(|body| body.mass).sum();
        Inventory { counts: engine.counts(), mass }
    }

    /// Whether the counts are equal, and the masses equal within 0.5 %. Masses differ because engines approximate
    /// rounded corners.
    pub fn is_like(&self, other: &Inventory) -> bool {
        self.counts == other.counts && (self.mass - other.mass).abs() <= 0.005 * self.mass
    }
}

/// Builds a scene in an engine other than lockstep2d.
pub trait Builder {
    const NAME: &str;

    /// Creates a body at a pose. Later commands refer to the body by the id from lockstep2d.
    fn spawn(&mut self, id: BodyId, body: &BodyDef, shapes: &[ShapeDef], pose: BodyPose) -> Result<()>;

    /// Joins two bodies. The first one is body A of the joint.
    fn join(&mut self, joint: &JointDef, bodies: (BodyId, BodyId)) -> Result<()>;

    fn despawn(&mut self, body: BodyId) -> Result<()>;

    fn enable(&mut self, body: BodyId) -> Result<()>;

    /// Gives a kinematic body the velocity that moves it to a pose within a tick.
    fn move_to(&mut self, body: BodyId, position: Vec2<Fx>, angle: Angle) -> Result<()>;
}

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

/// Number of saves of a rollback frame: one at its start and one after each of eight ticks.
pub const SAVES: usize = 9;

pub trait Engine {
    /// Executes a recorded command. New bodies are registered under the handles from lockstep2d.
    fn apply(&mut self, event: &Event) -> Result<()>;

    /// Advances by one step with the scene's configuration.
    fn step(&mut self);

    /// Bodies that are not fixed, in the order of lockstep2d's slots.
    fn bodies(&self) -> Vec<BodyState>;

    fn counts(&self) -> Counts;

    fn contacts(&self) -> Contacts;

    /// Largest distance between the anchors of a joint, in metres. `None` without joints.
    fn joint_gap(&self) -> Option<f64>;

    /// Saves the world in one of [`SAVES`] slots, whose memory is reused.
    fn save(&mut self, slot: usize);

    /// Size of the saved world as a file, in bytes.
    fn saved_bytes(&self, slot: usize) -> usize;

    /// Number of bytes of the save in a slot that are not shared with the world. The saves of Box2D and rapier2d share
    /// no bytes.
    fn held_bytes(&self, slot: usize) -> usize {
        self.saved_bytes(slot)
    }

    fn restore(&mut self, slot: usize) -> Result<()>;

    /// Checksum of the state that was just saved in a slot: the engine's state hash if it has one, otherwise the
    /// XXH3-128 of the save.
    fn checksum(&self, slot: usize) -> u128;

    /// Hash of all state that influences later steps. `None` if the engine cannot compute one.
    fn hash(&self) -> Option<u128>;
}

pub fn float(x: Fx) -> f64 {
    x.to_num()
}

pub fn floats(v: Vec2<Fx>) -> [f64; 2] {
    [float(v.x), float(v.y)]
}

/// Vector in single precision, as in Box2D and rapier2d.
pub fn singles(v: Vec2<Fx>) -> [f32; 2] {
    [v.x.to_num(), v.y.to_num()]
}

/// Corners of a polygon, moved by an offset.
pub fn corners(polygon: &Polygon, offset: Vec2<Fx>) -> Vec<[f32; 2]> {
    let moved = |vertex: &Vec2<Length>| singles(vertex.widen() + offset);
    polygon.vertices().iter().map(moved).collect()
}

/// Handles of another engine's bodies, indexed by the slots of lockstep2d's bodies.
pub struct Slots<T>(Vec<Option<T>>);

impl<T: Copy> Slots<T> {
    pub const fn new() -> Self {
        Slots(Vec::new())
    }

    pub fn insert(&mut self, id: BodyId, value: T) {
        let index = id.index() as usize;
        if self.0.len() <= index {
            self.0.resize(index + 1, None);
        }
        self.0[index] = Some(value);
    }

    pub fn get(&self, id: BodyId) -> Result<T> {
        let found = self.0.get(id.index() as usize).copied().flatten();
        found.ok_or_else(|| anyhow::anyhow!("no body {id}"))
    }

    pub fn remove(&mut self, id: BodyId) -> Result<T> {
        let value = self.get(id)?;
        self.0[id.index() as usize] = None;
        Ok(value)
    }

    /// Values in slot order.
    pub fn iter(&self) -> impl Iterator<Item = T> {
        self.0.iter().copied().flatten()
    }
}
