//! Bodies in the solver.

#[cfg(test)]
mod tests;

use core::cell::Cell;

use super::limits::{Faults, SPEED_MAX};
use crate::body::Body;
use crate::math::{Reciprocal, Shift, Speed, Vec2, round_shift_wide, saturate_wide};
pub(crate) use crate::simd::SolverBody;

impl SolverBody {
    pub(crate) fn of(body: &Body) -> Self {
        SolverBody { velocity: body.velocity, spin: body.spin, ..Self::default() }
    }

    /// Sets the velocity. Clamps every component to ±[`SPEED_MAX`], and counts each clamp as a fault.
    #[inline]
    pub(crate) fn set_velocity(&mut self, x: Speed, y: Speed, spin: Speed, faults: &mut Faults) {
        self.velocity = Vec2::new(x, y);
        self.spin = spin;
        // One branch that is almost never taken replaces three clamps. Magnitudes are unsigned, because the negative of
        // the minimum does not fit the format.
        let fastest = x.unsigned_abs().max(y.unsigned_abs()).max(spin.unsigned_abs());
        if fastest > SPEED_MAX.unsigned_abs() {
            self.clamp(faults);
        }
    }

    #[cold]
    fn clamp(&mut self, faults: &mut Faults) {
        for speed in [&mut self.velocity.x, &mut self.velocity.y, &mut self.spin] {
            let within = (*speed).clamp(-SPEED_MAX, SPEED_MAX);
            *faults += u64::from(within != *speed);
            *speed = within;
        }
    }

    pub(crate) fn reversed(&self) -> Self {
        SolverBody { velocity: -self.velocity, spin: self.spin.saturating_neg(), ..*self }
    }

    #[inline]
    pub(super) fn change_pair(
        bodies: &[Cell<SolverBody>],
        [a, b]: [u32; 2],
        change: impl FnOnce(&mut SolverBody, &mut SolverBody),
    ) {
        assert!(a != b, "a constraint is between two bodies, not between {a} and {b}");
        let (cell_a, cell_b) = (&bodies[a as usize], &bodies[b as usize]);
        let (mut a, mut b) = (cell_a.get(), cell_b.get());
        change(&mut a, &mut b);
        cell_a.set(a);
        cell_b.set(b);
    }
}

/// Converts `turn`, the rotation of a body times its radius of gyration (`k dtheta`, in metres), to the rotation in units
/// of 2^-32 of a full turn. The result may exceed a full turn.
pub(crate) fn turn_of(turn: Shift, inverse_gyration: Reciprocal) -> i64 {
    /// `1 / (2 pi)` with 63 fraction bits.
    const INVERSE_TAU: i128 = 1_467_945_251_641_000_613;
    if turn == Shift::ZERO {
        return 0;
    }
    let (product, extra) = inverse_gyration.times_exact(turn);
    saturate_wide(round_shift_wide(i128::from(product) * INVERSE_TAU, extra + Shift::FRAC_NBITS + 63 - 32))
}
