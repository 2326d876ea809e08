//! Velocity changes by impulses of hinges.

use super::super::super::limits::Faults;
use super::super::super::pair::{BodyPairW, UNIT, beyond};
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
