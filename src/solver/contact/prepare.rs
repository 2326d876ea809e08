//! Fills batches: the rows of eight contacts at a time, in the order in which they are solved.
//!
//! ```text
//! D = aA (1 + eA^2) + aB (1 + eB^2),   g = a / D,   f = g e,   grip = mu Dt / Dn,   L = p D
//! ```

use alloc::vec::Vec;

use super::super::TouchingPair;
use super::super::body_list::BodyList;
use super::super::colour::{Colouring, Group, Node};
use super::super::lanes::{Ints, Kernel, Lanes, Machine, Scalar, WIDTH};
use super::super::limits::IMPULSE_MAX;
use super::super::pair::{RATIO, UNIT};
use super::batch::{Batch, Row};
use super::input::Input;
use super::special::Special;
use super::{Batches, ContactSet, TANGENT_MAX, WarmStarts};
use crate::collision::{Contact, Manifold, PointImpulse};
use crate::math::{Fx, Grip, Speed, Unit, mul, narrow, round_shift_wide, saturate, saturate_wide};

/// What it takes to bring the impulses of a batch back to its contacts.
#[derive(Clone, Debug)]
pub(super) struct Records<const N: usize> {
    /// How many lanes are used.
    len: u32,
    contacts: [u32; N],
    counts: [u8; N],
    features: [[u16; 2]; N],
    /// `1 / D` of the normal and the tangent of each point.
    inverses: [[Ints<N>; 2]; 2],
}

impl<const N: usize> Records<N> {
    const NONE: Self = Records {
        len: 0,
        contacts: [0; N],
        counts: [0; N],
        features: [[0; 2]; N],
        inverses: [[Ints::ZERO; 2]; 2],
    };

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
        nodes.clear();
        for pair in pairs {
            let (manifold, memory) = (&manifolds[pair.manifold as usize], &contacts[pair.contact as usize]);
            let input = Input::new(pair, manifold, memory, list, warm);
            nodes.push(input.node(pair.shapes));
            inputs.push(input);
        }
        colouring.order(nodes, list.len());
        Fill { batches: serial, inputs, list, colouring }.run::<Scalar<1>>();
        machine.run(Fill { batches: coloured, inputs, list, colouring });
    }
}

/// Fills the batches of `N` contacts.
struct Fill<'a, const N: usize> {
    batches: &'a mut Batches<N>,
    inputs: &'a [Input],
    list: &'a BodyList,
    colouring: &'a Colouring,
}

impl<const N: usize> Kernel<N> for Fill<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Fill { batches, inputs, list, colouring } = self;
        batches.clear();
        for group in colouring.groups() {
            let indices = match group {
                Group::Serial(indices) if N == 1 => indices,
                Group::Coloured(indices) if N == WIDTH => indices,
                _ => continue,
            };
            for chunk in indices.chunks(N) {
                batches.push::<L>(inputs, list, chunk);
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
    fn push<L: Lanes<N>>(&mut self, inputs: &[Input], list: &BodyList, indices: &[u32]) {
        let Batches { batches, special, records, .. } = self;
        batches.push(Batch::NONE);
        records.push(Records::NONE);
        let (Some(batch), Some(records)) = (batches.last_mut(), records.last_mut()) else { return };
        let mut gathered = Gathered::NONE;
        for (lane, &index) in indices.iter().enumerate() {
            gathered.take(&inputs[index as usize], lane, batch, records);
        }
        gathered.fill::<L>(batch, records);
        if indices.iter().any(|&index| inputs[index as usize].is_special()) {
            batch.special = true;
            let mut rest = Special::NONE;
            for (lane, &index) in indices.iter().enumerate() {
                let inverses = [0, 1].map(|point| Unit::from_bits(records.inverses[point][0].0[lane]));
                rest.fill(lane, &inputs[index as usize], list, inverses);
            }
            special.push(rest);
        }
    }
}

/// What the rows of a batch are made of, lane by lane.
struct Gathered<const N: usize> {
    fractions: [Ints<N>; 2],
    friction: Ints<N>,
    /// For each point, the impulses of the last tick: along the normal and along the tangent.
    carried: [[Ints<N>; 2]; 2],
}

impl<const N: usize> Gathered<N> {
    const NONE: Self =
        Gathered { fractions: [Ints::ZERO; 2], friction: Ints::ZERO, carried: [[Ints::ZERO; 2]; 2] };

    /// Puts a contact into a lane.
    #[inline(always)]
    fn take(&mut self, input: &Input, lane: usize, batch: &mut Batch<N>, records: &mut Records<N>) {
        self.fractions[0].0[lane] = input.fractions.a.to_bits();
        self.fractions[1].0[lane] = input.fractions.b.to_bits();
        self.friction.0[lane] = input.friction;
        for side in 0..2 {
            batch.bodies[side][lane] = input.bodies[side];
            batch.changed[side][lane] = input.changed[side];
        }
        batch.n_x.0[lane] = input.n.x.to_bits();
        batch.n_y.0[lane] = input.n.y.to_bits();
        batch.immovable.0[lane] = -i32::from(input.immovable);
        batch.count = batch.count.max(input.count.into());
        records.len += 1;
        records.contacts[lane] = input.contact;
        records.counts[lane] = input.count;
        records.features[lane] = input.features;
        for (i, from) in input.points.iter().take(input.count.into()).enumerate() {
            let point = &mut batch.points[i];
            for (row, e) in [(&mut point.normal, from.normal), (&mut point.tangent, from.tangent)] {
                row.e_a.0[lane] = e[0].to_bits();
                row.e_b.0[lane] = e[1].to_bits();
            }
            point.first_separation.0[lane] = from.separation.to_bits();
            point.separation.0[lane] = from.separation.to_bits();
            self.carried[i][0].0[lane] = from.carried[0].to_bits();
            self.carried[i][1].0[lane] = from.carried[1].to_bits();
        }
    }

    /// Makes the rows of what has been gathered.
    #[inline(always)]
    fn fill<L: Lanes<N>>(&self, batch: &mut Batch<N>, records: &mut Records<N>) {
        let (x, y) = (L::load(&batch.n_x), L::load(&batch.n_y));
        let minus_y = L::sub(L::splat(0), y);
        let fractions = [L::load(&self.fractions[0]), L::load(&self.fractions[1])];
        for i in 0..batch.count {
            let (point, [normal_inverses, tangent_inverses]) =
                (&mut batch.points[i], &mut records.inverses[i]);
            let normal = fill_row::<L, N>(&mut point.normal, [x, y], fractions, normal_inverses);
            let tangent = fill_row::<L, N>(&mut point.tangent, [minus_y, x], fractions, tangent_inverses);
            for lane in 0..N {
                let ratio = i128::from(tangent[lane]) * i128::from(normal_inverses.0[lane]);
                let ratio = saturate_wide(round_shift_wide(ratio, 30));
                let friction = i64::from(self.friction.0[lane]);
                point.grip.0[lane] = grip_of(friction, ratio).to_bits();
                let [normal_p, tangent_p] = self.carried[i].each_ref().map(|carried| carried.0[lane]);
                // A guess, so that to clamp it is no fault.
                point.normal_lambda.0[lane] = carried(normal_p, normal[lane], IMPULSE_MAX).max(0);
                point.tangent_lambda.0[lane] = carried(tangent_p, tangent[lane], TANGENT_MAX);
            }
        }
    }
}

/// `p D`, as far as a limit.
#[inline(always)]
fn carried(p: i32, denominator: i64, limit: Speed) -> i32 {
    let bits = round_shift_wide(i128::from(p) * i128::from(denominator), 30);
    saturate(saturate_wide(bits)).clamp(-limit.to_bits(), limit.to_bits())
}

/// Makes the gains of a row from its lever ratios. Returns its denominators, with 30 fraction bits.
#[inline(always)]
fn fill_row<L: Lanes<N>, const N: usize>(
    row: &mut Row<N>,
    n: [L::Int; 2],
    fractions: [L::Int; 2],
    inverses: &mut Ints<N>,
) -> [i64; N] {
    let (e_a, e_b) = (L::load(&row.e_a), L::load(&row.e_b));
    // Ratios and their products with a fraction have 24 fraction bits, and their squares 48.
    let ae = L::narrow::<UNIT>(L::mul(fractions[0], e_a));
    let be = L::narrow::<UNIT>(L::mul(fractions[1], e_b));
    let squares = L::add_wide(L::mul(ae, e_a), L::mul(be, e_b));
    let ones = L::mul(L::add(fractions[0], fractions[1]), L::splat(1 << 18));
    let denominators = L::to_array(L::add_wide(squares, ones)).map(|wide| wide >> 18);
    for (inverse, &denominator) in inverses.0.iter_mut().zip(&denominators) {
        *inverse = reciprocal(denominator);
    }
    let inverse = L::load(inverses);
    for (gains, fraction, e) in [(&mut row.a, fractions[0], e_a), (&mut row.b, fractions[1], e_b)] {
        let g = L::narrow::<UNIT>(L::mul(fraction, inverse));
        L::store(L::narrow::<RATIO>(L::mul(g, n[0])), &mut gains[0]);
        L::store(L::narrow::<RATIO>(L::mul(g, n[1])), &mut gains[1]);
        L::store(L::narrow::<RATIO>(L::mul(g, e)), &mut gains[2]);
    }
    denominators
}

/// `1 / D`, both with 30 fraction bits; of a lane without a contact, whose fractions are 0, anything.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "D is 1 or more, so it is at most 1"
)]
fn reciprocal(denominator: i64) -> i32 {
    ((1u64 << 60) / denominator.max(1 << 30) as u64) as i32
}

/// `mu r`, with `r = Dt / Dn` with 30 fraction bits, saturated.
pub(super) fn grip(friction: Fx, ratio: i64) -> Grip {
    grip_of(narrow::<fixed::types::extra::U20>(friction).to_bits().into(), ratio)
}

#[inline(always)]
fn grip_of(friction: i64, ratio: i64) -> Grip {
    let wide = i128::from(friction) * i128::from(ratio);
    Grip::from_bits(saturate(saturate_wide(round_shift_wide(wide, 30))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fx;

    #[test]
    fn grip_is_friction_times_the_ratio_of_denominators() {
        let one = 1i64 << 30;
        assert_eq!(grip(fx!(0.5), one), Grip::lit("0.5"));
        assert_eq!(grip(fx!(0.5), 4 * one), Grip::lit("2"));
        assert_eq!(grip(fx!(0.5), one / 4), Grip::lit("0.125"));
        assert_eq!(grip(fx!(16), 16130 * one), Grip::MAX, "saturated, not wrapped");
    }
}
