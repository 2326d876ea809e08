//! Levels built from entities.

use core::fmt;

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::{Component, Entity, World as BevyWorld};
use lockstep2d::body::{BodyDef, ShapeDef, WorldError};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::solver::JointKind;
use lockstep2d::world::{Command, Config, Outcome, World};

use crate::views::BodyView;

/// A body for [`build_level`]. The entity becomes its view.
#[derive(Component, Clone, Debug)]
pub struct SpawnBody {
    /// The body with its position. The `Transform` of the entity is ignored, because its floats are rounded.
    pub body: BodyDef,
    /// Shapes of the body.
    pub shapes: Vec<ShapeDef>,
}

impl SpawnBody {
    /// A body of one shape.
    #[must_use]
    pub fn new(body: BodyDef, shape: ShapeDef) -> Self {
        SpawnBody { body, shapes: vec![shape] }
    }

    /// Adds a shape.
    #[must_use]
    pub fn and(mut self, shape: ShapeDef) -> Self {
        self.shapes.push(shape);
        self
    }
}

/// A joint for [`build_level`] between two entities with a [`SpawnBody`]. The component may be on an entity of its own,
/// or on one of the two entities.
#[derive(Component, Clone, Debug)]
pub struct SpawnJoint {
    /// Entity of body A.
    pub body_a: Entity,
    /// Entity of body B.
    pub body_b: Entity,
    /// The joint.
    pub kind: JointKind,
    /// Anchor in world coordinates, in metres.
    pub anchor: Vec2<Fx>,
    /// The x axis of the joint's frames, as a direction in the world. Used by sliders, wheels and racks.
    pub axis: Vec2<Fx>,
}

impl SpawnJoint {
    /// A joint with its anchor at a point of the world, in metres. Its axis is the world's x axis: see
    /// [`SpawnJoint::axis`].
    #[must_use]
    pub fn new(
        [body_a, body_b]: [Entity; 2],
        kind: impl Into<JointKind>,
        anchor: impl Into<Vec2<Fx>>,
    ) -> Self {
        let axis = Vec2::new(Fx::ONE, Fx::ZERO);
        SpawnJoint { body_a, body_b, kind: kind.into(), anchor: anchor.into(), axis }
    }

    /// Sets the axis of a slider, wheel or rack.
    #[must_use]
    pub fn axis(mut self, axis: impl Into<Vec2<Fx>>) -> Self {
        self.axis = axis.into();
        self
    }
}

/// Reason why a level cannot be built.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LevelError {
    /// The world refuses its settings, a body or a joint.
    Refused {
        /// Entity of the body or joint. `None` for the settings.
        entity: Option<Entity>,
        /// Reason.
        error: WorldError,
    },
    /// A joint names an entity without a [`SpawnBody`].
    NoBody {
        /// The entity of the joint.
        joint: Entity,
        /// The entity without a body.
        body: Entity,
    },
}

impl fmt::Display for LevelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LevelError::Refused { entity: Some(entity), error } => write!(f, "entity {entity}: {error}"),
            LevelError::Refused { entity: None, error } => error.fmt(f),
            LevelError::NoBody { joint, body } => write!(f, "the joint of {joint}: {body} has no SpawnBody"),
        }
    }
}

impl core::error::Error for LevelError {}

/// Turns entities with a [`SpawnBody`] or [`SpawnJoint`] into commands for the setup of a game.
///
/// Removes these components, and inserts a [`BodyView`] into the entities of bodies. Bodies and joints are created in
/// the order of the indices of their entities. These indices may differ between machines. Therefore, for a match, build
/// the level on one machine and send the commands to the others.
///
/// # Errors
/// [`LevelError`]. All entities are then unchanged.
pub fn build_level(app: &mut BevyWorld, config: Config) -> Result<Vec<Command>, LevelError> {
    let refused = |entity: Entity| move |error| LevelError::Refused { entity: Some(entity), error };
    // This temporary world assigns to the bodies the ids that the world of the game will assign.
    let mut scratch = World::new(config).map_err(|error| LevelError::Refused { entity: None, error })?;
    let mut commands = Vec::new();
    let mut bodies = EntityHashMap::default();
    for (entity, SpawnBody { body, shapes }) in in_order::<SpawnBody>(app) {
        let command = Command::Spawn { body, shapes };
        let outcome = scratch.execute(&command).map_err(refused(entity))?;
        if let Outcome::Body(body) = outcome {
            bodies.insert(entity, body);
        }
        commands.push(command);
    }
    let joints = in_order::<SpawnJoint>(app);
    for (entity, joint) in &joints {
        let body_of =
            |body: Entity| bodies.get(&body).copied().ok_or(LevelError::NoBody { joint: *entity, body });
        let (body_a, body_b) = (body_of(joint.body_a)?, body_of(joint.body_b)?);
        let def = scratch.joint_along(body_a, body_b, joint.kind, joint.anchor, joint.axis);
        let command = Command::AddJoint { joint: def.map_err(refused(*entity))? };
        scratch.execute(&command).map_err(refused(*entity))?;
        commands.push(command);
    }
    for (entity, _) in in_order::<SpawnBody>(app) {
        if let Some(body) = bodies.get(&entity) {
            app.entity_mut(entity).remove::<SpawnBody>().insert(BodyView::new(*body));
        }
    }
    for (entity, _) in joints {
        app.entity_mut(entity).remove::<SpawnJoint>();
    }
    Ok(commands)
}

/// Components, in the order of the indices of their entities.
fn in_order<C: Component + Clone>(app: &mut BevyWorld) -> Vec<(Entity, C)> {
    let mut query = app.query::<(Entity, &C)>();
    let mut found: Vec<(Entity, C)> =
        query.iter(app).map(|(entity, component)| (entity, component.clone())).collect();
    found.sort_by_key(|(entity, _)| entity.index_u32());
    found
}
