//! Overflow policies: how numbers are kept within their formats.
//!
//! [`Saturating`] saturates sums that may not fit their format. [`Unchecked`] only records whether all numbers were
//! within bounds in which no sum can overflow and no clamp can act. Most contacts are within these bounds, because they
//! are neither fast nor deep and their impulses are small. They are solved with `Unchecked` first, and again with
//! `Saturating` if a number was out of bounds. Within the bounds, both policies give the same bits:
//!
//! ```text
//! |vx|, |vy|, |u| < 64 at first, |d| < 4 for at most 10 rows       velocities stay below 104, spins below 84
//! |e| <= 3                                                        |J v| < 2 sqrt(2) 104 + 6 84 < 799
//! |s| < 1/8 m, rates <= 512 per second                            |bias| <= 64, and below 863 with J v
//! 0 <= L < 64 at first, below 80 after four rounds                |L - w| < 943, where 1024 fit
//! friction ratios <= 3.5                                          friction limit < 2 3.5 80 = 560, where 1024 fit
//! |dx|, |dy|, |k dtheta|, |s0| < 2 m                              |s| < 20 m, where 32 fit
//! ```

#[cfg(test)]
mod tests;

use super::super::limits::{Faults, IMPULSE_MAX};
use super::super::pair::{BodyPairW, HALF, RATIO, UNIT, beyond, clamp, shift};
use super::batch::{Batch, Row};
use super::extras::ContactExtras;
use crate::math::{FrictionRatio, Rate, Ratio, Shift, Speed};
use crate::simd::{Lanes, VelocityW};

pub(super) const FRICTION_RATIO: i32 = shift(FrictionRatio::FRAC_NBITS);

const UNCHECKED_RATIO: Ratio = Ratio::lit("3");
const UNCHECKED_FRICTION_RATIO: FrictionRatio = FrictionRatio::lit("3.5");
/// Largest factor, in 1/s, between a separation and a speed in unchecked contacts.
const UNCHECKED_RATE: Rate = Rate::lit("512");

/// In unchecked contacts, the bits of a velocity or impulse as a [`Speed`] (below 64 m/s) and of a displacement as a
/// [`Shift`] (below 2 m) are both below 2 to this power.
const LARGE_BITS: u32 = 6 + Speed::FRAC_NBITS;
const _: () = assert!(LARGE_BITS == 1 + Shift::FRAC_NBITS);
/// In unchecked contacts, the bits of an impulse change as a [`Speed`] (below 4 m/s) and of a separation as a [`Shift`]
/// (below 1/8 m) are both below 2 to this power.
const SMALL_BITS: u32 = 2 + Speed::FRAC_NBITS;
const _: () = assert!(SMALL_BITS + 3 == Shift::FRAC_NBITS);

/// Whether contacts may be unchecked if separations are multiplied by these rates.
pub(super) fn unchecked_at(rates: [Rate; 3]) -> bool {
    rates.into_iter().all(|rate| rate <= UNCHECKED_RATE)
}

pub(super) trait OverflowPolicy<L: Lanes<N>, const N: usize> {
    /// Restricts the counting of faults to the given lanes. Velocities that `apply` clamps count in every lane.
    #[inline(always)]
    fn count_faults_in(&mut self, _: L::Mask) {}
    /// Checks velocities or displacements that an operation has loaded.
    #[inline(always)]
    fn see(&mut self, _: &BodyPairW<L, N>) {}
    #[inline(always)]
    fn see_impulse(&mut self, _: L::Int) {}
    #[inline(always)]
    fn see_separation(&mut self, _: L::Int) {}
    /// The relative velocity `J v` along a row, as a speed.
    fn speed(&mut self, wide: L::Wide) -> L::Int;
    /// Converts a friction limit, the sum of friction ratios times normal impulses, from the format of the products to
    /// that of [`Speed`].
    fn limit(wide: L::Wide) -> L::Int;
    fn add(a: L::Int, b: L::Int) -> L::Int;
    fn sub(a: L::Int, b: L::Int) -> L::Int;
    fn clamp(value: L::Int, limit: L::Int) -> L::Int;
    /// Clamps an accumulated impulse along a normal.
    fn impulse(&mut self, wanted: L::Int) -> L::Int;
    /// The sum of a separation and its change `J dx`.
    fn moved(&mut self, separation: L::Int, wide: L::Wide) -> L::Int;
    /// Changes velocities by impulses `d`.
    fn apply(&mut self, pair: &mut BodyPairW<L, N>, row: &Row<N>, d: L::Int);
    /// Changes velocities by accumulated impulses, in a warm start.
    fn apply_again(&mut self, pair: &mut BodyPairW<L, N>, row: &Row<N>, lambda: L::Int);
}

/// Saturates sums. Counts each velocity and normal impulse that it clamps as a fault.
pub(super) struct Saturating<'a, L: Lanes<N>, const N: usize> {
    faults: &'a mut Faults,
    counted: L::Mask,
}

impl<'a, L: Lanes<N>, const N: usize> Saturating<'a, L, N> {
    #[inline(always)]
    pub(super) fn new(faults: &'a mut Faults) -> Self {
        Saturating { faults, counted: L::greater(L::splat(1), L::splat(0)) }
    }

    #[inline(always)]
    fn count(&mut self, out: L::Mask) {
        if L::any(out) {
            *self.faults += u64::from(L::count(L::both(out, self.counted)));
        }
    }
}

impl<L: Lanes<N>, const N: usize> OverflowPolicy<L, N> for Saturating<'_, L, N> {
    #[inline(always)]
    fn count_faults_in(&mut self, lanes: L::Mask) {
        self.counted = lanes;
    }

    #[inline(always)]
    fn moved(&mut self, separation: L::Int, wide: L::Wide) -> L::Int {
        L::add_saturating(separation, L::narrow_saturating::<RATIO>(wide).0)
    }

    #[inline(always)]
    fn speed(&mut self, wide: L::Wide) -> L::Int {
        let (vn, out) = L::narrow_saturating::<RATIO>(wide);
        self.count(out);
        vn
    }

    #[inline(always)]
    fn limit(wide: L::Wide) -> L::Int {
        L::narrow_saturating::<FRICTION_RATIO>(wide).0
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
        self.count(L::greater(wanted, limit));
        L::min(wanted, limit)
    }

    #[inline(always)]
    fn apply(&mut self, pair: &mut BodyPairW<L, N>, row: &Row<N>, d: L::Int) {
        if L::any(L::negative(L::add(d, L::splat(HALF)))) {
            apply_in_steps(pair, row, d, self.faults);
        } else {
            pair.change::<UNIT>(row, d);
            pair.keep_in_range(self.faults);
        }
    }

    #[inline(always)]
    fn apply_again(&mut self, pair: &mut BodyPairW<L, N>, row: &Row<N>, lambda: L::Int) {
        self.apply(pair, row, lambda);
    }
}

/// Applies impulses of more than 512 m/s in steps of at most 512 m/s. Such impulses occur when a friction limit shrinks
/// or a shape under load is released.
#[cold]
fn apply_in_steps<L: Lanes<N>, const N: usize>(
    pair: &mut BodyPairW<L, N>,
    row: &Row<N>,
    mut d: L::Int,
    faults: &mut Faults,
) {
    for _ in 0..3 {
        // The range includes `-HALF`, because `Saturating::apply` also applies `-HALF` in one step.
        let step = L::max(L::min(d, L::splat(HALF - 1)), L::splat(-HALF));
        pair.change::<UNIT>(row, step);
        pair.keep_in_range(faults);
        d = L::sub(d, step);
    }
}

/// Does not check single sums, but records whether all numbers were within their bounds.
pub(super) struct Unchecked<L: Lanes<N>, const N: usize> {
    /// Bitwise OR of the numbers that must be within the bound of [`LARGE_BITS`], with the bound added to each. The
    /// bound is a power of two, so a number within the bound sets no bit at or above twice the bound.
    large: L::Int,
    /// Bitwise OR of the numbers that must be within the bound of [`SMALL_BITS`], with that bound added to each.
    small: L::Int,
}

impl<L: Lanes<N>, const N: usize> Unchecked<L, N> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Unchecked { large: L::splat(0), small: L::splat(0) }
    }

    #[inline(always)]
    fn see_large(&mut self, number: L::Int) {
        self.large = L::or(self.large, L::add(number, L::splat(1 << LARGE_BITS)));
    }

    #[inline(always)]
    fn see_small(&mut self, number: L::Int) {
        self.small = L::or(self.small, L::add(number, L::splat(1 << SMALL_BITS)));
    }

    /// Whether the rows are within the bounds, and no contact has a surface speed or rolling resistance.
    #[inline(always)]
    pub(super) fn suits(batch: &Batch<N>, extras: Option<&ContactExtras<N>>) -> bool {
        let ratio = L::splat(UNCHECKED_RATIO.to_bits());
        let mut wild = long::<L, N>(&batch.tangent, ratio);
        for point in &batch.points[..batch.count] {
            wild = L::either(wild, long::<L, N>(&point.normal, ratio));
            wild = L::either(
                wild,
                L::greater(L::load(&point.friction_ratio), L::splat(UNCHECKED_FRICTION_RATIO.to_bits())),
            );
        }
        let drags = extras.is_some_and(|extras| extras.rolls || extras.surface_speed.0 != [0; N]);
        !(drags || L::any(wild))
    }

    #[inline(always)]
    pub(super) fn held(&self) -> bool {
        let beyond = |seen: L::Int, bits: u32| {
            L::either(L::negative(seen), L::greater(seen, L::splat((2 << bits) - 1)))
        };
        !L::any(L::either(beyond(self.large, LARGE_BITS), beyond(self.small, SMALL_BITS)))
    }
}

/// Mask of the lanes in which a lever ratio of a row is above a limit.
#[inline(always)]
fn long<L: Lanes<N>, const N: usize>(row: &Row<N>, limit: L::Int) -> L::Mask {
    L::either(beyond::<L, N>(L::load(&row.e_a), limit), beyond::<L, N>(L::load(&row.e_b), limit))
}

impl<L: Lanes<N>, const N: usize> OverflowPolicy<L, N> for Unchecked<L, N> {
    #[inline(always)]
    fn see(&mut self, pair: &BodyPairW<L, N>) {
        let VelocityW { x, y, turn } = pair.a;
        self.see_large(x);
        self.see_large(y);
        self.see_large(turn);
        let VelocityW { x, y, turn } = pair.b;
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
        L::narrow::<FRICTION_RATIO>(wide)
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
    fn apply(&mut self, pair: &mut BodyPairW<L, N>, row: &Row<N>, d: L::Int) {
        self.see_small(d);
        change_within_bounds(pair, row, d);
    }

    #[inline(always)]
    fn apply_again(&mut self, pair: &mut BodyPairW<L, N>, row: &Row<N>, lambda: L::Int) {
        self.see_impulse(lambda);
        change_within_bounds(pair, row, lambda);
    }
}

/// Changes velocities by impulses within the bounds. Multiplying the impulse by four puts the velocity change into the
/// upper half of the product, which saves a shift.
#[inline(always)]
fn change_within_bounds<L: Lanes<N>, const N: usize>(pair: &mut BodyPairW<L, N>, row: &Row<N>, d: L::Int) {
    let twice = L::add(d, d);
    pair.change::<{ UNIT + 2 }>(row, L::add(twice, twice));
}
