//! The point block pins a point of body A to a point of body B. Both directions are solved at once.
//!
//! In world axes, with `e = (-r_y, r_x) / k` of each body, the mass fractions `a`, and `s = massScale`:
//!
//! ```text
//! K   = I + s (aA eA eA^T + aB eB eB^T)
//! det = 1 + s aA |eA|^2 + s aB |eB|^2 + s^2 aA aB (eA x eB)^2   (no cancellation)
//! G   = K^-1 = [K22 -K12; -K12 K11] / det                       (0 < Gii <= 1, |G12| <= 1/2)
//! GA  = aA G,  GB = aB G,  fA = aA G eA,  fB = aB G eB          (every entry of f <= 1/2 if s = 1)
//!
//! p   = G L
//! vr  = vB - vA + eB uB - eA uA
//! d   = -massScale (vr + bias) - impulseScale p - push
//! L'  = L + d, shortened so that |G L'| <= the largest impulse and components are at most 1023
//! d   = L' - L, shortened so that components are at most 512
//! vA -= GA d,  uA -= fA.d,  vB += GB d,  uB += fB.d
//! ```
//!
//! `L` accumulates over the iterations, and `p` is the impulse times the sum of the inverse masses. For a rigid block
//! (`s = 1`), `L` is the change of the relative velocity of the anchors.
//!
//! **A soft block is an isotropic spring**, with the potential `omega^2 m |x|^2 / 2` and `m = 1 / (mA + mB)`. Let `K1`
//! be `K` of the rigid block. The equation `(impulseScale I + massScale K1) p = -massScale v - push` is then the
//! implicit step of a spring with the stiffness `omega^2 m` and the damping `2 zeta omega m` in all directions. If `d`
//! contained `impulseScale L` instead of `impulseScale p`, the stiffness would be `omega^2 m K1^-1`, which depends on
//! the directions of the arms. Such a spring has no potential, and feeds energy into bodies that turn.
//!
//! `L` is carried over from pose to pose: the new `G` removes the part of `L` that no longer acts along the arm. If
//! `p = G L` were carried over instead, that part would be multiplied by up to `|e|^2`: on a rod 40 radii of gyration
//! long, this added 1100 m/s. If two scalar rows replaced the block, a swinging chain would gain energy.
//!
//! **The bias pass of a hinge measures along the chord.** Displacements are straight while arms turn, which opens the
//! joint by about half the length of an arm times the square of its rotation. The velocity is therefore measured with
//! the arm averaged over the predicted rotation `t = h u / k`, to second order in `t`:
//!
//! ```text
//! eM = e + M (t/2 (-e_y, e_x) - t^2/6 e),   M = 1 + 0.6 impulseScale / massScale, at most 1.9
//! vr = vB - vA + eMB uB - eMA uA
//! ```
//!
//! The impulse still acts along the arm at the start of the sub-step, and therefore dissipates no energy (the position
//! constraint of RATTLE, H. Andersen 1983). The factor `M` compensates for a part of the softness, because a soft joint
//! yields to the centrifugal force. The relax pass measures with the arm at the new pose. Hinges solve these equations
//! in batches (`joint/hinge`). Springs and motors between points (`joint/point`) measure with the arm at the current
//! pose in both passes.

#[cfg(test)]
mod tests;

use fixed::types::extra::U30;

use super::body::SolverBody;
use super::body_pair::{BodyPair, Change};
use super::limits::{Faults, IMPULSE_MAX, STEP_MAX, shortened};
use super::row::{Lever, MassFractions, turning};
use super::softness::Softness;
use crate::math::{
    Ratio, Speed, Unit, Vec2, div_round, mul, round_shift, round_shift_wide, saturate, saturate_wide,
};

#[derive(Clone, Copy, Debug, Default)]
struct Symmetric<T> {
    m11: T,
    m12: T,
    m22: T,
}

impl Symmetric<Unit> {
    fn apply(&self, [x, y]: [i64; 2]) -> [i64; 2] {
        let dot = |a: Unit, b: Unit| {
            let times = |gain: Unit, part: i64| i128::from(gain.to_bits()) * i128::from(part);
            saturate_wide(round_shift_wide(times(a, x) + times(b, y), 30))
        };
        [dot(self.m11, self.m12), dot(self.m12, self.m22)]
    }

    /// `f = G e`, with 30 fraction bits.
    fn apply_ratio(&self, e: Vec2<Ratio>) -> Vec2<i64> {
        let dot = |x: Unit, y: Unit| {
            let times = |gain: Unit, e: Ratio| i64::from(gain.to_bits()) * i64::from(e.to_bits());
            round_shift(times(x, e.x) + times(y, e.y), 24)
        };
        Vec2::new(dot(self.m11, self.m12), dot(self.m12, self.m22))
    }

    fn scale(&self, fraction: Unit) -> Self {
        Symmetric { m11: mul(self.m11, fraction), m12: mul(self.m12, fraction), m22: mul(self.m22, fraction) }
    }
}

/// `bias` and `push` in the equations of a point block.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PointGoal {
    /// The negated target velocity.
    pub(crate) bias: Vec2<Speed>,
    /// Impulse that the softness does not scale, in units of [`Speed`]: [`Softness::push_along`].
    pub(crate) push: [i64; 2],
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PointBlock {
    e_a: Vec2<Ratio>,
    e_b: Vec2<Ratio>,
    g_a: Symmetric<Unit>,
    g_b: Symmetric<Unit>,
    /// `f` of A and B with 30 fraction bits, in 64 bits, because it may be as large as `e` in a soft block.
    f_a: Vec2<i64>,
    f_b: Vec2<i64>,
}

impl PointBlock {
    /// The block that pins the ends of two levers together, for a softness with this `mass_scale`.
    pub(crate) fn new(a: Lever, b: Lever, fractions: MassFractions, mass_scale: Unit) -> Self {
        let ratios = |end: Lever| -> Vec2<Ratio> {
            let perp = end.arm.perp();
            Vec2::new(end.inverse_gyration.times(perp.x), end.inverse_gyration.times(perp.y))
        };
        let (e_a, e_b) = (ratios(a), ratios(b));
        let sum = |i: fn(Vec2<Ratio>) -> Ratio, j: fn(Vec2<Ratio>) -> Ratio| {
            scaled(turning(fractions.a, i(e_a), j(e_a)) + turning(fractions.b, i(e_b), j(e_b)), mass_scale)
        };
        let (xx, xy, yy) = (sum(|e| e.x, |e| e.x), sum(|e| e.x, |e| e.y), sum(|e| e.y, |e| e.y));
        let product = |a: Ratio, b: Ratio| i128::from(a.to_bits()) * i128::from(b.to_bits());
        // Rounding `eA x eB` to 24 fraction bits changes the determinant by a relative error below 2^-25.
        let cross = round_shift_wide(product(e_a.x, e_b.y) - product(e_a.y, e_b.x), 24);
        let shares = product_of_fractions(fractions);
        let square = saturate_wide(round_shift_wide(cross * cross, 24));
        let both = i128::from(scaled(scaled(square, mass_scale), mass_scale)) * shares;
        let one = 1i64 << 30;
        let det = one + xx + yy + saturate_wide(round_shift_wide(both, 24));
        let k = Symmetric { m11: one + xx, m12: xy, m22: one + yy };
        let g = inverse(&k, det);
        let (g_a, g_b) = (g.scale(fractions.a), g.scale(fractions.b));
        PointBlock { e_a, e_b, g_a, g_b, f_a: g_a.apply_ratio(e_a), f_b: g_b.apply_ratio(e_b) }
    }

    /// The block whose impulses act only along `n`, the direction of the line through both centres: `G = n n^T`.
    pub(crate) fn along(n: Vec2<Unit>, fractions: MassFractions) -> Self {
        let g = Symmetric { m11: mul(n.x, n.x), m12: mul(n.x, n.y), m22: mul(n.y, n.y) };
        PointBlock { g_a: g.scale(fractions.a), g_b: g.scale(fractions.b), ..PointBlock::default() }
    }

    /// Changes the velocities by a change `d` of `L`.
    #[inline]
    pub(crate) fn apply(&self, d: Vec2<Speed>, bodies: &mut BodyPair<'_>) {
        // Sums of two products have 51 fraction bits. As bits they are at most 2^61, because gains are at most 1 and
        // impulses at most 512 m/s.
        let dot = |x: Unit, y: Unit| {
            let times = |gain: Unit, d: Speed| i64::from(gain.to_bits()) * i64::from(d.to_bits());
            times(x, d.x) + times(y, d.y)
        };
        let turn = |f: Vec2<i64>| {
            let times = |gain: i64, d: Speed| i128::from(gain) * i128::from(d.to_bits());
            saturate_wide(times(f.x, d.x) + times(f.y, d.y))
        };
        let Symmetric { m11, m12, m22 } = self.g_a;
        let a = Change { x: -dot(m11, m12), y: -dot(m12, m22), spin: turn(self.f_a).saturating_neg() };
        let Symmetric { m11, m12, m22 } = self.g_b;
        bodies.change(a, Change { x: dot(m11, m12), y: dot(m12, m22), spin: turn(self.f_b) });
    }

    /// `p = G L`, in units of [`Speed`].
    fn impulse(&self, lambda: [i64; 2]) -> [i64; 2] {
        // `G` is `GA + GB`, because the mass fractions add up to 1.
        let ([a_x, a_y], [b_x, b_y]) = (self.g_a.apply(lambda), self.g_b.apply(lambda));
        [a_x.saturating_add(b_x), a_y.saturating_add(b_y)]
    }

    pub(crate) fn ratios(&self) -> (Vec2<Ratio>, Vec2<Ratio>) {
        (self.e_a, self.e_b)
    }

    /// Solves the block for one iteration, with `|p| <= p_max`.
    #[inline]
    pub(crate) fn solve_within(
        &self,
        bodies: &mut BodyPair<'_>,
        goal: PointGoal,
        softness: &Softness,
        p_max: Speed,
        lambda: &mut Vec2<Speed>,
    ) {
        let [d_x, d_y] = self.wanted(bodies.a, bodies.b, goal, softness, *lambda, bodies.faults);
        let faults = &mut *bodies.faults;
        let [x, y] = units_of(*lambda);
        let next = self.within([x.saturating_add(d_x), y.saturating_add(d_y)], p_max);
        let [next_x, next_y] = units_of(shortened(next, IMPULSE_MAX, faults));
        let d = shortened([next_x - x, next_y - y], STEP_MAX, faults);
        *lambda += d;
        self.apply(d, bodies);
    }

    /// The change of `L` in one iteration, before limits, in units of [`Speed`].
    #[inline]
    pub(crate) fn wanted(
        &self,
        a: &SolverBody,
        b: &SolverBody,
        goal: PointGoal,
        softness: &Softness,
        lambda: Vec2<Speed>,
        faults: &mut Faults,
    ) -> [i64; 2] {
        let PointGoal { bias, push } = goal;
        let vr = self.velocity(a, b, self.ratios(), faults);
        let [p_x, p_y] = self.impulse(units_of(lambda)).map(|part| Speed::from_bits(saturate(part)));
        [softness.wanted(vr.x, bias.x, p_x) - push[0], softness.wanted(vr.y, bias.y, p_y) - push[1]]
    }

    /// Shortens `L` so that `|G L| <= p_max`. A `p_max` of [`Speed::MAX`] means no limit.
    fn within(&self, lambda: [i64; 2], p_max: Speed) -> [i64; 2] {
        if p_max == Speed::MAX {
            return lambda;
        }
        let [x, y] = self.impulse(lambda).map(|part| i128::from(part).pow(2));
        let most = i128::from(p_max.to_bits());
        if x + y < (most + 1).pow(2) {
            return lambda;
        }
        let length = (x + y).isqrt();
        lambda.map(|part| saturate_wide(div_round(i128::from(part) * most, length)))
    }

    /// `vr`, measured with the given lever ratios.
    #[inline]
    fn velocity(
        &self,
        a: &SolverBody,
        b: &SolverBody,
        (e_a, e_b): (Vec2<Ratio>, Vec2<Ratio>),
        faults: &mut Faults,
    ) -> Vec2<Speed> {
        let along = |e_a: Ratio, e_b: Ratio, dv: Speed, faults: &mut Faults| {
            let angular = i64::from(e_b.to_bits()) * i64::from(b.spin.to_bits())
                - i64::from(e_a.to_bits()) * i64::from(a.spin.to_bits());
            let wide = i64::from(dv.to_bits()) + round_shift(angular, 24);
            let within = saturate(wide);
            *faults += u64::from(i64::from(within) != wide);
            Speed::from_bits(within)
        };
        let x = along(e_a.x, e_b.x, b.velocity.x - a.velocity.x, faults);
        let y = along(e_a.y, e_b.y, b.velocity.y - a.velocity.y, faults);
        Vec2::new(x, y)
    }
}

/// A number times a fraction.
#[inline]
fn scaled(x: i64, fraction: Unit) -> i64 {
    saturate_wide(round_shift_wide(i128::from(x) * i128::from(fraction.to_bits()), 30))
}

/// `aA aB` with 30 fraction bits.
fn product_of_fractions(fractions: MassFractions) -> i128 {
    i128::from(mul::<_, _, U30>(fractions.a, fractions.b).to_bits())
}

fn units_of(lambda: Vec2<Speed>) -> [i64; 2] {
    [lambda.x, lambda.y].map(|part| part.to_bits().into())
}

/// `[K22 -K12; -K12 K11] / det` with one division. All numbers have 30 fraction bits.
fn inverse(k: &Symmetric<i64>, det: i64) -> Symmetric<Unit> {
    // The determinant is reduced to 32 bits. Products with its reciprocal, `2^62 / det`, fit 64 bits, because no entry
    // of `K` is larger than the determinant.
    let excess = (64 - det.leading_zeros()).saturating_sub(32);
    let reciprocal = (1i64 << 62) / (det >> excess);
    let entry = |value: i64| Unit::from_bits(saturate(round_shift((value >> excess) * reciprocal, 32)));
    Symmetric { m11: entry(k.m22), m12: entry(-k.m12), m22: entry(k.m11) }
}
