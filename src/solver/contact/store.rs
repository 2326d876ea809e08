//! Brings the impulses of batches back to their contacts.

use super::super::pair::UNIT;
use super::Batches;
use super::batch::Batch;
use super::input::Input;
use super::kernel;
use super::rows::Inverses;
use crate::collision::{Contact, PointImpulse};
use crate::lanes::{Ints, Kernel, Lanes, prefetch};
use crate::math::Speed;

/// How many batches before its impulses are stored a contact is asked for: in the order of colours they lie anywhere.
const CONTACTS_AHEAD: usize = 2;

/// What it takes to bring the impulses of a batch back to its contacts.
#[derive(Clone, Debug)]
pub(super) struct Records<const N: usize> {
    /// How many lanes are used.
    len: u32,
    contacts: [u32; N],
    counts: [u8; N],
    features: [[u16; 2]; N],
    /// `1 / D` of its rows.
    pub(super) inverses: Inverses<N>,
}

impl<const N: usize> Records<N> {
    pub(super) const NONE: Self =
        Records { len: 0, contacts: [0; N], counts: [0; N], features: [[0; 2]; N], inverses: Inverses::NONE };

    /// Forgets the contacts of an earlier batch.
    #[inline(always)]
    pub(super) fn begin(&mut self) {
        self.len = 0;
    }

    #[inline(always)]
    pub(super) fn take(&mut self, lane: usize, input: &Input) {
        self.len += 1;
        self.contacts[lane] = input.contact;
        self.counts[lane] = input.count;
        self.features[lane] = input.features;
    }

    /// The lanes that are used, each with the index of its contact and its number of points.
    pub(super) fn lanes(&self) -> impl Iterator<Item = (usize, usize, u8)> {
        let lanes = self.contacts.iter().zip(&self.counts).take(self.len as usize);
        lanes.enumerate().map(|(lane, (&contact, &count))| (lane, contact as usize, count))
    }

    /// What is kept of the impulses of each point: `p = L / D`, along the normal and along the tangent.
    #[inline(always)]
    fn impulses<L: Lanes<N>>(&self, batch: &Batch<N>) -> [[Ints<N>; 2]; 2] {
        let shares = kernel::shares_of_friction::<L, N>(batch);
        let mut impulses = [[Ints::ZERO; 2]; 2];
        for (i, [normal, tangent]) in impulses.iter_mut().enumerate() {
            let lambda = L::load(&batch.points[i].normal_lambda);
            L::store(L::narrow::<UNIT>(L::mul(L::load(&self.inverses.normals[i]), lambda)), normal);
            L::store(L::narrow::<UNIT>(L::mul(L::load(&self.inverses.tangent), shares[i])), tangent);
        }
        impulses
    }
}

/// Stores what is to be kept of the batches.
pub(super) struct Store<'a, const N: usize> {
    pub(super) batches: &'a Batches<N>,
    pub(super) contacts: &'a mut [Contact],
    /// Whether the shapes of each contact have pushed each other.
    pub(super) pushed: &'a mut [bool],
}

impl<const N: usize> Kernel<N> for Store<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Store { batches: Batches { batches, special, records, .. }, contacts, pushed } = self;
        let mut special = special.iter();
        for (number, (batch, record)) in batches.iter().zip(records).enumerate() {
            for (_, index, _) in records.get(number + CONTACTS_AHEAD).into_iter().flat_map(Records::lanes) {
                prefetch(&contacts[index]);
            }
            let special = if batch.special { special.next() } else { None };
            let impulses = record.impulses::<L>(batch);
            for (lane, index, count) in record.lanes() {
                let point = |i: usize| {
                    let [normal, tangent] = &impulses[i];
                    PointImpulse {
                        feature: record.features[lane][i],
                        normal: Speed::from_bits(normal.0[lane]),
                        tangent: Speed::from_bits(tangent.0[lane]),
                    }
                };
                let second = if count > 1 { point(1) } else { PointImpulse::default() };
                let rolling = special.map_or(Speed::ZERO, |special| special.rolling.impulse(lane));
                contacts[index].remember([point(0), second], count, rolling);
                pushed[index] =
                    batch.pushed[0] >> lane & 1 != 0 || count > 1 && batch.pushed[1] >> lane & 1 != 0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Scalar;
    use crate::math::Rng;

    /// Together the points have the whole impulse along the tangent, each no more than its friction allows, and half of it
    /// where both may have that.
    #[test]
    fn friction_is_shared_out_by_halves_as_far_as_each_point_reaches() {
        let mut rng = Rng::new(31);
        for _ in 0..20_000 {
            let mut batch = Batch::<1> { count: 2, ..Batch::NONE };
            let limits = [0, 1].map(|i| {
                let limit = i64::from(rng.below(1000));
                // A grip of 1.
                batch.points[i].grip.0[0] = 1 << 20;
                batch.points[i].normal_lambda.0[0] = i32::try_from(limit).expect("below 1000");
                limit
            });
            let most = limits[0] + limits[1];
            let whole = i64::from(rng.below(2000)).min(2 * most) - most;
            batch.tangent_lambda.0[0] = i32::try_from(whole).expect("below 2000");
            let shares = kernel::shares_of_friction::<Scalar<1>, 1>(&batch).map(|share| i64::from(share[0]));
            assert_eq!(shares[0] + shares[1], whole);
            for (share, limit) in shares.into_iter().zip(limits) {
                assert!(share.abs() <= limit, "{share} of {whole} within {limits:?}");
                let half = (whole.abs() + 1) / 2;
                assert!(half > limits[0].min(limits[1]) || share.abs().abs_diff(half) <= 1, "{shares:?}");
            }
        }
    }
}
