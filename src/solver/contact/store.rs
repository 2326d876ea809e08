//! Brings the impulses of batches back to their contacts.

use super::super::lanes::{Ints, Kernel, Lanes, prefetch};
use super::super::pair::UNIT;
use super::Batches;
use super::batch::Batch;
use super::input::Input;
use crate::collision::{Contact, PointImpulse};
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
    /// `1 / D` of the normal and the tangent of each point.
    pub(super) inverses: [[Ints<N>; 2]; 2],
}

impl<const N: usize> Records<N> {
    pub(super) const NONE: Self = Records {
        len: 0,
        contacts: [0; N],
        counts: [0; N],
        features: [[0; 2]; N],
        inverses: [[Ints::ZERO; 2]; 2],
    };

    #[inline(always)]
    pub(super) fn take(&mut self, lane: usize, input: &Input) {
        self.len += 1;
        self.contacts[lane] = input.contact;
        self.counts[lane] = input.count;
        self.features[lane] = input.features;
    }

    /// The lanes that are used, each with the index of its contact and its number of points.
    pub(super) fn lanes(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let lanes = self.contacts.iter().zip(&self.counts).take(self.len as usize);
        lanes.enumerate().map(|(lane, (&contact, &count))| (lane, contact as usize, count.into()))
    }

    /// What is kept of the impulses of a point: `p = L / D`, along the normal and along the tangent.
    #[inline(always)]
    fn impulses<L: Lanes<N>>(&self, batch: &Batch<N>, point: usize) -> [Ints<N>; 2] {
        let (lambdas, inverses) = (&batch.points[point], &self.inverses[point]);
        let mut impulses = [Ints::ZERO; 2];
        for (row, lambda) in [&lambdas.normal_lambda, &lambdas.tangent_lambda].into_iter().enumerate() {
            let p = L::mul(L::load(&inverses[row]), L::load(lambda));
            L::store(L::narrow::<UNIT>(p), &mut impulses[row]);
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
            let impulses = [record.impulses::<L>(batch, 0), record.impulses::<L>(batch, 1)];
            for (lane, index, count) in record.lanes() {
                let memory = &mut contacts[index];
                memory.clear_points();
                memory.rolling = special.map_or(Speed::ZERO, |special| special.rolling.impulse(lane));
                for (i, [normal, tangent]) in impulses.iter().enumerate().take(count) {
                    memory.push_point(PointImpulse {
                        feature: record.features[lane][i],
                        normal: Speed::from_bits(normal.0[lane]),
                        tangent: Speed::from_bits(tangent.0[lane]),
                    });
                    pushed[index] |= batch.pushed[i] >> lane & 1 != 0;
                }
            }
        }
    }
}
