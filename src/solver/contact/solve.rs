//! Solve: one iteration over the rows of a batch. The normals come first, because their impulses limit rolling
//! resistance and friction.
//!
//! ```text
//! bias pass    w = massScale (vn + bias(s)) + impulseScale L        bias(s) = s / h            for a gap
//!                                                                   max(rate min(s + slop, 0), -push) for an overlap
//!              a gap, a bounce and a fast impact (IMPACT_SPEED) are rigid: massScale = 1, impulseScale = 0
//!              s - s' takes the place of s for a point that bounces (`impact.rs`)
//! relax pass   w = vn + s / h for a gap with an impulse, vn for an overlap or a point that bounces
//!              L' = L for a gap without an impulse, 0 for a late point (`impact.rs`)
//! normal       L' = max(L - w, 0)
//! friction     |L'| <= sum of (mu Dt / Dn) Ln over the points,   w = vt + surface speed
//! rolling      the same limit with the friction ratios of `rolling`,   w = vn
//! ```

use core::cell::Cell;

use super::super::batches::{BatchParts, Operation};
use super::super::body::SolverBody;
use super::super::context::{Pass, SolverPass};
use super::super::pair::{BodyPairW, UNIT, beyond, clamp, shift};
use super::batch::{Batch, Point};
use super::extras::ContactExtras;
use super::impact::PointImpact;
use super::measure::measure;
use super::overflow_policy::{OverflowPolicy, Saturating, Unchecked};
use super::{Constants, Contacts, TANGENT_MAX};
use crate::math::{Rate, Shift, Speed, Unit};
use crate::simd::{Ints, Lanes};

/// Maximum number of rounds in which the two points of a contact are solved against each other. With a single round, an
/// impact would turn the body: ten boxes that fall on each other from 5 or 10 mm would sway by 12 mm instead of 1 mm.
/// In a pile at rest one round is usually enough, so that the limit of four rounds costs little: a pyramid of 5050
/// boxes takes a tenth more time than with a limit of one round.
const NORMAL_ROUNDS_MAX: u32 = 4;

/// Change of the second point's impulse, in m/s, below which the points are not solved again.
const SETTLED: Speed = Speed::lit("0.005");

/// Normal velocity, in m/s, below which an overlap with a body that no impulse moves is rigid, if the other body has an
/// impact ([`super::ActiveContact::is_impact`]). A soft contact would remove only a part of the approach velocity. If
/// the other body has no impact, the velocity comes from other constraints, against which a rigid contact would work: a
/// wheel on a fixed axle that overlaps the ground would shake.
const IMPACT_SPEED: Speed = Speed::lit("-1");

/// Order in which the two points of a contact are solved. Solving the first point turns the body a little before the
/// second point is solved. With a fixed order, a stack of ten boxes sways by 4.7 mm while it settles, instead of 0.05
/// mm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solver) enum PointOrder {
    Forward,
    Backward,
}

impl PointOrder {
    /// The order alternates with every sub-step and with every iteration.
    pub(in crate::solver) const fn of(sub_step: u64, iteration: u32) -> Self {
        if sub_step % 2 == iteration as u64 % 2 { PointOrder::Forward } else { PointOrder::Backward }
    }
}

/// One iteration of a pass. The relax pass measures the separations, which the bias pass of the next sub-step uses as
/// well, because no body moves in between.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Solve<P> {
    pub(in crate::solver) pass: P,
    pub(in crate::solver) order: PointOrder,
    pub(in crate::solver) constants: Constants,
}

impl<P: SolverPass> Operation<Contacts> for Solve<P> {
    /// An unchecked batch is first solved without overflow checks, and again with checks if a number was out of bounds.
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let BatchParts { batch, extra: mut extras, bodies, faults, .. } = parts;
        if batch.unchecked && self.constants.unchecked {
            let mut unchecked = Unchecked::<L, N>::new();
            let solved = self.iterate(batch, None, bodies, &mut unchecked);
            if unchecked.held() {
                solved.store(batch, bodies);
                return;
            }
            // The batch is likely to be out of bounds again in this tick.
            batch.unchecked = false;
        }
        let saturating = &mut Saturating::<L, N>::new(faults);
        let solved: Solved<L, N> = self.iterate(batch, extras.as_deref_mut(), bodies, saturating);
        solved.store(batch, bodies);
        if let (Some(extras), Pass::Bias) = (extras, self.pass.kind()) {
            extras.impacts.record_touches::<L>(batch);
        }
    }
}

struct Solved<L: Lanes<N>, const N: usize> {
    /// Indices of the points in the order in which they were solved. `normal_lambdas` has the same order.
    places: [usize; 2],
    normal_lambdas: [L::Int; 2],
    tangent_lambda: L::Int,
    pair: BodyPairW<L, N>,
}

impl<P: SolverPass> Solve<P> {
    /// Solves one iteration. `extras` is `None` without overflow checks.
    #[inline(always)]
    fn iterate<L: Lanes<N>, C: OverflowPolicy<L, N>, const N: usize>(
        self,
        batch: &mut Batch<N>,
        extras: Option<&mut ContactExtras<N>>,
        bodies: &[Cell<SolverBody>],
        policy: &mut C,
    ) -> Solved<L, N> {
        if self.pass.kind() == Pass::Relax {
            measure(batch, bodies, policy);
        }
        let mut pair = BodyPairW::<L, N>::load(bodies, &batch.bodies);
        policy.see(&pair);
        let (n, t) = batch.directions::<L>();
        let places = match (self.order, batch.count) {
            (PointOrder::Backward, 2) => [1, 0],
            _ => [0, 1],
        };
        let points = [&batch.points[places[0]], &batch.points[places[1]]];
        let normals = Normals::<L, N>::new(batch, self.pass.kind(), &self.constants, n);
        let every = every::<L, N>();
        points[0].show_to(policy);
        let impacts = match &extras {
            Some(extras) => {
                let [first, second] = places;
                let impacts = &extras.impacts;
                [
                    impacts.of_point::<L>(first, self.pass.kind()),
                    impacts.of_point::<L>(second, self.pass.kind()),
                ]
            }
            None => [PointImpact::none(); 2],
        };
        let normal_lambdas = if batch.count == 2 {
            points[1].show_to(policy);
            let both = L::negative(L::load(&batch.both));
            let present = if places[0] == 0 { [every, both] } else { [both, every] };
            normals.solve_both(points, impacts, present, &mut pair, policy)
        } else {
            let old = L::load(&points[0].normal_lambda);
            [
                normals.solve((points[0], impacts[0]), [old, L::splat(0)], every, &mut pair, policy),
                L::splat(0),
            ]
        };
        let mut surface_speed = L::splat(0);
        let mut pressing = normal_lambdas;
        if let Some(extras) = extras {
            surface_speed = L::load(&extras.surface_speed);
            if self.pass.kind() == Pass::Bias {
                // Friction acts only after the time of impact. Its limit does not include the impulse of restitution.
                surface_speed = C::sub(surface_speed, L::load(&extras.impacts.slip));
                for (pressing, impact) in pressing.iter_mut().zip(&impacts) {
                    *pressing = L::max(C::sub(*pressing, impact.rebound), L::splat(0));
                }
            }
            if extras.rolls {
                let friction_ratios =
                    [&extras.rolling.friction_ratios[places[0]], &extras.rolling.friction_ratios[places[1]]];
                let limit = limit::<L, C, N>(friction_ratios, pressing);
                extras.rolling.solve(limit, &mut pair, policy);
            }
        }
        // Coulomb friction.
        let vt = C::add(pair.velocity(t, &batch.tangent, policy), surface_speed);
        let limit = limit::<L, C, N>([&points[0].friction_ratio, &points[1].friction_ratio], pressing);
        let old = L::load(&batch.tangent_lambda);
        policy.see_impulse(old);
        let tangent_lambda = clamp::<L, N>(C::sub(old, vt), limit);
        policy.apply(&mut pair, &batch.tangent, L::sub(tangent_lambda, old));
        Solved { places, normal_lambdas, tangent_lambda, pair }
    }
}

impl<const N: usize> Point<N> {
    #[inline(always)]
    fn show_to<L: Lanes<N>>(&self, policy: &mut impl OverflowPolicy<L, N>) {
        policy.see_impulse(L::load(&self.normal_lambda));
        policy.see_separation(L::load(&self.separation));
    }
}

impl<L: Lanes<N>, const N: usize> Solved<L, N> {
    #[inline(always)]
    fn store(self, batch: &mut Batch<N>, bodies: &[Cell<SolverBody>]) {
        let Solved { places, normal_lambdas, tangent_lambda, pair } = self;
        batch.push::<L>(places[0], normal_lambdas[0]);
        if batch.count == 2 {
            batch.push::<L>(places[1], normal_lambdas[1]);
        }
        L::store(tangent_lambda, &mut batch.tangent_lambda);
        pair.store(bodies, &batch.changed);
    }
}

/// The parameters of the normal rows of a batch in a pass.
struct Normals<L: Lanes<N>, const N: usize> {
    pass: Pass,
    n: [L::Int; 2],
    rate: L::Int,
    separation_max: L::Int,
    slop: L::Int,
    push_speed: L::Int,
    bias_rate: L::Int,
    mass_scale: L::Int,
    impulse_scale: L::Int,
    /// Normal velocity below which an overlap is rigid.
    impact_speed: L::Int,
}

impl<L: Lanes<N>, const N: usize> Normals<L, N> {
    #[inline(always)]
    fn new(batch: &Batch<N>, pass: Pass, constants: &Constants, n: [L::Int; 2]) -> Self {
        let &Constants { rate, separation_max, slop, push_speed, soft, stiff, .. } = constants;
        let immovable = L::load(&batch.immovable);
        let impact = L::greater(L::splat(-1), immovable);
        let immovable = L::negative(immovable);
        let (soft_impulse, stiff_impulse) = (soft.impulse_scale.to_bits(), stiff.impulse_scale.to_bits());
        Normals {
            pass,
            n,
            rate: L::splat(rate),
            separation_max: L::splat(separation_max),
            slop: L::splat(slop),
            push_speed: L::splat(-push_speed),
            bias_rate: chosen::<L, N>(immovable, soft.bias_rate.to_bits(), stiff.bias_rate.to_bits()),
            mass_scale: chosen::<L, N>(immovable, soft.mass_scale.to_bits(), stiff.mass_scale.to_bits()),
            impulse_scale: chosen::<L, N>(immovable, soft_impulse, stiff_impulse),
            impact_speed: chosen::<L, N>(impact, i32::MIN, IMPACT_SPEED.to_bits()),
        }
    }

    /// Solves two points against each other, until the impulse of the second changes by less than [`SETTLED`], in up to
    /// [`NORMAL_ROUNDS_MAX`] rounds. For each point, `present` is the mask of the lanes that have this point. Returns
    /// the impulses of both points.
    #[inline(always)]
    fn solve_both<C: OverflowPolicy<L, N>>(
        &self,
        [first, second]: [&Point<N>; 2],
        impacts: [PointImpact<L, N>; 2],
        present: [L::Mask; 2],
        pair: &mut BodyPairW<L, N>,
        policy: &mut C,
    ) -> [L::Int; 2] {
        let (first, second) = ((first, impacts[0]), (second, impacts[1]));
        policy.count_faults_in(present[0]);
        let old = L::load(&second.0.normal_lambda);
        let mut one = self.solve(first, [L::load(&first.0.normal_lambda), old], present[0], pair, policy);
        policy.count_faults_in(present[1]);
        let mut two = self.solve(second, [old, one], present[1], pair, policy);
        let both = L::both(present[0], present[1]);
        let settled = L::splat(SETTLED.to_bits() - 1);
        let mut unsettled = L::both(beyond::<L, N>(L::sub(two, old), settled), both);
        for _ in 1..NORMAL_ROUNDS_MAX {
            if !L::any(unsettled) {
                break;
            }
            // Faults count only in unsettled lanes, because their number must not depend on the contacts that share a
            // batch.
            policy.count_faults_in(unsettled);
            one = self.solve(first, [one, two], unsettled, pair, policy);
            let old = two;
            two = self.solve(second, [old, one], unsettled, pair, policy);
            unsettled = L::both(unsettled, beyond::<L, N>(L::sub(two, old), settled));
        }
        policy.count_faults_in(every::<L, N>());
        [one, two]
    }

    /// The contact equation. Solves a point in the given lanes: computes the impulse that it should have instead of
    /// `old`, and applies the difference. `other` is the impulse of the other point: a point with a rebound bounces if
    /// it needs an impulse or if either point already has one.
    #[inline(always)]
    fn solve<C: OverflowPolicy<L, N>>(
        &self,
        (point, PointImpact { rebound, late }): (&Point<N>, PointImpact<L, N>),
        [old, other]: [L::Int; 2],
        lanes: L::Mask,
        pair: &mut BodyPairW<L, N>,
        policy: &mut C,
    ) -> L::Int {
        let vn = pair.velocity(self.n, &point.normal, policy);
        let separation = L::load(&point.separation);
        let gap = L::greater(separation, L::splat(0));
        let wanted = match self.pass {
            Pass::Bias => {
                let error = C::add(vn, self.bias::<C>(separation, gap));
                let touches = L::either(L::negative(error), L::greater(L::max(old, other), L::splat(0)));
                let bounces = L::both(L::greater(rebound, L::splat(0)), touches);
                let error = L::select(bounces, C::sub(error, rebound), error);
                let rigid = L::either(L::either(gap, bounces), L::greater(self.impact_speed, vn));
                let mass_scale = L::select(rigid, L::splat(Unit::ONE.to_bits()), self.mass_scale);
                let impulse_scale = L::select(rigid, L::splat(0), self.impulse_scale);
                let wide = L::add_wide(L::mul(mass_scale, error), L::mul(impulse_scale, old));
                policy.impulse(L::max(C::sub(old, L::narrow::<UNIT>(wide)), L::splat(0)))
            }
            // The relax pass leaves out a point with a gap and without an impulse. If it slowed such a point before the
            // gap is closed, a ball would rebound from above the floor.
            Pass::Relax => {
                let approaches = L::both(gap, L::greater(L::splat(1), rebound));
                let speed = L::select(approaches, self.speed_of::<C>(separation, self.rate), L::splat(0));
                let untouched = L::both(approaches, L::greater(L::splat(1), old));
                let wanted = policy.impulse(L::max(C::sub(old, C::add(vn, speed)), L::splat(0)));
                L::select(untouched, old, L::select(late, L::splat(0), wanted))
            }
        };
        let new = L::select(lanes, wanted, old);
        policy.apply(pair, &point.normal, L::sub(new, old));
        new
    }

    /// The bias velocity for a separation. A gap may close within this sub-step, but not turn into an overlap.
    #[inline(always)]
    fn bias<C: OverflowPolicy<L, N>>(&self, separation: L::Int, gap: L::Mask) -> L::Int {
        let overlap = L::min(C::add(separation, self.slop), L::splat(0));
        let distance = L::select(gap, separation, overlap);
        L::max(self.speed_of::<C>(distance, L::select(gap, self.rate, self.bias_rate)), self.push_speed)
    }

    #[inline(always)]
    fn speed_of<C: OverflowPolicy<L, N>>(&self, distance: L::Int, rate: L::Int) -> L::Int {
        const EXTRA: i32 = shift(Shift::FRAC_NBITS + Rate::FRAC_NBITS - Speed::FRAC_NBITS);
        L::narrow::<EXTRA>(L::mul(C::clamp(distance, self.separation_max), rate))
    }
}

/// Limit of the impulse of a friction or rolling row.
#[inline(always)]
fn limit<L: Lanes<N>, C: OverflowPolicy<L, N>, const N: usize>(
    friction_ratios: [&Ints<N>; 2],
    normal_lambdas: [L::Int; 2],
) -> L::Int {
    let first = L::mul(L::load(friction_ratios[0]), normal_lambdas[0]);
    let second = L::mul(L::load(friction_ratios[1]), normal_lambdas[1]);
    L::min(C::limit(L::add_wide(first, second)), L::splat(TANGENT_MAX.to_bits()))
}

#[inline(always)]
fn every<L: Lanes<N>, const N: usize>() -> L::Mask {
    L::greater(L::splat(1), L::splat(0))
}

/// Selects `stiff` in the lanes of a mask, and `soft` in all other lanes.
#[inline(always)]
fn chosen<L: Lanes<N>, const N: usize>(immovable: L::Mask, soft: i32, stiff: i32) -> L::Int {
    L::select(immovable, L::splat(stiff), L::splat(soft))
}
