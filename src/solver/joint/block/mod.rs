//! Blocks: joints that one iteration after the other cannot solve are solved together, exactly.
//!
//! Warm-started iterations over joints that meet at one body may diverge: they are a heavy ball with momentum 1 in the
//! sense of B. Polyak (1964), and joints that disturb each other in a circle make it spiral outwards. `choice.rs` finds
//! such joints. All their rows without limits, `i`, then get the changes `d` that satisfy the softness of every row at
//! once, instead of the changes `w` that each row by itself would make:
//!
//! ```text
//! w_i = -massScale_i (v_i + bias_i) - impulseScale_i L_i           as for a single row
//! A_ij = sum over common bodies of H_i . H_j,  A_ii = 1            `scaling.rs`
//! S_i = sqrt(massScale_i),   (1 - S^2 + S A S) z = w / S,   d = S z
//! ```
//!
//! Changes are also divided by `Q = sqrt(m_least / m)`, where `m` is the reduced mass of the two bodies, because the
//! matrix is symmetric only for impulses, not for speeds.
//!
//! This is `A d + (impulseScale / massScale) d = w / massScale` with a unit diagonal, whose smallest eigenvalue is at
//! least the smallest impulse scale, whatever masses and arms are, even if rows depend on each other, as in a loop of
//! welds. The relax pass, which has no softness, adds [`EXCESS`] to the diagonal instead. The matrix depends on the pose
//! alone. The impulses and the arithmetic that applies them are those of single rows.

mod choice;
mod matrix;
mod scaling;
mod unit;

use alloc::vec::Vec;

use super::super::context::{Pass, StepContext};
use super::super::settings::Tuning;
use super::hinge::{HingeSet, Poses};
use super::list::{BlockedPart, JointList};
use choice::Choice;
pub(super) use choice::Candidate;
use matrix::{Factor, Matrix, ONE};
use scaling::{ScaledRow, product, root_and_inverse};
use unit::Unit;
use crate::math::{Fx, div_round, saturate_wide};

/// Added to the diagonal in the relax pass, with 30 fraction bits: 2^-14. It leaves this share of the velocity of rows
/// that no other row disturbs.
const EXCESS: i64 = 1 << 16;

/// All blocks of a tick.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks {
    choice: Choice,
    blocks: Vec<Block>,
    /// Whether bodies have moved since the matrices were computed.
    is_stale: bool,
}

/// Joints that are solved together.
#[derive(Clone, Debug, Default)]
struct Block {
    units: Vec<Unit>,
    /// Pairs of units with a common body, the later one first. Each unit is also paired with itself.
    pairs: Vec<(u32, u32)>,
    rows: Vec<ScaledRow>,
    bias: Scales,
    relax: Scales,
    matrix: Matrix,
    factor: Factor,
    /// The pass for which the factor is.
    factored: Option<Pass>,
    /// The unknowns.
    x: Vec<i64>,
}

/// Scales of each row, with 30 fraction bits. All are 0 for rows that the pass leaves out.
#[derive(Clone, Debug, Default)]
struct Scales {
    /// `S`.
    scales: Vec<i64>,
    /// `1 / (S Q)`, by which changes are multiplied before the equations are solved.
    inwards: Vec<i64>,
    /// `S Q`, by which the results are multiplied.
    outwards: Vec<i64>,
}

impl Scales {
    fn push(&mut self, (scale, inverse): (i64, i64), (mass_root, mass_inverse): (i64, i64)) {
        self.scales.push(scale);
        self.inwards.push(product(inverse, mass_inverse));
        self.outwards.push(product(scale, mass_root));
    }
}

/// `least / mass` with 30 fraction bits.
fn mass_share(least: Fx, mass: Fx) -> i64 {
    saturate_wide(div_round(i128::from(least.to_bits()) << 30, mass.to_bits().max(1).into())).clamp(0, ONE)
}

impl Blocks {
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.choice.order.clear();
        self.choice.block_ends.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.choice.order.is_empty()
    }

    /// Chooses the joints that are solved in blocks.
    pub(super) fn choose(&mut self, candidates: &[Candidate], body_count: usize) {
        self.choice.choose(candidates, body_count);
    }

    /// The chosen joints, by the indices of their candidates.
    pub(super) fn chosen(&self) -> &[u32] {
        &self.choice.order
    }

    /// Arranges the chosen joints. `numbers` has the number of each chosen hinge among the hinges in blocks, and
    /// the slot of each other joint, by which its parts are sorted.
    pub(super) fn arrange(
        &mut self,
        hinges: &HingeSet,
        parts: &[(u32, BlockedPart)],
        tuning: &Tuning,
        candidates: &[Candidate],
        numbers: &[Result<usize, u32>],
    ) {
        let mut start = 0;
        for &end in &self.choice.block_ends {
            let mut block = Block::default();
            let joints = &self.choice.order[start..end];
            let mass = |&joint: &u32| candidates[joint as usize].reduced_mass;
            let least = joints.iter().map(mass).min().unwrap_or(Fx::ONE);
            for (joint, number) in joints.iter().zip(&numbers[start..end]) {
                let share = mass_share(least, mass(joint));
                match *number {
                    Ok(number) => block.push(Unit::hinge(number, hinges, tuning), share),
                    Err(slot) => {
                        let first = parts.partition_point(|&(other, _)| other < slot);
                        let own = parts[first..].iter().take_while(|&&(other, _)| other == slot);
                        own.for_each(|(_, part)| block.push(Unit::part(part), share));
                    }
                }
            }
            start = end;
            block.arrange();
            self.blocks.push(block);
        }
        self.is_stale = true;
    }

    /// Invalidates the matrices, because bodies have moved.
    pub(super) fn expire(&mut self) {
        self.is_stale = true;
    }

    /// Solves all blocks, one after the other.
    pub(super) fn solve(
        &mut self,
        pass: Pass,
        hinges: &mut HingeSet,
        list: &mut JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
    ) {
        for block in &mut self.blocks {
            if self.is_stale {
                block.refresh(hinges, list);
            }
            block.solve(pass, hinges, list, poses, context);
        }
        self.is_stale = false;
    }
}

impl Block {
    /// Adds a unit. `share` is the smallest reduced mass of the block divided by that of the unit.
    fn push(&mut self, mut unit: Unit, share: i64) {
        unit.row = self.bias.scales.len();
        let mass = root_and_inverse(share);
        for softness in unit.rows() {
            self.bias.push(root_and_inverse(softness.mass_scale.to_bits().into()), mass);
            self.relax.push(if softness.is_spring { (0, 0) } else { (ONE, ONE) }, mass);
        }
        self.units.push(unit);
    }

    /// Finds the pairs of units with a common body, and the envelope of the matrix.
    fn arrange(&mut self) {
        let Block { units, pairs, rows, matrix, x, bias, .. } = self;
        for (at, unit) in (0..).zip(units.iter()) {
            let mut first = unit.row;
            for (earlier, other) in (0..=at).zip(units.iter()) {
                if earlier == at || unit.touches(other) {
                    first = first.min(other.row);
                    pairs.push((at, earlier));
                }
            }
            unit.rows().for_each(|_| matrix.push_row(first));
        }
        rows.resize(bias.scales.len(), ScaledRow::default());
        x.resize(bias.scales.len(), 0);
    }

    /// Computes the matrix at the current pose.
    fn refresh(&mut self, hinges: &HingeSet, list: &JointList) {
        let Block { units, pairs, rows, matrix, factored, .. } = self;
        *factored = None;
        for unit in units.iter_mut() {
            unit.refresh(hinges, list, rows);
        }
        for &(later, earlier) in pairs.iter() {
            let (unit, other) = (&units[later as usize], &units[earlier as usize]);
            let sides = unit.common_sides(other);
            for row in unit.range() {
                for column in other.range().filter(|&column| column < row) {
                    let parts = sides.iter().flatten().map(|&(side, other)| dot(rows[row][side], rows[column][other]));
                    matrix.set(row, column, crate::math::round_shift(parts.sum(), 30));
                }
            }
        }
    }

    fn solve(
        &mut self,
        pass: Pass,
        hinges: &mut HingeSet,
        list: &mut JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
    ) {
        let Block { units, bias, relax, matrix, factor, factored, x, .. } = self;
        let (Scales { scales, inwards, outwards }, excess) = match pass {
            Pass::Bias => (&*bias, 0),
            Pass::Relax => (&*relax, EXCESS),
        };
        if *factored != Some(pass) {
            factor.compute(matrix, scales, excess);
            *factored = Some(pass);
        }
        let mut faults = 0;
        for unit in units.iter() {
            let wanted = unit.wanted(pass, hinges, list, poses, context, &mut faults);
            for (row, wanted) in unit.range().zip(wanted) {
                x[row] = product(wanted, inwards[row]);
            }
        }
        factor.solve(matrix, x);
        for unit in units.iter() {
            let mut changes = [0; 3];
            for (row, change) in unit.range().zip(&mut changes) {
                *change = product(x[row], outwards[row]);
            }
            unit.add(changes, hinges, list, context, &mut faults);
        }
        context.add_faults(faults);
    }
}

/// The scalar product of two scaled Jacobians, with 60 fraction bits.
fn dot(a: [i32; 3], b: [i32; 3]) -> i64 {
    let products = a.into_iter().zip(b).map(|(a, b)| i64::from(a) * i64::from(b));
    products.sum()
}
