//! Relax: the velocity that pushing out has left is taken away again, after displacements have been integrated.
//!
//! The separations at the new positions, `s = s0 + J dx`, are measured here and kept for the bias pass of the next
//! sub-step, between which no body moves.

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

/// One iteration without bias, at the separations that it measures.
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

/// Measures the separations where no relax pass does.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Measure;

impl Operation<Contacts> for Measure {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        // Nothing in it counts as a fault.
        measure::<L, N>(parts.batch, parts.bodies, &mut Saturating(&mut 0));
    }
}

/// Finds the separations at the present positions.
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
