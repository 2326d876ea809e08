//! Warm start: applies the accumulated impulses. Impulses of points are first clamped to [`STEP_MAX`].

use super::super::super::batches::{BatchParts, Operation};
use super::super::super::limits::STEP_MAX;
use super::super::super::pair::{BodyPairW, beyond, clamp};
use super::Hinges;
use super::refresh::Refresh;
use crate::simd::Lanes;

#[derive(Clone, Copy)]
pub(super) struct WarmStart<'a> {
    pub(super) refresh: Refresh<'a>,
}

impl Operation<Hinges> for WarmStart<'_> {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Hinges, N>) {
        let BatchParts { batch, record, extra: mut angle, bodies, faults } = parts;
        self.refresh.refresh::<L, N>(batch, record, angle.as_deref_mut(), bodies);
        let mut pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
        if let Some(rows) = angle {
            rows.warm_start(&mut pair, faults);
        }
        let limit = L::splat(STEP_MAX.to_bits());
        let lambda = [L::load(&batch.lambda[0]), L::load(&batch.lambda[1])];
        let large = L::either(beyond::<L, N>(lambda[0], limit), beyond::<L, N>(lambda[1], limit));
        if L::any(large) {
            *faults += u64::from(L::count(large));
        }
        let lambda = [clamp::<L, N>(lambda[0], limit), clamp::<L, N>(lambda[1], limit)];
        L::store(lambda[0], &mut batch.lambda[0]);
        L::store(lambda[1], &mut batch.lambda[1]);
        pair.apply_at_point(batch, lambda, faults);
        pair.store(bodies, &batch.changed);
    }
}
