//! Fills batches: what the kernels need of a contact, in the order in which they solve it.

use alloc::vec::Vec;

use super::super::body_list::GROUND;
use super::super::colour::{Colouring, Group};
use super::super::lanes::WIDTH;
use super::super::limits::IMPULSE_MAX;
use super::super::row::{Denominator, Lever, MassFractions, turning};
use super::super::settings::Tuning;
use super::super::TouchingPair;
use super::batch::{Batch, Point, Row};
use super::rolling::RollingRows;
use super::{Batches, ContactSet, Surface, TANGENT_MAX, WarmStarts};
use crate::body::Body;
use crate::collision::{Contact, Manifold, ManifoldPoint, PointImpulse};
use crate::math::{
    Fx, Grip, Length, Ratio, Shift, Speed, Unit, Vec2, convert, mul, narrow, round_shift_wide, saturate, saturate_wide,
};

/// A body at one end of a contact.
#[derive(Clone, Copy)]
pub(in crate::solver) struct ContactEnd<'a> {
    /// Where the kernels find it.
    pub(in crate::solver) index: u32,
    pub(in crate::solver) body: &'a Body,
}

/// What it takes to bring the impulses of a lane back to its contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    /// [`NO_CONTACT`] for a lane that is not used.
    contact: u32,
    count: u8,
    features: [u16; 2],
    /// `1 / D` of the normal and the tangent of each point.
    inverse_denominators: [[Unit; 2]; 2],
}

const NO_CONTACT: u32 = u32::MAX;

impl Record {
    const NONE: Self = Record {
        contact: NO_CONTACT,
        count: 0,
        features: [0; 2],
        inverse_denominators: [[Unit::ZERO; 2]; 2],
    };

    /// The index of the contact, unless the lane is empty.
    pub(super) fn contact(&self) -> Option<usize> {
        (self.contact != NO_CONTACT).then_some(self.contact as usize)
    }

    pub(super) fn count(&self) -> usize {
        self.count.into()
    }

    /// What is kept of the impulses of a point: `p = L / D`.
    pub(super) fn impulse(&self, point: usize, (normal, tangent): (i32, i32)) -> PointImpulse {
        let [inverse_normal, inverse_tangent] = self.inverse_denominators[point];
        PointImpulse {
            feature: self.features[point],
            normal: mul(inverse_normal, Speed::from_bits(normal)),
            tangent: mul(inverse_tangent, Speed::from_bits(tangent)),
        }
    }
}

impl ContactSet {
    /// Takes the contacts of a tick, in the order of their colours.
    pub(in crate::solver) fn prepare<'a>(
        &mut self,
        colouring: &Colouring,
        pairs: &[TouchingPair],
        (manifolds, contacts): (&[Manifold], &[Contact]),
        end: impl Fn(u32) -> ContactEnd<'a>,
        tuning: &Tuning,
        warm: &mut WarmStarts,
    ) {
        let Self { serial, coloured } = self;
        serial.clear();
        coloured.clear();
        let source = |index: u32| {
            let TouchingPair { contact, bodies: (a, b), surface } = pairs[index as usize];
            let (manifold, memory) = (&manifolds[contact as usize], &contacts[contact as usize]);
            Source { contact, manifold, memory, surface, a: end(a), b: end(b), tuning }
        };
        for group in colouring.groups() {
            match group {
                Group::Serial(indices) => {
                    indices.iter().for_each(|&index| serial.push(&[index], source, warm));
                }
                Group::Coloured(indices) => {
                    indices.chunks(WIDTH).for_each(|chunk| coloured.push(chunk, source, warm));
                }
            }
        }
    }
}

/// A contact, before it is prepared.
struct Source<'a> {
    contact: u32,
    manifold: &'a Manifold,
    memory: &'a Contact,
    surface: Surface,
    a: ContactEnd<'a>,
    b: ContactEnd<'a>,
    tuning: &'a Tuning,
}

impl<const N: usize> Batches<N> {
    fn clear(&mut self) {
        let Batches { batches, rolling, records } = self;
        batches.clear();
        rolling.clear();
        records.clear();
    }

    /// Adds a batch of up to `N` contacts.
    fn push<'a>(&mut self, indices: &[u32], source: impl Fn(u32) -> Source<'a>, warm: &mut WarmStarts) {
        let Batches { batches, rolling, records } = self;
        batches.push(Batch::NONE);
        records.push([Record::NONE; N]);
        let (Some(batch), Some(records)) = (batches.last_mut(), records.last_mut()) else { return };
        for (lane, (record, &index)) in records.iter_mut().zip(indices).enumerate() {
            *record = source(index).fill(batch, lane, rolling, warm);
        }
    }
}

impl Source<'_> {
    fn fill<const N: usize>(
        &self,
        batch: &mut Batch<N>,
        lane: usize,
        rolling: &mut Vec<RollingRows<N>>,
        warm: &mut WarmStarts,
    ) -> Record {
        let &Source { manifold, memory, surface, a, b, tuning, .. } = self;
        let fractions = MassFractions::of(a.body, b.body);
        let ends = [(a, fractions.a), (b, fractions.b)];
        let softness = match ends.iter().any(|&(_, fraction)| fraction == 0) {
            true => tuning.contact_immovable,
            false => tuning.contact,
        };
        for (side, (end, fraction)) in ends.into_iter().enumerate() {
            batch.bodies[side][lane] = end.index;
            batch.changed[side][lane] = if fraction == 0 { GROUND } else { end.index };
        }
        let n: Vec2<Ratio> = manifold.normal.convert();
        batch.n_x.0[lane] = n.x.to_bits();
        batch.n_y.0[lane] = n.y.to_bits();
        batch.bias_rate.0[lane] = softness.bias_rate.to_bits();
        batch.mass_scale.0[lane] = softness.mass_scale.to_bits();
        batch.impulse_scale.0[lane] = softness.impulse_scale.to_bits();
        batch.surface_speed.0[lane] = narrow::<fixed::types::extra::U21>(surface.surface_speed).to_bits();
        batch.restitution.0[lane] = narrow::<fixed::types::extra::U30>(surface.restitution).to_bits();
        batch.bounces |= surface.restitution > 0;

        let points = manifold.points();
        batch.count = batch.count.max(points.len());
        let mut record = Record { contact: self.contact, ..Record::NONE };
        let mut inverse_normals = [Unit::ZERO; 2];
        for (i, point) in points.iter().enumerate() {
            let carried = memory.impulse_of(point.feature);
            warm.points += 1;
            warm.kept += u32::from(carried.is_some());
            record.count += 1;
            record.features[i] = point.feature.0;
            let inverses =
                self.fill_point(&mut batch.points[i], lane, n, point, fractions, carried.unwrap_or_default());
            record.inverse_denominators[i] = inverses;
            inverse_normals[i] = inverses[0];
        }
        let still_there = |old: &PointImpulse| points.iter().any(|point| point.feature.0 == old.feature);
        let lost = memory.points().iter().filter(|old| old.normal > 0 && !still_there(old)).count();
        warm.lost += u32::try_from(lost).expect("at most 2 points");
        if surface.rolling_resistance > 0 {
            self.fill_rolling(batch, lane, rolling, fractions, inverse_normals);
        }
        record
    }

    /// Returns `1 / D` of both rows.
    fn fill_point<const N: usize>(
        &self,
        point: &mut Point<N>,
        lane: usize,
        n: Vec2<Ratio>,
        from: &ManifoldPoint,
        fractions: MassFractions,
        carried: PointImpulse,
    ) -> [Unit; 2] {
        let lever = |end: ContactEnd<'_>| {
            let to_end = (self.manifold.origin - end.body.centre_of_mass()).narrow();
            Lever { arm: from.anchor + to_end, inverse_gyration: end.body.mass.inverse_gyration }
        };
        let levers = [lever(self.a), lever(self.b)];
        let normal = fill_row(&mut point.normal, lane, n, levers, fractions);
        let tangent = fill_row(&mut point.tangent, lane, n.perp(), levers, fractions);
        let separation: Shift = convert(from.separation);
        point.first_separation.0[lane] = separation.to_bits();
        point.separation.0[lane] = separation.to_bits();
        let ratio = round_shift_wide(i128::from(tangent.0) * i128::from(normal.1.to_bits()), 30);
        point.grip.0[lane] = grip(self.surface.friction, saturate_wide(ratio)).to_bits();
        point.normal_max.0[lane] = IMPULSE_MAX.to_bits();
        let lambda = |p: Speed, denominator: Denominator, limit: Speed| {
            let bits = round_shift_wide(i128::from(p.to_bits()) * i128::from(denominator), 30);
            saturate(saturate_wide(bits)).clamp(-limit.to_bits(), limit.to_bits())
        };
        // A guess, so that to clamp it is no fault.
        point.normal_lambda.0[lane] = lambda(carried.normal, normal.0, IMPULSE_MAX).max(0);
        point.tangent_lambda.0[lane] = lambda(carried.tangent, tangent.0, TANGENT_MAX);
        [normal.1, tangent.1]
    }

    fn fill_rolling<const N: usize>(
        &self,
        batch: &mut Batch<N>,
        lane: usize,
        rolling: &mut Vec<RollingRows<N>>,
        fractions: MassFractions,
        inverse_normals: [Unit; 2],
    ) {
        let gyrations = [self.a, self.b].map(|end| end.body.mass.inverse_gyration);
        let place = *batch.rolling.get_or_insert_with(|| {
            rolling.push(RollingRows::NONE);
            u32::try_from(rolling.len() - 1).expect("fewer than 2^32 contacts")
        });
        let (resistance, carried) = (self.surface.rolling_resistance, self.memory.rolling);
        rolling[place as usize].fill(lane, gyrations, fractions, resistance, inverse_normals, carried);
    }
}

/// Fills a lane of a row. Returns its denominator, with 30 fraction bits, and the reciprocal of that.
fn fill_row<const N: usize>(
    row: &mut Row<N>,
    lane: usize,
    n: Vec2<Ratio>,
    [a, b]: [Lever; 2],
    fractions: MassFractions,
) -> (Denominator, Unit) {
    let (e_a, e_b) = (lever_ratio(a, n), lever_ratio(b, n));
    row.e_a.0[lane] = e_a.to_bits();
    row.e_b.0[lane] = e_b.to_bits();
    let one = i64::from(fractions.a.to_bits()) + i64::from(fractions.b.to_bits());
    let denominator = (one + turning(fractions.a, e_a, e_a) + turning(fractions.b, e_b, e_b)).max(1 << 29);
    let inverse = Unit::from_bits(saturate((1i64 << 60) / denominator));
    for (gains, fraction, e) in [(&mut row.a, fractions.a, e_a), (&mut row.b, fractions.b, e_b)] {
        let g: Unit = mul(fraction, inverse);
        for (gain, direction) in gains.iter_mut().zip([n.x, n.y, e]) {
            gain.0[lane] = mul::<_, _, fixed::types::extra::U30>(g, direction).to_bits();
        }
    }
    (denominator, inverse)
}

/// `e = c / k`.
fn lever_ratio(lever: Lever, n: Vec2<Ratio>) -> Ratio {
    let c: Length = lever.arm.cross(n);
    let e: Ratio = lever.inverse_gyration.times(c);
    e.clamp(-super::super::row::RATIO_MAX, super::super::row::RATIO_MAX)
}

/// `mu r`, with `r = Dt / Dn` with 30 fraction bits, saturated.
pub(in crate::solver) fn grip(friction: Fx, ratio: i64) -> Grip {
    let friction: Grip = narrow(friction);
    let wide = i128::from(friction.to_bits()) * i128::from(ratio);
    Grip::from_bits(saturate(saturate_wide(round_shift_wide(wide, 30))))
}
