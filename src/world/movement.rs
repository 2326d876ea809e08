//! Moving a body together with its shapes and their fat boxes.

use super::cache::Scratch;
use super::derived::fattened;
use super::state::State;
use crate::body::{Handle, Pose};
use crate::math::Vec2;

/// Moves a body to a pose. Shapes that leave their fat box get a new one.
pub(crate) fn move_body(state: &mut State, scratch: &mut Scratch, slot: u32, pose: Pose) {
    let body = state.bodies.at_mut(slot);
    let (by, is_rotated) = (pose.centre - body.centre, pose.angle != body.angle);
    if is_rotated || by != Vec2::ZERO {
        (body.centre, body.angle) = (pose.centre, pose.angle);
        let body = state.bodies.at(slot);
        if is_rotated {
            scratch.shapes.move_body(state, body);
        } else {
            scratch.shapes.shift_body(body, by);
        }
        cover_shapes(state, scratch, slot);
    }
}

/// Gives the shapes of a body that have left their fat box a new one, so that queries find them.
fn cover_shapes(state: &mut State, scratch: &mut Scratch, slot: u32) {
    let State { bodies, shapes, config, .. } = state;
    for id in bodies.at(slot).shapes() {
        let bounds = scratch.shapes.poses().at(id.slot()).bounds;
        if !scratch.shapes.broad_phase().fat(id.slot()).contains(bounds) {
            let fat = fattened(bounds, config.margin_of(bounds));
            shapes.at_mut(id.slot()).fat = fat;
            scratch.shapes.refit(id.slot(), fat);
            scratch.pairs.changes.box_changed(id.slot());
            if scratch.shapes.motion().may_have_sensors() {
                scratch.sweeps.left_boxes.push(id.slot());
            }
        }
    }
}
