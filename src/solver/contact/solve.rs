//! Solve: one iteration over the rows of a batch, the normals first and then what they limit.
//!
//! ```text
//! bias pass    w = massScale (vn + bias(s)) + impulseScale L        bias(s) = s / h            for a gap
//!                                                                   max(rate (s + slop), -push) for an overlap
//!              a gap is rigid: massScale = 1, impulseScale = 0
//! relax pass   w = vn + s / h for a gap that already pushes, vn for an overlap
//! normal       L' = max(L - w, 0)
//! friction     |L'| <= sum of grip Ln over the points,   w = vt + surface speed
//! rolling      the same with the grips of `rolling`
//! ```

use core::cell::Cell;

use super::super::batches::{BatchParts, Operation};
use super::super::body::SolverBody;
use super::super::context::Pass;
use super::super::pair::{Pair, UNIT, beyond, clamp, shift};
use super::batch::{Batch, Point};
use super::care::{Calm, Care, Careful};
use super::relax::measure;
use super::special::Special;
use super::{Constants, Contacts, TANGENT_MAX};
use crate::lanes::{Ints, Lanes};
use crate::math::{Rate, Shift, Speed, Unit};

/// Largest number of rounds in which the two points of a contact are solved against each other. At an impact a single
/// round turns the body: ten boxes that fall on each other from 5 or 10 mm then sway by 12 mm, and with up to four
/// rounds by 1 mm. Where piles rest the first round is mostly enough: a pyramid of 5050 boxes costs a tenth more.
const NORMAL_ROUNDS_MAX: u32 = 4;

/// Change of the second point's impulse, in m/s, below which it does not disturb the first point.
const SETTLED: Speed = Speed::lit("0.005");

/// Which of a contact's two points is solved first. It alternates: the point that is solved first turns the body a
/// little, and always the same way it makes a stack of ten boxes sway by 4.7 mm while it settles instead of 0.05 mm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solver) enum Sweep {
    Forward,
    Backward,
}

impl Sweep {
    /// The order in an iteration of a sub-step: successive sub-steps differ, and so do successive iterations.
    pub(in crate::solver) const fn of(sub_step: u64, iteration: u32) -> Self {
        if sub_step % 2 == iteration as u64 % 2 { Sweep::Forward } else { Sweep::Backward }
    }
}

/// One iteration with bias, at the separations that the last relax pass has measured.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Solve {
    pub(in crate::solver) sweep: Sweep,
    pub(in crate::solver) constants: Constants,
}

impl Operation<Contacts> for Solve {
    #[inline(always)]
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, Contacts, N>) {
        let settings = Settings { pass: Pass::Bias, sweep: self.sweep, constants: &self.constants };
        solve::<L, N>(parts, settings);
    }
}

/// The parameters of an iteration. `pass` is a constant where it is set, so that each pass is compiled by itself.
#[derive(Clone, Copy)]
pub(super) struct Settings<'a> {
    pub(super) pass: Pass,
    pub(super) sweep: Sweep,
    pub(super) constants: &'a Constants,
}

/// Iterates without a check of any sum if the batch is calm, and again with all checks if it turns out not to be.
#[inline(always)]
pub(super) fn solve<L: Lanes<N>, const N: usize>(parts: BatchParts<'_, Contacts, N>, settings: Settings<'_>) {
    let BatchParts { batch, extra: mut special, bodies, faults, .. } = parts;
    if batch.calm && settings.constants.calm {
        let mut calm = Calm::<L, N>::new();
        let solved = iterate(batch, None, settings, bodies, &mut calm);
        if calm.held() {
            solved.store(batch, special, bodies);
            return;
        }
        // A batch that is not calm now will hardly be calm later in the tick.
        batch.calm = false;
    }
    let careful = &mut Careful(faults);
    let solved: Solved<L, N> = iterate(batch, special.as_deref_mut(), settings, bodies, careful);
    solved.store(batch, special, bodies);
}

/// The result of an iteration, before it is stored.
struct Solved<L: Lanes<N>, const N: usize> {
    /// Which point was solved first.
    places: [usize; 2],
    /// The impulses of the points, in that order.
    normal_lambdas: [L::Int; 2],
    tangent_lambda: L::Int,
    pair: Pair<L, N>,
}

/// One iteration. `special` is left out of batches that are calm.
#[inline(always)]
fn iterate<L: Lanes<N>, C: Care<L, N>, const N: usize>(
    batch: &mut Batch<N>,
    special: Option<&mut Special<N>>,
    settings: Settings<'_>,
    bodies: &[Cell<SolverBody>],
    care: &mut C,
) -> Solved<L, N> {
    if settings.pass == Pass::Relax {
        measure(batch, bodies, care);
    }
    let mut pair = Pair::<L, N>::load(bodies, &batch.bodies);
    care.see(&pair);
    let (n, t) = batch.directions::<L>();
    let places = match (settings.sweep, batch.count) {
        (Sweep::Backward, 2) => [1, 0],
        _ => [0, 1],
    };
    let points = [&batch.points[places[0]], &batch.points[places[1]]];
    let normals = Normals::<L, N>::new(batch, settings, n);
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
            special.rolling.solve(limit, &mut pair, care);
        }
    }
    // Coulomb friction: an impulse against sliding, at most as large as the normal impulses allow.
    let vt = C::add(pair.velocity(t, &batch.tangent, care), surface_speed);
    let limit = limit::<L, C, N>([&points[0].grip, &points[1].grip], normal_lambdas);
    let old = L::load(&batch.tangent_lambda);
    care.see_impulse(old);
    let tangent_lambda = clamp::<L, N>(C::sub(old, vt), limit);
    care.apply(&mut pair, &batch.tangent, L::sub(tangent_lambda, old));
    Solved { places, normal_lambdas, tangent_lambda, pair }
}

impl<L: Lanes<N>, const N: usize> Solved<L, N> {
    /// Stores the impulses in the batch, and the velocities in its bodies.
    #[inline(always)]
    fn store(self, batch: &mut Batch<N>, special: Option<&mut Special<N>>, bodies: &[Cell<SolverBody>]) {
        let Solved { places, normal_lambdas, tangent_lambda, pair } = self;
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

/// The parameters that the normal rows of a batch have in common in a pass.
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
    fn new(batch: &Batch<N>, settings: Settings<'_>, n: [L::Int; 2]) -> Self {
        let &Constants { rate, separation_max, slop, push_speed, soft, stiff, .. } = settings.constants;
        let immovable = L::negative(L::load(&batch.immovable));
        let (soft_impulse, stiff_impulse) = (soft.impulse_scale.to_bits(), stiff.impulse_scale.to_bits());
        Normals {
            pass: settings.pass,
            n,
            rate: L::splat(rate),
            separation_max: L::splat(separation_max),
            slop: L::splat(slop),
            push_speed: L::splat(-push_speed),
            bias_rate: chosen::<L, N>(immovable, soft.bias_rate.to_bits(), stiff.bias_rate.to_bits()),
            mass_scale: chosen::<L, N>(immovable, soft.mass_scale.to_bits(), stiff.mass_scale.to_bits()),
            impulse_scale: chosen::<L, N>(immovable, soft_impulse, stiff_impulse),
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

    /// The contact equation: the accumulated impulse that a point should have.
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

    /// The velocity that a separation calls for: a gap may close within this sub-step, but not more; an overlap is
    /// pushed out slowly.
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

/// The largest impulse of a row that the normal impulses of both points limit.
#[inline(always)]
fn limit<L: Lanes<N>, C: Care<L, N>, const N: usize>(
    grips: [&Ints<N>; 2],
    normal_lambdas: [L::Int; 2],
) -> L::Int {
    let first = L::mul(L::load(grips[0]), normal_lambdas[0]);
    let second = L::mul(L::load(grips[1]), normal_lambdas[1]);
    L::min(C::limit(L::add_wide(first, second)), L::splat(TANGENT_MAX.to_bits()))
}

/// One number where both bodies move, another where one of them does not.
#[inline(always)]
fn chosen<L: Lanes<N>, const N: usize>(immovable: L::Mask, soft: i32, stiff: i32) -> L::Int {
    L::select(immovable, L::splat(stiff), L::splat(soft))
}
