//! Mobility of the two bodies of a unit: the velocity changes that impulses cause.

use super::ONE;
use super::scaling::product;
use crate::math::Ratio;
use crate::solver::row::{MassFractions, turning};

#[derive(Clone, Copy, Debug)]
pub(super) struct Mobility {
    pub(super) fractions: MassFractions,
    /// Square roots of the fractions, with 30 fraction bits.
    pub(super) roots: [i64; 2],
    /// Factor of geometric stiffness on the inverse inertia of each body, `I / (I + h^2 F r)`, with 30 fraction bits.
    spins: [i64; 2],
    pub(super) spin_roots: [i64; 2],
}

impl Mobility {
    pub(super) fn new(fractions: MassFractions) -> Self {
        let roots = [fractions.a, fractions.b].map(|a| root(a.to_bits().into()));
        Mobility { fractions, roots, spins: [ONE; 2], spin_roots: [ONE; 2] }
    }

    /// Sets the factors of geometric stiffness. Returns whether they have changed.
    pub(super) fn set_spins(&mut self, spins: [i64; 2]) -> bool {
        let changed = self.spins != spins;
        if changed {
            (self.spins, self.spin_roots) = (spins, spins.map(root));
        }
        changed
    }

    pub(super) fn is_stiffened(&self) -> bool {
        self.spins != [ONE; 2]
    }

    /// The part of an entry of `K` (or of `D` if `other` is `e`) that comes from rotations: the sum over both bodies of
    /// `a e other` times the factor of geometric stiffness.
    pub(super) fn turning(&self, e: [Ratio; 2], other: [Ratio; 2]) -> i64 {
        let MassFractions { a, b } = self.fractions;
        product(turning(a, e[0], other[0]), self.spins[0])
            + product(turning(b, e[1], other[1]), self.spins[1])
    }

    /// Decrease of the denominator of a row by geometric stiffness.
    pub(super) fn lost_turning(&self, e: [Ratio; 2]) -> i64 {
        if self.is_stiffened() { Mobility::new(self.fractions).turning(e, e) - self.turning(e, e) } else { 0 }
    }
}

/// The square root of a number from 0 to 1 with 30 fraction bits.
fn root(x: i64) -> i64 {
    (x.unsigned_abs() << 30).isqrt().cast_signed()
}
