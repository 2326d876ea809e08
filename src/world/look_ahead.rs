//! How far ahead a tick has to look: what a body's velocity can do within it.

use super::state::State;
use crate::body::{Body, Shape};
use crate::collision::{Manifold, ManifoldPoint, OneWay, Outline, Passage, PosedShape, margin_for, pass_by};
use crate::fx;
use crate::math::{Fx, Length, Rot, Unit, Vec2, fx_mul, narrow, widen};

/// Bounds of how far a body can come in a tick at its present velocity.
pub(super) struct Motion {
    pub(super) shift: Vec2<Fx>,
    /// In radians.
    turn: Fx,
}

impl Motion {
    pub(super) fn of(body: &Body, tick_rate: u32) -> Self {
        let rate = i64::from(tick_rate);
        let velocity = body.velocity();
        Motion {
            shift: Vec2::new(velocity.x / rate, velocity.y / rate),
            turn: body.angular_velocity().saturating_abs() / rate,
        }
    }

    /// How far any point of a shape moves because its body turns: at most arm times angle, and at most from one
    /// side to the other.
    pub(super) fn turn_reach(&self, posed: &PosedShape, body: &Body) -> Fx {
        if self.turn < Fx::DELTA * 64 {
            return Fx::ZERO;
        }
        let offset = posed.bounds.centre() - body.centre_of_mass();
        if matches!(posed.outline, Outline::Circle { .. }) && offset == Vec2::ZERO {
            return Fx::ZERO;
        }
        let half = posed.bounds.extents();
        let reach = half
            .x
            .saturating_add(half.y)
            .saturating_add(offset.x.saturating_abs())
            .saturating_add(offset.y.saturating_abs());
        fx_mul(reach, self.turn.min(fx!(2)))
    }
}

/// How two bodies approach: it decides how far ahead their contact has to look.
pub(super) struct Approach<'a> {
    a: &'a Body,
    b: &'a Body,
    tick_rate: u32,
    speculative: Length,
    /// Bound of the way by which any two points of the shapes approach each other in the tick, in metres.
    closing: Fx,
    pub(super) margin: Length,
    posed_a: &'a PosedShape,
    posed_b: &'a PosedShape,
    /// How far the shapes may overlap, in metres, when they pass by each other.
    slack: Fx,
}

/// Shapes that move against each other by less than this in a tick, in metres, do not pass by.
const PASSAGE_MIN: Fx = fx!(0.0001);

impl<'a> Approach<'a> {
    pub(super) fn new(
        state: &State,
        (a, posed_a): (&'a Body, &'a PosedShape),
        (b, posed_b): (&'a Body, &'a PosedShape),
    ) -> Self {
        let tick_rate = state.config.tick_rate;
        let (motion_a, motion_b) = (Motion::of(a, tick_rate), Motion::of(b, tick_rate));
        let shift = motion_b.shift - motion_a.shift;
        let turn = motion_a.turn_reach(posed_a, a).saturating_add(motion_b.turn_reach(posed_b, b));
        let closing = shift.x.saturating_abs().saturating_add(shift.y.saturating_abs()).saturating_add(turn);
        let speculative: Length = narrow(state.config.speculative_distance);
        let size = |posed: &PosedShape| {
            let half = posed.bounds.extents();
            half.x.max(half.y) / 16
        };
        let slack = state.config.touching_distance().min(size(posed_a)).min(size(posed_b));
        let margin = margin_for(speculative, closing);
        Approach { a, b, tick_rate, speculative, closing, margin, posed_a, posed_b, slack }
    }

    /// Drops the points that the bodies, at their present velocities, will not reach within the tick: shapes that
    /// pass by at speed must not catch on each other.
    pub(super) fn keep_reachable(&self, manifold: &mut Manifold) {
        if self.margin == self.speculative {
            return;
        }
        let normal = manifold.normal.widen();
        let origin = manifold.origin;
        let closing = |point: &ManifoldPoint| {
            let place = origin + point.anchor.widen();
            let vn = (self.b.velocity_at(place) - self.a.velocity_at(place)).dot(normal);
            -vn / i64::from(self.tick_rate)
        };
        manifold.retain(|point| {
            let separation = widen(point.separation);
            separation <= widen(self.speculative)
                || separation <= closing(point).saturating_add(widen(self.speculative))
        });
        if self.closing <= PASSAGE_MIN {
            return;
        }
        // A point that is not reached does nothing, so only one that is decides.
        let reached = manifold.points().iter().filter(|point| {
            let separation = widen(point.separation);
            let closing = closing(point);
            // A quarter more: a gap that just closes acts too.
            separation >= -self.slack
                && closing > PASSAGE_MIN
                && closing.saturating_add(closing / 4) > separation
        });
        if reached.map(closing).max().is_some_and(|closing| self.passes_by(manifold.normal, closing)) {
            manifold.retain(|_| false);
        }
    }

    /// Whether one of the shapes lets the other pass through it.
    pub(super) fn lets_pass(&self, (a, b): (&Shape, &Shape), manifold: &Manifold, was_passing: bool) -> bool {
        let one_way = |shape: &Shape, body: &Body, posed: &'a PosedShape| {
            let direction =
                shape.one_way().map(|angle| Rot::from_angle(body.angle() + angle).apply(Vec2::X))?;
            Some(OneWay { shape: posed, direction })
        };
        one_way(a, self.a, self.posed_a)
            .is_some_and(|a| a.lets_pass(self.posed_b, manifold, was_passing, self.slack))
            || one_way(b, self.b, self.posed_b)
                .is_some_and(|b| b.lets_pass(self.posed_a, &manifold.swapped(), was_passing, self.slack))
    }

    /// Whether the shapes pass by each other, within the slack, although a contact closes by some way in the tick.
    fn passes_by(&self, normal: Vec2<Unit>, closing: Fx) -> bool {
        let (a, b) = (Motion::of(self.a, self.tick_rate), Motion::of(self.b, self.tick_rate));
        let rate = i64::from(self.tick_rate);
        let velocity = self.b.velocity_at(self.posed_b.centre) - self.a.velocity_at(self.posed_a.centre);
        let turn = a.turn_reach(self.posed_a, self.a).saturating_add(b.turn_reach(self.posed_b, self.b));
        let shift = Vec2::new(velocity.x / rate, velocity.y / rate).narrow();
        let passage = Passage::new(shift, narrow(turn), narrow(self.slack), narrow(closing / 8), normal);
        pass_by(self.posed_a, self.posed_b, &passage)
    }
}
