//! Fat boxes for the tick: every shape that may leave its fat box at its current velocity gets a new one.
//!
//! The swept AABB of a shape is its box, extended by the translation of its body, by the largest movement that the
//! body's rotation can cause, and by the speculative distance.

use crate::body::{Body, Handle};
use crate::math::{Aabb, Fx, Reciprocal, Vec2, fx_mul};
use crate::world::cache::{Extents, PredictedMotion, Scratch};
use crate::world::derived::fattened;
use crate::world::state::State;

/// Largest distance, in margins, between a fat box and the swept AABB on each side. Without this limit, a shape that
/// was fast would keep a large fat box with many pairs for ever.
const MARGINS_MAX: i64 = 4;

/// Predicts the motion of all awake bodies and their shapes, and gives every shape that may leave its fat box within
/// the tick, or whose fat box has become too large, a new one.
pub(super) fn refit_boxes(state: &mut State, scratch: &mut Scratch) {
    let State { bodies, shapes, config, .. } = state;
    let Scratch { awake, shapes: cache, pairs, .. } = scratch;
    let per_second = Reciprocal::of_integer(config.tick_rate);
    cache.begin_prediction(bodies.slot_count());
    for &slot in awake.bodies() {
        let body = bodies.at(slot);
        let motion = PredictedMotion::of(body, per_second);
        let turn = motion.turned();
        cache.set_body_motion(slot, motion);
        let extents = cache.poses().extents(slot);
        let swept = SweptAabb::of(body, extents, &motion, config.speculative_distance);
        for &id in body.shapes() {
            let shape = cache.motion().shape(id.slot());
            let (bounds, turn_reach) = (shape.bounds, motion.turn_reach(turn, shape));
            cache.set_shape_motion(id.slot(), &motion, turn_reach);
            let needed = swept.around(bounds);
            let margin = config.margin_of(bounds);
            let fat = cache.broad_phase().fat(id.slot());
            let largest = needed.expanded_nearby(margin.wrapping_mul_int(MARGINS_MAX));
            if !fat.contains(needed) || !largest.contains(fat) {
                let fat = fattened(needed, margin);
                shapes.at_mut(id.slot()).fat = fat;
                cache.queue_refit(id.slot(), fat);
                pairs.changes.box_changed(id.slot());
                if !body.is_active() {
                    // The new fat box of a kinematic body that has stopped may no longer overlap shapes that rest on
                    // it.
                    pairs.changes.sleeping_contacts_changed();
                }
            }
        }
    }
    cache.apply_refits();
}

/// Extends the AABB of a shape to its swept AABB, alike for all shapes of a body. Positions are in the world and
/// displacements below 52 m, so that no sum overflows.
struct SweptAabb {
    /// Displacement of the lower and of the upper corner, including the speculative distance.
    corners: [Vec2<Fx>; 2],
    /// Largest distance by which rotation moves a point, in metres, on both axes.
    turned: Vec2<Fx>,
    /// Box around the disc that contains the body's shapes at every rotation.
    disc: Aabb,
}

impl SweptAabb {
    fn of(body: &Body, extents: Extents, motion: &PredictedMotion, speculative: Fx) -> Self {
        let (shift, room) = (motion.shift.widen(), Vec2::new(speculative, speculative));
        let turned = fx_mul(motion.turned(), extents.reach);
        SweptAabb {
            corners: [shift.min(Vec2::ZERO).wrapping_sub(room), shift.max(Vec2::ZERO).wrapping_add(room)],
            turned: Vec2::new(turned, turned),
            disc: Aabb::new(body.centre, body.centre).expanded_nearby(extents.radius),
        }
    }

    /// The swept AABB of a shape with the given AABB.
    fn around(&self, bounds: Aabb) -> Aabb {
        let lower = bounds.lower.wrapping_sub(self.turned).max(self.disc.lower);
        let upper = bounds.upper.wrapping_add(self.turned).min(self.disc.upper);
        Aabb::new(lower.wrapping_add(self.corners[0]), upper.wrapping_add(self.corners[1]))
    }
}
