//! The velocities of the bodies of a batch while the batch is solved, and arithmetic that contacts and hinges share.

use core::cell::Cell;

use super::body::SolverBody;
use super::limits::{Faults, SPEED_MAX};
use crate::math::{Ratio, Unit};
pub(super) use crate::simd::shift;
use crate::simd::{Lanes, VelocityW};

pub(super) const UNIT: i32 = shift(Unit::FRAC_NBITS);
pub(super) const RATIO: i32 = shift(Ratio::FRAC_NBITS);

/// 512 m/s in units of [`Speed`](crate::math::Speed): half of the range of the format, which is ±1024 m/s.
pub(super) const HALF: i32 = 1 << 30;

/// The velocities of two bodies in each lane.
pub(super) struct BodyPairW<L: Lanes<N>, const N: usize> {
    pub(super) a: VelocityW<L::Int>,
    pub(super) b: VelocityW<L::Int>,
}

impl<L: Lanes<N>, const N: usize> BodyPairW<L, N> {
    #[inline(always)]
    pub(super) fn copy(&self) -> Self {
        BodyPairW { a: self.a, b: self.b }
    }

    /// Replaces the velocities in the lanes of a mask.
    #[inline(always)]
    pub(super) fn replace(&mut self, mask: L::Mask, other: &Self) {
        for (to, from) in [(&mut self.a, &other.a), (&mut self.b, &other.b)] {
            to.x = L::select(mask, from.x, to.x);
            to.y = L::select(mask, from.y, to.y);
            to.turn = L::select(mask, from.turn, to.turn);
        }
    }

    #[inline(always)]
    pub(super) fn load(bodies: &[Cell<SolverBody>], [a, b]: &[[u32; N]; 2]) -> Self {
        BodyPairW { a: L::velocities(bodies, a), b: L::velocities(bodies, b) }
    }

    /// Loads displacements instead of velocities.
    #[inline(always)]
    pub(super) fn load_shifts(bodies: &[Cell<SolverBody>], [a, b]: &[[u32; N]; 2]) -> Self {
        BodyPairW { a: L::shifts(bodies, a), b: L::shifts(bodies, b) }
    }

    #[inline(always)]
    pub(super) fn store(self, bodies: &[Cell<SolverBody>], [a, b]: &[[u32; N]; 2]) {
        L::set_velocities(bodies, a, self.a);
        L::set_velocities(bodies, b, self.b);
    }

    /// Clamps every component to [`SPEED_MAX`], and counts each change as a fault.
    #[inline(always)]
    pub(super) fn keep_in_range(&mut self, faults: &mut Faults) {
        // One branch that is almost never taken replaces six clamps.
        let limit = L::splat(SPEED_MAX.to_bits());
        let most = L::max(most::<L, N>(self.a), most::<L, N>(self.b));
        let least = L::min(least::<L, N>(self.a), least::<L, N>(self.b));
        if L::any(L::either(L::greater(most, limit), L::greater(L::sub(L::splat(0), limit), least))) {
            self.clamp(faults);
        }
    }

    #[cold]
    fn clamp(&mut self, faults: &mut Faults) {
        let limit = L::splat(SPEED_MAX.to_bits());
        for body in [&mut self.a, &mut self.b] {
            for speed in [&mut body.x, &mut body.y, &mut body.turn] {
                *faults += u64::from(L::count(beyond::<L, N>(*speed, limit)));
                *speed = clamp::<L, N>(*speed, limit);
            }
        }
    }
}

/// Mask of the lanes in which `|value| > limit`.
#[inline(always)]
pub(super) fn beyond<L: Lanes<N>, const N: usize>(value: L::Int, limit: L::Int) -> L::Mask {
    L::either(L::greater(value, limit), L::greater(L::sub(L::splat(0), limit), value))
}

#[inline(always)]
pub(super) fn clamp<L: Lanes<N>, const N: usize>(value: L::Int, limit: L::Int) -> L::Int {
    L::min(L::max(value, L::sub(L::splat(0), limit)), limit)
}

#[inline(always)]
fn most<L: Lanes<N>, const N: usize>(v: VelocityW<L::Int>) -> L::Int {
    L::max(L::max(v.x, v.y), v.turn)
}

#[inline(always)]
fn least<L: Lanes<N>, const N: usize>(v: VelocityW<L::Int>) -> L::Int {
    L::min(L::min(v.x, v.y), v.turn)
}
