//! Fills batches with eight contacts at a time, in the order in which they are solved.

use alloc::vec::Vec;

use super::super::TouchingPair;
use super::super::body_list::BodyList;
use super::super::colour::{Colouring, Group, Node};
use super::super::lanes::{Ints, Kernel, Lanes, Machine, Scalar, WIDTH};
use super::batch::Batch;
use super::input::{Input, Source};
use super::rows;
use super::special::Special;
use super::{Batches, ContactSet, WarmStarts};
use crate::collision::{Contact, Manifold, PointImpulse};
use crate::math::{Speed, Unit, mul};

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
    fn take(&mut self, lane: usize, input: &Input) {
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

    /// What is kept of the impulses of a point: `p = L / D`.
    pub(super) fn impulse(&self, lane: usize, point: usize, (normal, tangent): (i32, i32)) -> PointImpulse {
        let inverse = |row: usize| Unit::from_bits(self.inverses[point][row].0[lane]);
        PointImpulse {
            feature: self.features[lane][point],
            normal: mul(inverse(0), Speed::from_bits(normal)),
            tangent: mul(inverse(1), Speed::from_bits(tangent)),
        }
    }
}

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
        inputs.extend(pairs.iter().map(|pair| {
            let (manifold, memory) = (&manifolds[pair.manifold as usize], &contacts[pair.contact as usize]);
            Input::new(pair, manifold, memory, list, warm)
        }));
        nodes.clear();
        nodes.extend(inputs.iter().zip(pairs).map(|(input, pair)| input.node(pair.shapes)));
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
        batches.clear();
        for group in colouring.groups() {
            let indices = match group {
                Group::Serial(indices) if N == 1 => indices,
                Group::Coloured(indices) if N == WIDTH => indices,
                _ => continue,
            };
            for (number, chunk) in indices.chunks(N).enumerate() {
                for &index in indices.iter().skip((number + INPUTS_AHEAD) * N).take(N) {
                    L::prefetch(&inputs[index as usize]);
                }
                batches.push::<L>(inputs, source, chunk);
            }
            batches.colours.push(batches.batches.len());
        }
    }
}

impl<const N: usize> Batches<N> {
    fn clear(&mut self) {
        let Batches { batches, special, records, colours } = self;
        colours.clear();
        batches.clear();
        special.clear();
        records.clear();
    }

    /// Adds a batch of up to `N` contacts.
    #[inline(always)]
    fn push<L: Lanes<N>>(&mut self, inputs: &[Input], source: &Source<'_>, indices: &[u32]) {
        let Batches { batches, special, records, .. } = self;
        batches.push(Batch::NONE);
        records.push(Records::NONE);
        let (Some(batch), Some(records)) = (batches.last_mut(), records.last_mut()) else { return };
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
        if batch.special {
            let mut rest = Special::NONE;
            for (lane, &index) in indices.iter().enumerate() {
                let inverses = [0, 1].map(|point| Unit::from_bits(records.inverses[point][0].0[lane]));
                rest.fill(lane, source, index as usize, inverses);
            }
            special.push(rest);
        }
    }
}
