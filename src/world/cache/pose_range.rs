use core::cell::LazyCell;

use super::motion::ShapeMotion;
use crate::body::{Arena, Body, Handle, Pose, Shape, ShapeId};
use crate::collision::{PosedShape, SmallBoxesRange};
use crate::math::{Aabb, Fx, Vec2};

/// The shapes that a thread may move: a range of slots.
pub(crate) struct PoseRange<'a> {
    pub(super) first: u32,
    pub(super) shapes: &'a mut [Option<PosedShape>],
    pub(super) motion: &'a mut [ShapeMotion],
    pub(super) boxes: SmallBoxesRange<'a>,
}

impl PoseRange<'_> {
    pub(crate) fn holds(&self, body: &Body) -> bool {
        let is_held = |slot: u32| slot >= self.first && self.index(slot) < self.shapes.len();
        body.shapes().iter().all(|id| is_held(id.slot()))
    }

    fn index(&self, slot: u32) -> usize {
        (slot - self.first) as usize
    }

    pub(crate) fn bounds(&self, slot: u32) -> Aabb {
        self.motion[self.index(slot)].bounds
    }

    /// Moves a body with its shapes. Returns whether it has moved.
    #[inline]
    pub(crate) fn move_body(&mut self, body: &mut Body, pose: Pose, shapes: &Arena<Shape, ShapeId>) -> bool {
        let (by, is_rotated) = (pose.centre - body.centre, pose.angle != body.angle);
        (body.centre, body.angle) = (pose.centre, pose.angle);
        if is_rotated {
            self.renew_body(shapes, body);
        } else if by != Vec2::ZERO {
            self.shift_body(body, by);
        }
        is_rotated || by != Vec2::ZERO
    }

    /// Poses the shapes of a body that was translated but not rotated.
    pub(super) fn shift_body(&mut self, body: &Body, by: Vec2<Fx>) {
        for &id in body.shapes() {
            let index = self.index(id.slot());
            let posed = posed(&mut self.shapes[index]);
            posed.shift(by);
            self.motion[index].set_bounds(posed.bounds);
        }
    }

    /// Poses the shapes of a body that was rotated, and possibly translated.
    pub(super) fn renew_body(&mut self, shapes: &Arena<Shape, ShapeId>, body: &Body) {
        let rotation = LazyCell::new(|| body.rotation());
        for &id in body.shapes() {
            let index = self.index(id.slot());
            let posed = posed(&mut self.shapes[index]);
            if let Some(faces) = self.boxes.turn(index, &rotation) {
                posed.turn_box(&faces, body.centre);
            } else if self.motion[index].disc {
                // Avoids the random access to the shape's definition.
                posed.shift(body.centre.wrapping_sub(posed.centre));
            } else {
                posed.renew(&shapes.at(id.slot()).def, body, &rotation);
                self.boxes.renew(index, posed);
            }
            self.motion[index].set_bounds(posed.bounds);
        }
    }
}

fn posed(shape: &mut Option<PosedShape>) -> &mut PosedShape {
    shape.as_mut().expect("every shape is posed when it is added")
}
