//! Refresh: computes lever ratios, gains and gaps of hinges at the current pose.
//!
//! Lever ratios are rotated out of the frames of their bodies, `e = R e0`. If impulses move both bodies, each lever
//! ratio is then extended to the middle of the gap: `eA + perp(gap) / (2 kA)` and `eB - perp(gap) / (2 kB)`. The
//! impulses on A and B then act at one point, which conserves angular momentum.
//!
//! Each entry of `K` is rounded only once, to 46 fraction bits. The product `a e` is exact, as a high part and a low
//! part of 32 bits:
//!
//! ```text
//! a e = hi 2^32 + lo,    a e e' = hi e' + round(lo e' / 2^32)       (46 fraction bits)
//! ```
//!
//! If `a e` were rounded to the 24 fraction bits of `e` first, `e'` would multiply the rounding error by up to 2^7.
//! Entries with 46 fraction bits are so precise that the determinant can be computed as the difference
//! `K11 K22 - K12^2`, in which large products cancel.

use core::cell::Cell;

use super::super::super::body::SolverBody;
use super::super::super::pair::{RATIO, UNIT, beyond, shift};
use super::super::super::row::MassFractions;
use super::super::super::softness::Softness;
use super::Poses;
use super::angle::AngleRows;
use super::batch::{Batch, Records, Shape};
use crate::math::{Fx, Length, Rate, Ratio, Reciprocal, Shift, Speed, Step, Unit, saturate};
use crate::simd::{Ints, Lanes};

#[derive(Clone, Copy)]
pub(super) struct Stiffness {
    pub(super) points: Softness,
    pub(super) limits: Softness,
}

#[derive(Clone, Copy)]
pub(super) struct Refresh<'a> {
    pub(super) is_stale: bool,
    pub(super) stiffness: Stiffness,
    pub(super) poses: Poses<'a>,
}

impl Refresh<'_> {
    /// The hinges' own softness if the batch is tuned, otherwise the default for ordinary or for anchored hinges.
    #[inline(always)]
    pub(super) fn stiffness_of<const N: usize>(&self, batch: &Batch<N>, records: &Records<N>) -> Stiffness {
        match batch.is_tuned {
            false => self.stiffness,
            true => Stiffness { points: records.softness, limits: records.softness },
        }
    }

    #[inline(always)]
    pub(super) fn refresh<L: Lanes<N>, const N: usize>(
        &self,
        batch: &mut Batch<N>,
        records: &Records<N>,
        angle: Option<&mut AngleRows<N>>,
        bodies: &[Cell<SolverBody>],
    ) {
        if self.is_stale {
            let (stiffness, poses) = (self.stiffness_of(batch, records), self.poses);
            let quads = [L::quads(poses.quads, &batch.bodies[0]), L::quads(poses.quads, &batch.bodies[1])];
            let gap = gaps::<L, N>(batch, &records.shape, &quads, bodies);
            for (gap, bias) in gap.into_iter().zip(&mut batch.bias) {
                L::store(closing::<L, N>(gap, &stiffness.points), bias);
            }
            refresh_gains::<L, N>(batch, &records.shape, &quads, gap);
            if let Some(rows) = angle {
                rows.refresh(&records.turns[..records.len], &batch.bodies, poses.body_rotations);
            }
        }
    }
}

#[inline(always)]
fn gaps<L: Lanes<N>, const N: usize>(
    batch: &Batch<N>,
    shape: &Shape<N>,
    quads: &[[L::Int; 4]; 2],
    bodies: &[Cell<SolverBody>],
) -> [L::Int; 2] {
    let arms = [rotated::<L, N>(&quads[0], &shape.arms[0]), rotated::<L, N>(&quads[1], &shape.arms[1])];
    let (a, b) = (L::shifts(bodies, &batch.bodies[0]), L::shifts(bodies, &batch.bodies[1]));
    let moved = [L::sub(b.x, a.x), L::sub(b.y, a.y)];
    let [x, y] = &shape.between;
    let gap_x = L::add_wide(L::sub_wide(arms[1][0], arms[0][0]), L::load_wide(x));
    let gap_y = L::add_wide(L::sub_wide(arms[1][1], arms[0][1]), L::load_wide(y));
    [moved_gap::<L, N>(gap_x, moved[0]), moved_gap::<L, N>(gap_y, moved[1])]
}

#[inline(always)]
fn refresh_gains<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    shape: &Shape<N>,
    quads: &[[L::Int; 4]; 2],
    gap: [L::Int; 2],
) {
    let e = [
        reaching::<L, N>(rotated_ratios::<L, N>(&quads[0], &shape.ratios[0]), gap, &shape.gap_factors[0]),
        reaching::<L, N>(rotated_ratios::<L, N>(&quads[1], &shape.ratios[1]), gap, &shape.gap_factors[1]),
    ];
    for (e, batch) in e.iter().zip(&mut batch.e) {
        L::store(e[0], &mut batch[0]);
        L::store(e[1], &mut batch[1]);
    }
    let fractions = [L::load(&shape.fractions[0]), L::load(&shape.fractions[1])];
    let g = inverse::<L, N>(e, fractions);
    for side in 0..2 {
        fill_gains::<L, N>(batch, side, g, e[side], fractions[side]);
    }
}

/// `R v`, with 30 more fraction bits than `v`.
#[inline(always)]
fn rotated<L: Lanes<N>, const N: usize>(quads: &[L::Int; 4], v: &[Ints<N>; 2]) -> [L::Wide; 2] {
    let [c, s, ..] = *quads;
    let (x, y) = (L::load(&v[0]), L::load(&v[1]));
    [L::sub_wide(L::mul(c, x), L::mul(s, y)), L::add_wide(L::mul(s, x), L::mul(c, y))]
}

#[inline(always)]
fn rotated_ratios<L: Lanes<N>, const N: usize>(quads: &[L::Int; 4], ratios: &[Ints<N>; 2]) -> [L::Int; 2] {
    let [x, y] = rotated::<L, N>(quads, ratios);
    [L::narrow::<UNIT>(x), L::narrow::<UNIT>(y)]
}

/// Fraction bits of [`gap_factors`].
pub(super) const FACTOR: u32 = 14;

/// Changes of the lever ratios per metre of the gap: `1 / (2 kA)` and `-1 / (2 kB)`, in 1/m. Both are 0 if impulses do
/// not move one of the bodies, because angular momentum is then not conserved anyway. Saturates for radii of gyration
/// below 2^-18 m.
pub(super) fn gap_factors(inverse_gyrations: [Reciprocal; 2], fractions: MassFractions) -> [i32; 2] {
    if fractions.a == 0 || fractions.b == 0 {
        return [0; 2];
    }
    let [a, b] = inverse_gyrations
        .map(|inverse| saturate(inverse.times_wide(Fx::ONE).to_bits() >> (Fx::FRAC_NBITS - FACTOR + 1)));
    [a, -b]
}

/// The lever ratio of one body, extended into the gap: `e + factor (-gap_y, gap_x)`. If a component would exceed 87,
/// the ratio stays as it is, and the impulses then do not conserve angular momentum.
#[inline(always)]
fn reaching<L: Lanes<N>, const N: usize>(
    e: [L::Int; 2],
    [gap_x, gap_y]: [L::Int; 2],
    factors: &Ints<N>,
) -> [L::Int; 2] {
    /// Largest component of an extended ratio. The length is then below [`super::input::LENGTH_MAX`].
    const REACH_MAX: Ratio = Ratio::lit("87");
    const SHIFT: i32 = shift(Step::FRAC_NBITS + FACTOR - Ratio::FRAC_NBITS);
    let factor = L::load(factors);
    let (across_x, _) = L::narrow_saturating::<SHIFT>(L::mul(gap_x, factor));
    let (across_y, _) = L::narrow_saturating::<SHIFT>(L::mul(gap_y, factor));
    let (x, y) = (L::sub_saturating(e[0], across_y), L::add_saturating(e[1], across_x));
    let most = L::splat(REACH_MAX.to_bits());
    let beyond = L::either(beyond::<L, N>(x, most), beyond::<L, N>(y, most));
    [L::select(beyond, e[0], x), L::select(beyond, e[1], y)]
}

/// A component of the current gap, `gap + moved`, rounded once. `gap` has 52 fraction bits and uses the centres of mass
/// at the start of the tick. `moved` is the displacement of B relative to A since then.
#[inline(always)]
fn moved_gap<L: Lanes<N>, const N: usize>(gap: L::Wide, moved: L::Int) -> L::Int {
    const ARM: u32 = Length::FRAC_NBITS + Unit::FRAC_NBITS;
    let moved = L::mul(moved, L::splat(1 << (ARM - Shift::FRAC_NBITS)));
    L::narrow_saturating::<{ shift(ARM - Step::FRAC_NBITS) }>(L::add_wide(gap, moved)).0
}

/// The bias of a hinge: the negated velocity that closes the gap.
#[inline(always)]
fn closing<L: Lanes<N>, const N: usize>(gap: L::Int, softness: &Softness) -> L::Int {
    const RATE: i32 = shift(Step::FRAC_NBITS + Rate::FRAC_NBITS - Speed::FRAC_NBITS);
    L::narrow_saturating::<RATE>(L::mul(gap, L::splat(softness.bias_rate.to_bits()))).0
}

/// A component `e` of a lever ratio, and its product with the mass fraction, `a e = high 2^32 + low`.
struct Parts<L: Lanes<N>, const N: usize> {
    e: L::Int,
    high: L::Int,
    low: L::Int,
}

impl<L: Lanes<N>, const N: usize> Parts<L, N> {
    #[inline(always)]
    fn of(fraction: L::Int, e: L::Int) -> Self {
        let wide = L::mul(fraction, e);
        Parts { e, high: L::narrow::<32>(wide), low: L::low(wide) }
    }
}

/// `aA eA eA' + aB eB eB'`, an entry of `K - I`. `a` and `b` contain `aA eA` and `aB eB`. `other_a` and `other_b`
/// contain `eA'` and `eB'`.
#[inline(always)]
fn entry<L: Lanes<N>, const N: usize>(
    a: &Parts<L, N>,
    other_a: &Parts<L, N>,
    b: &Parts<L, N>,
    other_b: &Parts<L, N>,
) -> L::Wide {
    let high = L::add_wide(L::mul(a.high, other_a.e), L::mul(b.high, other_b.e));
    let low = L::add_wide(L::mul(a.low, other_a.e), L::mul(b.low, other_b.e));
    L::add_wide(high, L::mul(L::narrow::<32>(low), L::splat(1)))
}

/// `G = K^-1`.
#[inline(always)]
fn inverse<L: Lanes<N>, const N: usize>([a, b]: [[L::Int; 2]; 2], fractions: [L::Int; 2]) -> [L::Int; 3] {
    let (a_x, a_y) = (Parts::<L, N>::of(fractions[0], a[0]), Parts::<L, N>::of(fractions[0], a[1]));
    let (b_x, b_y) = (Parts::<L, N>::of(fractions[1], b[0]), Parts::<L, N>::of(fractions[1], b[1]));
    let xx = entry::<L, N>(&a_x, &a_x, &b_x, &b_x);
    let xy = entry::<L, N>(&a_x, &a_y, &b_x, &b_y);
    let yy = entry::<L, N>(&a_y, &a_y, &b_y, &b_y);
    L::inverse([xx, xy, yy])
}

#[inline(always)]
fn fill_gains<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    side: usize,
    g: [L::Int; 3],
    e: [L::Int; 2],
    fraction: L::Int,
) {
    let mut gains = [fraction; 3];
    for i in 0..3 {
        gains[i] = L::narrow::<UNIT>(L::mul(g[i], fraction));
        L::store(gains[i], &mut batch.g[side][i]);
    }
    for i in 0..2 {
        let wide = L::add_wide(L::mul(gains[i], e[0]), L::mul(gains[i + 1], e[1]));
        L::store(L::narrow::<RATIO>(wide), &mut batch.f[side][i]);
    }
}
