//! Factors by which the rows of a block are multiplied before and after its equations are solved.

use alloc::vec::Vec;

use super::ONE;
use super::scaling::product;
use crate::math::{Fx, div_round, saturate_wide};

/// Scales of each row, with 30 fraction bits. They are 0 for rows that the pass leaves out.
#[derive(Clone, Debug, Default)]
pub(super) struct Scales {
    /// `S` of the equations in `mod.rs`.
    pub(super) scales: Vec<i64>,
    /// `1 / (S Q)`, by which the right-hand side is multiplied.
    pub(super) inwards: Vec<i64>,
    /// `S Q`, by which the solution is multiplied.
    pub(super) outwards: Vec<i64>,
    /// `impulseScale` of the equations in `mod.rs`.
    pub(super) yields: Vec<i64>,
}

impl Scales {
    pub(super) fn push(&mut self, scale: (i64, i64), mass: (i64, i64), give: i64) {
        for numbers in [&mut self.scales, &mut self.inwards, &mut self.outwards, &mut self.yields] {
            numbers.push(0);
        }
        self.set(self.scales.len() - 1, scale, mass, give);
    }

    pub(super) fn set(
        &mut self,
        row: usize,
        (scale, inverse): (i64, i64),
        (mass_root, mass_inverse): (i64, i64),
        give: i64,
    ) {
        self.scales[row] = scale;
        self.inwards[row] = product(inverse, mass_inverse);
        self.outwards[row] = product(scale, mass_root);
        self.yields[row] = give;
    }
}

/// `least / mass` with 30 fraction bits.
pub(super) fn mass_share(least: Fx, mass: Fx) -> i64 {
    saturate_wide(div_round(i128::from(least.to_bits()) << 30, mass.to_bits().max(1).into())).clamp(0, ONE)
}
