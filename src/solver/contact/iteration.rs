//! One iteration over all rows of a batch: the normals, against each other, then what they limit.

use core::cell::Cell;

use super::super::body::SolverBody;
use super::super::pair::{Pair, UNIT, beyond, clamp, shift};
use super::batch::{Batch, Point};
use super::care::Care;
use super::kernel::{Constants, directions};
use super::rolling::RollingRows;
use super::special::Special;
use super::{NORMAL_ROUNDS_MAX, Pass, SETTLED, Sweep, TANGENT_MAX};
use crate::lanes::{Ints, Lanes};
use crate::math::{Rate, Shift, Speed, Unit};

/// What an iteration makes of a batch.
pub(super) struct Iteration<L: Lanes<N>, const N: usize> {
    /// Which point was solved first, and the impulses that push both, in that order.
    places: [usize; 2],
    normal_lambdas: [L::Int; 2],
    tangent_lambda: L::Int,
    pair: Pair<L, N>,
}

impl<L: Lanes<N>, const N: usize> Iteration<L, N> {
    /// Without what is special, if that is not given.
    #[inline(always)]
    pub(super) fn of<C: Care<L, N>>(
        batch: &Batch<N>,
        special: Option<&mut Special<N>>,
        (pass, sweep): (Pass, Sweep),
        constants: &Constants,
        bodies: &[Cell<SolverBody>],
        care: &mut C,
    ) -> Self {
        let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
        care.see(&pair);
        let (n, t) = directions::<L, N>(batch);
        let places = match (sweep, batch.count) {
            (Sweep::Backward, 2) => [1, 0],
            _ => [0, 1],
        };
        let points = [&batch.points[places[0]], &batch.points[places[1]]];
        let normals = Normals::<L, N>::new(batch, pass, n, constants);
        let normal_lambdas = if batch.count == 2 {
            normals.solve_both(points, &mut pair, care)
        } else {
            [normals.solve_one(points[0], &mut pair, care), L::splat(0)]
        };
        let mut surface_speed = L::splat(0);
        if let Some(special) = special {
            surface_speed = L::load(&special.surface_speed);
            if special.rolls {
                let grips = [&special.rolling.grips[places[0]], &special.rolling.grips[places[1]]];
                let limit = limit::<L, C, N>(grips, normal_lambdas);
                solve_rolling(&mut special.rolling, limit, &mut pair, care);
            }
        }
        // Coulomb: friction stops sliding, as far as it reaches.
        let vt = C::add(pair.velocity(t, &batch.tangent, care), surface_speed);
        let limit = limit::<L, C, N>([&points[0].grip, &points[1].grip], normal_lambdas);
        let old = L::load(&batch.tangent_lambda);
        care.see_impulse(old);
        let tangent_lambda = clamp::<L, N>(C::sub(old, vt), limit);
        care.apply(&mut pair, &batch.tangent, L::sub(tangent_lambda, old));
        Iteration { places, normal_lambdas, tangent_lambda, pair }
    }

    /// Puts the impulses into the batch, and the velocities into its bodies.
    #[inline(always)]
    pub(super) fn store(
        self,
        batch: &mut Batch<N>,
        special: Option<&mut Special<N>>,
        bodies: &[Cell<SolverBody>],
    ) {
        let Iteration { places, normal_lambdas, tangent_lambda, pair } = self;
        batch.push::<L>(places[0], normal_lambdas[0]);
        if batch.count == 2 {
            batch.push::<L>(places[1], normal_lambdas[1]);
        }
        L::store(tangent_lambda, &mut batch.tangent_lambda);
        pair.store(bodies, &batch.changed);
        if let Some(special) = special {
            special.remember_pushes::<L>(batch);
        }
    }
}

/// What the normal rows of a batch have in common in a pass: the bodies may touch there but not overlap.
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
}

impl<L: Lanes<N>, const N: usize> Normals<L, N> {
    #[inline(always)]
    fn new(batch: &Batch<N>, pass: Pass, n: [L::Int; 2], constants: &Constants) -> Self {
        let &Constants { rate, separation_max, slop, push_speed, soft, stiff, .. } = constants;
        let immovable = L::negative(L::load(&batch.immovable));
        Normals {
            pass,
            n,
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

    /// Solves a point for the first time. Returns its impulse.
    #[inline(always)]
    fn solve_one<C: Care<L, N>>(&self, point: &Point<N>, pair: &mut Pair<L, N>, care: &mut C) -> L::Int {
        let old = L::load(&point.normal_lambda);
        care.see_impulse(old);
        care.see_separation(L::load(&point.separation));
        let new = self.wanted(point, old, pair, care);
        care.apply(pair, &point.normal, L::sub(new, old));
        new
    }

    /// Solves two points against each other, until the second leaves the first alone. Returns their impulses.
    #[inline(always)]
    fn solve_both<C: Care<L, N>>(
        &self,
        [first, second]: [&Point<N>; 2],
        pair: &mut Pair<L, N>,
        care: &mut C,
    ) -> [L::Int; 2] {
        let one = self.solve_one(first, pair, care);
        let old = L::load(&second.normal_lambda);
        let two = self.solve_one(second, pair, care);
        let mut lambdas = [one, two];
        let settled = L::splat(SETTLED.to_bits() - 1);
        let mut unsettled = beyond::<L, N>(L::sub(two, old), settled);
        for _ in 1..NORMAL_ROUNDS_MAX {
            if !L::any(unsettled) {
                break;
            }
            let wanted = self.wanted(first, lambdas[0], pair, care);
            let new = L::select(unsettled, wanted, lambdas[0]);
            care.apply(pair, &first.normal, L::sub(new, lambdas[0]));
            lambdas[0] = new;
            let wanted = self.wanted(second, lambdas[1], pair, care);
            let new = L::select(unsettled, wanted, lambdas[1]);
            let d = L::sub(new, lambdas[1]);
            care.apply(pair, &second.normal, d);
            lambdas[1] = new;
            unsettled = L::both(unsettled, beyond::<L, N>(d, settled));
        }
        lambdas
    }

    /// The impulse that a point asks for.
    #[inline(always)]
    fn wanted<C: Care<L, N>>(
        &self,
        point: &Point<N>,
        old: L::Int,
        pair: &Pair<L, N>,
        care: &mut C,
    ) -> L::Int {
        let vn = pair.velocity(self.n, &point.normal, care);
        let separation = L::load(&point.separation);
        let gap = L::greater(separation, L::splat(0));
        match self.pass {
            Pass::Bias => {
                let error = C::add(vn, self.bias::<C>(separation, gap));
                let mass_scale = L::select(gap, L::splat(Unit::ONE.to_bits()), self.mass_scale);
                let impulse_scale = L::select(gap, L::splat(0), self.impulse_scale);
                let wide = L::add_wide(L::mul(mass_scale, error), L::mul(impulse_scale, old));
                care.impulse(L::max(C::sub(old, L::narrow::<UNIT>(wide)), L::splat(0)))
            }
            // A gap that the bias pass has not closed is left to the next sub-step: to slow an approach down before
            // it arrives, and to bounce there, would make a ball rebound from above the floor.
            Pass::Relax => {
                let speed = L::select(gap, self.speed_of::<C>(separation, self.rate), L::splat(0));
                let untouched = L::both(gap, L::greater(L::splat(1), old));
                let wanted = care.impulse(L::max(C::sub(old, C::add(vn, speed)), L::splat(0)));
                L::select(untouched, old, wanted)
            }
        }
    }

    /// The velocity that a separation asks for: a gap may close within this sub-step, but not more; an overlap is pushed
    /// out slowly.
    #[inline(always)]
    fn bias<C: Care<L, N>>(&self, separation: L::Int, gap: L::Mask) -> L::Int {
        let overlap = L::min(C::add(separation, self.slop), L::splat(0));
        let distance = L::select(gap, separation, overlap);
        L::max(self.speed_of::<C>(distance, L::select(gap, self.rate, self.bias_rate)), self.push_speed)
    }

    #[inline(always)]
    fn speed_of<C: Care<L, N>>(&self, distance: L::Int, rate: L::Int) -> L::Int {
        const EXTRA: i32 = shift(Shift::FRAC_NBITS + Rate::FRAC_NBITS - Speed::FRAC_NBITS);
        L::narrow::<EXTRA>(L::mul(C::clamp(distance, self.separation_max), rate))
    }
}

/// What the normal impulses of both points let a row do that they limit.
#[inline(always)]
fn limit<L: Lanes<N>, C: Care<L, N>, const N: usize>(
    grips: [&Ints<N>; 2],
    normal_lambdas: [L::Int; 2],
) -> L::Int {
    let first = L::mul(L::load(grips[0]), normal_lambdas[0]);
    let second = L::mul(L::load(grips[1]), normal_lambdas[1]);
    L::min(C::limit(L::add_wide(first, second)), L::splat(TANGENT_MAX.to_bits()))
}

#[inline(always)]
fn solve_rolling<L: Lanes<N>, const N: usize>(
    rolling: &mut RollingRows<N>,
    limit: L::Int,
    pair: &mut Pair<L, N>,
    care: &mut impl Care<L, N>,
) {
    let still = [L::splat(0), L::splat(0)];
    let vn = pair.velocity(still, &rolling.row, care);
    let old = L::load(&rolling.lambda);
    let new = clamp::<L, N>(L::sub_saturating(old, vn), limit);
    L::store(new, &mut rolling.lambda);
    care.apply(pair, &rolling.row, L::sub(new, old));
}

/// A number for contacts between bodies that give way, another for the others.
#[inline(always)]
fn chosen<L: Lanes<N>, const N: usize>(immovable: L::Mask, soft: i32, stiff: i32) -> L::Int {
    L::select(immovable, L::splat(stiff), L::splat(soft))
}
