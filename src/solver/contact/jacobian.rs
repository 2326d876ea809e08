//! Relative velocities along a row, and the velocity changes of its impulses.

use super::super::pair::BodyPairW;
use super::batch::Row;
use super::overflow_policy::OverflowPolicy;
use crate::simd::{Ints, Lanes, VelocityW};

impl<L: Lanes<N>, const N: usize> BodyPairW<L, N> {
    /// The relative velocity `J v` along a row, as a speed.
    #[inline(always)]
    pub(super) fn velocity(
        &self,
        n: [L::Int; 2],
        row: &Row<N>,
        policy: &mut impl OverflowPolicy<L, N>,
    ) -> L::Int {
        policy.speed(along::<L, N>(&self.a, &self.b, n, row))
    }

    /// Changes the velocities by impulses `d`, which must be at most 512 m/s, so that no sum overflows. `SHIFT` is the
    /// number of fraction bits by which the product of a gain and an impulse exceeds a speed.
    #[inline(always)]
    pub(super) fn change<const SHIFT: i32>(&mut self, row: &Row<N>, d: L::Int) {
        let VelocityW { x, y, turn } = self.a;
        let a = VelocityW {
            x: L::sub(x, part::<L, N, SHIFT>(&row.a[0], d)),
            y: L::sub(y, part::<L, N, SHIFT>(&row.a[1], d)),
            turn: L::sub(turn, part::<L, N, SHIFT>(&row.a[2], d)),
        };
        let VelocityW { x, y, turn } = self.b;
        let b = VelocityW {
            x: L::add(x, part::<L, N, SHIFT>(&row.b[0], d)),
            y: L::add(y, part::<L, N, SHIFT>(&row.b[1], d)),
            turn: L::add(turn, part::<L, N, SHIFT>(&row.b[2], d)),
        };
        (self.a, self.b) = (a, b);
    }
}

#[inline(always)]
fn part<L: Lanes<N>, const N: usize, const SHIFT: i32>(gain: &Ints<N>, d: L::Int) -> L::Int {
    L::narrow::<SHIFT>(L::mul(L::load(gain), d))
}

/// `n.(b - a) + eB uB - eA uA`, with 24 more fraction bits than its arguments.
#[inline(always)]
pub(super) fn along<L: Lanes<N>, const N: usize>(
    a: &VelocityW<L::Int>,
    b: &VelocityW<L::Int>,
    [x, y]: [L::Int; 2],
    row: &Row<N>,
) -> L::Wide {
    let linear = L::add_wide(L::mul(x, L::sub(b.x, a.x)), L::mul(y, L::sub(b.y, a.y)));
    let angular = L::sub_wide(L::mul(L::load(&row.e_b), b.turn), L::mul(L::load(&row.e_a), a.turn));
    L::add_wide(linear, angular)
}
