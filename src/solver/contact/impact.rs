//! Impacts of points with restitution: the time of impact within a sub-step, and the rebound until the end of the
//! sub-step.
//!
//! Semi-implicit Euler is a leapfrog scheme: the velocity that moves a body is the velocity at the middle of the
//! sub-step. With the time step `h` of a sub-step, the restitution `e`, the relative normal velocity `v` of the point,
//! its change `a` by forces in the sub-step, and the separation `s`:
//!
//! ```text
//! f  = s / (-v h)                 time of impact, as a fraction of the sub-step
//! va = v + a (f - 1/2)            velocity of approach at the impact
//! vs = -e va - a (f - 1/2)        velocity after the impact, at the middle of the sub-step
//! s' = s + v f h + vs (1 - f) h   gap at the end of the sub-step
//! ```
//!
//! With `e = 1` and a constant force, these equations conserve the energy of the leapfrog scheme, which is `v^2 / 2 + g
//! x - g h v / 2` at the height `x` under gravity `g`. Bodies move as if the impulse had acted at the time of impact,
//! so that angular momentum is conserved as well.

#[cfg(test)]
mod tests;

use super::super::batches::{BatchParts, Operation};
use super::super::context::Pass;
use super::super::pair::BodyPairW;
use super::batch::Batch;
use super::extras::ContactExtras;
use super::overflow_policy::Saturating;
use super::restitution::ELASTIC;
use super::{Constants, Contacts};
use crate::math::{Rate, Shift, Speed, Unit, mul};
use crate::simd::{Ints, Lanes};

/// Gap in metres below which a point bounces together with another point of its contact that hits. If only the point
/// that hits bounced, a box that lands not quite flat would spin.
const NEAR: Shift = Shift::lit("0.005");

#[derive(Clone, Debug)]
pub(super) struct Impacts<const N: usize> {
    /// For each point, the change `a` of its relative normal velocity by forces. Until [`PredictImpacts`] runs in the
    /// first sub-step of a tick, this is the relative normal velocity before forces act.
    forced: [Ints<N>; 2],
    /// For each point, the relative normal velocity before contacts act: `va` for a point that bounces, else `v`. A
    /// point bounces if its approach speed is at least the restitution threshold, and its gap is below [`NEAR`] at the
    /// time of the first impact.
    pub(super) approach: [Ints<N>; 2],
    /// For each point that bounces, `a (f - 1/2)` plus one unit of [`Speed`].
    pub(super) drift: [Ints<N>; 2],
    /// For each point that hits in this sub-step, `s' / h`: the speed that opens the gap `s'` within a sub-step.
    pub(super) rebound: [Ints<N>; 2],
    /// For each point, -1 where its normal impulse is positive after the bias pass.
    touches: [Ints<N>; 2],
    /// For each point of an elastic contact, -1 in the lanes in which the point is late: it does not approach before
    /// contacts act, so only another impulse can drive it to the surface. If the shapes touch or overlap, the point is
    /// late only if it separates at the restitution threshold or faster.
    late: [Ints<N>; 2],
    pub(super) slide: Ints<N>,
    /// `f` times the tangential velocity `slide`: the sliding before the impact, when friction does not act yet.
    pub(super) slip: Ints<N>,
}

impl<const N: usize> Impacts<N> {
    pub(super) const NONE: Self = Impacts {
        forced: [Ints::ZERO; 2],
        approach: [Ints::ZERO; 2],
        drift: [Ints::ZERO; 2],
        rebound: [Ints::ZERO; 2],
        touches: [Ints::ZERO; 2],
        late: [Ints::ZERO; 2],
        slide: Ints::ZERO,
        slip: Ints::ZERO,
    };

    #[inline(always)]
    pub(super) fn record_touches<L: Lanes<N>>(&mut self, batch: &Batch<N>) {
        for (point, touches) in batch.points[..batch.count].iter().zip(&mut self.touches) {
            L::store(L::to_int(L::greater(L::load(&point.normal_lambda), L::splat(0))), touches);
        }
    }

    /// The impact of a point. In the relax pass, only points with a positive normal impulse after the bias pass
    /// rebound.
    #[inline(always)]
    pub(super) fn of_point<L: Lanes<N>>(&self, i: usize, pass: Pass) -> PointImpact<L, N> {
        let rebound = L::load(&self.rebound[i]);
        let rebound = match pass {
            Pass::Bias => rebound,
            Pass::Relax => L::select(L::negative(L::load(&self.touches[i])), rebound, L::splat(0)),
        };
        PointImpact { rebound, late: L::negative(L::load(&self.late[i])) }
    }
}

#[derive(Clone, Copy)]
pub(super) struct PointImpact<L: Lanes<N>, const N: usize> {
    /// `s' / h`, or 0 for a point that does not hit in this sub-step.
    pub(super) rebound: L::Int,
    /// See [`Impacts::late`]. If another impulse drives a late point to the surface, the relax pass removes the impulse
    /// of the late point. In the next sub-step the point approaches and may bounce.
    pub(super) late: L::Mask,
}

impl<L: Lanes<N>, const N: usize> PointImpact<L, N> {
    #[inline(always)]
    pub(super) fn none() -> Self {
        PointImpact { rebound: L::splat(0), late: L::greater(L::splat(0), L::splat(0)) }
    }
}

/// Measures relative normal velocities before forces act in a tick. Counts no faults: a contact without extras is
/// measured only if it shares a batch with a contact that has extras, and the number of faults must not depend on which
/// contacts share a batch.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct MeasureApproach;

impl Operation<Contacts> for MeasureApproach {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, extra: Some(extras), bodies, .. } = parts else { return };
        let mut unread = 0;
        let policy = &mut Saturating::<L, N>::new(&mut unread);
        let pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
        let (n, _) = batch.directions::<L>();
        for (point, forced) in batch.points[..batch.count].iter().zip(&mut extras.impacts.forced) {
            L::store(pair.velocity(n, &point.normal, policy), forced);
        }
    }
}

/// Predicts the impacts of a sub-step, from the velocities after forces have acted. Counts no faults, like
/// [`MeasureApproach`].
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct PredictImpacts {
    pub(in crate::solver) constants: Constants,
    pub(in crate::solver) is_first: bool,
}

impl Operation<Contacts> for PredictImpacts {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, extra: Some(extras), bodies, .. } = parts else { return };
        let mut unread = 0;
        let policy = &mut Saturating::<L, N>::new(&mut unread);
        let pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
        let (n, t) = batch.directions::<L>();
        let restitution = L::load(&extras.restitution);
        let elastic = L::greater(restitution, L::splat(ELASTIC.to_bits()));
        let bounces = L::greater(restitution, L::splat(0));
        let threshold = L::sub(L::splat(1), L::load(&extras.restitution_threshold));
        extras.begin_sub_step();
        let mut fast = L::greater(L::splat(0), L::splat(0));
        let mut late = fast;
        for (i, point) in batch.points[..batch.count].iter().enumerate() {
            let v = pair.velocity(n, &point.normal, policy);
            L::store(v, &mut extras.impacts.approach[i]);
            if self.is_first {
                let forced = L::sub_saturating(v, L::load(&extras.impacts.forced[i]));
                L::store(forced, &mut extras.impacts.forced[i]);
            }
            fast = L::either(fast, L::both(bounces, L::greater(threshold, v)));
            // Shapes that rest on each other may separate in single sub-steps, more slowly than the threshold.
            let gap = L::greater(L::load(&point.separation), L::splat(0));
            let least = L::select(gap, L::splat(0), L::load(&extras.restitution_threshold));
            let is_late = L::both(elastic, L::greater(v, L::sub(least, L::splat(1))));
            L::store(L::to_int(is_late), &mut extras.impacts.late[i]);
            late = L::either(late, is_late);
        }
        batch.unchecked &= !L::any(L::either(fast, late));
        if !L::any(fast) {
            return;
        }
        L::store(pair.velocity(t, &batch.tangent, policy), &mut extras.impacts.slide);
        let rate = Rate::from_bits(self.constants.rate);
        let fast = L::bits(fast);
        for lane in (0..N).filter(|lane| fast >> lane & 1 == 1) {
            extras.predict(batch, lane, rate);
        }
    }
}

impl<const N: usize> ContactExtras<N> {
    /// Resets the fields that are read even for points without an impact.
    #[inline(always)]
    fn begin_sub_step(&mut self) {
        self.impacts.drift = [Ints::ZERO; 2];
        self.impacts.rebound = [Ints::ZERO; 2];
        self.impacts.slip = Ints::ZERO;
        self.bounce = [Ints::ZERO; 2];
    }

    fn predict(&mut self, batch: &Batch<N>, lane: usize, rate: Rate) {
        let speed = |of: &Ints<N>| Speed::from_bits(of.0[lane]);
        let restitution = Unit::from_bits(self.restitution.0[lane]);
        let threshold = speed(&self.restitution_threshold);
        let impacts = &mut self.impacts;
        let is_fast = |v: Speed| v.is_negative() && v <= -threshold;
        let velocities = [speed(&impacts.approach[0]), speed(&impacts.approach[1])];
        let points = (0..batch.count).filter(|&i| restitution > 0 && is_fast(velocities[i]));
        let closing = |i: usize| -> Speed { mul(Shift::from_bits(batch.points[i].separation.0[lane]), rate) };
        let Some(time) = points.clone().map(|i| time_of_impact(closing(i), velocities[i])).min() else {
            return;
        };
        let near: Speed = mul(NEAR, rate);
        for i in points {
            let v = velocities[i];
            let gap = closing(i).saturating_add(mul(v, time));
            if gap >= near {
                continue;
            }
            let impact = Impact::of(v, speed(&impacts.forced[i]), time, restitution);
            impacts.approach[i].0[lane] = impact.approach.to_bits();
            impacts.drift[i].0[lane] = impact.drift.to_bits();
            if is_fast(impact.approach) && time < Unit::ONE {
                let rebound = gap.saturating_add(mul(impact.after, Unit::ONE - time));
                impacts.rebound[i].0[lane] = rebound.to_bits();
                let slip: Speed = mul(speed(&impacts.slide), time);
                impacts.slip.0[lane] = slip.to_bits();
            }
        }
    }
}

/// The time of impact `f`, clamped to the range from 0 to 1. `closing` is `s / h`, and `v` is negative.
fn time_of_impact(closing: Speed, v: Speed) -> Unit {
    let one = i64::from(Unit::ONE.to_bits());
    let time = i64::from(closing.to_bits()) * one / -i64::from(v.to_bits());
    #[expect(clippy::cast_possible_truncation, reason = "clamped to the bits of a number from 0 to 1")]
    Unit::from_bits(time.clamp(0, one) as i32)
}

#[derive(Clone, Copy, Debug)]
struct Impact {
    /// `va`: the velocity of approach at the impact.
    approach: Speed,
    /// `a (f - 1/2)`, plus one unit of [`Speed`].
    drift: Speed,
    /// `vs`: the velocity after the impact.
    after: Speed,
}

impl Impact {
    /// The velocities of an impact at the time `f`. `forced` is the part of `v` that forces have added.
    fn of(v: Speed, forced: Speed, time: Unit, restitution: Unit) -> Self {
        let drift: Speed = mul(forced, time - Unit::lit("0.5"));
        let approach = v.saturating_add(drift);
        let bounce: Speed = mul(restitution, approach);
        // Rounding must not add energy.
        let drift = drift.saturating_add(Speed::DELTA);
        let after = bounce.saturating_add(drift).saturating_neg().max(Speed::ZERO);
        Impact { approach, drift, after }
    }
}
