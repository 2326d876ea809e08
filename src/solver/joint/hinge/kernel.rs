//! The point block of `point_block.rs` for any number of lanes: refresh, warm start, solve.
//!
//! Lever ratios are turned in their body's frame, `e = R e0`, instead of made anew from the arms: their length does not
//! change. The products of `K` are exact in two parts of 32 bits before they are rounded,
//!
//! ```text
//! a e = hi 2^32 + lo,    a e e' = hi e' + round(lo e' / 2^32)       (46 fraction bits)
//! ```
//!
//! because rounding `a e` to the format of `e` would cost 7 of its 24 bits. With so many, the determinant may be the
//! difference `K11 K22 - K12^2`: what cancels is exact.

use core::cell::Cell;

use super::super::super::body::SolverBody;
use super::super::super::contact::Pass;
use super::super::super::limits::{Faults, IMPULSE_MAX, STEP_MAX};
use super::super::super::pair::{Pair, RATIO, UNIT, beyond, clamp, shift};
use super::super::super::softness::Softness;
use super::angle::AngleRows;
use super::batch::{Batch, Shape};
use crate::lanes::{Ints, Lanes, Motion, Quad};
use crate::math::{Length, Rate, Shift, Speed, Step, Unit};

/// How soft the rows of a batch are. A copy, so that what is written to a batch cannot change it.
#[derive(Clone, Copy)]
pub(super) struct Stiffness {
    pub(super) points: Softness,
    pub(super) limits: Softness,
}

/// `R v` of the rotations of quads, with 30 more fraction bits.
#[inline(always)]
fn rotated<L: Lanes<N>, const N: usize>(quads: &[L::Int; 4], v: &[Ints<N>; 2]) -> [L::Wide; 2] {
    let [c, s, ..] = *quads;
    let (x, y) = (L::load(&v[0]), L::load(&v[1]));
    [L::sub_wide(L::mul(c, x), L::mul(s, y)), L::add_wide(L::mul(s, x), L::mul(c, y))]
}

/// How the bodies of a batch are turned.
#[inline(always)]
pub(super) fn turns<L: Lanes<N>, const N: usize>(batch: &Batch<N>, quads: &[Quad]) -> [[L::Int; 4]; 2] {
    [L::quads(quads, &batch.bodies[0]), L::quads(quads, &batch.bodies[1])]
}

/// Gaps at the present pose.
#[inline(always)]
pub(super) fn refresh_gaps<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    shape: &Shape<N>,
    quads: &[[L::Int; 4]; 2],
    bodies: &[Cell<SolverBody>],
    softness: &Softness,
) {
    let arms = [rotated::<L, N>(&quads[0], &shape.arms[0]), rotated::<L, N>(&quads[1], &shape.arms[1])];
    let (a, b) = (L::shifts(bodies, &batch.bodies[0]), L::shifts(bodies, &batch.bodies[1]));
    let moved = [L::sub(b.x, a.x), L::sub(b.y, a.y)];
    for axis in 0..2 {
        let between = L::load_wide(&shape.between[axis]);
        let gap = L::add_wide(L::sub_wide(arms[1][axis], arms[0][axis]), between);
        L::store(closing::<L, N>(gap, moved[axis], softness), &mut batch.bias[axis]);
    }
}

/// Lever ratios and gains at the present pose.
#[inline(always)]
pub(super) fn refresh_gains<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    shape: &Shape<N>,
    quads: &[[L::Int; 4]; 2],
) {
    let e = [
        turned::<L, N>(&mut batch.e[0], &quads[0], &shape.ratios[0]),
        turned::<L, N>(&mut batch.e[1], &quads[1], &shape.ratios[1]),
    ];
    let fractions = [L::load(&shape.fractions[0]), L::load(&shape.fractions[1])];
    let g = inverse::<L, N>(e, fractions);
    for side in 0..2 {
        fill_gains::<L, N>(batch, side, g, e[side], fractions[side]);
    }
}

/// Lever ratios in world axes.
#[inline(always)]
fn turned<L: Lanes<N>, const N: usize>(
    e: &mut [Ints<N>; 2],
    quads: &[L::Int; 4],
    ratios: &[Ints<N>; 2],
) -> [L::Int; 2] {
    let [x, y] = rotated::<L, N>(quads, ratios);
    let turned = [L::narrow::<UNIT>(x), L::narrow::<UNIT>(y)];
    L::store(turned[0], &mut e[0]);
    L::store(turned[1], &mut e[1]);
    turned
}

/// The velocity that closes a gap, reversed: of the gap with 52 fraction bits, which is exact until it is rounded once,
/// and what has moved since.
#[inline(always)]
fn closing<L: Lanes<N>, const N: usize>(gap: L::Wide, moved: L::Int, softness: &Softness) -> L::Int {
    const ARM: u32 = Length::FRAC_NBITS + Unit::FRAC_NBITS;
    const RATE: i32 = shift(Step::FRAC_NBITS + Rate::FRAC_NBITS - Speed::FRAC_NBITS);
    let moved = L::mul(moved, L::splat(1 << (ARM - Shift::FRAC_NBITS)));
    let (gap, _) = L::narrow_saturating::<{ shift(ARM - Step::FRAC_NBITS) }>(L::add_wide(gap, moved));
    L::narrow_saturating::<RATE>(L::mul(gap, L::splat(softness.bias_rate.to_bits()))).0
}

/// `a e` in two parts: what is left of it when 32 bits are dropped, and those.
struct Parts<L: Lanes<N>, const N: usize> {
    high: L::Int,
    low: L::Int,
}

impl<L: Lanes<N>, const N: usize> Parts<L, N> {
    #[inline(always)]
    fn of(fraction: L::Int, e: L::Int) -> Self {
        let wide = L::mul(fraction, e);
        Parts { high: L::narrow::<32>(wide), low: L::low(wide) }
    }
}

/// An entry of `K - I`: `aA eA eA' + aB eB eB'`.
#[inline(always)]
fn entry<L: Lanes<N>, const N: usize>(
    (part_a, a): (&Parts<L, N>, L::Int),
    (part_b, b): (&Parts<L, N>, L::Int),
) -> L::Wide {
    let high = L::add_wide(L::mul(part_a.high, a), L::mul(part_b.high, b));
    let low = L::add_wide(L::mul(part_a.low, a), L::mul(part_b.low, b));
    L::add_wide(high, L::mul(L::narrow::<32>(low), L::splat(1)))
}

/// `G = K^-1`.
#[inline(always)]
fn inverse<L: Lanes<N>, const N: usize>([a, b]: [[L::Int; 2]; 2], fractions: [L::Int; 2]) -> [L::Int; 3] {
    let (a_x, a_y) = (Parts::<L, N>::of(fractions[0], a[0]), Parts::<L, N>::of(fractions[0], a[1]));
    let (b_x, b_y) = (Parts::<L, N>::of(fractions[1], b[0]), Parts::<L, N>::of(fractions[1], b[1]));
    let xx = entry::<L, N>((&a_x, a[0]), (&b_x, b[0]));
    let xy = entry::<L, N>((&a_x, a[1]), (&b_x, b[1]));
    let yy = entry::<L, N>((&a_y, a[1]), (&b_y, b[1]));
    L::inverse([xx, xy, yy])
}

/// The gains of the body on a side.
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

/// Applies the impulses that were carried over, each kept within what may be applied at once.
#[inline(always)]
pub(super) fn warm_start<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    angles: &mut [AngleRows<N>],
    bodies: &[Cell<SolverBody>],
    faults: &mut Faults,
) {
    let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
    if let Some(place) = batch.angle {
        angles[place as usize].warm_start(&mut pair, faults);
    }
    let limit = L::splat(STEP_MAX.to_bits());
    let lambda = [L::load(&batch.lambda[0]), L::load(&batch.lambda[1])];
    let large = L::either(beyond::<L, N>(lambda[0], limit), beyond::<L, N>(lambda[1], limit));
    if L::any(large) {
        *faults += u64::from(L::count(large));
    }
    let lambda = [clamp::<L, N>(lambda[0], limit), clamp::<L, N>(lambda[1], limit)];
    L::store(lambda[0], &mut batch.lambda[0]);
    L::store(lambda[1], &mut batch.lambda[1]);
    pair.apply_at_point(batch, lambda, faults);
    pair.store(bodies, &batch.changed);
}

/// One iteration over the rows and points of a batch.
#[inline(always)]
pub(super) fn solve<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    angles: &mut [AngleRows<N>],
    pass: Pass,
    (stiffness, quads): (Stiffness, &[Quad]),
    bodies: &[Cell<SolverBody>],
    faults: &mut Faults,
) {
    let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
    if let Some(place) = batch.angle {
        angles[place as usize].solve(pass, &stiffness.limits, &mut pair, faults);
    }
    let (e_a, e_b) = match pass {
        Pass::Bias => (
            ratios_ahead::<L, N>(&batch.e[0], &L::quads(quads, &batch.bodies[0])),
            ratios_ahead::<L, N>(&batch.e[1], &L::quads(quads, &batch.bodies[1])),
        ),
        Pass::Relax => (
            [L::load(&batch.e[0][0]), L::load(&batch.e[0][1])],
            [L::load(&batch.e[1][0]), L::load(&batch.e[1][1])],
        ),
    };
    let Pair { a, b } = &pair;
    let vr = [
        velocity::<L, N>(L::sub(b.x, a.x), (e_a[0], e_b[0]), a, b, faults),
        velocity::<L, N>(L::sub(b.y, a.y), (e_a[1], e_b[1]), a, b, faults),
    ];
    let d = [
        accumulate::<L, N>(batch, 0, vr[0], pass, &stiffness.points, faults),
        accumulate::<L, N>(batch, 1, vr[1], pass, &stiffness.points, faults),
    ];
    pair.apply_at_point(batch, d, faults);
    pair.store(bodies, &batch.changed);
}

/// The impulse along an axis against a relative velocity: adds it to what has accumulated, and returns it.
#[inline(always)]
fn accumulate<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    axis: usize,
    vr: L::Int,
    pass: Pass,
    softness: &Softness,
    faults: &mut Faults,
) -> L::Int {
    let old = L::load(&batch.lambda[axis]);
    let w = match pass {
        Pass::Relax => vr,
        Pass::Bias => {
            let error = L::add_saturating(vr, L::load(&batch.bias[axis]));
            let scales = [softness.mass_scale, softness.impulse_scale].map(Unit::to_bits);
            let wide = L::add_wide(L::mul(L::splat(scales[0]), error), L::mul(L::splat(scales[1]), old));
            L::narrow::<UNIT>(wide)
        }
    };
    let step = L::splat(STEP_MAX.to_bits());
    let wanted = L::sub_saturating(old, clamp::<L, N>(w, step));
    let most = L::splat(IMPULSE_MAX.to_bits());
    let out = L::either(beyond::<L, N>(w, step), beyond::<L, N>(wanted, most));
    if L::any(out) {
        *faults += u64::from(L::count(out));
    }
    let new = clamp::<L, N>(wanted, most);
    L::store(new, &mut batch.lambda[axis]);
    L::sub(new, old)
}

/// `e + M (t/2 (-e_y, e_x) - t^2/6 e)`, with `M t/2` and `M t^2/6` of each body.
#[inline(always)]
fn ratios_ahead<L: Lanes<N>, const N: usize>(
    e: &[Ints<N>; 2],
    &[_, _, across, along]: &[L::Int; 4],
) -> [L::Int; 2] {
    let (x, y) = (L::load(&e[0]), L::load(&e[1]));
    let back_x = L::add_wide(L::mul(y, across), L::mul(x, along));
    let back_y = L::sub_wide(L::mul(y, along), L::mul(x, across));
    [L::sub(x, L::narrow::<UNIT>(back_x)), L::sub(y, L::narrow::<UNIT>(back_y))]
}

/// Relative velocity of B from A along an axis. A lane in which it does not fit is a fault.
#[inline(always)]
fn velocity<L: Lanes<N>, const N: usize>(
    linear: L::Int,
    (e_a, e_b): (L::Int, L::Int),
    a: &Motion<L::Int>,
    b: &Motion<L::Int>,
    faults: &mut Faults,
) -> L::Int {
    let angular = L::sub_wide(L::mul(e_b, b.turn), L::mul(e_a, a.turn));
    let wide = L::add_wide(L::mul(linear, L::splat(1 << RATIO)), angular);
    let (vr, out) = L::narrow_saturating::<RATIO>(wide);
    if L::any(out) {
        *faults += u64::from(L::count(out));
    }
    vr
}
