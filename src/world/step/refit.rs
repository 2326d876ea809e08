//! Fat boxes: every shape that may leave its fat box in the tick at its current velocity, or whose fat box is much too
//! large, gets a new fat box.
//!
//! The swept AABB of a shape is its AABB, extended by the translation of its body, by the largest movement through
//! rotation, and by the speculative distance.

use alloc::vec::Vec;

use smallvec::SmallVec;

use crate::body::{Body, Handle};
use crate::collision::BroadPhase;
use crate::math::{Aabb, Fx, Reciprocal, Vec2, fx_mul};
use crate::solver::Solver;
use crate::world::cache::{
    Extents, MotionRange, Outgrown, Predicted, PredictedMotion, Scratch, ShapeCache, SlotShare,
};
use crate::world::derived::fattened;
use crate::world::state::State;

/// Largest distance by which a fat box may extend beyond the swept AABB, as a multiple of the margin. Without this
/// limit, a shape that was fast would keep a large fat box, which overlaps many others.
const MARGINS_MAX: i64 = 4;

/// Predicts motion, and gives new fat boxes to the shapes that need them.
pub(super) fn refit_boxes(state: &mut State, scratch: &mut Scratch) {
    let Scratch { awake, shapes: cache, pairs, solver, predicted, .. } = scratch;
    let last_moving = predicted.iter_mut().flat_map(|predicted| predicted.moving.drain(..));
    cache.begin_prediction(state.bodies.slot_count(), last_moving);
    predict(state, cache, awake.shares(state, solver.parts), solver, predicted);
    for &Outgrown { shape, fat, is_active } in predicted.iter().flat_map(|predicted| &predicted.outgrown) {
        state.shapes.at_mut(shape).fat = fat;
        cache.queue_refit(shape, fat);
        pairs.changes.box_changed(shape);
        if !is_active {
            // A kinematic body that has stopped may get a smaller fat box, which no longer overlaps the shapes of
            // sleeping bodies on it.
            pairs.changes.sleeping_contacts_changed();
        }
    }
    cache.bodies_move(awake.bodies());
    cache.apply_refits();
}

fn predict(
    state: &State,
    cache: &mut ShapeCache,
    shares: SmallVec<[SlotShare<'_>; 1]>,
    solver: &Solver,
    predicted: &mut Vec<Predicted>,
) {
    predicted.resize_with(shares.len(), Predicted::default);
    let (motion, extents, broad_phase) = cache.prediction();
    let per_second = Reciprocal::of_integer(state.config.tick_rate);
    let prediction = Prediction { state, extents, broad_phase, per_second };
    let parts = shares.iter().zip(motion.split(shares.iter().map(|share| share.ends))).zip(&mut *predicted);
    solver.threads.run_team(parts, |((share, mut motion), predicted), _| {
        predicted.clear();
        for &slot in share.bodies {
            if motion.holds(slot, state.bodies.at(slot)) {
                prediction.predict(slot, &mut motion, predicted);
            } else {
                predicted.others.push(slot);
            }
        }
        0
    });
    let mut motion = motion.whole();
    for predicted in predicted {
        for slot in core::mem::take(&mut predicted.others) {
            prediction.predict(slot, &mut motion, predicted);
        }
    }
}

struct Prediction<'a> {
    state: &'a State,
    extents: &'a [Extents],
    broad_phase: &'a BroadPhase,
    per_second: Reciprocal,
}

impl Prediction<'_> {
    #[inline]
    fn predict(&self, slot: u32, range: &mut MotionRange<'_>, predicted: &mut Predicted) {
        let Prediction { state, extents, broad_phase, per_second } = self;
        let body = state.bodies.at(slot);
        let motion = PredictedMotion::of(body, *per_second);
        let turn = motion.turned();
        *range.body_mut(slot) = motion;
        let config = &state.config;
        let swept = SweptAabb::of(body, extents[slot as usize], &motion, config.speculative_distance);
        for &id in body.shapes() {
            let shape = range.shape_mut(id.slot());
            let (bounds, turn_reach) = (shape.bounds, motion.turn_reach(turn, shape));
            shape.set_motion(&motion, turn_reach);
            predicted.moving.push(id.slot());
            let needed = swept.around(bounds);
            let margin = config.margin_of(bounds);
            let fat = broad_phase.fat(id.slot());
            let largest = needed.expanded_nearby(margin.wrapping_mul_int(MARGINS_MAX));
            if !fat.contains(needed) || !largest.contains(fat) {
                let (shape, fat) = (id.slot(), fattened(needed, margin));
                predicted.outgrown.push(Outgrown { shape, fat, is_active: body.is_active() });
            }
        }
    }
}

/// Extension of the AABBs of a body's shapes to swept AABBs. The sums below cannot overflow: positions are within the
/// world extent, and displacements are at most 52 m on each axis (`SPEED_MAX`, 511 m/s, at 10 ticks a second).
struct SweptAabb {
    /// Displacements of the lower and of the upper corner of an AABB by the body's translation, each extended by the
    /// speculative distance.
    corners: [Vec2<Fx>; 2],
    /// Largest movement of a point of the body by rotation, in metres. The same for both axes.
    turned: Vec2<Fx>,
    /// Box that contains the body's shapes at every rotation of the body, at its initial position.
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

    fn around(&self, bounds: Aabb) -> Aabb {
        let lower = bounds.lower.wrapping_sub(self.turned).max(self.disc.lower);
        let upper = bounds.upper.wrapping_add(self.turned).min(self.disc.upper);
        Aabb::new(lower.wrapping_add(self.corners[0]), upper.wrapping_add(self.corners[1]))
    }
}
