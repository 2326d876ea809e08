//! Rolling resistance of a contact: one angular row, limited by the normal impulses.
//!
//! A wheel that deforms is supported slightly ahead of its axle, which gives a torque of at most `R N` against rolling,
//! with a length `R` and the normal force `N` (the model of Box2D 3). With the scale `s` of
//! [`super::super::row::Row::angular`]:
//!
//! ```text
//! vn = s (wB - wA) = eB uB - eA uA           e = s / k
//! D  = aA eA^2 + aB eB^2
//! |L / D| s <= R sum Ln / Dn
//! ```

use super::super::body_list::BodyList;
use super::super::pair::{BodyPairW, clamp};
use super::super::row::{Denominator, MassFractions, Row as ScalarRow, impulse_of, lambda_of};
use super::batch::Row;
use super::overflow_policy::OverflowPolicy;
use super::rows::friction_ratio;
use super::{ActiveContact, TANGENT_MAX};
use crate::math::{Speed, Unit, fx_div, round_shift_wide, saturate_wide};
use crate::simd::{Ints, Lanes};

#[derive(Clone, Debug)]
pub(super) struct RollingRows<const N: usize> {
    pub(super) row: Row<N>,
    /// Limit per unit of a point's normal impulse: `R D / (s Dn)`.
    pub(super) friction_ratios: [Ints<N>; 2],
    pub(super) lambda: Ints<N>,
    denominators: [Denominator; N],
}

impl<const N: usize> RollingRows<N> {
    pub(super) const NONE: Self = RollingRows {
        row: Row::NONE,
        friction_ratios: [Ints::ZERO; 2],
        lambda: Ints::ZERO,
        denominators: [0; N],
    };

    /// Computes the row of a contact. `inverse_normals` are the reciprocals of its points' denominators, with any value
    /// for a missing point.
    pub(super) fn fill(
        &mut self,
        lane: usize,
        pair: &ActiveContact,
        carried: Speed,
        list: &BodyList,
        inverse_normals: [Unit; 2],
    ) {
        let [a, b] = [pair.bodies.0, pair.bodies.1].map(|slot| list.facts(list.index_of(slot)));
        let fractions = MassFractions::of_masses(a.mass, b.mass);
        let (row, denominator, scale) = ScalarRow::angular(a.inverse_gyration, b.inverse_gyration, fractions);
        // The scale is 0 if impulses turn neither body.
        let Some(length) = fx_div(pair.surface.rolling_resistance, scale.into()) else { return };
        let (e, f) = row.turning_parts();
        (self.row.e_a.0[lane], self.row.e_b.0[lane]) = (e[0].to_bits(), e[1].to_bits());
        (self.row.a[2].0[lane], self.row.b[2].0[lane]) = (f[0].to_bits(), f[1].to_bits());
        for (friction_ratios, inverse) in self.friction_ratios.iter_mut().zip(inverse_normals) {
            let ratio = round_shift_wide(i128::from(denominator) * i128::from(inverse.to_bits()), 30);
            friction_ratios.0[lane] = friction_ratio(length, saturate_wide(ratio)).to_bits();
        }
        self.lambda.0[lane] = lambda_of(carried, denominator).clamp(-TANGENT_MAX, TANGENT_MAX).to_bits();
        self.denominators[lane] = denominator;
    }

    #[inline(always)]
    pub(super) fn solve<L: Lanes<N>>(
        &mut self,
        limit: L::Int,
        pair: &mut BodyPairW<L, N>,
        policy: &mut impl OverflowPolicy<L, N>,
    ) {
        let vn = pair.velocity([L::splat(0), L::splat(0)], &self.row, policy);
        let old = L::load(&self.lambda);
        let new = clamp::<L, N>(L::sub_saturating(old, vn), limit);
        L::store(new, &mut self.lambda);
        policy.apply(pair, &self.row, L::sub(new, old));
    }

    pub(super) fn impulse(&self, lane: usize) -> Speed {
        impulse_of(Speed::from_bits(self.lambda.0[lane]), self.denominators[lane])
    }
}
