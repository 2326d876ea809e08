//! The contact kernel, for any number of lanes: warm start, solve, restitution.
//!
//! ```text
//! J  = (-n, -eA, n, eB)                                  rows along the normal and the tangent have this form
//! vn = J v,    s = s0 + J dx
//! w  = massScale (vn + bias) + impulseScale L,           L' = clamp(L - w, lo, hi),   d = L' - L
//! vA -= gA d n,  uA -= fA d,  vB += gB d n,  uB += fB d
//! ```
//!
//! with the gains of `row.rs`. Differences of two velocities fit because each is below 512; a sum that may not fit
//! saturates. What is below 0 in lanes that have no contact is never looked at: their gains are 0.

use core::cell::Cell;

use super::super::body::SolverBody;
use super::super::limits::{Faults, IMPULSE_MAX};
use super::super::pair::{Pair, UNIT, clamp};
use super::super::settings::Tuning;
use super::super::softness::Softness;
use super::batch::Batch;
use super::care::{Calm, Care, Careful, GRIP, calm_at};
use super::iteration::Iteration;
use super::pair::along;
use super::special::Special;
use super::{Pass, RESTITUTION_ITERATIONS, Sweep};
use crate::lanes::Lanes;
use crate::math::{Rate, Shift};

/// The constants of a tick.
#[derive(Clone, Copy)]
pub(super) struct Constants {
    /// Sub-steps per second, in the format of [`Rate`].
    pub(super) rate: i32,
    /// The widest gap or overlap whose speed fits.
    pub(super) separation_max: i32,
    pub(super) slop: i32,
    pub(super) push_speed: i32,
    restitution_threshold: i32,
    pub(super) soft: Softness,
    /// Against bodies that do not give way.
    pub(super) stiff: Softness,
    /// Whether contacts may be [`Calm`].
    calm: bool,
}

impl Constants {
    #[expect(clippy::cast_possible_truncation, reason = "a rate is at most 4000")]
    pub(super) fn new(tuning: &Tuning) -> Self {
        let widest = (1023i64 << Shift::FRAC_NBITS) / i64::from(tuning.rate);
        let rate = Rate::from_bits((i64::from(tuning.rate) << Rate::FRAC_NBITS) as i32);
        Constants {
            rate: rate.to_bits(),
            separation_max: widest.min(i64::from(i32::MAX)) as i32,
            slop: crate::math::convert::<_, fixed::types::extra::U26>(tuning.slop).to_bits(),
            push_speed: tuning.push_speed.to_bits(),
            restitution_threshold: tuning.restitution_threshold.to_bits(),
            soft: tuning.contact,
            stiff: tuning.contact_immovable,
            calm: calm_at([rate, tuning.contact.bias_rate, tuning.contact_immovable.bias_rate]),
        }
    }
}

/// The normal and the tangent of a batch.
#[inline(always)]
pub(super) fn directions<L: Lanes<N>, const N: usize>(batch: &Batch<N>) -> ([L::Int; 2], [L::Int; 2]) {
    let (x, y) = (L::load(&batch.n_x), L::load(&batch.n_y));
    ([x, y], [L::sub(L::splat(0), y), x])
}

/// Remembers how fast shapes that bounce approach, until they push each other: before anything has been solved, since
/// the impulses of one contact alone would be an approach to another.
#[inline(always)]
pub(super) fn observe<L: Lanes<N>, const N: usize>(
    batch: &Batch<N>,
    special: &mut Special<N>,
    bodies: &[Cell<SolverBody>],
    faults: &mut Faults,
) {
    let care = &mut Careful(faults);
    let pair = Pair::<L, N>::load(bodies, &batch.bodies);
    let (n, _) = directions::<L, N>(batch);
    let Special { approach, pushed, .. } = special;
    for ((point, approach), pushed) in batch.points[..batch.count].iter().zip(approach).zip(pushed) {
        let vn = pair.velocity(n, &point.normal, care);
        let pushed = L::negative(L::load(pushed));
        L::store(L::select(pushed, L::load(approach), vn), approach);
    }
}

/// Applies the impulses that were carried over.
#[inline(always)]
pub(super) fn warm_start<L: Lanes<N>, const N: usize>(
    batch: &Batch<N>,
    special: Option<&mut Special<N>>,
    bodies: &[Cell<SolverBody>],
    faults: &mut Faults,
) {
    if batch.calm {
        let mut calm = Calm::<L, N>::new();
        let pair = warm_started(batch, bodies, &mut calm);
        if calm.held() {
            pair.store(bodies, &batch.changed);
            return;
        }
    }
    let care = &mut Careful(faults);
    let mut pair: Pair<L, N> = warm_started(batch, bodies, care);
    if let Some(Special { rolls: true, rolling, .. }) = special {
        care.apply(&mut pair, &rolling.row, L::load(&rolling.lambda));
    }
    pair.store(bodies, &batch.changed);
}

#[inline(always)]
fn warm_started<L: Lanes<N>, const N: usize>(
    batch: &Batch<N>,
    bodies: &[Cell<SolverBody>],
    care: &mut impl Care<L, N>,
) -> Pair<L, N> {
    let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
    care.see(&pair);
    for point in &batch.points[..batch.count] {
        care.apply_again(&mut pair, &point.normal, L::load(&point.normal_lambda));
    }
    care.apply_again(&mut pair, &batch.tangent, L::load(&batch.tangent_lambda));
    pair
}

/// One iteration over all rows of a batch.
#[inline(always)]
pub(super) fn solve<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    mut special: Option<&mut Special<N>>,
    how: (Pass, Sweep),
    constants: &Constants,
    bodies: &[Cell<SolverBody>],
    faults: &mut Faults,
) {
    if batch.calm && constants.calm {
        let mut calm = Calm::<L, N>::new();
        let iteration = iterate(batch, None, how, constants, bodies, &mut calm);
        if calm.held() {
            iteration.store(batch, special, bodies);
            return;
        }
        // What is not calm now will hardly be later in the tick.
        batch.calm = false;
    }
    let careful = &mut Careful(faults);
    let iteration: Iteration<L, N> = iterate(batch, special.as_deref_mut(), how, constants, bodies, careful);
    iteration.store(batch, special, bodies);
}

#[inline(always)]
fn iterate<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    special: Option<&mut Special<N>>,
    (pass, sweep): (Pass, Sweep),
    constants: &Constants,
    bodies: &[Cell<SolverBody>],
    care: &mut impl Care<L, N>,
) -> Iteration<L, N> {
    if pass == Pass::Relax {
        measure_with(batch, bodies, care);
    }
    Iteration::of(batch, special, (pass, sweep), constants, bodies, care)
}

/// Finds the separations where the bodies are now.
#[inline(always)]
pub(super) fn measure<L: Lanes<N>, const N: usize>(batch: &mut Batch<N>, bodies: &[Cell<SolverBody>]) {
    // Nothing in it counts as a fault.
    measure_with::<L, N>(batch, bodies, &mut Careful(&mut 0));
}

#[inline(always)]
fn measure_with<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    bodies: &[Cell<SolverBody>],
    care: &mut impl Care<L, N>,
) {
    let (n, _) = directions::<L, N>(batch);
    let shifts = Pair::<L, N>::load_shifts(bodies, &batch.bodies);
    care.see(&shifts);
    for point in &mut batch.points[..batch.count] {
        let first = L::load(&point.first_separation);
        let change = along::<L, N>(&shifts.a, &shifts.b, n, &point.normal);
        L::store(care.moved(first, change), &mut point.separation);
    }
}

/// What each point has of the impulse along the tangent: half of it, as far as the friction of each reaches.
#[inline(always)]
pub(super) fn shares_of_friction<L: Lanes<N>, const N: usize>(batch: &Batch<N>) -> [L::Int; 2] {
    let whole = L::load(&batch.tangent_lambda);
    if batch.count != 2 {
        return [whole, L::splat(0)];
    }
    let [first, second] = &batch.points;
    let first = L::mul(L::load(&first.grip), L::load(&first.normal_lambda));
    let second = L::mul(L::load(&second.grip), L::load(&second.normal_lambda));
    let (first, _) = L::narrow_saturating::<GRIP>(first);
    let (second, _) = L::narrow_saturating::<GRIP>(second);
    let half = clamp::<L, N>(L::narrow::<1>(L::mul(whole, L::splat(1))), first);
    let rest = clamp::<L, N>(L::sub(whole, half), second);
    [L::sub(whole, rest), rest]
}

/// Once in a tick, after the sub-steps: what approached faster than the threshold and was pushed, leaves.
#[inline(always)]
pub(super) fn apply_restitution<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    special: &Special<N>,
    constants: &Constants,
    bodies: &[Cell<SolverBody>],
    faults: &mut Faults,
) {
    let care = &mut Careful(faults);
    let restitution = L::load(&special.restitution);
    let (n, _) = directions::<L, N>(batch);
    let masks = [bounces::<L, N>(special, 0, constants), bounces::<L, N>(special, 1, constants)];
    if !L::any(L::either(masks[0], masks[1])) {
        return;
    }
    let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
    for _ in 0..if batch.count == 2 { RESTITUTION_ITERATIONS } else { 1 } {
        for (i, &mask) in masks.iter().enumerate().take(batch.count) {
            let point = &mut batch.points[i];
            let bounce = L::mul(restitution, L::load(&special.approach[i]));
            let bounce = L::narrow::<UNIT>(bounce);
            let error = L::add_saturating(pair.velocity(n, &point.normal, care), bounce);
            let old = L::load(&point.normal_lambda);
            let wanted = L::max(L::sub_saturating(old, error), L::splat(0));
            let new = L::select(mask, L::min(wanted, L::splat(IMPULSE_MAX.to_bits())), old);
            L::store(new, &mut point.normal_lambda);
            care.apply(&mut pair, &point.normal, L::sub(new, old));
        }
    }
    pair.store(bodies, &batch.changed);
}

/// Whether a point approached fast enough, and was pushed.
#[inline(always)]
fn bounces<L: Lanes<N>, const N: usize>(special: &Special<N>, i: usize, constants: &Constants) -> L::Mask {
    let threshold = L::splat(1 - constants.restitution_threshold);
    let fast = L::greater(threshold, L::load(&special.approach[i]));
    let pushed = L::negative(L::load(&special.pushed[i]));
    L::both(L::both(fast, pushed), L::greater(L::load(&special.restitution), L::splat(0)))
}
