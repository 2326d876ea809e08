//! Joints as a user defines them and as the state keeps them.

use serde::{Deserialize, Serialize};

use crate::body::{BodyId, REACH_MAX, WorldError};
use crate::math::{Fx, Speed, Vec2};

/// What to connect two bodies with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum JointDef {
    /// A hinge.
    Revolute(RevoluteDef),
}

impl From<RevoluteDef> for JointDef {
    fn from(def: RevoluteDef) -> Self {
        JointDef::Revolute(def)
    }
}

/// A hinge: pins a point of body A to a point of body B.
///
/// ```
/// use lockstep2d::{body::BodyDef, fx, solver::RevoluteDef, world::World};
/// # use lockstep2d::body::{Polygon, ShapeDef};
/// let mut world = World::default();
/// let post = world.spawn(&BodyDef::fixed(), &[])?;
/// let plank = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.1))?);
/// let gate = world.spawn(&BodyDef::dynamic().position(fx!(1), fx!(0)), &[plank])?;
/// let hinge = world.add_joint(&RevoluteDef::new(post, gate).anchor_b(fx!(-1), fx!(0)).into())?;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RevoluteDef {
    /// One body.
    pub body_a: BodyId,
    /// The other body.
    pub body_b: BodyId,
    /// The pinned point in A's frame, in metres, within ±128.
    pub anchor_a: Vec2<Fx>,
    /// The pinned point in B's frame, in metres, within ±128.
    pub anchor_b: Vec2<Fx>,
    /// Whether the two bodies collide with each other.
    pub collide_connected: bool,
}

impl RevoluteDef {
    /// A hinge at the origins of both bodies, which then do not collide with each other.
    #[must_use]
    pub const fn new(body_a: BodyId, body_b: BodyId) -> Self {
        let origin = Vec2::new(Fx::ZERO, Fx::ZERO);
        RevoluteDef { body_a, body_b, anchor_a: origin, anchor_b: origin, collide_connected: false }
    }

    /// Sets the pinned point in A's frame, in metres.
    #[must_use]
    pub const fn anchor_a(mut self, x: Fx, y: Fx) -> Self {
        self.anchor_a = Vec2::new(x, y);
        self
    }

    /// Sets the pinned point in B's frame, in metres.
    #[must_use]
    pub const fn anchor_b(mut self, x: Fx, y: Fx) -> Self {
        self.anchor_b = Vec2::new(x, y);
        self
    }

    /// Lets the two bodies collide with each other.
    #[must_use]
    pub const fn colliding(mut self) -> Self {
        self.collide_connected = true;
        self
    }
}

impl JointDef {
    /// The two bodies, A first.
    #[must_use]
    pub const fn bodies(&self) -> (BodyId, BodyId) {
        match self {
            JointDef::Revolute(def) => (def.body_a, def.body_b),
        }
    }

    /// The same between other bodies.
    #[must_use]
    pub const fn between(mut self, a: BodyId, b: BodyId) -> Self {
        let JointDef::Revolute(def) = &mut self;
        def.body_a = a;
        def.body_b = b;
        self
    }

    /// Whether the two bodies collide with each other.
    #[must_use]
    pub const fn collide_connected(&self) -> bool {
        match self {
            JointDef::Revolute(def) => def.collide_connected,
        }
    }

    /// Checks what does not depend on the world.
    pub(crate) fn validate(&self) -> Result<(), WorldError> {
        let JointDef::Revolute(def) = self;
        if def.body_a == def.body_b {
            return Err(WorldError::JointToItself(def.body_a));
        }
        for value in [def.anchor_a.x, def.anchor_a.y, def.anchor_b.x, def.anchor_b.y] {
            if !(-REACH_MAX..=REACH_MAX).contains(&value) {
                return Err(WorldError::OffsetOutOfRange { value });
            }
        }
        Ok(())
    }
}

/// A joint in the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    pub(crate) def: JointDef,
    /// `L`, the relative velocity of the anchors that the last impulse made, in world axes.
    pub(crate) lambda: Vec2<Speed>,
}

impl Joint {
    pub(crate) fn new(def: JointDef) -> Self {
        Joint { def, lambda: Vec2::ZERO }
    }

    /// What it was defined as.
    #[must_use]
    pub const fn def(&self) -> &JointDef {
        &self.def
    }

    /// Takes another definition.
    pub(crate) fn redefine(&mut self, def: JointDef) {
        self.def = def;
    }

    /// Whether the solver has to do with it.
    pub(crate) fn is_solved(&self) -> bool {
        true
    }
}
