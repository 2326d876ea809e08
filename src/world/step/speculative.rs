//! Speculative contacts: selects the points that bodies can reach within the tick at their initial velocities.

use crate::body::{Body, Shape};
use crate::collision::{GhostFilter, Manifold, ManifoldPoint, OneWay, PosedShape, is_ghost, pass_direction};
use crate::math::{Length, Step, Unit, Vec2, convert, saturate, widen};
use crate::world::cache::{
    ClosingBound, GHOST_TRAVEL_MIN, Margins, MotionCache, Poses, PredictedMotion, ShapeMotion, Travel,
};
use crate::world::state::State;
use fixed::FixedI32;
use fixed::types::extra::{LeEqU32, U27};

/// Returns a function that gives the approach of two bodies along the normal in a whole tick, at a point of their
/// contact. With `n` the normal, and for each body `x` the translation, `t` the rotation and `r` the lever arm, the
/// approach is
///
/// ```text
/// n.(xA - xB) + tA (rA x n) - tB (rB x n)
/// ```
///
/// The lever arm is the vector from the body's centre to the manifold's origin, plus the anchor of the point. The terms
/// without the anchor are computed once for all points; each point adds `(tA - tB) (anchor x n)`. The result is in
/// units of `Step`. It may exceed the range of a `Step`, but not that of an `i64`.
#[inline(always)]
pub(super) fn approach(
    a: &PredictedMotion,
    b: &PredictedMotion,
    manifold: &Manifold,
) -> impl Fn(&ManifoldPoint) -> i64 + use<> {
    let n = (raw(manifold.normal.x), raw(manifold.normal.y));
    // Translations are at most 52 m on each axis, lever arms and anchors at most 725 m long, and rotations at most
    // 128 rad. No product and no sum of products reaches 2^63.
    let dot = (raw(a.shift.x) - raw(b.shift.x)) * n.0 + (raw(a.shift.y) - raw(b.shift.y)) * n.1;
    let lever = move |r: Vec2<Length>| (raw(r.x) * n.1 - raw(r.y) * n.0) >> Unit::FRAC_NBITS;
    let turned = move |turn: Travel, lever: i64| (raw(turn) * lever) >> TURN_BITS;
    let by_turn = |motion: &PredictedMotion| {
        if motion.turn == 0 || motion.centre == manifold.origin {
            return 0;
        }
        // Both points are within the world extent, so their difference does not overflow.
        turned(motion.turn, lever(manifold.origin.wrapping_sub(motion.centre).narrow()))
    };
    let common =
        (dot >> (Travel::FRAC_NBITS + Unit::FRAC_NBITS - Step::FRAC_NBITS)) + by_turn(a) - by_turn(b);
    let turn = a.turn.saturating_sub(b.turn);
    move |point| common + turned(turn, lever(point.anchor))
}

fn raw<A: LeEqU32>(x: FixedI32<A>) -> i64 {
    i64::from(x.to_bits())
}

/// The product of a rotation and a lever arm has this many fraction bits more than a `Step`.
const TURN_BITS: u32 = Travel::FRAC_NBITS + Length::FRAC_NBITS - Step::FRAC_NBITS;

pub(super) struct SpeculativePair<'a> {
    pub(super) margins: &'a Margins,
    pub(super) a: &'a ShapeMotion,
    pub(super) b: &'a ShapeMotion,
    pub(super) closing: ClosingBound,
}

#[derive(Clone, Copy)]
pub(super) struct Side<'a> {
    pub(super) shape: &'a Shape,
    pub(super) body: &'a Body,
    pub(super) posed: &'a PosedShape,
}

impl<'a> Side<'a> {
    pub(super) fn of(state: &'a State, poses: &'a Poses, slot: u32) -> Self {
        Side { shape: state.shapes.at(slot), body: state.body_of(slot), posed: poses.at(slot) }
    }

    fn one_way(&self) -> Option<OneWay<'a>> {
        let angle = self.shape.one_way()?;
        Some(OneWay { shape: self.posed, direction: pass_direction(self.body.angle() + angle) })
    }
}

impl SpeculativePair<'_> {
    /// Overlap in metres up to which the shapes may pass by each other.
    fn slack(&self) -> Step {
        self.margins.touching.min(self.a.slack).min(self.b.slack)
    }

    /// Removes the points that the bodies do not reach within the tick, or all points if the shapes pass by each other.
    /// Speculative contacts would otherwise deflect shapes that pass by each other at high speed.
    #[inline(always)]
    pub(super) fn keep_reachable<'p>(
        &self,
        manifold: &mut Manifold,
        motion: &MotionCache,
        posed: impl FnOnce() -> [&'p PosedShape; 2],
    ) {
        let speculative: Step = convert(self.margins.speculative);
        let is_ahead = |point: &ManifoldPoint| point.separation > speculative;
        if self.closing.is_fast() || manifold.points().iter().any(is_ahead) {
            self.drop_unreached(manifold, motion, posed);
        }
    }

    #[inline(never)]
    fn drop_unreached<'p>(
        &self,
        manifold: &mut Manifold,
        motion: &MotionCache,
        posed: impl FnOnce() -> [&'p PosedShape; 2],
    ) {
        let motions = [motion.motion(self.a), motion.motion(self.b)];
        let closing_at = approach(motions[0], motions[1], manifold);
        let (speculative, slack) = (raw::<U27>(convert(self.margins.speculative)), raw(self.slack()));
        // Largest approach at a point that may get an impulse within the tick. A point that overlaps by more than the
        // slack is kept and does not count, because such shapes do not pass by each other.
        let mut fastest = 0;
        manifold.retain(|point| {
            let separation = raw(point.separation);
            if separation < -slack {
                return true;
            }
            let closing = closing_at(point);
            let is_reached = separation <= speculative.max(closing + speculative);
            // Adds a quarter of the approach, because a point whose gap almost closes can get an impulse, too.
            if is_reached && closing + closing / 4 > separation {
                fastest = fastest.max(closing);
            }
            is_reached
        });
        let fastest = Step::from_bits(saturate(fastest));
        if fastest > GHOST_TRAVEL_MIN && self.is_ghost_collision(motions, posed(), manifold.normal, fastest) {
            *manifold = Manifold::NONE;
        }
    }

    pub(super) fn lets_pass(&self, [a, b]: [Side; 2], manifold: &Manifold, was_passing: bool) -> bool {
        let slack = widen(self.slack());
        a.one_way().is_some_and(|one_way| one_way.lets_pass(b.posed, manifold, was_passing, slack))
            || b.one_way()
                .is_some_and(|one_way| one_way.lets_pass(a.posed, &manifold.swapped(), was_passing, slack))
    }

    /// Whether the shapes pass by each other although a contact point closes by `closing` metres in the tick.
    fn is_ghost_collision(
        &self,
        [motion_a, motion_b]: [&PredictedMotion; 2],
        [posed_a, posed_b]: [&PosedShape; 2],
        normal: Vec2<Unit>,
        closing: Step,
    ) -> bool {
        let shift = motion_b.shift_at(posed_b.centre) - motion_a.shift_at(posed_a.centre);
        let turn = convert(self.a.turn.saturating_add(self.b.turn));
        let filter =
            GhostFilter::new(shift.convert(), turn, convert(self.slack()), convert(closing / 8), normal);
        is_ghost(posed_a, posed_b, &filter)
    }
}
