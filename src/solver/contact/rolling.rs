//! Rolling resistance of a contact: one angular row, limited by the normal impulses.
//!
//! A wheel that deforms is pushed back in front of its axle: a torque of at most `R N` against rolling, with a length
//! `R` and the normal force `N` (E. Catto uses the same model in Box2D 3). With the scale `s` of
//! [`super::super::row::Row::angular`]:
//!
//! ```text
//! vn = s (wB - wA) = eB uB - eA uA           e = s / k
//! D  = aA eA^2 + aB eB^2
//! |L / D| s <= R sum Ln / Dn
//! ```

use super::super::TouchingPair;
use super::super::body_list::BodyList;
use super::super::row::{Denominator, MassFractions, Row as ScalarRow, impulse_of, lambda_of};
use super::TANGENT_MAX;
use super::batch::Row;
use super::rows::grip;
use crate::lanes::Ints;
use crate::math::{Speed, Unit, fx_div, round_shift_wide, saturate_wide};

/// The rolling rows of a batch. Few surfaces resist rolling, and the others should not carry rows for it through the
/// caches.
#[derive(Clone, Debug)]
pub(super) struct RollingRows<const N: usize> {
    pub(super) row: Row<N>,
    /// Limit for each unit of a point's normal impulse: `R D / (s Dn)`.
    pub(super) grips: [Ints<N>; 2],
    pub(super) lambda: Ints<N>,
    denominators: [Denominator; N],
}

impl<const N: usize> RollingRows<N> {
    /// No rolling resistance in any lane.
    pub(super) const NONE: Self =
        RollingRows { row: Row::NONE, grips: [Ints::ZERO; 2], lambda: Ints::ZERO, denominators: [0; N] };

    /// `inverse_normals` are the reciprocals of the points' denominators, anything for a missing one.
    pub(super) fn fill(
        &mut self,
        lane: usize,
        pair: &TouchingPair,
        carried: Speed,
        list: &BodyList,
        inverse_normals: [Unit; 2],
    ) {
        let [a, b] = [pair.bodies.0, pair.bodies.1].map(|slot| list.facts(list.index_of(slot)));
        let fractions = MassFractions::of_masses(a.mass, b.mass);
        let (row, denominator, scale) = ScalarRow::angular(a.inverse_gyration, b.inverse_gyration, fractions);
        // Neither body turns if there is no scale.
        let Some(length) = fx_div(pair.surface.rolling_resistance, scale.into()) else { return };
        let (e, f) = row.turning_parts();
        (self.row.e_a.0[lane], self.row.e_b.0[lane]) = (e[0].to_bits(), e[1].to_bits());
        (self.row.a[2].0[lane], self.row.b[2].0[lane]) = (f[0].to_bits(), f[1].to_bits());
        for (grips, inverse) in self.grips.iter_mut().zip(inverse_normals) {
            let ratio = round_shift_wide(i128::from(denominator) * i128::from(inverse.to_bits()), 30);
            grips.0[lane] = grip(length, saturate_wide(ratio)).to_bits();
        }
        self.lambda.0[lane] = lambda_of(carried, denominator).clamp(-TANGENT_MAX, TANGENT_MAX).to_bits();
        self.denominators[lane] = denominator;
    }

    /// The impulse to carry over.
    pub(super) fn impulse(&self, lane: usize) -> Speed {
        impulse_of(Speed::from_bits(self.lambda.0[lane]), self.denominators[lane])
    }
}
