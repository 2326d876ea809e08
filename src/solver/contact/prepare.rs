//! Fills batches with eight contacts at a time, in the order in which they are solved.

use alloc::vec::Vec;

use super::super::TouchingPair;
use super::super::body_list::BodyList;
use super::super::colour::{Colouring, Group, Node};
use super::batch::Batch;
use super::care::Calm;
use super::input::{Input, Source};
use super::rows;
use super::special::Special;
use super::store::Records;
use super::{Batches, ContactSet, WarmStarts};
use crate::collision::{Contact, Manifold};
use crate::lanes::{Kernel, Lanes, Machine, Scalar, WIDTH, prefetch};
use crate::math::Unit;

impl ContactSet {
    /// Takes the contacts of a tick, and sorts them into colours.
    pub(in crate::solver) fn prepare(
        &mut self,
        pairs: &[TouchingPair],
        (manifolds, contacts): (&[Manifold], &[Contact]),
        list: &BodyList,
        (nodes, colouring): (&mut Vec<Node>, &mut Colouring),
        machine: Machine,
        warm: &mut WarmStarts,
    ) {
        let Self { serial, coloured, inputs } = self;
        inputs.clear();
        nodes.clear();
        nodes.reserve(pairs.len());
        inputs.extend(pairs.iter().map(|pair| {
            let (manifold, memory) = (&manifolds[pair.manifold as usize], &contacts[pair.contact as usize]);
            let input = Input::new(pair, manifold, memory, list, warm);
            nodes.push(input.node(pair.shapes));
            input
        }));
        colouring.order(nodes, list.len());
        // For lanes without a contact.
        inputs.push(Input::default());
        let source = &Source { pairs, contacts, list };
        Fill { batches: serial, inputs, source, colouring }.run::<Scalar<1>>();
        machine.run(Fill { batches: coloured, inputs, source, colouring });
    }
}

/// How many batches before it is read an input is asked for: in the order of colours they lie anywhere.
const INPUTS_AHEAD: usize = 2;

/// Fills the batches of `N` contacts.
struct Fill<'a, const N: usize> {
    batches: &'a mut Batches<N>,
    /// One for each contact, and one more for none.
    inputs: &'a [Input],
    source: &'a Source<'a>,
    colouring: &'a Colouring,
}

impl<const N: usize> Kernel<N> for Fill<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Fill { batches, inputs, source, colouring } = self;
        batches.special.clear();
        batches.colours.clear();
        let mut count = 0;
        for group in colouring.groups() {
            let indices = match group {
                Group::Serial(indices) if N == 1 => indices,
                Group::Coloured(indices) if N == WIDTH => indices,
                _ => continue,
            };
            for (number, chunk) in indices.chunks(N).enumerate() {
                for &index in indices.iter().skip((number + INPUTS_AHEAD) * N).take(N) {
                    prefetch(&inputs[index as usize]);
                }
                batches.fill::<L>(count, inputs, source, chunk);
                count += 1;
            }
            batches.colours.push(count);
        }
        batches.truncate(count);
    }
}

impl<const N: usize> Batches<N> {
    /// Forgets all batches but the first so many.
    fn truncate(&mut self, count: usize) {
        self.batches.truncate(count);
        self.records.truncate(count);
    }

    /// Makes a batch of up to `N` contacts, in the place of one of the last tick if there was one: nothing is written that
    /// is written again, for memory cannot keep up.
    #[inline(always)]
    fn fill<L: Lanes<N>>(&mut self, number: usize, inputs: &[Input], source: &Source<'_>, indices: &[u32]) {
        let Batches { batches, special, records, .. } = self;
        if number >= batches.len() {
            batches.push(Batch::NONE);
            records.push(Records::NONE);
        }
        let (batch, records) = (&mut batches[number], &mut records[number]);
        batch.begin();
        records.begin();
        let mut chosen = [&inputs[inputs.len() - 1]; N];
        for (lane, (input, &index)) in chosen.iter_mut().zip(indices).enumerate() {
            *input = &inputs[index as usize];
            batch.special |= input.special;
            batch.count = batch.count.max(input.count.into());
            for side in 0..2 {
                batch.bodies[side][lane] = input.bodies[side];
                batch.changed[side][lane] = input.changed[side];
            }
            records.take(lane, input);
        }
        rows::fill::<L, N>(&chosen, batch, &mut records.inverses);
        let mut rest = None;
        if batch.special {
            let rest = rest.insert(Special::NONE);
            for (lane, &index) in indices.iter().enumerate() {
                let inverses = [0, 1].map(|point| Unit::from_bits(records.inverses.normals[point].0[lane]));
                rest.fill(lane, source, index as usize, inverses);
            }
        }
        batch.calm = Calm::<L, N>::suits(batch, rest.as_ref());
        special.extend(rest);
    }
}
