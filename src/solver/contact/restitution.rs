//! Restitution: a point bounces if its approach speed is at least the threshold and its normal impulse is positive. If
//! two points bounce together, a positive impulse of one of them is enough. The point separates at `e` times the
//! approach speed, or more slowly if `e` is at most 1 and the contact would gain energy.
//!
//! ```text
//! L' = max(L - (vn + min(e va + drift, 0)), 0)     after the passes of the sub-step in which it bounces
//! ```
//!
//! The impulse of restitution is not added to the accumulated impulse, because the next sub-step would apply it again.
//! `impact.rs` computes `va` and the drift.
//!
//! The approach speed is measured before the warm start. Otherwise the impulse of one contact would count as an
//! approach at the next contact, and balls in a groove would bounce for ever.

use super::super::batches::{BatchParts, Operation};
use super::super::pair::{BodyPairW, UNIT};
use super::Contacts;
use super::batch::Batch;
use super::extras::ContactExtras;
use super::overflow_policy::{OverflowPolicy, Saturating};
use super::rows::Denominators;
use crate::math::{Unit, saturate, saturate_wide};
use crate::simd::{Ints, Lanes};

/// Number of iterations in which two points that bounce are solved against each other. With one iteration, a tall box
/// that is dropped flat would gain a third of its energy, and spin. For boxes with an aspect ratio of up to 3, each
/// iteration removes at least 3/4 of the error.
const RESTITUTION_ITERATIONS: u32 = 12;

#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct ApplyRestitution {
    /// `false` in the first pass of a sub-step. In later passes, only elastic contacts bounce.
    pub(in crate::solver) again: bool,
}

/// Restitution above which contacts that bounce at the same time are solved against each other. At a lower restitution,
/// an impact loses so much energy that the order of the contacts does not matter.
pub(super) const ELASTIC: Unit = Unit::lit("0.5");

impl Operation<Contacts> for ApplyRestitution {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, record, extra: Some(extras), bodies, faults } = parts else { return };
        let policy = &mut Saturating::<L, N>::new(faults);
        // Velocities are read in all lanes, but a velocity that does not fit is no fault in a lane that does not
        // bounce. `reader` therefore counts no faults.
        let mut unread = 0;
        let reader = &mut Saturating::<L, N>::new(&mut unread);
        let restitution = L::load(&extras.restitution);
        let (n, t) = batch.directions::<L>();
        let least = if self.again { ELASTIC } else { Unit::ZERO };
        let takes_part = L::greater(restitution, L::splat(least.to_bits()));
        if !L::any(takes_part) {
            return;
        }
        let masks = [bounces::<L, N>(batch, extras, 0), bounces::<L, N>(batch, extras, 1)];
        let masks = [L::both(masks[0], takes_part), L::both(masks[1], takes_part)];
        let active = L::either(masks[0], masks[1]);
        if !L::any(active) {
            return;
        }
        let mut pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
        let mut rebound = [Rebound::NONE; 2];
        for (point, bounce) in batch.points[..batch.count].iter().zip(&extras.bounce) {
            let back = L::sub(L::splat(0), L::load(bounce));
            policy.apply(&mut pair, &point.normal, L::select(active, back, L::splat(0)));
        }
        let stopped = pair.copy();
        let mut slides = [Ints::ZERO; 2];
        L::store(pair.velocity(t, &batch.tangent, reader), &mut slides[0]);
        for (point, rebound) in batch.points[..batch.count].iter().zip(&mut rebound) {
            L::store(pair.velocity(n, &point.normal, reader), &mut rebound.before);
            (rebound.old, rebound.new) = (point.normal_lambda, point.normal_lambda);
        }
        for (i, point) in batch.points[..batch.count].iter().enumerate() {
            let bounce = L::select(active, L::load(&extras.bounce[i]), L::splat(0));
            L::store(L::add_saturating(L::load(&point.normal_lambda), bounce), &mut rebound[i].new);
            policy.apply(&mut pair, &point.normal, bounce);
        }
        for _ in 0..if batch.count == 2 { RESTITUTION_ITERATIONS } else { 1 } {
            for (i, &mask) in masks.iter().enumerate().take(batch.count) {
                let point = &batch.points[i];
                let bounce = L::mul(restitution, L::load(&extras.impacts.approach[i]));
                // With a restitution above 1, the product may not fit.
                let (bounce, _) = L::narrow_saturating::<UNIT>(bounce);
                let bounce =
                    L::min(L::add_saturating(bounce, L::load(&extras.impacts.drift[i])), L::splat(0));
                let error = L::add_saturating(pair.velocity(n, &point.normal, reader), bounce);
                let old = L::load(&rebound[i].new);
                let wanted = L::max(L::sub_saturating(old, error), L::splat(0));
                policy.count_faults_in(mask);
                let new = L::select(mask, policy.impulse(wanted), old);
                L::store(new, &mut rebound[i].new);
                policy.apply(&mut pair, &point.normal, L::sub(new, old));
            }
        }
        for (point, rebound) in batch.points[..batch.count].iter().zip(&mut rebound) {
            L::store(pair.velocity(n, &point.normal, reader), &mut rebound.after);
        }
        L::store(pair.velocity(t, &batch.tangent, reader), &mut slides[1]);
        let mut shares = Ints([Unit::ONE.to_bits(); N]);
        let lanes = L::bits(active);
        for (lane, share) in shares.0.iter_mut().enumerate().filter(|(lane, _)| lanes >> lane & 1 == 1) {
            *share = share_without_gain(lane, batch, extras, &record.denominators, &rebound, &slides);
        }
        let share = L::load(&shares);
        let limited = L::both(active, L::greater(L::splat(Unit::ONE.to_bits()), share));
        let mut part = stopped;
        for (i, (point, rebound)) in batch.points[..batch.count].iter().zip(&rebound).enumerate() {
            let d = L::sub(L::load(&rebound.new), L::load(&rebound.old));
            let limited_d = L::narrow::<UNIT>(L::mul(share, d));
            policy.apply(&mut part, &point.normal, L::select(limited, limited_d, L::splat(0)));
            let bounce = L::select(active, L::select(limited, limited_d, d), L::load(&extras.bounce[i]));
            L::store(bounce, &mut extras.bounce[i]);
        }
        pair.replace(limited, &part);
        pair.store(bodies, &batch.changed);
    }
}

/// The full rebound of a point: its impulses without and with restitution (`old` and `new`), and its relative normal
/// velocities before and after the rebound.
#[derive(Clone, Copy)]
struct Rebound<const N: usize> {
    old: Ints<N>,
    new: Ints<N>,
    before: Ints<N>,
    after: Ints<N>,
}

impl<const N: usize> Rebound<N> {
    const NONE: Self = Rebound { old: Ints::ZERO, new: Ints::ZERO, before: Ints::ZERO, after: Ints::ZERO };
}

/// The share of the rebound in a lane at which the contact's impulses in the sub-step add no energy. It satisfies:
///
/// ```text
/// W = sum P (v+ + drift + va) / 2 <= 0          P = L / D
/// ```
///
/// The sum is over the normal rows and the friction row of the contact, and `v+` is the velocity after the rebound.
/// Tangential velocities are relative to a moving surface. A restitution above 1 is meant to do work, and is not
/// limited.
///
/// Newton's restitution gains energy where the rebounds of two points add up, and in a corner, where the rebound from
/// one wall reverses the sliding along the other. `W` is convex in the share, and therefore nowhere above the straight
/// line from its value without a rebound to its value with the full rebound. `slides` are the tangential velocities
/// without a rebound and with the full rebound.
fn share_without_gain<const N: usize>(
    lane: usize,
    batch: &Batch<N>,
    extras: &ContactExtras<N>,
    denominators: &Denominators<N>,
    rebound: &[Rebound<N>; 2],
    slides: &[Ints<N>; 2],
) -> i32 {
    let at = |ints: &Ints<N>| i128::from(ints.0[lane]);
    let impacts = &extras.impacts;
    let friction = at(&denominators.tangent.inverse) * at(&batch.tangent_lambda);
    let slide = at(&impacts.slide) + 2 * at(&extras.surface_speed);
    let mut none = friction * (at(&slides[0]) + slide);
    let mut all = friction * (at(&slides[1]) + slide);
    for (i, Rebound { old, new, before, after }) in rebound.iter().enumerate().take(batch.count) {
        let inverse = at(&denominators.normals[i].inverse);
        let approach = at(&impacts.approach[i]) + at(&impacts.drift[i]);
        none += inverse * at(old) * (at(before) + approach);
        all += inverse * at(new) * (at(after) + approach);
    }
    // Even without a rebound, the contact adds energy (`none` is positive) if another contact has driven its shapes
    // apart. The full rebound is then allowed if it adds no more energy than that.
    if all <= none.max(0) || extras.restitution.0[lane] > Unit::ONE.to_bits() {
        Unit::ONE.to_bits()
    } else if none >= 0 {
        0
    } else {
        // `none` is at most 2^98.
        saturate(saturate_wide((-none << Unit::FRAC_NBITS) / (all - none)))
    }
}

/// Mask of the lanes in which a point bounces.
#[inline(always)]
pub(super) fn bounces<L: Lanes<N>, const N: usize>(
    batch: &Batch<N>,
    extras: &ContactExtras<N>,
    i: usize,
) -> L::Mask {
    if i >= batch.count {
        return L::greater(L::splat(0), L::splat(0));
    }
    let threshold = L::sub(L::splat(1), L::load(&extras.restitution_threshold));
    let fast = L::greater(threshold, L::load(&extras.impacts.approach[i]));
    let is_pushed = |i: usize| L::greater(L::load(&batch.points[i].normal_lambda), L::splat(0));
    let mut pushed = is_pushed(i);
    if batch.count == 2 {
        let both = L::negative(L::load(&batch.both));
        let together = L::both(L::greater(L::load(&extras.impacts.rebound[i]), L::splat(0)), both);
        pushed = L::either(pushed, L::both(together, is_pushed(1 - i)));
    }
    L::both(fast, pushed)
}
