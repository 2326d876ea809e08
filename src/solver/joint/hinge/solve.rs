//! Solve: one iteration over the rows on the angle and over the point block of `point_block.rs`.
//!
//! ```text
//! bias pass    vr = vB - vA + eMB uB - eMA uA,   w = massScale (vr + bias) + impulseScale L
//! relax pass   vr = vB - vA + eB uB - eA uA,     w = vr
//! L' = clamp(L - clamp(w, -512, 512), -1023, 1023),  d = L' - L
//! vA -= GA d,  uA -= fA.d,  vB += GB d,  uB += fB.d
//! ```

use super::super::super::batches::{BatchParts, Operation};
use super::super::super::context::{Pass, SolverPass};
use super::super::super::limits::{Faults, IMPULSE_MAX, STEP_MAX};
use super::super::super::pair::{BodyPairW, RATIO, UNIT, beyond, clamp};
use super::super::super::softness::Softness;
use super::Hinges;
use super::batch::Batch;
use super::refresh::Refresh;
use crate::math::Unit;
use crate::simd::{Ints, Lanes, Quad, VelocityW};

#[derive(Clone, Copy)]
pub(super) struct Solve<'a, P> {
    pub(super) pass: P,
    pub(super) refresh: Refresh<'a>,
}

impl<P: SolverPass> Operation<Hinges> for Solve<'_, P> {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Hinges, N>) {
        let (pass, refresh) = (self.pass.kind(), &self.refresh);
        let BatchParts { batch, record, extra: mut angle, bodies, faults } = parts;
        refresh.refresh::<L, N>(batch, record, angle.as_deref_mut(), bodies);
        // Local copies, so that the compiler sees that writing to the batch does not change them.
        let (stiffness, quads) = (refresh.stiffness_of(batch, record), refresh.poses.quads);
        let mut pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
        if let Some(rows) = angle {
            rows.solve(pass, &stiffness.limits, &mut pair, faults);
        }
        let (e_a, e_b) = ratios_of::<L, N>(batch, pass, quads);
        let vr = relative_velocity::<L, N>(e_a, e_b, &pair, faults);
        let d = [
            accumulate::<L, N>(batch, 0, vr[0], pass, &stiffness.points, faults),
            accumulate::<L, N>(batch, 1, vr[1], pass, &stiffness.points, faults),
        ];
        pair.apply_at_point(batch, d, faults);
        pair.store(bodies, &batch.changed);
    }
}

#[inline(always)]
pub(super) fn ratios_of<L: Lanes<N>, const N: usize>(
    batch: &Batch<N>,
    pass: Pass,
    quads: &[Quad],
) -> ([L::Int; 2], [L::Int; 2]) {
    match pass {
        Pass::Bias => (
            ratios_ahead::<L, N>(&batch.e[0], &L::quads(quads, &batch.bodies[0])),
            ratios_ahead::<L, N>(&batch.e[1], &L::quads(quads, &batch.bodies[1])),
        ),
        Pass::Relax => (
            [L::load(&batch.e[0][0]), L::load(&batch.e[0][1])],
            [L::load(&batch.e[1][0]), L::load(&batch.e[1][1])],
        ),
    }
}

#[inline(always)]
pub(super) fn relative_velocity<L: Lanes<N>, const N: usize>(
    e_a: [L::Int; 2],
    e_b: [L::Int; 2],
    pair: &BodyPairW<L, N>,
    faults: &mut Faults,
) -> [L::Int; 2] {
    let BodyPairW { a, b } = pair;
    let linear = [L::sub(b.x, a.x), L::sub(b.y, a.y)];
    [
        velocity::<L, N>(linear[0], e_a[0], e_b[0], pair, faults),
        velocity::<L, N>(linear[1], e_a[1], e_b[1], pair, faults),
    ]
}

/// `w` along one axis, before it is clamped.
#[inline(always)]
pub(super) fn wanted<L: Lanes<N>, const N: usize>(
    batch: &Batch<N>,
    axis: usize,
    vr: L::Int,
    pass: Pass,
    softness: &Softness,
) -> L::Int {
    match pass {
        Pass::Relax => vr,
        Pass::Bias => {
            let error = L::add_saturating(vr, L::load(&batch.bias[axis]));
            let scales = [softness.mass_scale, softness.impulse_scale].map(Unit::to_bits);
            let old = L::load(&batch.lambda[axis]);
            let wide = L::add_wide(L::mul(L::splat(scales[0]), error), L::mul(L::splat(scales[1]), old));
            L::narrow::<UNIT>(wide)
        }
    }
}

/// Updates the impulse along an axis, and returns its change.
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
    let w = wanted::<L, N>(batch, axis, vr, pass, softness);
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

/// Lever ratios averaged over the predicted rotation: `e + across (-e_y, e_x) - along e`, with the last two numbers of
/// the body's quad.
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

/// The relative velocity `vr` along one axis. Lanes in which it does not fit a [`Speed`](crate::math::Speed) saturate,
/// and count as faults.
#[inline(always)]
fn velocity<L: Lanes<N>, const N: usize>(
    linear: L::Int,
    e_a: L::Int,
    e_b: L::Int,
    pair: &BodyPairW<L, N>,
    faults: &mut Faults,
) -> L::Int {
    let BodyPairW { a: VelocityW { turn: turn_a, .. }, b: VelocityW { turn: turn_b, .. } } = *pair;
    let angular = L::sub_wide(L::mul(e_b, turn_b), L::mul(e_a, turn_a));
    let wide = L::add_wide(L::mul(linear, L::splat(1 << RATIO)), angular);
    let (vr, out) = L::narrow_saturating::<RATIO>(wide);
    if L::any(out) {
        *faults += u64::from(L::count(out));
    }
    vr
}
