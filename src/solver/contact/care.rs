//! How numbers are kept in their formats: by looking at each sum, or by knowing beforehand that none is too large.
//!
//! Nearly all contacts are [`Calm`]: nothing in them is fast, deep or pushed hard, and then no sum can leave its format
//! and no clamp can bite. So a batch is solved without a look at any sum, and solved again by [`Careful`] if it turns
//! out not to have been calm after all. Both find the same numbers wherever calm ones are used:
//!
//! ```text
//! |vx|, |vy|, |u| < 64 at first, |d| < 4 for at most 10 rows       velocities stay below 104, spins below 84
//! |e| <= 3                                                        |J v| < 2 sqrt(2) 104 + 6 84 < 799
//! |s| < 1/8 m, rates <= 512 per second                            |bias| <= 64, and below 863 with J v
//! 0 <= L < 64                                                     |L - w| < 927, where 1024 fit
//! grips <= 3.5                                                    friction limit < 2 3.5 68 = 476
//! |dx|, |dy|, |k dtheta|, |s0| < 2 m                              |s| < 20 m, where 32 fit
//! ```

#[cfg(test)]
mod tests;

use super::super::limits::{Faults, IMPULSE_MAX};
use super::super::pair::{HALF, Pair, RATIO, UNIT, beyond, clamp, shift};
use super::batch::{Batch, Row};
use super::special::Special;
use crate::lanes::{Lanes, Motion};
use crate::math::{Grip, Rate, Ratio, Shift, Speed};

pub(super) const GRIP: i32 = shift(Grip::FRAC_NBITS);

/// The longest lever ratio and the best grip of calm contacts.
const CALM_RATIO: Ratio = Ratio::lit("3");
const CALM_GRIP: Grip = Grip::lit("3.5");
/// The highest rate at which calm separations are turned into speeds.
const CALM_RATE: Rate = Rate::lit("512");

/// The limit of speeds and impulses, 64 m/s, and of ways, 2 m: a power of two.
const LARGE_BITS: u32 = 6 + Speed::FRAC_NBITS;
const _: () = assert!(LARGE_BITS == 1 + Shift::FRAC_NBITS);
/// The limit of changes of an impulse, 4 m/s, and of separations that are pushed, 1/8 m.
const SMALL_BITS: u32 = 2 + Speed::FRAC_NBITS;
const _: () = assert!(SMALL_BITS + 3 == Shift::FRAC_NBITS);

/// Whether contacts may be calm in a world whose separations are turned into speeds at such rates.
pub(super) fn calm_at(rates: [Rate; 3]) -> bool {
    rates.into_iter().all(|rate| rate <= CALM_RATE)
}

/// What is done where a number might leave its format.
pub(super) trait Care<L: Lanes<N>, const N: usize> {
    /// Looks at the velocities that an iteration begins with, or at how far bodies have come.
    #[inline(always)]
    fn see(&mut self, _: &Pair<L, N>) {}
    /// Looks at an impulse that is there already.
    #[inline(always)]
    fn see_impulse(&mut self, _: L::Int) {}
    /// Looks at a separation.
    #[inline(always)]
    fn see_separation(&mut self, _: L::Int) {}
    /// `J v` as a speed.
    fn speed(&mut self, wide: L::Wide) -> L::Int;
    /// A friction limit.
    fn limit(wide: L::Wide) -> L::Int;
    fn add(a: L::Int, b: L::Int) -> L::Int;
    fn sub(a: L::Int, b: L::Int) -> L::Int;
    /// A number kept within a limit on either side.
    fn clamp(value: L::Int, limit: L::Int) -> L::Int;
    /// An accumulated impulse along a normal.
    fn impulse(&mut self, wanted: L::Int) -> L::Int;
    /// A separation that has changed by `J dx`.
    fn moved(&mut self, separation: L::Int, wide: L::Wide) -> L::Int;
    /// Changes velocities by impulses `d`.
    fn apply(&mut self, pair: &mut Pair<L, N>, row: &Row<N>, d: L::Int);
    /// Changes velocities by impulses that are there already.
    fn apply_again(&mut self, pair: &mut Pair<L, N>, row: &Row<N>, lambda: L::Int);
}

/// Looks at every sum, saturates it and counts what did not fit.
pub(super) struct Careful<'a>(pub(super) &'a mut Faults);

impl<L: Lanes<N>, const N: usize> Care<L, N> for Careful<'_> {
    #[inline(always)]
    fn moved(&mut self, separation: L::Int, wide: L::Wide) -> L::Int {
        L::add_saturating(separation, L::narrow_saturating::<RATIO>(wide).0)
    }

    #[inline(always)]
    fn speed(&mut self, wide: L::Wide) -> L::Int {
        let (vn, out) = L::narrow_saturating::<RATIO>(wide);
        if L::any(out) {
            *self.0 += u64::from(L::count(out));
        }
        vn
    }

    #[inline(always)]
    fn limit(wide: L::Wide) -> L::Int {
        L::narrow_saturating::<GRIP>(wide).0
    }

    #[inline(always)]
    fn add(a: L::Int, b: L::Int) -> L::Int {
        L::add_saturating(a, b)
    }

    #[inline(always)]
    fn sub(a: L::Int, b: L::Int) -> L::Int {
        L::sub_saturating(a, b)
    }

    #[inline(always)]
    fn clamp(value: L::Int, limit: L::Int) -> L::Int {
        clamp::<L, N>(value, limit)
    }

    #[inline(always)]
    fn impulse(&mut self, wanted: L::Int) -> L::Int {
        let limit = L::splat(IMPULSE_MAX.to_bits());
        let over = L::greater(wanted, limit);
        if L::any(over) {
            *self.0 += u64::from(L::count(over));
        }
        L::min(wanted, limit)
    }

    #[inline(always)]
    fn apply(&mut self, pair: &mut Pair<L, N>, row: &Row<N>, d: L::Int) {
        if L::any(L::negative(L::add(d, L::splat(HALF)))) {
            apply_in_steps(pair, row, d, self.0);
        } else {
            pair.change::<UNIT>(row, d);
            pair.keep_in_range(self.0);
        }
    }

    #[inline(always)]
    fn apply_again(&mut self, pair: &mut Pair<L, N>, row: &Row<N>, lambda: L::Int) {
        self.apply(pair, row, lambda);
    }
}

/// A friction limit may shrink, and what was pushed may come free, by more than a velocity has room for.
#[cold]
fn apply_in_steps<L: Lanes<N>, const N: usize>(
    pair: &mut Pair<L, N>,
    row: &Row<N>,
    mut d: L::Int,
    faults: &mut Faults,
) {
    let limit = L::splat(HALF - 1);
    for _ in 0..3 {
        let step = clamp::<L, N>(d, limit);
        pair.change::<UNIT>(row, step);
        pair.keep_in_range(faults);
        d = L::sub(d, step);
    }
}

/// Looks at no sum, and says in the end whether none was too large.
pub(super) struct Calm<L: Lanes<N>, const N: usize> {
    /// All numbers that must be small so far, each with its limit added: what is within has no higher bit than twice
    /// the limit, which is a power of two.
    large: L::Int,
    small: L::Int,
}

impl<L: Lanes<N>, const N: usize> Calm<L, N> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Calm { large: L::splat(0), small: L::splat(0) }
    }

    #[inline(always)]
    fn see_large(&mut self, number: L::Int) {
        self.large = L::or(self.large, L::add(number, L::splat(1 << LARGE_BITS)));
    }

    #[inline(always)]
    fn see_small(&mut self, number: L::Int) {
        self.small = L::or(self.small, L::add(number, L::splat(1 << SMALL_BITS)));
    }

    /// Whether the rows of a batch, and what is special about it, can be those of calm contacts.
    #[inline(always)]
    pub(super) fn suits(batch: &Batch<N>, special: Option<&Special<N>>) -> bool {
        let ratio = L::splat(CALM_RATIO.to_bits());
        let mut wild = long::<L, N>(&batch.tangent, ratio);
        for point in &batch.points[..batch.count] {
            wild = L::either(wild, long::<L, N>(&point.normal, ratio));
            wild = L::either(wild, L::greater(L::load(&point.grip), L::splat(CALM_GRIP.to_bits())));
        }
        let drags = special.is_some_and(|special| special.rolls || special.surface_speed.0 != [0; N]);
        !(drags || L::any(wild))
    }

    /// Whether everything seen was within its limit.
    #[inline(always)]
    pub(super) fn held(&self) -> bool {
        let beyond = |seen: L::Int, bits: u32| {
            L::either(L::negative(seen), L::greater(seen, L::splat((2 << bits) - 1)))
        };
        !L::any(L::either(beyond(self.large, LARGE_BITS), beyond(self.small, SMALL_BITS)))
    }
}

/// Where a lever ratio of a row is longer than a limit.
#[inline(always)]
fn long<L: Lanes<N>, const N: usize>(row: &Row<N>, limit: L::Int) -> L::Mask {
    L::either(beyond::<L, N>(L::load(&row.e_a), limit), beyond::<L, N>(L::load(&row.e_b), limit))
}

impl<L: Lanes<N>, const N: usize> Care<L, N> for Calm<L, N> {
    #[inline(always)]
    fn see(&mut self, pair: &Pair<L, N>) {
        let Motion { x, y, turn } = pair.a;
        self.see_large(x);
        self.see_large(y);
        self.see_large(turn);
        let Motion { x, y, turn } = pair.b;
        self.see_large(x);
        self.see_large(y);
        self.see_large(turn);
    }

    #[inline(always)]
    fn see_impulse(&mut self, lambda: L::Int) {
        self.see_large(lambda);
    }

    #[inline(always)]
    fn see_separation(&mut self, separation: L::Int) {
        self.see_small(separation);
    }

    #[inline(always)]
    fn moved(&mut self, separation: L::Int, wide: L::Wide) -> L::Int {
        self.see_large(separation);
        L::add(separation, L::narrow::<RATIO>(wide))
    }

    #[inline(always)]
    fn speed(&mut self, wide: L::Wide) -> L::Int {
        L::narrow::<RATIO>(wide)
    }

    #[inline(always)]
    fn limit(wide: L::Wide) -> L::Int {
        L::narrow::<GRIP>(wide)
    }

    #[inline(always)]
    fn add(a: L::Int, b: L::Int) -> L::Int {
        L::add(a, b)
    }

    #[inline(always)]
    fn sub(a: L::Int, b: L::Int) -> L::Int {
        L::sub(a, b)
    }

    #[inline(always)]
    fn clamp(value: L::Int, _: L::Int) -> L::Int {
        value
    }

    #[inline(always)]
    fn impulse(&mut self, wanted: L::Int) -> L::Int {
        wanted
    }

    #[inline(always)]
    fn apply(&mut self, pair: &mut Pair<L, N>, row: &Row<N>, d: L::Int) {
        self.see_small(d);
        change(pair, row, d);
    }

    #[inline(always)]
    fn apply_again(&mut self, pair: &mut Pair<L, N>, row: &Row<N>, lambda: L::Int) {
        self.see_impulse(lambda);
        change(pair, row, lambda);
    }
}

/// Changes velocities by impulses that have bits to spare, so that what is wanted of a product is its upper half: one
/// shift less.
#[inline(always)]
fn change<L: Lanes<N>, const N: usize>(pair: &mut Pair<L, N>, row: &Row<N>, d: L::Int) {
    let twice = L::add(d, d);
    pair.change::<{ UNIT + 2 }>(row, L::add(twice, twice));
}
