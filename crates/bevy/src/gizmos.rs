//! [`LockstepGizmosPlugin`]: all layers of [`lockstep2d::draw`] as gizmos.

use core::marker::PhantomData;

use bevy::app::{App, Plugin, PostUpdate};
use bevy::color::Color;
use bevy::gizmos::AppGizmoBuilder;
use bevy::gizmos::config::{GizmoConfigGroup, GizmoConfigStore};
use bevy::gizmos::gizmos::Gizmos;
use bevy::math::{Isometry2d, Vec2};
use bevy::prelude::{IntoScheduleConfigs, Reflect, ReflectDefault, Res, resource_exists};
use lockstep2d::draw::{Form, Layers, Primitive, each_primitive, to_f32};

use crate::game::LockstepGame;
use crate::lockstep::Lockstep;
use crate::plugin::LockstepSettings;

/// Draws the bodies at their poses after the last tick, without interpolation. These poses may differ from those of
/// their views.
#[derive(Clone, Copy, Debug)]
pub struct LockstepGizmosPlugin<G>(PhantomData<fn() -> G>);

impl<G> Default for LockstepGizmosPlugin<G> {
    fn default() -> Self {
        LockstepGizmosPlugin(PhantomData)
    }
}

/// The layers to draw, as a config group of `GizmoConfigStore`. The fields are those of [`Layers`].
#[derive(Reflect, GizmoConfigGroup, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Default)]
pub struct LockstepGizmos {
    /// The shapes of all bodies.
    pub outlines: bool,
    /// Outlines in the colour of their island, whose bodies fall asleep together.
    pub islands: bool,
    /// Fat boxes of the broad phase.
    pub fat_boxes: bool,
    /// Boxes of the inner nodes of the broad phase.
    pub broad_phase: bool,
    /// Contact points.
    pub contact_points: bool,
    /// Contact normals.
    pub contact_normals: bool,
    /// Normal and friction forces.
    pub contact_forces: bool,
    /// Contact points in the colours of the solver's graph colouring.
    pub solver_colours: bool,
    /// Anchors and errors of enabled joints, and lines to the bodies that they connect.
    pub joints: bool,
    /// Sizes of the joint errors, as text.
    pub joint_errors: bool,
    /// Centres of mass.
    pub centres_of_mass: bool,
    /// Velocities.
    pub velocities: bool,
    /// Ids of bodies.
    pub ids: bool,
}

impl LockstepGizmos {
    /// Converts these settings to [`Layers`].
    #[must_use]
    pub const fn layers(self) -> Layers {
        Layers {
            outlines: self.outlines,
            islands: self.islands,
            fat_boxes: self.fat_boxes,
            broad_phase: self.broad_phase,
            contact_points: self.contact_points,
            contact_normals: self.contact_normals,
            contact_forces: self.contact_forces,
            solver_colours: self.solver_colours,
            joints: self.joints,
            joint_errors: self.joint_errors,
            centres_of_mass: self.centres_of_mass,
            velocities: self.velocities,
            ids: self.ids,
        }
    }
}

impl From<Layers> for LockstepGizmos {
    fn from(layers: Layers) -> Self {
        LockstepGizmos {
            outlines: layers.outlines,
            islands: layers.islands,
            fat_boxes: layers.fat_boxes,
            broad_phase: layers.broad_phase,
            contact_points: layers.contact_points,
            contact_normals: layers.contact_normals,
            contact_forces: layers.contact_forces,
            solver_colours: layers.solver_colours,
            joints: layers.joints,
            joint_errors: layers.joint_errors,
            centres_of_mass: layers.centres_of_mass,
            velocities: layers.velocities,
            ids: layers.ids,
        }
    }
}

impl Default for LockstepGizmos {
    /// Outlines, contact points and joints.
    fn default() -> Self {
        Layers { outlines: true, contact_points: true, joints: true, ..Layers::NONE }.into()
    }
}

impl<G: LockstepGame> Plugin for LockstepGizmosPlugin<G> {
    fn build(&self, app: &mut App) {
        app.init_gizmo_group::<LockstepGizmos>()
            .add_systems(PostUpdate, draw_world::<G>.run_if(resource_exists::<Lockstep<G>>));
    }
}

fn draw_world<G: LockstepGame>(
    lockstep: Res<Lockstep<G>>,
    settings: Res<LockstepSettings>,
    store: Res<GizmoConfigStore>,
    mut gizmos: Gizmos<LockstepGizmos>,
) {
    let (config, group) = store.config::<LockstepGizmos>();
    let Some(world) = lockstep.world().filter(|_| config.enabled) else { return };
    let scale = settings.pixels_per_metre;
    each_primitive(world, group.layers(), &mut |primitive| draw(&mut gizmos, &primitive, scale));
}

/// Radius of the circle that marks a point, in units of `Transform`.
const MARK: f32 = 3.0;
/// Length of the arrow of a direction, in units of `Transform`.
const DIRECTION: f32 = 15.0;
/// Size of text, in units of `Transform`.
const TEXT: f32 = 10.0;

fn draw(gizmos: &mut Gizmos<LockstepGizmos>, primitive: &Primitive, scale: f32) {
    let at = |v| Vec2::from(to_f32(v)) * scale;
    let length = |length: lockstep2d::math::Fx| length.to_num::<f32>() * scale;
    let [_, red, green, blue] = primitive.style.paint().stroke.to_be_bytes();
    let colour = Color::srgb_u8(red, green, blue);
    match &primitive.form {
        Form::Point(place) => drop(gizmos.circle_2d(Isometry2d::from_translation(at(*place)), MARK, colour)),
        Form::Line { from, to } => gizmos.line_2d(at(*from), at(*to), colour),
        Form::Direction { from, direction } => {
            let way = Vec2::from(to_f32(direction.widen()));
            drop(gizmos.arrow_2d(at(*from), at(*from) + way * DIRECTION, colour));
        }
        Form::Label { at: place, text } => {
            gizmos.text_2d(Isometry2d::from_translation(at(*place)), text, TEXT, Vec2::ZERO, colour);
        }
        Form::Box(aabb) => {
            let (low, high) = (at(aabb.lower), at(aabb.upper));
            gizmos.rect_2d(Isometry2d::from_translation((low + high) / 2.0), high - low, colour);
        }
        Form::Circle { centre, radius } => {
            drop(gizmos.circle_2d(Isometry2d::from_translation(at(*centre)), length(*radius), colour));
        }
        Form::Polygon { vertices, radius } => {
            let vertices: Vec<Vec2> = vertices.iter().map(|vertex| at(*vertex)).collect();
            gizmos.lineloop_2d(rounded(&vertices, length(*radius)), colour);
        }
    }
}

/// Outline at the distance `radius` around a convex polygon. The arc around each vertex consists of four lines.
fn rounded(vertices: &[Vec2], radius: f32) -> Vec<Vec2> {
    if radius <= 0.0 {
        return vertices.to_vec();
    }
    let count = vertices.len();
    let normal = |from: usize| {
        let (a, b) = (vertices[from % count], vertices[(from + 1) % count]);
        -(b - a).perp().normalize_or_zero()
    };
    let arc = |index: usize| {
        let (before, after) = (normal(index + count - 1), normal(index));
        // The outline of a line, which has two vertices, ends in half circles.
        let turn = if before.dot(after) < -0.999 { core::f32::consts::PI } else { before.angle_to(after) };
        (0..=4_u8).map(move |part| before.rotate(Vec2::from_angle(turn * f32::from(part) / 4.0)))
    };
    (0..count).flat_map(|index| arc(index).map(move |way| vertices[index] + way * radius)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_keep_their_distance_from_the_vertices() {
        let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let line = [Vec2::ZERO, Vec2::X * 3.0];
        for vertices in [&square[..], &line[..]] {
            let outline = rounded(vertices, 0.5);
            assert_eq!(outline.len(), 5 * vertices.len());
            let centre = vertices.iter().sum::<Vec2>() / vertices.len() as f32;
            for (place, corner) in outline.iter().enumerate() {
                let vertex = vertices[place / 5];
                assert!((corner.distance(vertex) - 0.5).abs() < 1e-5);
                assert!(corner.distance(centre) >= vertex.distance(centre) - 1e-5, "outwards");
            }
        }
        assert_eq!(rounded(&square, 0.0), square);
    }
}
