use super::cache::Scratch;
use super::derived::fattened;
use super::state::State;
use crate::body::{Handle, Pose};

/// Moves a body and its shapes to a pose. Shapes that leave their fat box get a new fat box.
pub(crate) fn move_body(state: &mut State, scratch: &mut Scratch, slot: u32, pose: Pose) {
    let State { bodies, shapes, .. } = &mut *state;
    if !scratch.shapes.whole().move_body(bodies.at_mut(slot), pose, shapes) {
        return;
    }
    for index in 0..state.bodies.at(slot).shapes().len() {
        let shape = state.bodies.at(slot).shapes()[index].slot();
        let bounds = scratch.shapes.motion().shape(shape).bounds;
        if !scratch.shapes.broad_phase().fat(shape).contains(bounds) {
            cover_shape(state, scratch, shape);
        }
    }
}

/// Gives a new fat box to a shape that has left its fat box, so that queries find the shape.
pub(crate) fn cover_shape(state: &mut State, scratch: &mut Scratch, shape: u32) {
    let bounds = scratch.shapes.motion().shape(shape).bounds;
    let fat = fattened(bounds, state.config.margin_of(bounds));
    state.shapes.at_mut(shape).fat = fat;
    scratch.shapes.refit(shape, fat);
    scratch.pairs.changes.box_changed(shape);
    if scratch.shapes.motion().may_have_sensors() {
        scratch.sweeps.left_boxes.push(shape);
    }
}
