//! Fills batches with the contacts of a tick.

use super::super::batches::{Batches, Coloured};
use super::super::colour::{Colouring, Group};
use super::batch::Batch;
use super::extras::ContactExtras;
use super::input::{ContactSource, Input};
use super::overflow_policy::Unchecked;
use super::prospect::Prospect;
use super::rows;
use super::store::Records;
use super::{ContactSet, Contacts, WarmStarts};
use crate::math::Unit;
use crate::simd::{Kernel, Lanes, Layout, Machine, Quad, Scalar, prefetch};
use crate::threads::Threads;

/// Prefetch distance, in batches, for the active contacts ([`ActiveContact`](super::ActiveContact)).
const PAIRS_AHEAD: usize = 4;
/// Prefetch distance, in batches, for the manifolds and the contacts of the state.
const MANIFOLDS_AHEAD: usize = 2;

impl ContactSet {
    pub(in crate::solver) fn sort(
        &mut self,
        source: &ContactSource<'_>,
        colouring: &mut Colouring,
        parts: usize,
    ) {
        colouring.begin();
        self.features = source.add_nodes(colouring, &mut self.prospects);
        colouring.sort(source.list.len(), parts);
    }

    pub(in crate::solver) fn fill(
        &mut self,
        source: &ContactSource<'_>,
        colouring: &Colouring,
        threads: &Threads,
        parts: usize,
        machine: Machine,
    ) -> WarmStarts {
        let ContactSet { warm, cold, prospects, warm_starts, features } = self;
        warm_starts.clear();
        warm_starts.resize(parts, WarmStarts::default());
        for (list, is_cold) in [(&mut *warm, false), (&mut *cold, true)] {
            list.coloured.resize_with(parts, Coloured::default);
            let colours = core::iter::once(Group::of_singles(colouring.overflow(is_cold)));
            let (batches, warm_starts) = (&mut list.overflow, &mut warm_starts[0]);
            Fill { batches, source, prospects, colours, warm_starts }.run::<Scalar<1>>();
        }
        let shares = warm.coloured.iter_mut().zip(&mut cold.coloured).zip(&mut *warm_starts).enumerate();
        threads.run_team(shares, |(part, ((warm, cold), warm_starts)), _| {
            // Counts in a local variable, because the elements of `warm_starts` for several threads share a cache line.
            let mut own = WarmStarts::default();
            for (coloured, is_cold) in [(warm, false), (cold, true)] {
                let (colours, warm_starts) = (colouring.colours(is_cold, part), &mut own);
                coloured.fit(machine);
                match coloured {
                    Layout::Wide(batches, vectors) => {
                        vectors.run(Fill { batches, source, prospects, colours, warm_starts });
                    }
                    Layout::Single(batches) => {
                        Fill { batches, source, prospects, colours, warm_starts }.run::<Scalar<1>>();
                    }
                }
            }
            *warm_starts = [*warm_starts, own].into_iter().sum();
            0
        });
        features.cold = !cold.is_empty();
        features.extras = warm.has_extras() || cold.has_extras();
        warm_starts.iter().copied().sum()
    }
}

struct Fill<'a, I, const N: usize> {
    batches: &'a mut Batches<Contacts, N>,
    source: &'a ContactSource<'a>,
    prospects: &'a [Prospect],
    colours: I,
    warm_starts: &'a mut WarmStarts,
}

impl<'a, I: Iterator<Item = Group<'a>>, const N: usize> Kernel<N> for Fill<'_, I, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Fill { batches, source, prospects, colours, warm_starts } = self;
        batches.clear_all_but_batches();
        let mut count = 0;
        for group in colours {
            let mut start = 0;
            for indices in group.batches::<N>(|index| !source.pairs[index as usize].extras) {
                for &index in group.indices.iter().skip(start + PAIRS_AHEAD * N).take(N) {
                    prefetch(&source.pairs[index as usize]);
                }
                for &index in group.indices.iter().skip(start + MANIFOLDS_AHEAD * N).take(N) {
                    source.prefetch(index);
                }
                batches.fill::<L>(count, source, prospects, indices, warm_starts);
                start += indices.len();
                count += 1;
            }
            batches.end_colour(count);
        }
        batches.batches.truncate(count);
        batches.records.truncate(count);
    }
}

impl<const N: usize> Batches<Contacts, N> {
    /// Fills a batch with up to `N` contacts. Reuses the memory of a batch of the last tick without initialising it,
    /// because the operation is memory-bound.
    #[inline(always)]
    fn fill<L: Lanes<N>>(
        &mut self,
        number: usize,
        source: &ContactSource<'_>,
        prospects: &[Prospect],
        indices: &[u32],
        warm_starts: &mut WarmStarts,
    ) {
        let Batches { batches, records, extras, .. } = self;
        if number >= batches.len() {
            batches.push(Batch::NONE);
            records.push(Records::NONE);
        }
        let (batch, records) = (&mut batches[number], &mut records[number]);
        if keep::<L, N>(batch, records, source, prospects, indices, warm_starts) {
            return;
        }
        batch.begin();
        records.begin();
        let mut inputs = [Input::NONE; N];
        for (lane, (input, &index)) in inputs.iter_mut().zip(indices).enumerate() {
            source.gather(&source.pairs[index as usize], prospects, warm_starts, input);
            batch.extras |= input.extras;
            batch.count = batch.count.max(input.count.into());
            for side in 0..2 {
                batch.bodies[side][lane] = input.bodies[side];
                batch.changed[side][lane] = input.changed[side];
            }
            records.take(lane, input);
        }
        rows::fill::<L, N>(&inputs, batch, &mut records.denominators);
        for (lane, _) in inputs.iter().enumerate().filter(|(_, input)| input.impact) {
            batch.immovable.0[lane] *= 2;
        }
        let mut extra = None;
        if batch.extras {
            let extra = extra.insert(ContactExtras::NONE);
            for (lane, &index) in indices.iter().enumerate() {
                let inverses =
                    [0, 1].map(|point| Unit::from_bits(records.denominators.normals[point].inverse.0[lane]));
                extra.fill(lane, source, index as usize, inverses);
            }
        }
        batch.unchecked = Unchecked::<L, N>::suits(batch, extra.as_ref());
        extras.extend(extra);
    }
}

/// Keeps the rows of a batch if it had the same contacts in the last tick and their rows have not changed. The impulses
/// for the warm start are already in the batch. Returns `false` if the batch has to be filled again.
#[inline(always)]
fn keep<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    records: &mut Records<N>,
    source: &ContactSource<'_>,
    prospects: &[Prospect],
    indices: &[u32],
    warm_starts: &mut WarmStarts,
) -> bool {
    if batch.extras || records.keepable_len() != Some(indices.len()) {
        return false;
    }
    let mut separations = [Quad([0; 4]); N];
    let mut points = 0;
    for (lane, (separations, &index)) in separations.iter_mut().zip(indices).enumerate() {
        let pair = &source.pairs[index as usize];
        if !pair.keeps_rows || !records.keep(lane, pair) {
            return false;
        }
        let bodies = source.bodies_of(pair);
        let changed = source.changed(bodies);
        let has_impact = changed.iter().any(|&body| prospects[body as usize].has_impact());
        let has = |of: &[[u32; N]; 2], bodies: [u32; 2]| [of[0][lane], of[1][lane]] == bodies;
        if has_impact
            || batch.immovable.0[lane] < -1
            || !has(&batch.bodies, bodies)
            || !has(&batch.changed, changed)
        {
            return false;
        }
        let manifold = &source.manifolds[pair.manifold as usize];
        let [first, second] = manifold.both_points();
        *separations = Quad([first.separation.to_bits(), second.separation.to_bits(), 0, 0]);
        points += u32::from(manifold.count());
    }
    warm_starts.points += points;
    warm_starts.kept += points;
    let [first, second, ..] = L::transposed(separations.each_ref());
    batch.separate::<L>([first, second]);
    batch.pushed = [0; 2];
    batch.unchecked = Unchecked::<L, N>::suits(batch, None);
    true
}
