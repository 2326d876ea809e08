//! Warm start: applies the impulses that contacts have accumulated so far, row by row, in the first sub-step of a tick.
//! In other sub-steps `contact_velocity` applies their sum for each body.

use core::cell::Cell;

use super::super::batches::{BatchParts, Operation};
use super::super::body::SolverBody;
use super::super::pair::BodyPairW;
use super::Contacts;
use super::batch::Batch;
use super::extras::ContactExtras;
use super::overflow_policy::{OverflowPolicy, Saturating, Unchecked};
use crate::simd::Lanes;

#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct WarmStart;

impl Operation<Contacts> for WarmStart {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, extra, bodies, faults, .. } = parts;
        if batch.unchecked {
            let mut unchecked = Unchecked::<L, N>::new();
            let pair = warm_started(batch, bodies, &mut unchecked);
            if unchecked.held() {
                pair.store(bodies, &batch.changed);
                return;
            }
        }
        let policy = &mut Saturating::<L, N>::new(faults);
        let mut pair: BodyPairW<L, N> = warm_started(batch, bodies, policy);
        if let Some(ContactExtras { rolls: true, rolling, .. }) = extra {
            policy.apply(&mut pair, &rolling.row, L::load(&rolling.lambda));
        }
        pair.store(bodies, &batch.changed);
    }
}

/// The velocities after the impulses along normals and tangent.
#[inline(always)]
fn warm_started<L: Lanes<N>, const N: usize>(
    batch: &Batch<N>,
    bodies: &[Cell<SolverBody>],
    policy: &mut impl OverflowPolicy<L, N>,
) -> BodyPairW<L, N> {
    let mut pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
    policy.see(&pair);
    for point in &batch.points[..batch.count] {
        policy.apply_again(&mut pair, &point.normal, L::load(&point.normal_lambda));
    }
    policy.apply_again(&mut pair, &batch.tangent, L::load(&batch.tangent_lambda));
    pair
}
