//! Warm start: the impulses that contacts have accumulated so far are applied first.
//!
//! Only the first sub-step of a tick does this row by row. In the others `push` applies the sum of what all contacts
//! change, once for each body.

use core::cell::Cell;

use super::super::batches::{BatchParts, Operation};
use super::super::body::SolverBody;
use super::super::pair::Pair;
use super::Contacts;
use super::batch::Batch;
use super::care::{Calm, Care, Careful};
use super::special::Special;
use crate::lanes::Lanes;

/// Applies the accumulated impulses of all rows.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct WarmStart;

impl Operation<Contacts> for WarmStart {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, extra, bodies, faults, .. } = parts;
        if batch.calm {
            let mut calm = Calm::<L, N>::new();
            let pair = warm_started(batch, bodies, &mut calm);
            if calm.held() {
                pair.store(bodies, &batch.changed);
                return;
            }
        }
        let care = &mut Careful(faults);
        let mut pair: Pair<L, N> = warm_started(batch, bodies, care);
        if let Some(Special { rolls: true, rolling, .. }) = extra {
            care.apply(&mut pair, &rolling.row, L::load(&rolling.lambda));
        }
        pair.store(bodies, &batch.changed);
    }
}

/// The velocities after the impulses along normals and tangent.
#[inline(always)]
fn warm_started<L: Lanes<N>, const N: usize>(
    batch: &Batch<N>,
    bodies: &[Cell<SolverBody>],
    care: &mut impl Care<L, N>,
) -> Pair<L, N> {
    let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
    care.see(&pair);
    for point in &batch.points[..batch.count] {
        care.apply_again(&mut pair, &point.normal, L::load(&point.normal_lambda));
    }
    care.apply_again(&mut pair, &batch.tangent, L::load(&batch.tangent_lambda));
    pair
}
