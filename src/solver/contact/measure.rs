//! Measures separations at the current positions, `s = s0 + J dx`.

use core::cell::Cell;

use super::super::batches::{BatchParts, Operation};
use super::super::body::SolverBody;
use super::super::pair::BodyPairW;
use super::Contacts;
use super::batch::Batch;
use super::jacobian::along;
use super::overflow_policy::{OverflowPolicy, Saturating};
use crate::simd::Lanes;

/// Measures the separations if the settings have no relax pass. Otherwise the relax pass measures them.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Measure;

impl Operation<Contacts> for Measure {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        // Clamping a separation is not a fault.
        measure::<L, N>(parts.batch, parts.bodies, &mut Saturating::<L, N>::new(&mut 0));
    }
}

#[inline(always)]
pub(super) fn measure<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    bodies: &[Cell<SolverBody>],
    policy: &mut impl OverflowPolicy<L, N>,
) {
    let (n, _) = batch.directions::<L>();
    let shifts = BodyPairW::<L, N>::load_shifts(bodies, &batch.bodies);
    policy.see(&shifts);
    for point in &mut batch.points[..batch.count] {
        let first = L::load(&point.first_separation);
        let change = along::<L, N>(&shifts.a, &shifts.b, n, &point.normal);
        L::store(policy.moved(first, change), &mut point.separation);
    }
}
