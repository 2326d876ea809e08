//! Relax: removes the velocity that pushing out overlap has left, after displacements have been integrated.
//!
//! The relax pass also measures the separations at the new positions, `s = s0 + J dx`. The bias pass of the next
//! sub-step reuses them, because no body moves in between.

use core::cell::Cell;

use super::super::batches::{BatchParts, Operation};
use super::super::body::SolverBody;
use super::super::context::Pass;
use super::super::pair::BodyPairW;
use super::batch::Batch;
use super::overflow_policy::{OverflowPolicy, Saturating};
use super::pair::along;
use super::solve::{self, PointOrder};
use super::{Constants, Contacts};
use crate::simd::Lanes;

/// One iteration without bias. Measures the separations first.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Relax {
    pub(in crate::solver) order: PointOrder,
    pub(in crate::solver) constants: Constants,
}

impl Operation<Contacts> for Relax {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let settings = solve::Settings { pass: Pass::Relax, order: self.order, constants: &self.constants };
        solve::solve::<L, N>(parts, settings);
    }
}

/// Measures the separations, for settings without a relax pass.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Measure;

impl Operation<Contacts> for Measure {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        // Clamping a separation is not a fault.
        measure::<L, N>(parts.batch, parts.bodies, &mut Saturating::<L, N>::new(&mut 0));
    }
}

/// Computes the separations at the current positions.
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
