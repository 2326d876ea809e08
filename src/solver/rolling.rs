//! Rolling resistance of a contact: one angular row, limited by the normal impulses.
//!
//! A wheel that deforms is pushed back in front of its axle: a torque of at most `R N` against rolling, with a length
//! `R` and the normal force `N` (E. Catto uses the same model in Box2D 3). With the scale `s` of [`Row::angular`]:
//!
//! ```text
//! vn = s (wB - wA) = eB uB - eA uA           e = s / k
//! D  = aA eA^2 + aB eB^2
//! |L / D| s <= R sum Ln / Dn
//! ```

use super::body::SolverBody;
use super::contact::{Surface, grip};
use super::limits::{Faults, IMPULSE_MAX};
use super::row::{Denominator, MassFractions, Row, impulse_of, lambda_of};
use super::softness::Softness;
use crate::body::Body;
use crate::math::{Fx, Grip, Speed, fx_div, mul};

/// The angular row of a contact, for one tick.
#[derive(Clone, Debug)]
pub(super) struct Rolling {
    row: Row,
    denominator: Denominator,
    /// Limit for each unit of a point's normal impulse: `R D / (s Dn)`.
    grips: [Grip; 2],
    lambda: Speed,
}

impl Rolling {
    /// `carried` is the impulse of the last tick; `normals` are the denominators of the points. `None` for surfaces
    /// without resistance.
    pub(super) fn prepare(
        surface: &Surface,
        (a, b): (&Body, &Body),
        fractions: MassFractions,
        normals: [Denominator; 2],
        carried: Speed,
    ) -> Option<Self> {
        if surface.rolling_resistance == Fx::ZERO {
            return None;
        }
        let (row, denominator, scale) =
            Row::angular(a.mass.inverse_gyration, b.mass.inverse_gyration, fractions);
        // Neither body turns if there is no scale.
        let length = fx_div(surface.rolling_resistance, scale.into())?;
        let grips = normals.map(|normal| grip(length, denominator, normal));
        Some(Rolling { row, denominator, grips, lambda: lambda_of(carried, denominator) })
    }

    pub(super) fn warm_start(&mut self, a: &mut SolverBody, b: &mut SolverBody, faults: &mut Faults) {
        self.row.apply(self.lambda, a, b, faults);
    }

    /// `normals` are the impulses of the points; that of a missing one is 0.
    #[inline]
    pub(super) fn solve(
        &mut self,
        a: &mut SolverBody,
        b: &mut SolverBody,
        normals: [Speed; 2],
        faults: &mut Faults,
    ) {
        let part = |i: usize| -> Speed { mul(self.grips[i], normals[i]) };
        let limit = part(0).saturating_add(part(1)).min(IMPULSE_MAX);
        let (bias, bounds) = (Speed::ZERO, (-limit, limit));
        self.row.solve(a, b, bias, &Softness::RIGID, bounds, &mut self.lambda, faults);
    }

    /// The impulse to carry over.
    pub(super) fn store(&self) -> Speed {
        impulse_of(self.lambda, self.denominator)
    }
}
