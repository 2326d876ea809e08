//! The row: removes relative velocity along one direction between two bodies.
//!
//! With lever arms `c = r x n`, inverse masses `m` and radii of gyration `k` of bodies A and B, and the spin `u = k w`
//! instead of the angular velocity (E. Catto, "Iterative Dynamics with Temporal Coherence", 2005, in units in which
//! every coefficient is bounded):
//!
//! ```text
//! e = c / k                                            lever ratio
//! aA = mA / (mA + mB),  aB = 1 - aA                    mass fractions, 0 for a body that no impulse moves
//! D  = aA (1 + eA^2) + aB (1 + eB^2)                   1 or more
//! g  = a / D,  f = g e                                 gains: g <= 1, |f| <= 1/2 (in coupled rows: 4.1 and 2)
//!
//! vn = n.(vB - vA) + eB uB - eA uA
//! d  = -massScale (vn + bias) - impulseScale L
//! L' = clamp(L + d, lo, hi),  d = L' - L
//! vA -= gA d n,  uA -= fA d,  vB += gB d n,  uB += fB d
//! ```
//!
//! `L` is the accumulated impulse divided by the effective mass: a speed. `limits.rs` limits velocities and `L`. A
//! number that these limits change counts as a fault, except in an initial guess ([`lambda_of`]). `softness.rs` defines
//! `massScale` and `impulseScale`.

mod angular;
mod coupled;

pub(super) use angular::angular_scale;

use super::body::SolverBody;
use super::body_pair::{BodyPair, Change};
use super::limits::{Faults, IMPULSE_MAX, STEP_MAX};
use crate::body::Body;
use crate::math::{
    Fx, Length, Ratio, Reciprocal, Speed, Unit, Vec2, div_round, round_shift, round_shift_wide, saturate,
    saturate_wide,
};

/// The share of each body in the change of the relative velocity by an impulse through both centres of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MassFractions {
    pub(crate) a: Unit,
    pub(crate) b: Unit,
}

impl MassFractions {
    pub(crate) fn of(a: &Body, b: &Body) -> Self {
        let mass = |body: &Body| if body.is_dynamic() { body.mass() } else { Fx::ZERO };
        Self::of_masses(mass(a), mass(b))
    }

    /// The fractions for masses in kg, where 0 is the mass of a body that no impulse moves. With masses `M` and inverse
    /// masses `m`, `mA / (mA + mB)` equals `MB / (MA + MB)`.
    pub(crate) fn of_masses(a: Fx, b: Fx) -> Self {
        match (a.is_positive(), b.is_positive()) {
            (true, true) if a == b => MassFractions { a: Unit::ONE / 2, b: Unit::ONE / 2 },
            (true, true) => {
                let (mass_a, mass_b) = (a.to_bits().unsigned_abs(), b.to_bits().unsigned_abs());
                // As bits, masses are below 2^62. The sum is reduced to 32 bits, so that a mass still fits 64 bits when
                // it is shifted up by the 30 fraction bits of the result.
                let excess = (64 - (mass_a + mass_b).leading_zeros()).saturating_sub(32);
                let (mass_a, mass_b) = (mass_a >> excess, mass_b >> excess);
                let bits = (mass_b << 30) / (mass_a + mass_b);
                let a = Unit::from_bits(i32::try_from(bits).unwrap_or(1 << 30));
                MassFractions { a, b: Unit::ONE - a }
            }
            (true, false) => MassFractions { a: Unit::ONE, b: Unit::ZERO },
            (false, true) => MassFractions { a: Unit::ZERO, b: Unit::ONE },
            (false, false) => MassFractions { a: Unit::ZERO, b: Unit::ZERO },
        }
    }
}

/// `a e e'` with 30 fraction bits. The value is below 2^14. If `a e` were rounded first, `e'` would multiply the
/// rounding error by up to 2^7.
#[inline]
pub(super) fn turning(fraction: Unit, e: Ratio, other: Ratio) -> i64 {
    let square = i64::from(e.to_bits()) * i64::from(other.to_bits());
    let wide = i128::from(square) * i128::from(fraction.to_bits());
    saturate_wide(round_shift_wide(wide, 48))
}

/// The point at which an impulse acts on a body, and the inverse radius of gyration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lever {
    /// Vector from the centre of mass to this point.
    pub(crate) arm: Vec2<Length>,
    pub(crate) inverse_gyration: Reciprocal,
}

impl Lever {
    /// The length of the arm over the radius of gyration, at most [`RATIO_MAX`].
    pub(crate) fn ratio(self) -> Ratio {
        let ratio: Ratio = self.inverse_gyration.times(self.arm.length());
        ratio.min(RATIO_MAX)
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    n: Vec2<Unit>,
    /// Direction on B, which differs from `n` in coupled rows.
    n_b: Vec2<Unit>,
    e_a: Ratio,
    e_b: Ratio,
    /// Gains with 30 fraction bits. They need 64 bits, because a coupled row may have a gain of 4.1.
    g_a: i64,
    g_b: i64,
    f_a: Unit,
    f_b: Unit,
}

/// Largest lever ratio. With spins of up to 1024 m/s, the angular part in [`Row::along`] is then at most 2^63 - 2^57,
/// which leaves room for a linear part of 2^57 in 64 bits.
pub(super) const RATIO_MAX: Ratio = Ratio::lit("126");

/// `D` of a row, with 30 fraction bits. 0 if impulses move neither body.
pub(crate) type Denominator = i64;

impl Row {
    pub(crate) fn prepare(n: Vec2<Unit>, a: Lever, b: Lever, fractions: MassFractions) -> (Row, Denominator) {
        let ratio = |lever: Lever| -> Ratio {
            let c: Length = lever.arm.cross(n);
            let e: Ratio = lever.inverse_gyration.times(c);
            e.clamp(-RATIO_MAX, RATIO_MAX)
        };
        let (e_a, e_b) = (ratio(a), ratio(b));
        let moving = i64::from(fractions.a.to_bits()) + i64::from(fractions.b.to_bits());
        let denominator = moving + turning(fractions.a, e_a, e_a) + turning(fractions.b, e_b, e_b);
        (Row::with_gains([n, n], [e_a, e_b], fractions, denominator), denominator)
    }

    fn with_gains(n: [Vec2<Unit>; 2], e: [Ratio; 2], fractions: MassFractions, denominator: i64) -> Row {
        let denominator = denominator.max(1);
        let gain = |fraction: Unit| ((i64::from(fraction.to_bits()) << 30) + denominator / 2) / denominator;
        let (g_a, g_b) = (gain(fractions.a), gain(fractions.b));
        let turning =
            |g: i64, e: Ratio| Unit::from_bits(saturate(round_shift(g * i64::from(e.to_bits()), 24)));
        let (f_a, f_b) = (turning(g_a, e[0]), turning(g_b, e[1]));
        Row { n: n[0], n_b: n[1], e_a: e[0], e_b: e[1], g_a, g_b, f_a, f_b }
    }

    /// A row whose impulses change nothing.
    pub(crate) const NONE: Self = Row {
        n: Vec2::new(Unit::ZERO, Unit::ZERO),
        n_b: Vec2::new(Unit::ZERO, Unit::ZERO),
        e_a: Ratio::ZERO,
        e_b: Ratio::ZERO,
        g_a: 0,
        g_b: 0,
        f_a: Unit::ZERO,
        f_b: Unit::ZERO,
    };

    pub(super) fn turning_parts(&self) -> ([Ratio; 2], [Unit; 2]) {
        ([self.e_a, self.e_b], [self.f_a, self.f_b])
    }

    pub(super) fn jacobian(&self) -> ([Vec2<Unit>; 2], [Ratio; 2]) {
        ([self.n, self.n_b], [self.e_a, self.e_b])
    }

    pub(crate) fn reversed(&self) -> Self {
        let Row { n, n_b, e_a, e_b, g_a, g_b, f_a, f_b } = *self;
        Row { n: -n, n_b: -n_b, e_a: -e_a, e_b: -e_b, g_a, g_b, f_a: -f_a, f_b: -f_b }
    }

    #[inline]
    pub(crate) fn velocity(&self, a: &SolverBody, b: &SolverBody, faults: &mut Faults) -> Speed {
        let along = |n: Vec2<Unit>, velocity: Vec2<Speed>| {
            i64::from(n.x.to_bits()) * i64::from(velocity.x.to_bits())
                + i64::from(n.y.to_bits()) * i64::from(velocity.y.to_bits())
        };
        let linear = along(self.n_b, b.velocity) - along(self.n, a.velocity);
        let bits = self.along(linear, a.spin.to_bits(), b.spin.to_bits());
        let vn = saturate(bits);
        *faults += u64::from(i64::from(vn) != bits);
        Speed::from_bits(vn)
    }

    /// `nB.vB - nA.vA + eB uB - eA uA` in the format of speeds. `linear` is the sum of the first two terms, with 30
    /// more fraction bits. As bits, `linear` is below 2^63, because speeds are below 2^30 and directions at most 2
    /// long.
    #[inline]
    fn along(&self, linear: i64, turn_a: i32, turn_b: i32) -> i64 {
        let angular = i64::from(self.e_b.to_bits()) * i64::from(turn_b)
            - i64::from(self.e_a.to_bits()) * i64::from(turn_a);
        round_shift(round_shift(linear, 6) + angular, 24)
    }

    /// Changes the velocities by an impulse `d` of at most [`STEP_MAX`].
    #[inline]
    fn apply_step(&self, d: Speed, bodies: &mut BodyPair<'_>) {
        let times = |gain: i64| gain * i64::from(d.to_bits());
        let along = |n: Unit, change: i64| {
            saturate_wide(round_shift_wide(i128::from(n.to_bits()) * i128::from(change), 30))
        };
        let change = |n: Vec2<Unit>, linear: i64, spin: i64| Change {
            x: along(n.x, linear),
            y: along(n.y, linear),
            spin,
        };
        bodies.change(
            change(self.n, -times(self.g_a), -times(self.f_a.to_bits().into())),
            change(self.n_b, times(self.g_b), times(self.f_b.to_bits().into())),
        );
    }

    /// Adds an impulse in units of [`Speed`] to `lambda`, within the bounds. Applies and returns the change.
    #[inline]
    pub(crate) fn accumulate(
        &self,
        d: i64,
        (lo, hi): (Speed, Speed),
        lambda: &mut Speed,
        bodies: &mut BodyPair<'_>,
    ) -> Speed {
        let wanted = i64::from(lambda.to_bits()) + d;
        let bounded = wanted.clamp(lo.to_bits().into(), hi.to_bits().into());
        let within = bounded.clamp(-i64::from(IMPULSE_MAX.to_bits()), IMPULSE_MAX.to_bits().into());
        *bodies.faults += u64::from(within != bounded);
        let d = within - i64::from(lambda.to_bits());
        *lambda = Speed::from_bits(saturate(within));
        self.apply_wide(d, bodies);
        Speed::from_bits(saturate(d))
    }

    #[inline]
    pub(crate) fn apply(&self, d: Speed, bodies: &mut BodyPair<'_>) {
        self.apply_wide(d.to_bits().into(), bodies);
    }

    /// Changes the velocities by an impulse in units of [`Speed`], which may exceed the range of [`Speed`].
    #[inline]
    fn apply_wide(&self, d: i64, bodies: &mut BodyPair<'_>) {
        if d.unsigned_abs() <= u64::from(STEP_MAX.to_bits().unsigned_abs()) {
            self.apply_step(Speed::from_bits(saturate(d)), bodies);
        } else {
            self.apply_in_steps(d, bodies);
        }
    }

    /// Applies an impulse of more than 512 m/s. Such impulses occur when a bound shrinks or a body under load is
    /// released.
    #[cold]
    fn apply_in_steps(&self, mut d: i64, bodies: &mut BodyPair<'_>) {
        let limit = i64::from(STEP_MAX.to_bits());
        while d != 0 {
            let step = d.clamp(-limit, limit);
            self.apply_step(Speed::from_bits(saturate(step)), bodies);
            d -= step;
        }
    }
}

/// `L = p D`, where `p` was computed with an earlier `D`. The result is only an initial guess, so clamping it does not
/// count as a fault.
pub(crate) fn lambda_of(p: Speed, denominator: Denominator) -> Speed {
    let bits = round_shift_wide(i128::from(p.to_bits()) * i128::from(denominator), 30);
    Speed::from_bits(saturate(saturate_wide(bits))).clamp(-IMPULSE_MAX, IMPULSE_MAX)
}

/// `p = L / D`: the impulse times the sum of the inverse masses. Unlike `L`, it does not depend on the lever arms.
pub(crate) fn impulse_of(lambda: Speed, denominator: Denominator) -> Speed {
    let bits = div_round(i128::from(lambda.to_bits()) << 30, denominator.max(1).into());
    Speed::from_bits(saturate(saturate_wide(bits)))
}

#[cfg(test)]
mod tests;
