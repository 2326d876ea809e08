//! The motion of a body within a tick as a sweep: a prediction at the start of the tick, and the actual motion at its
//! end.

use crate::collision::{SupportShape, Sweep};
use crate::math::{Angle, Fx, Rot, Shift, Vec2, narrow};
use crate::solver::turn_of;
use crate::world::cache::Scratch;
use crate::world::state::State;

/// The motion that a body has made in the tick. A body that is not awake stands still.
pub(super) fn made_motion(state: &State, scratch: &Scratch, slot: u32) -> Sweep {
    let body = state.bodies.at(slot);
    let Ok(index) = scratch.awake.bodies().binary_search(&slot) else { return Sweep::fixed(body.centre) };
    let start = scratch.sweeps.starts[index];
    let solved = turn_of(scratch.solver.body(slot).turn, body.mass.inverse_gyration);
    // If a sweep has stopped the body or the body had a target, the rotation of the solver may not lead to the final
    // angle. The result then has the smallest rotation to the final angle.
    let short = (body.angle - start.angle).to_turns().to_bits();
    let is_complete = Angle::from_turns(Fx::from_bits(solved.wrapping_sub(short))) == Angle::ZERO;
    let turn = if is_complete { solved } else { short };
    Sweep { start: start.centre, end: body.centre, turn }
}

/// The motion of a kinematic body in the tick, predicted from its target or, if it has none, from its velocity.
pub(super) fn predicted_motion(state: &State, slot: u32) -> Sweep {
    let body = state.bodies.at(slot);
    let start = body.centre;
    if let Some(target) = body.target.as_deref() {
        return Sweep { start, end: target.centre, turn: (target.angle - body.angle).to_turns().to_bits() };
    }
    let rate = i64::from(state.config.tick_rate);
    let velocity = body.velocity();
    let turn: Shift = narrow(Fx::from(body.spin) / rate);
    Sweep {
        start,
        end: start + Vec2::new(velocity.x / rate, velocity.y / rate),
        turn: turn_of(turn, body.mass.inverse_gyration),
    }
}

/// A shape at the start of a sweep, from the shape at its end.
pub(super) fn at_start(at_end: SupportShape, sweep: &Sweep) -> SupportShape {
    if sweep.turn == 0 {
        return at_end;
    }
    at_end.rotated(Rot::from_angle(Angle::from_turns(Fx::from_bits(sweep.turn.wrapping_neg()))))
}
