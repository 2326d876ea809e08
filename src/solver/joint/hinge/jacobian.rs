//! Velocity changes by impulses of hinges.

use super::super::super::limits::Faults;
use super::super::super::pair::{BodyPairW, HALF, UNIT, beyond, clamp};
use super::batch::Batch;
use crate::simd::{Ints, Lanes, VelocityW};

/// 362 m/s in units of a speed. Two impulses of this size along different axes change a velocity by less than 512 m/s.
const PLAIN_MAX: i32 = 362 << 21;

impl<L: Lanes<N>, const N: usize> BodyPairW<L, N> {
    /// Changes the velocities by impulses `d` along x and y, of at most 512 m/s each.
    #[inline(always)]
    pub(super) fn apply_at_point(&mut self, batch: &Batch<N>, d: [L::Int; 2], faults: &mut Faults) {
        let [g_a, g_b] = &batch.g;
        let [f_a, f_b] = &batch.f;
        let (a, b) = (changes::<L, N>(g_a, f_a, d), changes::<L, N>(g_b, f_b, d));
        let limit = L::splat(PLAIN_MAX);
        let large = L::either(beyond::<L, N>(d[0], limit), beyond::<L, N>(d[1], limit));
        if L::any(large) {
            self.apply_saturating(a, b);
        } else {
            let VelocityW { x, y, turn } = self.a;
            self.a = VelocityW { x: L::sub(x, a.x), y: L::sub(y, a.y), turn: L::sub(turn, a.turn) };
            let VelocityW { x, y, turn } = self.b;
            self.b = VelocityW { x: L::add(x, b.x), y: L::add(y, b.y), turn: L::add(turn, b.turn) };
        }
        self.keep_in_range(faults);
    }

    /// Applies impulses above [`PLAIN_MAX`]. Two impulses of 512 m/s may change a velocity by 724 m/s, so that the sums
    /// must saturate.
    #[cold]
    fn apply_saturating(&mut self, a: VelocityW<L::Int>, b: VelocityW<L::Int>) {
        let VelocityW { x, y, turn } = self.a;
        let sub = L::sub_saturating;
        self.a = VelocityW { x: sub(x, a.x), y: sub(y, a.y), turn: sub(turn, a.turn) };
        let VelocityW { x, y, turn } = self.b;
        let add = L::add_saturating;
        self.b = VelocityW { x: add(x, b.x), y: add(y, b.y), turn: add(turn, b.turn) };
    }

    /// Changes the spins by impulses on the angle of less than 1024 m/s.
    #[inline(always)]
    pub(super) fn turn(&mut self, f: &[Ints<N>; 2], d: L::Int, faults: &mut Faults) {
        // Most rows on the angle are limits that are not reached.
        if !L::any(beyond::<L, N>(d, L::splat(0))) {
            return;
        }
        if L::any(beyond::<L, N>(d, L::splat(HALF - 1))) {
            self.turn_in_steps(f, d, faults);
        } else {
            self.turn_step(f, d, faults);
        }
    }

    #[inline(always)]
    fn turn_step(&mut self, f: &[Ints<N>; 2], d: L::Int, faults: &mut Faults) {
        self.a.turn = L::sub(self.a.turn, L::narrow::<UNIT>(L::mul(L::load(&f[0]), d)));
        self.b.turn = L::add(self.b.turn, L::narrow::<UNIT>(L::mul(L::load(&f[1]), d)));
        self.keep_in_range(faults);
    }

    /// Applies impulses above 512 m/s, as when a motor reverses or a held body is released.
    #[cold]
    fn turn_in_steps(&mut self, f: &[Ints<N>; 2], mut d: L::Int, faults: &mut Faults) {
        for _ in 0..3 {
            let step = clamp::<L, N>(d, L::splat(HALF - 1));
            self.turn_step(f, step, faults);
            d = L::sub(d, step);
        }
    }
}

#[inline(always)]
fn changes<L: Lanes<N>, const N: usize>(
    g: &[Ints<N>; 3],
    f: &[Ints<N>; 2],
    d: [L::Int; 2],
) -> VelocityW<L::Int> {
    VelocityW {
        x: dot::<L, N>([&g[0], &g[1]], d),
        y: dot::<L, N>([&g[1], &g[2]], d),
        turn: dot::<L, N>([&f[0], &f[1]], d),
    }
}

#[inline(always)]
fn dot<L: Lanes<N>, const N: usize>([x, y]: [&Ints<N>; 2], d: [L::Int; 2]) -> L::Int {
    L::narrow::<UNIT>(L::add_wide(L::mul(L::load(x), d[0]), L::mul(L::load(y), d[1])))
}
