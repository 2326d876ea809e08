//! Writes the impulses of batches back to the contacts of the state.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use super::super::batches::Batches;
use super::super::pair::clamp;
use super::batch::Batch;
use super::extras::ContactExtras;
use super::input::{ActiveContact, Input};
use super::overflow_policy::FRICTION_RATIO;
use super::rows::Denominators;
use super::{ContactShare, Contacts};
use crate::collision::{Contact, Feature, Pair, PointImpulse};
use crate::math::Speed;
use crate::simd::{Ints, Kernel, Lanes, Layout, Scalar, Shared, prefetch};

/// Prefetch distance in batches. In the order of colours, the accesses to contacts are random.
const CONTACTS_AHEAD: usize = 2;

/// The contacts to which the impulses of a batch belong, and the data for converting the impulses.
#[derive(Clone, Debug)]
pub(in crate::solver) struct Records<const N: usize> {
    /// Number of lanes with a contact.
    len: u32,
    /// Indices of the contacts in the state.
    contacts: [u32; N],
    shapes: [Pair; N],
    counts: [u8; N],
    features: [[u16; 2]; N],
    wedged: [bool; N],
    /// Whether a contact has turned arms ([`Arms::turn`](super::arms::Arms::turn)).
    turned: bool,
    pub(super) denominators: Denominators<N>,
}

impl<const N: usize> Records<N> {
    pub(super) const NONE: Self = Records {
        len: 0,
        contacts: [0; N],
        shapes: [(0, 0); N],
        counts: [0; N],
        features: [[0; 2]; N],
        wedged: [false; N],
        turned: false,
        denominators: Denominators::NONE,
    };

    #[inline(always)]
    pub(super) fn begin(&mut self) {
        self.len = 0;
        self.wedged = [false; N];
        self.turned = false;
    }

    /// Puts a contact into `lane`, which must be the first lane without a contact.
    #[inline(always)]
    pub(super) fn take(&mut self, lane: usize, input: &Input) {
        self.len += 1;
        self.contacts[lane] = input.contact;
        self.shapes[lane] = input.shapes;
        self.counts[lane] = input.count;
        self.features[lane] = input.features;
        self.wedged[lane] = input.wedged;
        self.turned |= input.turned;
    }

    /// The lanes with a contact: lane, index of the contact and number of points.
    fn lanes(&self) -> impl Iterator<Item = (usize, usize, u8)> {
        let lanes = self.contacts.iter().zip(&self.counts).take(self.len as usize);
        lanes.enumerate().map(|(lane, (&contact, &count))| (lane, contact as usize, count))
    }

    /// Number of lanes with a contact, or `None` if the next tick cannot keep the rows, because a contact has turned
    /// arms or a wedged body (`Prospect::is_wedged`).
    #[inline(always)]
    pub(super) fn keepable_len(&self) -> Option<usize> {
        (!self.turned && self.wedged == [false; N]).then_some(self.len as usize)
    }

    /// Updates the index of the contact in a lane. Returns whether the lane already had a contact of the same shapes.
    #[inline(always)]
    pub(super) fn keep(&mut self, lane: usize, pair: &ActiveContact) -> bool {
        self.contacts[lane] = pair.contact;
        self.shapes[lane] == pair.shapes
    }

    /// The impulses of each point along the normal and the tangent, for the warm start in the next tick. Also writes
    /// them back to the batch, because the next tick may reuse the batch. They are rounded there as if the batch were
    /// filled from the state.
    #[inline(always)]
    fn impulses<L: Lanes<N>>(&self, batch: &mut Batch<N>) -> [[Ints<N>; 2]; 2] {
        let Denominators { normals, tangent } = &self.denominators;
        let [first, second] = shares_of_friction::<L, N>(batch);
        let shares = [tangent.impulse::<L>(first), tangent.impulse::<L>(second)];
        let mut impulses = [[Ints::ZERO; 2]; 2];
        let points = batch.points.iter_mut().zip(normals).zip(shares).zip(&mut impulses).take(batch.count);
        for (((point, denominator), share), [normal, tangent]) in points {
            let impulse = denominator.impulse::<L>(L::load(&point.normal_lambda));
            L::store(impulse, normal);
            L::store(share, tangent);
            L::store(denominator.normal_lambda::<L>(impulse), &mut point.normal_lambda);
        }
        let whole = L::add_saturating(shares[0], shares[1]);
        L::store(tangent.tangent_lambda::<L>(whole), &mut batch.tangent_lambda);
        impulses
    }

    #[inline(always)]
    fn hit_impulses<L: Lanes<N>>(&self, extras: &ContactExtras<N>) -> [Ints<N>; 2] {
        let mut impulses = [Ints::ZERO; 2];
        for (i, impulse) in impulses.iter_mut().enumerate() {
            let lambda = L::load(&extras.hit_lambda[i]);
            L::store(self.denominators.normals[i].impulse::<L>(lambda), impulse);
        }
        impulses
    }
}

/// The share of each point in the tangential impulse: one half, unless the friction limit of a point is lower. Such a
/// point gets its limit, and the other point gets the rest.
#[inline(always)]
fn shares_of_friction<L: Lanes<N>, const N: usize>(batch: &Batch<N>) -> [L::Int; 2] {
    let whole = L::load(&batch.tangent_lambda);
    if batch.count != 2 {
        return [whole, L::splat(0)];
    }
    let [first, second] = &batch.points;
    let first = L::mul(L::load(&first.friction_ratio), L::load(&first.normal_lambda));
    let second = L::mul(L::load(&second.friction_ratio), L::load(&second.normal_lambda));
    let (first, _) = L::narrow_saturating::<FRICTION_RATIO>(first);
    let (second, _) = L::narrow_saturating::<FRICTION_RATIO>(second);
    let half = clamp::<L, N>(L::narrow::<1>(L::mul(whole, L::splat(1))), first);
    let rest = clamp::<L, N>(L::sub(whole, half), second);
    [L::sub(whole, rest), rest]
}

/// Results of a tick for each contact of the state, by index.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactResults {
    /// Whether a normal impulse between the shapes was positive in the tick.
    pub(crate) pushed: Vec<bool>,
    /// Normal impulse of the tick for contacts with a hit event, as the relative velocity that it would give to the
    /// centres of mass. Empty if there is no hit event.
    pub(crate) hit_impulses: Vec<Speed>,
}

#[derive(Clone, Copy)]
pub(in crate::solver) struct ContactStore<'a> {
    contacts: Shared<'a, Contact>,
    pushed: Shared<'a, bool>,
    hit_impulses: Shared<'a, Speed>,
}

impl<'a> ContactStore<'a> {
    /// Creates the store, and clears the results.
    pub(in crate::solver) fn new(
        contacts: &'a mut [Contact],
        results: &'a mut ContactResults,
        has_hits: bool,
    ) -> Self {
        let ContactResults { pushed, hit_impulses } = results;
        pushed.clear();
        pushed.resize(contacts.len(), false);
        hit_impulses.clear();
        hit_impulses.resize(if has_hits { contacts.len() } else { 0 }, Speed::ZERO);
        ContactStore {
            contacts: Shared::new(contacts),
            pushed: Shared::new(pushed),
            hit_impulses: Shared::new(hit_impulses),
        }
    }
}

impl ContactShare<'_> {
    pub(in crate::solver) fn store(&mut self, store: ContactStore<'_>) {
        for share in [&mut self.warm, &mut self.cold] {
            if let Some(batches) = share.own_overflow() {
                Store { batches, store }.run::<Scalar<1>>();
            }
            match share.coloured {
                Layout::Wide(batches, vectors) => vectors.run(Store { batches, store }),
                Layout::Single(batches) => Store { batches, store }.run::<Scalar<1>>(),
            }
        }
    }
}

struct Store<'a, const N: usize> {
    batches: &'a mut Batches<Contacts, N>,
    store: ContactStore<'a>,
}

impl<const N: usize> Kernel<N> for Store<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Store { batches: Batches { batches, records, extras, .. }, store } = self;
        let (contacts, pushed) = (store.contacts.cells(), store.pushed.cells());
        let hit_impulses = store.hit_impulses.cells();
        let mut extras = extras.iter();
        for (number, (batch, record)) in batches.iter_mut().zip(&*records).enumerate() {
            for (_, index, _) in records.get(number + CONTACTS_AHEAD).into_iter().flat_map(Records::lanes) {
                prefetch(&contacts[index]);
            }
            let extras = if batch.extras { extras.next() } else { None };
            let impulses = record.impulses::<L>(batch);
            for (lane, index, count) in record.lanes() {
                let mut contact = contacts[index].get();
                let old = record.wedged[lane].then_some(contact);
                let point = |i: usize| {
                    let [normal, tangent] = &impulses[i];
                    let impulse = PointImpulse {
                        feature: record.features[lane][i],
                        normal: Speed::from_bits(normal.0[lane]),
                        tangent: Speed::from_bits(tangent.0[lane]),
                    };
                    old.map_or(impulse, |old| load_of(impulse, &old))
                };
                let second = if count > 1 { point(1) } else { PointImpulse::default() };
                let rolling = extras.map_or(Speed::ZERO, |extras| extras.rolling.impulse(lane));
                contact.store_impulses([point(0), second], count, rolling);
                contacts[index].set(contact);
                let has_pushed = |point: usize| batch.pushed[point] >> lane & 1 != 0;
                pushed[index].set(has_pushed(0) || count > 1 && has_pushed(1));
            }
            if let Some(extras) = extras.filter(|extras| extras.hits) {
                let impulses = record.hit_impulses::<L>(extras);
                for (lane, index, count) in record.lanes() {
                    let second = if count > 1 { impulses[1].0[lane] } else { 0 };
                    hit_impulses[index].set(Speed::from_bits(impulses[0].0[lane].saturating_add(second)));
                }
            }
        }
    }
}

/// The part of a wedged body's impulse that carries a load: at most the impulse of the last tick. Otherwise friction in
/// a narrow wedge would keep the impulse of the impact for ever, as a stress between the walls.
fn load_of(impulse: PointImpulse, old: &Contact) -> PointImpulse {
    let load = old.impulse_of(Feature(impulse.feature)).unwrap_or_default();
    let most = load.tangent.abs();
    PointImpulse {
        normal: impulse.normal.min(load.normal),
        tangent: impulse.tangent.clamp(-most, most),
        ..impulse
    }
}
