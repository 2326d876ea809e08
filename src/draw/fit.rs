//! Chooses the part of a world to show.

use alloc::vec::Vec;

use crate::body::{Body, BodyKind};
use crate::collision::PosedShape;
use crate::fx;
use crate::math::{Aabb, Fx, Vec2};
use crate::world::World;

/// Smallest reach of a scene in metres. The reach is the distance from the median position to the farthest body that
/// has been added so far. The next body belongs to the scene if it is within four times the reach.
const SCENE_REACH_MIN: Fx = fx!(16);
/// Upper limit of the search distance for ground, as a multiple of the size of the scene.
const GROUND_SIZES: i64 = 12;
/// Search distance for ground in metres. If the scene is larger than this distance, the search distance is the size of
/// the scene. A falling ball should be shown with the floor below it, but not with a floor so far away that the ball
/// becomes invisible.
const GROUND_REACH: Fx = fx!(16);
/// Maximum size in metres of a fixed shape that is shown if no body can move.
const FIXED_SIZE_MAX: Fx = fx!(512);

/// The window around the bodies that can move, their joints, and the ground near them, with a margin.
///
/// The window leaves out a body far away from all others, because this body would make the others too small to see. A
/// large fixed shape contributes only its point nearest to the middle of the shown bodies. If no body can move, the
/// window shows the fixed shapes of at most 512 m. The result changes as the bodies move. For a camera that does not
/// move, keep the window of one tick.
#[must_use]
pub fn fit(world: &World) -> Aabb {
    let moving = world.bodies().filter(|(_, body)| body.kind() != BodyKind::Fixed);
    let moving: Vec<Aabb> = moving.map(|(_, body)| bounds_of(world, body)).collect();
    let window = match scene_of(moving) {
        Some(scene) => with_surroundings(world, scene),
        None => fixed_boxes(world)
            .filter(|aabb| longest_side(*aabb) <= FIXED_SIZE_MAX)
            .reduce(Aabb::union)
            .unwrap_or_default(),
    };
    let side = longest_side(window);
    // A side of 0 means that the world is empty, or that there is only a single point to show.
    if side == Fx::ZERO { window.expanded(fx!(5)) } else { window.expanded(side / 12) }
}

/// The box around a body's shapes, or its centre of mass if it has no shapes.
fn bounds_of(world: &World, body: &Body) -> Aabb {
    let rotation = body.rotation();
    let shapes = body.shapes().iter().filter_map(|&id| world.shape(id));
    let boxes = shapes.map(|shape| PosedShape::new(&shape.def, body, rotation).bounds);
    let centre = body.centre_of_mass();
    boxes.reduce(Aabb::union).unwrap_or(Aabb::new(centre, centre))
}

/// The box around the bodies of the scene. Bodies are added in the order of their distance from the median. The first
/// one that is farther than four times the reach ends the scene: see [`SCENE_REACH_MIN`].
fn scene_of(mut boxes: Vec<Aabb>) -> Option<Aabb> {
    let middle = |component: fn(Vec2<Fx>) -> Fx| {
        let mut values: Vec<Fx> = boxes.iter().map(|aabb| component(aabb.centre())).collect();
        values.sort_unstable();
        values.get(values.len() / 2).copied()
    };
    let middle = Vec2::new(middle(|centre| centre.x)?, middle(|centre| centre.y)?);
    let distance = |aabb: &Aabb| {
        let from_middle = aabb.centre() - middle;
        from_middle.x.saturating_abs().max(from_middle.y.saturating_abs())
    };
    boxes.sort_by_key(distance);
    let mut reach = SCENE_REACH_MIN;
    let near = boxes.into_iter().take_while(|aabb| {
        let near = distance(aabb) <= reach.saturating_mul_int(4);
        reach = reach.max(distance(aabb));
        near
    });
    near.reduce(Aabb::union)
}

fn with_surroundings(world: &World, scene: Aabb) -> Aabb {
    let side = longest_side(scene);
    let reach = side.saturating_mul_int(GROUND_SIZES).min(side.max(GROUND_REACH));
    let surroundings = scene.expanded(reach);
    let anchors = world.joints().filter_map(|(id, _)| world.joint_anchors(id));
    let anchors = anchors.flat_map(|(a, b)| [a, b]).map(|anchor| Aabb::new(anchor, anchor));
    let ground = fixed_boxes(world).map(|aabb| {
        if longest_side(aabb) <= reach {
            return aabb;
        }
        let nearest = scene.centre().max(aabb.lower).min(aabb.upper);
        Aabb::new(nearest, nearest)
    });
    anchors.chain(ground).filter(|&aabb| surroundings.overlaps(aabb)).fold(scene, Aabb::union)
}

fn fixed_boxes(world: &World) -> impl Iterator<Item = Aabb> {
    world.shapes().filter_map(|(_, shape)| {
        let body = world.body(shape.body()).filter(|body| body.kind() == BodyKind::Fixed)?;
        Some(PosedShape::new(&shape.def, body, body.rotation()).bounds)
    })
}

fn longest_side(aabb: Aabb) -> Fx {
    let sides = aabb.upper - aabb.lower;
    sides.x.max(sides.y)
}
