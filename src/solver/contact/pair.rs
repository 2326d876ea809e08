//! How the impulses of a row change the bodies of a batch.

use super::super::lanes::{Ints, Lanes, Motion};
use super::super::limits::Faults;
use super::super::pair::{HALF, Pair, RATIO, UNIT, clamp};
use super::batch::Row;

impl<L: Lanes<N>, const N: usize> Pair<L, N> {
    /// `J v` as a speed. A lane in which it does not fit is a fault.
    #[inline(always)]
    pub(super) fn velocity(&self, n: [L::Int; 2], row: &Row<N>, faults: &mut Faults) -> L::Int {
        let (vn, out) = L::narrow_saturating::<RATIO>(along::<L, N>(&self.a, &self.b, n, row));
        if L::any(out) {
            *faults += u64::from(L::count(out));
        }
        vn
    }

    /// Changes the velocities by impulses `d`.
    #[inline(always)]
    pub(super) fn apply(&mut self, row: &Row<N>, d: L::Int, faults: &mut Faults) {
        if L::any(L::negative(L::add(d, L::splat(HALF)))) {
            self.apply_in_steps(row, d, faults);
        } else {
            self.apply_step(row, d, faults);
        }
    }

    /// Of impulses below 512: no sum leaves the format.
    #[inline(always)]
    fn apply_step(&mut self, row: &Row<N>, d: L::Int, faults: &mut Faults) {
        let Motion { x, y, turn } = self.a;
        let a = Motion {
            x: L::sub(x, part::<L, N>(&row.a[0], d)),
            y: L::sub(y, part::<L, N>(&row.a[1], d)),
            turn: L::sub(turn, part::<L, N>(&row.a[2], d)),
        };
        let Motion { x, y, turn } = self.b;
        let b = Motion {
            x: L::add(x, part::<L, N>(&row.b[0], d)),
            y: L::add(y, part::<L, N>(&row.b[1], d)),
            turn: L::add(turn, part::<L, N>(&row.b[2], d)),
        };
        (self.a, self.b) = (a, b);
        self.keep_in_range(faults);
    }

    /// A friction limit may shrink, and what was pushed may come free, by more than a velocity has room for.
    #[cold]
    fn apply_in_steps(&mut self, row: &Row<N>, mut d: L::Int, faults: &mut Faults) {
        let limit = L::splat(HALF - 1);
        for _ in 0..3 {
            let step = clamp::<L, N>(d, limit);
            self.apply_step(row, step, faults);
            d = L::sub(d, step);
        }
    }
}

/// What an impulse changes.
#[inline(always)]
fn part<L: Lanes<N>, const N: usize>(gain: &Ints<N>, d: L::Int) -> L::Int {
    L::narrow::<UNIT>(L::mul(L::load(gain), d))
}

/// `n.(b - a) + eB uB - eA uA`, with 24 more fraction bits.
#[inline(always)]
pub(super) fn along<L: Lanes<N>, const N: usize>(
    a: &Motion<L::Int>,
    b: &Motion<L::Int>,
    [x, y]: [L::Int; 2],
    row: &Row<N>,
) -> L::Wide {
    let linear = L::add_wide(L::mul(x, L::sub(b.x, a.x)), L::mul(y, L::sub(b.y, a.y)));
    let angular = L::sub_wide(L::mul(L::load(&row.e_b), b.turn), L::mul(L::load(&row.e_a), a.turn));
    L::add_wide(linear, angular)
}
