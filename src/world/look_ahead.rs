//! How far ahead a tick has to look: what a body's velocity can do within it.

use super::state::State;
use crate::body::Body;
use crate::collision::{Manifold, Outline, PosedShape, margin_for};
use crate::fx;
use crate::math::{Fx, Length, Vec2, fx_mul, narrow, widen};

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
    pub(super) margin: Length,
}

impl<'a> Approach<'a> {
    pub(super) fn new(
        state: &State,
        (a, posed_a): (&'a Body, &PosedShape),
        (b, posed_b): (&'a Body, &PosedShape),
    ) -> Self {
        let tick_rate = state.config.tick_rate;
        let (motion_a, motion_b) = (Motion::of(a, tick_rate), Motion::of(b, tick_rate));
        let shift = motion_b.shift - motion_a.shift;
        let turn = motion_a.turn_reach(posed_a, a).saturating_add(motion_b.turn_reach(posed_b, b));
        let closing = shift.x.saturating_abs().saturating_add(shift.y.saturating_abs()).saturating_add(turn);
        let speculative: Length = narrow(state.config.speculative_distance);
        Approach { a, b, tick_rate, speculative, margin: margin_for(speculative, closing) }
    }

    /// Drops the points that the bodies, at their present velocities, will not reach within the tick: shapes that
    /// pass by at speed must not catch on each other.
    pub(super) fn keep_reachable(&self, manifold: &mut Manifold) {
        if self.margin == self.speculative {
            return;
        }
        let normal = manifold.normal.widen();
        let origin = manifold.origin;
        manifold.retain(|point| {
            if widen(point.separation) <= widen(self.speculative) {
                return true;
            }
            let place = origin + point.anchor.widen();
            let vn = (self.b.velocity_at(place) - self.a.velocity_at(place)).dot(normal);
            let closing = -vn / i64::from(self.tick_rate);
            widen(point.separation) <= closing.saturating_add(widen(self.speculative))
        });
    }
}
