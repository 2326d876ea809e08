//! [`LockstepPickingPlugin`] and [`PointerDragPlugin`]: bodies as targets of Bevy's pointer events.

use core::marker::PhantomData;

use bevy::app::{App, Plugin, PreUpdate, RunFixedMainLoop};
use bevy::camera::Camera;
use bevy::math::{Dir3, Ray3d, Vec2, Vec3, Vec3Swizzles, primitives::InfinitePlane3d};
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::backend::{HitData, PointerHits};
use bevy::picking::events::{Pointer, Press};
use bevy::picking::pointer::{PointerAction, PointerButton, PointerInput};
use bevy::picking::{Pickable, PickingSystems};
use bevy::prelude::{
    Entity, IntoScheduleConfigs, MessageReader, MessageWriter, On, Query, Res, ResMut, Resource, Transform,
    TransformHelper, resource_exists,
};
use lockstep2d::body::BodyId;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::world::World;

use crate::drag::{DragHand, DragPlugin, pull, to_metres};
use crate::game::LockstepGame;
use crate::lockstep::Lockstep;
use crate::plugin::{LockstepSettings, LockstepSystems};
use crate::views::{BodyView, BodyViews};

/// A picking backend: views receive `Pointer<Click>` and the other events of [`bevy::picking`] at the shapes of their
/// bodies, except sensors. Views with [`Pickable::IGNORE`] receive none. If several views are at the pointer, the view
/// with the largest global z is in front.
///
/// The plugin needs the plugins of `bevy::picking`, which `DefaultPlugins` contains.
///
/// ```
/// # use bevy::picking::{InteractionPlugin, PickingPlugin};
/// # use bevy::prelude::*;
/// # use bevy_lockstep2d::{LockstepPickingPlugin, prelude::*};
/// # use lockstep2d::lockstep::Sandbox;
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, PickingPlugin, InteractionPlugin));
/// app.add_plugins((LockstepPlugin::<Sandbox>::default(), LockstepPickingPlugin::<Sandbox>::default()))
///     .add_observer(|click: On<Pointer<Click>>, views: Query<&BodyView>| {
///         if let Ok(view) = views.get(click.entity) {
///             println!("{} was clicked", view.body());
///         }
///     });
/// # app.update();
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LockstepPickingPlugin<G>(PhantomData<fn() -> G>);

impl<G> Default for LockstepPickingPlugin<G> {
    fn default() -> Self {
        LockstepPickingPlugin(PhantomData)
    }
}

impl<G: LockstepGame> Plugin for LockstepPickingPlugin<G> {
    fn build(&self, app: &mut App) {
        app.add_systems(
            PreUpdate,
            pick::<G>.in_set(PickingSystems::Backend).run_if(resource_exists::<Lockstep<G>>),
        );
    }
}

/// Drags the dynamic bodies of a [`Sandbox`] with the primary button or a finger. Adds [`LockstepPickingPlugin`] and
/// [`DragPlugin`] if the app does not have them.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointerDragPlugin;

impl Plugin for PointerDragPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<LockstepPickingPlugin<Sandbox>>() {
            app.add_plugins(LockstepPickingPlugin::<Sandbox>::default());
        }
        if !app.is_plugin_added::<DragPlugin>() {
            app.add_plugins(DragPlugin);
        }
        app.init_resource::<HoldingPointer>()
            .add_observer(grab)
            .add_systems(RunFixedMainLoop, move_hand.before(pull).in_set(LockstepSystems::Inputs));
    }
}

/// Point where a ray meets the plane z = 0, in which views are picked, and its distance along the ray.
fn on_plane(ray: Ray3d) -> Option<(Vec3, f32)> {
    let distance = ray.intersect_plane(Vec3::ZERO, InfinitePlane3d { normal: Dir3::Z })?;
    Some((ray.get_point(distance), distance))
}

fn pick<G: LockstepGame>(
    lockstep: Res<Lockstep<G>>,
    (settings, views, rays): (Res<LockstepSettings>, Res<BodyViews>, Res<RayMap>),
    cameras: Query<&Camera>,
    shown: Query<(&Transform, Option<&Pickable>)>,
    transforms: TransformHelper,
    mut hits: MessageWriter<PointerHits>,
) {
    let Some(world) = lockstep.world() else { return };
    let hits_of = |(id, ray): (&RayId, &Ray3d)| {
        let order = cameras.get(id.camera).ok()?.order;
        let (point, distance) = on_plane(*ray)?;
        let hit = |entity: Entity| {
            let (local, pickable) = shown.get(entity).ok()?;
            // If an ancestor has no `Transform`, the view is drawn as if it had no parent.
            let global = transforms.compute_global_transform(entity);
            let depth = distance - global.map_or(local.translation, |global| global.translation()).z;
            let is_pickable = pickable.is_none_or(|pickable| *pickable != Pickable::IGNORE);
            is_pickable.then(|| (entity, HitData::new(id.camera, depth, Some(point), None)))
        };
        let picks = views_at(world, &views, point, &settings).filter_map(hit).collect();
        Some(PointerHits::new(id.pointer, picks, order as f32))
    };
    hits.write_batch(rays.iter().filter_map(hits_of));
}

fn views_at<'a>(
    world: &'a World,
    views: &'a BodyViews,
    at: Vec3,
    settings: &LockstepSettings,
) -> impl Iterator<Item = Entity> + 'a {
    let shapes = world.overlap_point(to_metres(at.xy(), settings), Default::default());
    let mut entities: Vec<Entity> =
        shapes.into_iter().filter_map(|shape| views.of_shape(world, shape)).collect();
    // Several shapes of a body are one target.
    entities.sort_unstable();
    entities.dedup();
    entities.into_iter()
}

/// A pointer that holds a body, and the camera that it points through.
#[derive(Resource, Default)]
struct HoldingPointer {
    ray: Option<RayId>,
    /// Body and position of the last press in this frame. The pointer may have been released before this press, and
    /// `ray` may be of an earlier press.
    next: Option<(RayId, BodyId, Vec2)>,
    /// Whether a view has taken the latest press. Ancestors of this view receive the press after it.
    is_taken: bool,
}

/// A press on a view or on one of its children starts to drag the body of the view.
fn grab(
    press: On<Pointer<Press>>,
    views: Query<&BodyView>,
    lockstep: Option<Res<Lockstep<Sandbox>>>,
    mut hand: ResMut<DragHand>,
    mut holding: ResMut<HoldingPointer>,
) {
    // An entity that is pressed receives the press before its ancestors.
    if press.entity == press.original_event_target() {
        holding.is_taken = false;
    }
    if holding.is_taken {
        return;
    }
    let Some(world) = lockstep.as_ref().and_then(|lockstep| lockstep.world()) else { return };
    let Ok(body) = views.get(press.entity).map(|view| view.body()) else { return };
    let is_dynamic = world.body(body).is_some_and(|body| body.is_dynamic());
    let Some(at) = press.hit.position.filter(|_| is_dynamic && press.button == PointerButton::Primary) else {
        return;
    };
    let ray = RayId::new(press.hit.camera, press.pointer_id);
    match holding.ray {
        None => {
            hand.hold_body(body, at.xy());
            holding.ray = Some(ray);
        }
        Some(held) if held.pointer != ray.pointer => return,
        Some(_) => {}
    }
    holding.next = Some((ray, body, at.xy()));
    holding.is_taken = true;
}

/// Moves the hand with its pointer. Releases the body when the button goes up or the pointer is cancelled.
fn move_hand(
    rays: Res<RayMap>,
    mut inputs: MessageReader<PointerInput>,
    mut hand: ResMut<DragHand>,
    mut holding: ResMut<HoldingPointer>,
) {
    let Some(ray) = holding.ray else { return inputs.clear() };
    let is_down = |input: &PointerInput| match input.action {
        PointerAction::Press(PointerButton::Primary) => Some(true),
        PointerAction::Release(PointerButton::Primary) | PointerAction::Cancel => Some(false),
        _ => None,
    };
    let own = inputs.read().filter(|input| input.pointer_id == ray.pointer);
    let changes: Vec<bool> = own.filter_map(is_down).collect();
    let next = holding.next.take().filter(|_| changes.last() == Some(&true));
    if changes.contains(&false) {
        hand.release();
        holding.ray = next.map(|(ray, body, at)| {
            hand.hold_body(body, at);
            ray
        });
    }
    let Some(ray) = holding.ray else { return };
    if let Some((at, _)) = rays.map.get(&ray).and_then(|ray| on_plane(*ray)) {
        hand.move_to(at.xy());
    }
}
