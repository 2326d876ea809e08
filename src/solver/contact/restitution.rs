//! Restitution: a point that approached faster than the threshold of its surface and was pushed separates at `e` times the approach
//! speed.
//!
//! ```text
//! L' = max(L - (vn + e v_approach), 0)          once in a tick, after the sub-steps
//! ```
//!
//! The approach speed is measured before any contact is warm-started. Otherwise the impulse of one contact would look
//! like an approach at the next contact, and balls in a groove would bounce for ever.

use super::super::batches::{BatchParts, Operation};
use super::super::limits::IMPULSE_MAX;
use super::super::pair::{BodyPairW, UNIT};
use super::Contacts;
use super::extras::ContactExtras;
use super::overflow_policy::{OverflowPolicy, Saturating};
use crate::simd::Lanes;

/// Number of iterations in which two points that bounce are solved against each other. With one iteration, the first
/// point would separate too fast: a tall box that was dropped flat gained a third of its energy, and spun. For boxes
/// with an aspect ratio of up to 3, an iteration removes at least 3/4 of the error.
const RESTITUTION_ITERATIONS: u32 = 12;

/// Records the relative normal velocity of shapes with restitution, until the shapes push each other.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct ObserveApproach;

impl Operation<Contacts> for ObserveApproach {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, extra: Some(extras), bodies, faults, .. } = parts else { return };
        let policy = &mut Saturating(faults);
        let pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
        let (n, _) = batch.directions::<L>();
        let ContactExtras { approach, pushed, .. } = extras;
        for ((point, approach), pushed) in batch.points[..batch.count].iter().zip(approach).zip(pushed) {
            let vn = pair.velocity(n, &point.normal, policy);
            let pushed = L::negative(L::load(pushed));
            L::store(L::select(pushed, L::load(approach), vn), approach);
        }
    }
}

/// Applies restitution.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct ApplyRestitution;

impl Operation<Contacts> for ApplyRestitution {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, extra: Some(extras), bodies, faults, .. } = parts else { return };
        let policy = &mut Saturating(faults);
        let restitution = L::load(&extras.restitution);
        let (n, _) = batch.directions::<L>();
        let masks = [bounces::<L, N>(extras, 0), bounces::<L, N>(extras, 1)];
        if !L::any(L::either(masks[0], masks[1])) {
            return;
        }
        let mut pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
        for _ in 0..if batch.count == 2 { RESTITUTION_ITERATIONS } else { 1 } {
            for (i, &mask) in masks.iter().enumerate().take(batch.count) {
                let point = &mut batch.points[i];
                let bounce = L::mul(restitution, L::load(&extras.approach[i]));
                let bounce = L::narrow::<UNIT>(bounce);
                let error = L::add_saturating(pair.velocity(n, &point.normal, policy), bounce);
                let old = L::load(&point.normal_lambda);
                let wanted = L::max(L::sub_saturating(old, error), L::splat(0));
                let new = L::select(mask, L::min(wanted, L::splat(IMPULSE_MAX.to_bits())), old);
                L::store(new, &mut point.normal_lambda);
                policy.apply(&mut pair, &point.normal, L::sub(new, old));
            }
        }
        pair.store(bodies, &batch.changed);
    }
}

/// Mask of the lanes in which a point approached fast enough and was pushed.
#[inline(always)]
fn bounces<L: Lanes<N>, const N: usize>(extras: &ContactExtras<N>, i: usize) -> L::Mask {
    let threshold = L::sub(L::splat(1), L::load(&extras.restitution_threshold));
    let fast = L::greater(threshold, L::load(&extras.approach[i]));
    let pushed = L::negative(L::load(&extras.pushed[i]));
    L::both(L::both(fast, pushed), L::greater(L::load(&extras.restitution), L::splat(0)))
}
