//! The contact kernel, for any number of lanes: warm start, solve, restitution.
//!
//! ```text
//! J  = (-n, -eA, n, eB)                                  both rows of a point have this form
//! vn = J v,    s = s0 + J dx
//! w  = massScale (vn + bias) + impulseScale L,           L' = clamp(L - w, lo, hi),   d = L' - L
//! vA -= gA d n,  uA -= fA d,  vB += gB d n,  uB += fB d
//! ```
//!
//! with the gains of `row.rs`. Differences of two velocities fit because each is below 512; a sum that may not fit
//! saturates. What is below 0 in lanes that have no contact is never looked at: their gains are 0.

use core::cell::Cell;

use super::super::body::SolverBody;
use super::super::lanes::{Ints, Lanes};
use super::super::limits::{Faults, IMPULSE_MAX};
use super::super::pair::{Pair, RATIO, UNIT, clamp, shift};
use super::super::settings::Tuning;
use super::super::softness::Softness;
use super::batch::{Batch, Point};
use super::pair::along;
use super::rolling::RollingRows;
use super::special::Special;
use super::{NORMAL_ROUNDS_MAX, Pass, RESTITUTION_ITERATIONS, SETTLED, Sweep, TANGENT_MAX};
use crate::math::{Grip, Rate, Shift, Speed, Unit};

/// The constants of a tick.
#[derive(Clone, Copy)]
pub(super) struct Constants {
    /// Sub-steps per second, in the format of [`Rate`].
    rate: i32,
    /// The widest gap or overlap whose speed fits.
    separation_max: i32,
    slop: i32,
    push_speed: i32,
    restitution_threshold: i32,
    soft: Softness,
    /// Against bodies that do not give way.
    stiff: Softness,
}

impl Constants {
    #[expect(clippy::cast_possible_truncation, reason = "a rate is at most 4000")]
    pub(super) fn new(tuning: &Tuning) -> Self {
        let widest = (1023i64 << Shift::FRAC_NBITS) / i64::from(tuning.rate);
        Constants {
            rate: (i64::from(tuning.rate) << Rate::FRAC_NBITS) as i32,
            separation_max: widest.min(i64::from(i32::MAX)) as i32,
            slop: crate::math::convert::<_, fixed::types::extra::U26>(tuning.slop).to_bits(),
            push_speed: tuning.push_speed.to_bits(),
            restitution_threshold: tuning.restitution_threshold.to_bits(),
            soft: tuning.contact,
            stiff: tuning.contact_immovable,
        }
    }
}

/// The normal and the tangent of a batch.
#[inline(always)]
fn directions<L: Lanes<N>, const N: usize>(batch: &Batch<N>) -> ([L::Int; 2], [L::Int; 2]) {
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
    let pair = Pair::<L, N>::load(bodies, &batch.bodies);
    let (n, _) = directions::<L, N>(batch);
    let Special { approach, pushed, .. } = special;
    for ((point, approach), pushed) in batch.points[..batch.count].iter().zip(approach).zip(pushed) {
        let vn = pair.velocity(n, &point.normal, faults);
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
    let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
    for point in &batch.points[..batch.count] {
        pair.apply(&point.normal, L::load(&point.normal_lambda), faults);
        pair.apply(&point.tangent, L::load(&point.tangent_lambda), faults);
    }
    if let Some(Special { rolls: true, rolling, .. }) = special {
        pair.apply(&rolling.row, L::load(&rolling.lambda), faults);
    }
    pair.store(bodies, &batch.changed);
}

/// One iteration over all rows of a batch.
#[inline(always)]
pub(super) fn solve<L: Lanes<N>, const N: usize>(
    batch: &mut Batch<N>,
    special: Option<&mut Special<N>>,
    (pass, sweep): (Pass, Sweep),
    constants: &Constants,
    bodies: &[Cell<SolverBody>],
    faults: &mut Faults,
) {
    let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
    let (n, t) = directions::<L, N>(batch);
    if pass == Pass::Relax {
        measure::<L, N>(batch, bodies);
    }
    let context = Context::<L, N>::new(batch, pass, constants);
    let (first, second) = match (sweep, batch.count) {
        (Sweep::Backward, 2) => (1, 0),
        _ => (0, 1),
    };
    let all = L::greater(L::splat(1), L::splat(0));
    if batch.count == 2 {
        let mut unsettled = all;
        for _ in 0..NORMAL_ROUNDS_MAX {
            context.solve_normal(batch, first, n, unsettled, &mut pair, faults);
            let d = context.solve_normal(batch, second, n, unsettled, &mut pair, faults);
            let settled = L::splat(SETTLED.to_bits() - 1);
            let moved = L::either(L::greater(d, settled), L::greater(L::sub(L::splat(0), settled), d));
            unsettled = L::both(unsettled, moved);
            if !L::any(unsettled) {
                break;
            }
        }
    } else {
        context.solve_normal(batch, 0, n, all, &mut pair, faults);
    }
    let mut surface_speed = L::splat(0);
    if let Some(special) = special {
        surface_speed = L::load(&special.surface_speed);
        remember_pushes::<L, N>(batch, special);
        if special.rolls {
            solve_rolling::<L, N>(&mut special.rolling, &batch.points, &mut pair, faults);
        }
    }
    solve_tangent::<L, N>(&mut batch.points[first], t, surface_speed, &mut pair, faults);
    if batch.count == 2 {
        solve_tangent::<L, N>(&mut batch.points[second], t, surface_speed, &mut pair, faults);
    }
    pair.store(bodies, &batch.changed);
}

/// Of what bounces, which points have pushed.
#[inline(always)]
fn remember_pushes<L: Lanes<N>, const N: usize>(batch: &Batch<N>, special: &mut Special<N>) {
    for (point, pushed) in batch.points[..batch.count].iter().zip(&mut special.pushed) {
        let pushes = L::to_int(L::greater(L::load(&point.normal_lambda), L::splat(0)));
        L::store(L::or(L::load(pushed), pushes), pushed);
    }
}

/// Finds the separations where the bodies are now.
#[inline(always)]
pub(super) fn measure<L: Lanes<N>, const N: usize>(batch: &mut Batch<N>, bodies: &[Cell<SolverBody>]) {
    let (n, _) = directions::<L, N>(batch);
    let (a, b) = (L::shifts(bodies, &batch.bodies[0]), L::shifts(bodies, &batch.bodies[1]));
    for point in &mut batch.points[..batch.count] {
        let moved = along::<L, N>(&a, &b, n, &point.normal);
        let (moved, _) = L::narrow_saturating::<RATIO>(moved);
        L::store(L::add_saturating(L::load(&point.first_separation), moved), &mut point.separation);
    }
}

/// What the normal rows of a batch have in common in a pass.
struct Context<L: Lanes<N>, const N: usize> {
    pass: Pass,
    rate: L::Int,
    separation_max: L::Int,
    slop: L::Int,
    push_speed: L::Int,
    bias_rate: L::Int,
    mass_scale: L::Int,
    impulse_scale: L::Int,
}

impl<L: Lanes<N>, const N: usize> Context<L, N> {
    #[inline(always)]
    fn new(batch: &Batch<N>, pass: Pass, constants: &Constants) -> Self {
        let &Constants { rate, separation_max, slop, push_speed, soft, stiff, .. } = constants;
        let immovable = L::negative(L::load(&batch.immovable));
        Context {
            pass,
            rate: L::splat(rate),
            separation_max: L::splat(separation_max),
            slop: L::splat(slop),
            push_speed: L::splat(-push_speed),
            bias_rate: chosen::<L, N>(immovable, soft.bias_rate.to_bits(), stiff.bias_rate.to_bits()),
            mass_scale: chosen::<L, N>(immovable, soft.mass_scale.to_bits(), stiff.mass_scale.to_bits()),
            impulse_scale: chosen::<L, N>(
                immovable,
                soft.impulse_scale.to_bits(),
                stiff.impulse_scale.to_bits(),
            ),
        }
    }

    /// The bodies may touch here but not overlap. Returns the change of impulse. Lanes that are not `active` keep
    /// theirs.
    #[inline(always)]
    fn solve_normal(
        &self,
        batch: &mut Batch<N>,
        place: usize,
        n: [L::Int; 2],
        active: L::Mask,
        pair: &mut Pair<L, N>,
        faults: &mut Faults,
    ) -> L::Int {
        let Batch { points, pushed, .. } = batch;
        let point = &mut points[place];
        let vn = pair.velocity(n, &point.normal, faults);
        let old = L::load(&point.normal_lambda);
        let separation = L::load(&point.separation);
        let gap = L::greater(separation, L::splat(0));
        let (w, frozen) = match self.pass {
            Pass::Bias => {
                let error = L::add_saturating(vn, self.bias(separation, gap));
                let mass_scale = L::select(gap, L::splat(Unit::ONE.to_bits()), self.mass_scale);
                let impulse_scale = L::select(gap, L::splat(0), self.impulse_scale);
                let wide = L::add_wide(L::mul(mass_scale, error), L::mul(impulse_scale, old));
                (L::narrow::<UNIT>(wide), None)
            }
            // A gap that the bias pass has not closed is left to the next sub-step: to slow an approach down before
            // it arrives, and to bounce there, would make a ball rebound from above the floor.
            Pass::Relax => {
                let speed = L::select(gap, self.speed_of(separation, self.rate), L::splat(0));
                let untouched = L::both(gap, L::greater(L::splat(1), old));
                (L::add_saturating(vn, speed), Some(untouched))
            }
        };
        let wanted = L::max(L::sub_saturating(old, w), L::splat(0));
        let over = L::greater(wanted, L::splat(IMPULSE_MAX.to_bits()));
        if L::any(over) {
            *faults += u64::from(L::count(over));
        }
        let new = L::min(wanted, L::splat(IMPULSE_MAX.to_bits()));
        let new = frozen.map_or(new, |frozen| L::select(frozen, old, new));
        let new = L::select(active, new, old);
        L::store(new, &mut point.normal_lambda);
        pushed[place] |= L::bits(L::greater(new, L::splat(0)));
        let d = L::sub(new, old);
        pair.apply(&point.normal, d, faults);
        d
    }

    /// The velocity that a separation asks for: a gap may close within this sub-step, but not more; an overlap is pushed
    /// out slowly.
    #[inline(always)]
    fn bias(&self, separation: L::Int, gap: L::Mask) -> L::Int {
        let overlap = L::min(L::add_saturating(separation, self.slop), L::splat(0));
        let distance = L::select(gap, separation, overlap);
        L::max(self.speed_of(distance, L::select(gap, self.rate, self.bias_rate)), self.push_speed)
    }

    #[inline(always)]
    fn speed_of(&self, distance: L::Int, rate: L::Int) -> L::Int {
        const EXTRA: i32 = shift(Shift::FRAC_NBITS + Rate::FRAC_NBITS - Speed::FRAC_NBITS);
        L::narrow::<EXTRA>(L::mul(clamp::<L, N>(distance, self.separation_max), rate))
    }
}

/// Coulomb: friction stops sliding, as far as it reaches.
#[inline(always)]
fn solve_tangent<L: Lanes<N>, const N: usize>(
    point: &mut Point<N>,
    t: [L::Int; 2],
    surface_speed: L::Int,
    pair: &mut Pair<L, N>,
    faults: &mut Faults,
) {
    let vt = L::add_saturating(pair.velocity(t, &point.tangent, faults), surface_speed);
    let limit = limit::<L, N>(&point.grip, &point.normal_lambda);
    let old = L::load(&point.tangent_lambda);
    let new = clamp::<L, N>(L::sub_saturating(old, vt), limit);
    L::store(new, &mut point.tangent_lambda);
    pair.apply(&point.tangent, L::sub(new, old), faults);
}

/// What a normal impulse lets a row do that it limits.
#[inline(always)]
fn limit<L: Lanes<N>, const N: usize>(grip: &Ints<N>, normal_lambda: &Ints<N>) -> L::Int {
    let wide = L::mul(L::load(grip), L::load(normal_lambda));
    let (limit, _) = L::narrow_saturating::<{ shift(Grip::FRAC_NBITS) }>(wide);
    L::min(limit, L::splat(TANGENT_MAX.to_bits()))
}

#[inline(always)]
fn solve_rolling<L: Lanes<N>, const N: usize>(
    rolling: &mut RollingRows<N>,
    points: &[Point<N>; 2],
    pair: &mut Pair<L, N>,
    faults: &mut Faults,
) {
    let still = [L::splat(0); 2];
    let vn = pair.velocity(still, &rolling.row, faults);
    let first = limit::<L, N>(&rolling.grips[0], &points[0].normal_lambda);
    let second = limit::<L, N>(&rolling.grips[1], &points[1].normal_lambda);
    let limit = L::min(L::add_saturating(first, second), L::splat(TANGENT_MAX.to_bits()));
    let old = L::load(&rolling.lambda);
    let new = clamp::<L, N>(L::sub_saturating(old, vn), limit);
    L::store(new, &mut rolling.lambda);
    pair.apply(&rolling.row, L::sub(new, old), faults);
}

/// A number for contacts between bodies that give way, another for the others.
#[inline(always)]
fn chosen<L: Lanes<N>, const N: usize>(immovable: L::Mask, soft: i32, stiff: i32) -> L::Int {
    L::select(immovable, L::splat(stiff), L::splat(soft))
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
    let restitution = L::load(&special.restitution);
    let (n, _) = directions::<L, N>(batch);
    let masks = [bounces::<L, N>(special, 0, constants), bounces::<L, N>(special, 1, constants)];
    if !L::any(L::either(masks[0], masks[1])) {
        return;
    }
    let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
    for _ in 0..if batch.count == 2 { RESTITUTION_ITERATIONS } else { 1 } {
        let points = batch.points[..batch.count].iter_mut();
        for ((point, approach), &mask) in points.zip(&special.approach).zip(&masks) {
            let bounce = L::mul(restitution, L::load(approach));
            let bounce = L::narrow::<UNIT>(bounce);
            let error = L::add_saturating(pair.velocity(n, &point.normal, faults), bounce);
            let old = L::load(&point.normal_lambda);
            let wanted = L::max(L::sub_saturating(old, error), L::splat(0));
            let new = L::select(mask, L::min(wanted, L::splat(IMPULSE_MAX.to_bits())), old);
            L::store(new, &mut point.normal_lambda);
            pair.apply(&point.normal, L::sub(new, old), faults);
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
