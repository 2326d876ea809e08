//! What the benchmark asks of an engine, and what it reads from it.

use anyhow::{Result, bail};
use lockstep2d::body::{BodyDef, BodyId, Polygon, ShapeDef};
use lockstep2d::math::{Angle, Fx, Length, Vec2};
use lockstep2d::solver::JointDef;
use lockstep2d::world::{Command, Outcome, Place};
use serde::Serialize;

use crate::box2d::Box2d;
use crate::ours::Ours;
use crate::rapier::Rapier;
use crate::script::{Event, Script};

/// The engines, in the order of a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
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
    /// All of them.
    pub const ALL: [Kind; 3] = [Kind::Ours, Kind::Box2d, Kind::Rapier];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Kind::Ours => "lockstep2d",
            Kind::Box2d => "Box2D",
            Kind::Rapier => "rapier2d",
        }
    }

    /// A world with the scene's setup in it.
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

/// A body, as every engine can report it.
#[derive(Clone, Copy, Debug)]
pub struct BodyState {
    /// Whether forces move it.
    pub dynamic: bool,
    /// Whether it is simulated.
    pub awake: bool,
    /// In kg.
    pub mass: f64,
    /// Centre of mass in metres.
    pub centre: [f64; 2],
    /// In m/s.
    pub velocity: [f64; 2],
}

/// How much there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// All kinds of bodies.
    pub bodies: usize,
    /// A chain counts as its links.
    pub shapes: usize,
    /// Joints.
    pub joints: usize,
}

/// What touches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contacts {
    /// Pairs of shapes with contact points.
    pub pairs: usize,
    /// The deepest penetration in metres, or 0, as the engine found it in its last step.
    pub deepest: f64,
}

/// What a world consists of, to compare engines by.
#[derive(Clone, Copy, Debug)]
pub struct Inventory {
    /// How much there is.
    pub counts: Counts,
    /// Of all dynamic bodies, in kg.
    pub mass: f64,
}

impl Inventory {
    /// That of a world.
    pub fn of(engine: &dyn Engine) -> Self {
        let bodies = engine.bodies();
        let mass = bodies.iter().filter(|body| body.dynamic).map(|body| body.mass).sum();
        Inventory { counts: engine.counts(), mass }
    }

    /// Whether another world is made of the same things. Engines approximate the mass of rounded corners.
    pub fn is_like(&self, other: &Inventory) -> bool {
        self.counts == other.counts && (self.mass - other.mass).abs() <= 0.005 * self.mass
    }
}

/// The operations from which a scene is built in another engine.
pub trait Builder {
    /// The engine's name.
    const NAME: &str;

    /// Creates a body with its shapes at a place, under the id that lockstep2d gave it.
    fn spawn(&mut self, id: BodyId, body: &BodyDef, shapes: &[ShapeDef], place: Place) -> Result<()>;

    /// Creates a joint between two bodies, A first.
    fn join(&mut self, joint: &JointDef, bodies: (BodyId, BodyId)) -> Result<()>;

    /// Removes a body.
    fn despawn(&mut self, body: BodyId) -> Result<()>;

    /// Enables a body.
    fn enable(&mut self, body: BodyId) -> Result<()>;

    /// Gives a kinematic body the velocity that moves it there within a tick.
    fn move_to(&mut self, body: BodyId, position: Vec2<Fx>, angle: Angle) -> Result<()>;
}

/// Does in another engine what a command did to the scene's own world.
pub fn build<B: Builder>(builder: &mut B, event: &Event) -> Result<()> {
    match event {
        (Command::Spawn { body, shapes }, Outcome::Body(id)) => {
            builder.spawn(*id, body, shapes, Place { position: body.position, angle: body.angle })
        }
        (Command::SpawnEach { body, shapes, places }, Outcome::Bodies(ids)) => {
            ids.iter().zip(places).try_for_each(|(id, place)| builder.spawn(*id, body, shapes, *place))
        }
        (Command::AddJoint { joint }, _) => builder.join(joint, joint.bodies()),
        (Command::AddJointEach { joint, ends }, _) => {
            ends.iter().try_for_each(|ends| builder.join(joint, *ends))
        }
        (Command::Despawn { body }, _) => builder.despawn(*body),
        (Command::Enable { body }, _) => builder.enable(*body),
        (Command::MoveTo { body, position, angle }, _) => builder.move_to(*body, *position, *angle),
        (other, _) => bail!("{}'s adapter does not know {other:?}", B::NAME),
    }
}

/// A world in some engine.
pub trait Engine {
    /// Does what a command did to the scene's own world.
    fn apply(&mut self, event: &Event) -> Result<()>;

    /// 1/60 s in 4 sub-steps.
    fn step(&mut self);

    /// Every body that is not fixed, in the order of lockstep2d's slots.
    fn bodies(&self) -> Vec<BodyState>;

    /// How much there is.
    fn counts(&self) -> Counts;

    /// What touches.
    fn contacts(&self) -> Contacts;

    /// The largest distance of a joint's two anchors, in metres, unless there are no joints.
    fn joint_gap(&self) -> Option<f64>;

    /// Saves the world, replacing what was saved before.
    fn save(&mut self);

    /// Size of what was saved, as bytes for a file.
    fn saved_bytes(&self) -> usize;

    /// Returns to what was saved.
    fn restore(&mut self) -> Result<()>;

    /// A hash of all that influences the future, if the engine has one.
    fn hash(&self) -> Option<u128>;
}

/// An engine's number as a float.
pub fn float(x: Fx) -> f64 {
    x.to_num()
}

/// A vector as floats.
pub fn floats(v: Vec2<Fx>) -> [f64; 2] {
    [float(v.x), float(v.y)]
}

/// The same in single precision, which both peers compute in.
pub fn singles(v: Vec2<Fx>) -> [f32; 2] {
    [v.x.to_num(), v.y.to_num()]
}

/// The corners of a polygon, moved.
pub fn corners(polygon: &Polygon, offset: Vec2<Fx>) -> Vec<[f32; 2]> {
    let moved = |vertex: &Vec2<Length>| singles(vertex.widen() + offset);
    polygon.vertices().iter().map(moved).collect()
}

/// Values by slot of lockstep2d's handles: the peers' own handles.
pub struct Slots<T>(Vec<Option<T>>);

impl<T: Copy> Slots<T> {
    /// None yet.
    pub const fn new() -> Self {
        Slots(Vec::new())
    }

    /// Sets that of a body.
    pub fn insert(&mut self, id: BodyId, value: T) {
        let index = id.index() as usize;
        if self.0.len() <= index {
            self.0.resize(index + 1, None);
        }
        self.0[index] = Some(value);
    }

    /// That of a body.
    pub fn get(&self, id: BodyId) -> Result<T> {
        let found = self.0.get(id.index() as usize).copied().flatten();
        found.ok_or_else(|| anyhow::anyhow!("no body {id}"))
    }

    /// Removes that of a body.
    pub fn remove(&mut self, id: BodyId) -> Result<T> {
        let value = self.get(id)?;
        self.0[id.index() as usize] = None;
        Ok(value)
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = T> {
        self.0.iter().copied().flatten()
    }
}
