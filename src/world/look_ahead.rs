//! How far ahead a tick has to look: what a body's velocity can do within it.

use super::config::Config;
use super::outlook::{Motion, Outlook, Reach, Way};
use crate::body::{Body, Shape};
use crate::collision::{Manifold, ManifoldPoint, OneWay, Passage, PosedShape, margin_for, may_meet, pass_by};
use crate::math::{Length, Rot, Step, Unit, Vec2, convert, narrow, saturate, widen};
use fixed::FixedI32;
use fixed::types::extra::{LeEqU32, U27};

/// By how much two bodies approach each other in a tick at a point of their contact, along the normal. With `x` the
/// shift, `t` the turn and `r` the arm of each,
///
/// ```text
/// n.(xA - xB) + tA (rA x n) - tB (rB x n)
/// ```
///
/// where `r` is the arm of the manifold's origin and the anchor together: each point adds `(tA - tB) (anchor x n)`. In
/// units of `Step` that do not saturate.
#[inline]
pub(super) fn approach(
    a: &Motion,
    b: &Motion,
    manifold: &Manifold,
) -> impl Fn(&ManifoldPoint) -> i64 + use<> {
    let n = (raw(manifold.normal.x), raw(manifold.normal.y));
    // Shifts are at most 52 m, arms and anchors 725 m, and turns 128 rad: products of two have at most 62 bits.
    let dot = (raw(a.shift.x) - raw(b.shift.x)) * n.0 + (raw(a.shift.y) - raw(b.shift.y)) * n.1;
    let lever = move |r: Vec2<Length>| (raw(r.x) * n.1 - raw(r.y) * n.0) >> Unit::FRAC_NBITS;
    let turned = move |turn: Way, lever: i64| (raw(turn) * lever) >> TURN_BITS;
    let by_turn = |motion: &Motion| {
        if motion.turn == 0 || motion.centre == manifold.origin {
            return 0;
        }
        // Both are in the world.
        turned(motion.turn, lever(manifold.origin.wrapping_sub(motion.centre).narrow()))
    };
    let common = (dot >> (Way::FRAC_NBITS + Unit::FRAC_NBITS - Step::FRAC_NBITS)) + by_turn(a) - by_turn(b);
    let turn = a.turn.saturating_sub(b.turn);
    move |point| common + turned(turn, lever(point.anchor))
}

/// The bits of a number, with room for a product.
fn raw<A: LeEqU32>(x: FixedI32<A>) -> i64 {
    i64::from(x.to_bits())
}

/// The fraction bits of a product of a turn and a lever that a step does not have.
const TURN_BITS: u32 = Way::FRAC_NBITS + Length::FRAC_NBITS - Step::FRAC_NBITS;

/// What is the same for all pairs of a world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Horizon {
    speculative: Length,
    touching: Step,
}

impl Horizon {
    pub(super) fn of(config: &Config) -> Self {
        Horizon {
            speculative: narrow(config.speculative_distance),
            touching: narrow(config.touching_distance()),
        }
    }
}

/// How far two shapes may come towards each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closing {
    /// Bound of the way by which any two points of the shapes approach each other in the tick, in metres.
    way: Way,
    /// How far ahead their contact has to look, in metres.
    pub(super) margin: Length,
}

impl Closing {
    #[inline]
    pub(super) fn of(horizon: &Horizon, a: &Reach, b: &Reach) -> Self {
        let way = a.closing(b);
        Closing { way, margin: margin_for(horizon.speculative, way) }
    }

    /// Whether the shapes move so fast against each other that they may pass by.
    #[inline]
    pub(super) fn is_fast(self) -> bool {
        self.way > PASSAGE_MIN
    }

    /// Whether the shapes are so near that they may meet within the tick.
    #[inline]
    pub(super) fn may_meet(self, a: &Reach, b: &Reach) -> bool {
        may_meet(a.bounds, b.bounds, self.margin)
    }
}

/// How two bodies approach.
pub(super) struct Approach<'a> {
    pub(super) horizon: &'a Horizon,
    pub(super) a: &'a Reach,
    pub(super) b: &'a Reach,
    pub(super) closing: Closing,
}

/// Shapes that move against each other by less than this in a tick, in metres, do not pass by.
const PASSAGE_MIN: Step = Step::lit("0.0001");

impl Approach<'_> {
    /// How far the shapes may overlap, in metres, when they pass by each other.
    fn slack(&self) -> Step {
        self.horizon.touching.min(self.a.slack).min(self.b.slack)
    }

    /// Drops the points that the bodies, at their present velocities, will not reach within the tick: shapes that
    /// pass by at speed must not catch on each other.
    #[inline(always)]
    pub(super) fn keep_reachable<'p>(
        &self,
        manifold: &mut Manifold,
        outlook: &Outlook,
        posed: impl FnOnce() -> (&'p PosedShape, &'p PosedShape),
    ) {
        let speculative: Step = convert(self.horizon.speculative);
        let ahead = |point: &ManifoldPoint| point.separation > speculative;
        if self.closing.is_fast() || manifold.points().iter().any(ahead) {
            self.drop_unreached(manifold, outlook, posed);
        }
    }

    #[inline(never)]
    fn drop_unreached<'p>(
        &self,
        manifold: &mut Manifold,
        outlook: &Outlook,
        posed: impl FnOnce() -> (&'p PosedShape, &'p PosedShape),
    ) {
        let motions = (outlook.motion(self.a), outlook.motion(self.b));
        let closing_at = approach(motions.0, motions.1, manifold);
        let (speculative, slack) = (raw::<U27>(convert(self.horizon.speculative)), raw(self.slack()));
        // A point that is not reached does nothing, and a deep one does not pass by: only others decide.
        let mut most = 0;
        manifold.retain(|point| {
            let separation = raw(point.separation);
            if separation < -slack {
                return true;
            }
            let closing = closing_at(point);
            let kept = separation <= speculative.max(closing + speculative);
            // A quarter more: a gap that just closes acts too.
            if kept && closing + closing / 4 > separation {
                most = most.max(closing);
            }
            kept
        });
        let most = Step::from_bits(saturate(most));
        if most > PASSAGE_MIN && self.passes_by(motions, posed(), manifold.normal, most) {
            *manifold = Manifold::NONE;
        }
    }

    /// Whether one of the shapes lets the other pass through it.
    pub(super) fn lets_pass(
        &self,
        [(a, body_a, posed_a), (b, body_b, posed_b)]: [(&Shape, &Body, &PosedShape); 2],
        manifold: &Manifold,
        was_passing: bool,
    ) -> bool {
        let slack = widen(self.slack());
        one_way(a, body_a, posed_a).is_some_and(|a| a.lets_pass(posed_b, manifold, was_passing, slack))
            || one_way(b, body_b, posed_b)
                .is_some_and(|b| b.lets_pass(posed_a, &manifold.swapped(), was_passing, slack))
    }

    /// Whether the shapes pass by each other, within the slack, although a contact closes by some way in the tick.
    fn passes_by(
        &self,
        (motion_a, motion_b): (&Motion, &Motion),
        (posed_a, posed_b): (&PosedShape, &PosedShape),
        normal: Vec2<Unit>,
        closing: Step,
    ) -> bool {
        let shift = motion_b.shift_at(posed_b.centre) - motion_a.shift_at(posed_a.centre);
        let turn = convert(self.a.turn.saturating_add(self.b.turn));
        let passage =
            Passage::new(shift.convert(), turn, convert(self.slack()), convert(closing / 8), normal);
        pass_by(posed_a, posed_b, &passage)
    }
}

/// The shape with its direction in world axes, if it is a one-way shape.
fn one_way<'a>(shape: &Shape, body: &Body, posed: &'a PosedShape) -> Option<OneWay<'a>> {
    let direction = shape.one_way().map(|angle| Rot::from_angle(body.angle() + angle).apply(Vec2::X))?;
    Some(OneWay { shape: posed, direction })
}
