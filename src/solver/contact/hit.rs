//! Hit events: the normal impulse of a contact over a tick.
//!
//! ```text
//! L_tick = sum of (L + L_restitution) over the sub-steps
//! ```
//!
//! Every sub-step applies the whole `L`: the warm start applies the `L` of the last sub-step, and the passes apply the
//! changes of `L`.

use super::super::batches::{BatchParts, Operation};
use super::Contacts;
use crate::simd::Lanes;

/// Adds the impulses of a sub-step to the sum over the tick. The sum saturates.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct AddHits;

impl Operation<Contacts> for AddHits {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, extra: Some(extras), .. } = parts else { return };
        if !extras.hits {
            return;
        }
        for (i, point) in batch.points[..batch.count].iter().enumerate() {
            let lambda = L::add_saturating(L::load(&point.normal_lambda), L::load(&extras.bounce[i]));
            let sum = L::add_saturating(L::load(&extras.hit_lambda[i]), lambda);
            L::store(sum, &mut extras.hit_lambda[i]);
        }
    }
}
