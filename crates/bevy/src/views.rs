//! [`BodyView`] and [`BodyViews`]: the entities that show bodies.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::{Component, Entity, Reflect, ReflectComponent, Resource, Transform};
use lockstep2d::body::{BodyId, BodyKind, ShapeDef, ShapeId};
use lockstep2d::world::World;

use crate::poses::Pose;
use crate::smoothing::Offset;

/// An entity that shows a body. The plugin spawns one for every body, with a [`Transform`], and despawns it with the
/// body. Add components or children that draw the body, for example in an observer of `On<Add, BodyView>`.
///
/// If this component is added to an entity while the body has no view, that entity becomes the view when the body
/// appears. If a view is despawned or loses this component, the body has another view from the next frame on. Views are
/// despawned when another game begins, except those into which this component was inserted again for that game.
///
/// The plugin writes x, y and rotation of the `Transform`; z and scale belong to the game. A rollback or a seek may
/// replace a body by another body. The view is kept if both have the same id, kind, user data and shapes.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[component(immutable)]
#[require(Transform)]
#[reflect(Component, from_reflect = false)]
pub struct BodyView {
    #[reflect(ignore)]
    body: BodyId,
    slot: u32,
    generation: u32,
}

impl BodyView {
    /// The view of a body.
    #[must_use]
    pub const fn new(body: BodyId) -> Self {
        BodyView { body, slot: body.index(), generation: body.generation() }
    }

    /// The body.
    #[must_use]
    pub const fn body(&self) -> BodyId {
        self.body
    }
}

/// The views of all bodies.
#[derive(Resource, Debug, Default)]
pub struct BodyViews {
    /// Views, indexed by the slots of their bodies.
    slots: Vec<Option<View>>,
    frame: u32,
    /// Number of the game whose bodies are shown: see `Lockstep::number`.
    game: Option<u64>,
    /// Entities into which the game has inserted a [`BodyView`] again while they were views. They are prepared as views
    /// of the next game.
    prepared: EntityHashSet,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) body: BodyId,
    pub(crate) entity: Entity,
    /// Pose of the body before the last tick.
    pub(crate) previous: Pose,
    /// Pose of the body after the last tick.
    pub(crate) current: Pose,
    pub(crate) offset: Offset,
    /// Whether the `Transform` already shows `current`.
    pub(crate) is_settled: bool,
    frame: u32,
}

impl BodyViews {
    /// The view of a body.
    #[must_use]
    pub fn entity(&self, body: BodyId) -> Option<Entity> {
        self.view(body).map(|view| view.entity)
    }

    /// Sets the game whose bodies are shown. If the game has changed, returns the views of the former game that are
    /// prepared as views of the new game.
    pub(crate) fn begin_game(&mut self, number: u64) -> Option<EntityHashSet> {
        (self.game.replace(number) != Some(number)).then(|| core::mem::take(&mut self.prepared))
    }

    /// Marks views as prepared for the next game.
    pub(crate) fn prepare(&mut self, entities: Vec<Entity>) {
        self.prepared.extend(entities);
    }

    /// The view of the body of a shape.
    #[must_use]
    pub fn of_shape(&self, world: &World, shape: ShapeId) -> Option<Entity> {
        self.entity(world.shape(shape)?.body())
    }

    /// Bodies and their views, in slot order.
    pub fn iter(&self) -> impl Iterator<Item = (BodyId, Entity)> {
        self.slots.iter().flatten().map(|view| (view.body, view.entity))
    }

    pub(crate) fn view(&self, body: BodyId) -> Option<&View> {
        self.slots.get(body.index() as usize)?.as_ref().filter(|view| view.body == body)
    }

    pub(crate) fn view_mut(&mut self, body: BodyId) -> Option<&mut View> {
        self.slots.get_mut(body.index() as usize)?.as_mut().filter(|view| view.body == body)
    }

    pub(crate) fn views_mut(&mut self) -> impl Iterator<Item = &mut View> {
        self.slots.iter_mut().flatten()
    }

    /// Drops the views for which `keep` is false. Their entities stay.
    pub(crate) fn retain(&mut self, mut keep: impl FnMut(&View) -> bool) {
        for slot in &mut self.slots {
            slot.take_if(|view| !keep(view));
        }
    }

    /// Begins a frame. [`BodyViews::take_unseen`] takes the views that were not [seen](BodyViews::see) in the frame.
    pub(crate) fn begin_frame(&mut self) {
        self.frame = self.frame.wrapping_add(1);
    }

    /// Sets the poses of a body's view, and marks the view as seen in this frame. Returns `false` if the body has no
    /// view.
    pub(crate) fn see(&mut self, body: BodyId, previous: Pose, current: Pose) -> bool {
        let frame = self.frame;
        let Some(view) = self.view_mut(body) else { return false };
        view.frame = frame;
        view.is_settled &= view.current == current;
        (view.previous, view.current) = (previous, current);
        true
    }

    /// Adds a view. Returns the view that had the slot before.
    pub(crate) fn insert(&mut self, body: BodyId, entity: Entity, pose: Pose) -> Option<Entity> {
        let slot = body.index() as usize;
        if self.slots.len() <= slot {
            self.slots.resize(slot + 1, None);
        }
        let view = View {
            body,
            entity,
            previous: pose,
            current: pose,
            offset: Offset::ZERO,
            is_settled: false,
            frame: self.frame,
        };
        self.slots.get_mut(slot)?.replace(view).map(|old| old.entity)
    }

    pub(crate) fn take_unseen(&mut self) -> Vec<Entity> {
        let frame = self.frame;
        let unseen = |slot: &mut Option<View>| {
            let view = slot.take_if(|view| view.frame != frame)?;
            Some(view.entity)
        };
        self.slots.iter_mut().filter_map(unseen).collect()
    }

    pub(crate) fn take(&mut self, body: BodyId) -> Option<Entity> {
        let slot = self.slots.get_mut(body.index() as usize)?;
        slot.take_if(|view| view.body == body).map(|view| view.entity)
    }

    pub(crate) fn take_all(&mut self) -> Vec<View> {
        self.slots.drain(..).flatten().collect()
    }
}

/// Tells whether a body and the body that had the same id before a rollback or a seek are to share a view.
#[derive(Debug, PartialEq)]
pub(crate) struct Identity {
    kind: BodyKind,
    user_data: u64,
    shapes: Vec<ShapeDef>,
}

impl Identity {
    pub(crate) fn of(world: &World, body: BodyId) -> Option<Self> {
        let state = world.body(body)?;
        let shapes = state.shapes().iter().filter_map(|shape| world.shape(*shape));
        let shapes = shapes.map(|shape| *shape.def()).collect();
        Some(Identity { kind: state.kind(), user_data: state.user_data(), shapes })
    }

    pub(crate) fn is_of(&self, world: Option<&World>, body: BodyId) -> bool {
        world.and_then(|world| Self::of(world, body)).is_some_and(|found| found == *self)
    }
}
