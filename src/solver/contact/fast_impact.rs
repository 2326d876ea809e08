//! Fast impacts with restitution: the next sub-step does not apply their impulses again.
//!
//! In other contacts, the next sub-step first repeats the velocity change of the accumulated impulses and then corrects
//! the impulses (`contact_velocity.rs`). After a rebound, the correction removes the impulses completely. Between the
//! repetition and the correction, the velocity is the rebound velocity plus the repeated velocity change. If this sum
//! saturated, the rebound would become slower.

use super::super::batches::{BatchParts, Operation};
use super::super::pair::BodyPairW;
use super::Contacts;
use super::batch::Batch;
use super::extras::ContactExtras;
use super::overflow_policy::{OverflowPolicy, Saturating};
use super::restitution::bounces;
use crate::math::Speed;
use crate::simd::{Ints, Lanes};

/// Normal approach speed, in m/s, from which an impact is fast. Velocities are limited to 511 m/s. If one of the bodies
/// is at rest, the sum above saturates only in impacts at more than half of this limit; if both move, also in slower
/// impacts.
///
/// Slow impacts keep their impulses, because such impacts recur in heaps: without the impulses, 5 of 120 heaps do not
/// come to rest, instead of at most 3.
const FAST: Speed = Speed::lit("64");

/// Operations on the impulses of contacts with a fast impact. The impulse of rolling resistance stays: the next sub-step
/// removes it, because its limit is then 0.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) enum FastImpact {
    /// Takes the impulses back. Runs within `ContactVelocities::forget`, so that the velocities stay as they are, but the
    /// next sub-step does not repeat their changes. A velocity that saturates here counts as a fault, because a part of
    /// the impulse is then not taken back.
    Withdraw,
    /// Sets the impulses to zero, at the end of the sub-step.
    Clear,
}

impl Operation<Contacts> for FastImpact {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, extra: Some(extras), bodies, faults, .. } = parts else { return };
        let fast = fast::<L, N>(batch, extras);
        if !L::any(fast) {
            return;
        }
        match self {
            FastImpact::Withdraw => {
                let policy = &mut Saturating::<L, N>::new(faults);
                let back =
                    |lambda: &Ints<N>| L::select(fast, L::sub(L::splat(0), L::load(lambda)), L::splat(0));
                let mut pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
                for point in &batch.points[..batch.count] {
                    policy.apply(&mut pair, &point.normal, back(&point.normal_lambda));
                }
                policy.apply(&mut pair, &batch.tangent, back(&batch.tangent_lambda));
                pair.store(bodies, &batch.changed);
            }
            FastImpact::Clear => {
                for point in &mut batch.points[..batch.count] {
                    clear::<L, N>(&mut point.normal_lambda, fast);
                }
                clear::<L, N>(&mut batch.tangent_lambda, fast);
            }
        }
    }
}

#[inline(always)]
fn clear<L: Lanes<N>, const N: usize>(lambda: &mut Ints<N>, lanes: L::Mask) {
    let rest = L::select(lanes, L::splat(0), L::load(lambda));
    L::store(rest, lambda);
}

/// Mask of the lanes in which a point bounces after a fast approach.
#[inline(always)]
fn fast<L: Lanes<N>, const N: usize>(batch: &Batch<N>, extras: &ContactExtras<N>) -> L::Mask {
    let [first, second] = [0, 1].map(|i| {
        let fast = L::greater(L::splat(1 - FAST.to_bits()), L::load(&extras.impacts.approach[i]));
        L::both(bounces::<L, N>(batch, extras, i), fast)
    });
    L::both(L::greater(L::load(&extras.restitution), L::splat(0)), L::either(first, second))
}
