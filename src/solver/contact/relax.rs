//! Relax: the velocity that pushing out has left is taken away again, after displacements have been integrated.
//!
//! The separations at the new positions, `s = s0 + J dx`, are measured here and kept for the bias pass of the next
//! sub-step, between which no body moves.

use core::cell::Cell;

use super::super::batches::{BatchParts, Operation};
use super::super::body::SolverBody;
use super::super::context::Pass;
use super::super::pair::Pair;
use super::batch::Batch;
use super::care::{Care, Careful};
use super::pair::along;
use super::solve::{self, Sweep};
use super::{Constants, Contacts};
use crate::lanes::Lanes;

/// One iteration without bias, at the separations that it measures.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Relax {
    pub(in crate::solver) sweep: Sweep,
    pub(in crate::solver) constants: Constants,
}

impl Operation<Contacts> for Relax {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let settings = solve::Settings { pass: Pass::Relax, sweep: self.sweep, constants: &self.constants };
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
        measure::<L, N>(parts.batch, parts.bodies, &mut Careful(&mut 0));
    }
}

/// Finds the separations at the present positions.
#[inline(always)]
pub(super) fn measure<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    bodies: &[Cell<SolverBody>],
    care: &mut impl Care<L, N>,
) {
    let (n, _) = batch.directions::<L>();
    let shifts = Pair::<L, N>::load_shifts(bodies, &batch.bodies);
    care.see(&shifts);
    for point in &mut batch.points[..batch.count] {
        let first = L::load(&point.first_separation);
        let change = along::<L, N>(&shifts.a, &shifts.b, n, &point.normal);
        L::store(care.moved(first, change), &mut point.separation);
    }
}
