//! Blocks: groups of joints that are solved together, because iterations over single joints do not converge.
//!
//! Warm-started iterations over joints that meet at one body may diverge: they are the heavy-ball method of B. Polyak
//! (1964) with momentum 1. `choice.rs` finds such joints. A block solves their rows `i` together, except rows that are
//! held at a bound (`bounds.rs`). The impulse changes `d` satisfy the soft constraints of all rows at once. A row alone
//! would change its impulse by `w`:
//!
//! ```text
//! w_i = -massScale_i (v_i + bias_i) - impulseScale_i L_i           as for a single row
//! A_ij = sum over common bodies of H_i . H_j,  A_ii = 1            `scaling.rs`
//! S_i = sqrt(massScale_i),   (1 - S^2 + S A S) z = w / S,   d = S z
//! ```
//!
//! The scale of a spring between two points contains its softness, so its `S` is 1.
//!
//! Impulse changes are stored as speeds, but the matrix is symmetric only for impulses. The right-hand side is
//! therefore also divided by `Q = sqrt(m_least / m)`, and the solution multiplied by it. `m` is the reduced mass of the
//! two bodies, and `m_least` is the smallest reduced mass in the block.
//!
//! The equation of `z` is `A d + (impulseScale / massScale) d = w / massScale`, scaled to a unit diagonal. The smallest
//! eigenvalue of its matrix is at least the smallest impulse scale, even if rows depend on each other, as in a loop of
//! welds. With springs between points at long arms the eigenvalue may be smaller. `matrix.rs` therefore bounds the
//! pivots. In the relax pass, which has no impulse scales, [`EXCESS`] is added to the diagonal. In a block, impulses
//! `L` have 32 fraction bits.

mod bounds;
mod choice;
mod geometric_stiffness;
mod matrix;
mod mobility;
mod scales;
mod scaling;
mod solve;
#[cfg(test)]
mod tests;
mod unit;

use alloc::vec::Vec;

use super::super::context::{Pass, StepContext};
use super::hinge::{HingeSet, Poses};
use super::list::{BlockedPart, BlockedTask, JointList};
use crate::math::{Fx, Speed, round_shift, saturate};
use bounds::BoundedUnit;
pub(super) use choice::Candidate;
use choice::Choice;
use matrix::{Factor, Matrix, ONE};
use scales::{Scales, mass_share};
use scaling::{ScaledRow, root_and_inverse};
use unit::Unit;

/// Addition to the diagonal in the relax pass, with 30 fraction bits: 2^-14. A row that no other row disturbs keeps
/// this share of its velocity.
const EXCESS: i64 = 1 << 16;

#[derive(Clone, Debug, Default)]
pub(super) struct Blocks {
    choice: Choice,
    blocks: Vec<Block>,
    is_stale: bool,
    is_first_sub_step: bool,
}

#[derive(Clone, Copy, Debug)]
struct Spring {
    /// Index among the rows of all joints that are not hinges.
    at: usize,
    row: usize,
    mass: (i64, i64),
}

#[derive(Clone, Debug, Default)]
struct Block {
    units: Vec<Unit>,
    /// Pairs of units with a common body, the later unit first. Each unit is also paired with itself, except a spring
    /// between two points.
    pairs: Vec<(u32, u32)>,
    rows: Vec<ScaledRow>,
    bias: Scales,
    relax: Scales,
    matrix: Matrix,
    factor: Factor,
    /// The pass for which `factor` was computed.
    factored: Option<Pass>,
    bounded: Vec<BoundedUnit>,
    /// Springs whose softness may depend on the pose.
    springs: Vec<Spring>,
    /// Scales of the current pass, if the block has rows with bounds.
    current: Scales,
    /// `L` of each row, a speed with 32 fraction bits. It may be larger than a joint can store.
    impulses: Vec<i64>,
    /// Bodies, and changes of their velocities with 32 fraction bits. The update of the inertia uses the changes as
    /// working memory.
    bodies: Vec<(u32, [i64; 3])>,
    /// For each unit, the indices of its two bodies in `bodies`.
    places: Vec<[u32; 2]>,
    /// Factor of geometric stiffness on the inverse inertia of each body.
    spins: Vec<i64>,
    wanted: Vec<i64>,
    /// Working memory for the right-hand side and the solution of the equations, with 32 fraction bits.
    x: Vec<i64>,
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

    pub(super) fn is_arranged(&self) -> bool {
        self.blocks.is_empty() == self.choice.order.is_empty()
    }

    pub(super) fn choose(&mut self, candidates: &[Candidate], body_count: usize) {
        self.choice.choose(candidates, body_count);
    }

    /// The chosen joints, as indices of candidates.
    pub(super) fn chosen(&self) -> &[u32] {
        &self.choice.order
    }

    /// Makes the blocks of the chosen joints. For each of these joints, `numbers` contains the number of a hinge among
    /// the hinges in blocks, or the slot of any other joint. `parts` is sorted by slot.
    pub(super) fn arrange(
        &mut self,
        hinges: &HingeSet,
        parts: &[(u32, BlockedPart)],
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
                    Ok(number) => {
                        Unit::of_hinge(number, hinges).for_each(|unit| block.push(unit, share));
                    }
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

    pub(super) fn expire(&mut self) {
        self.is_stale = true;
    }

    /// Takes the impulses from the joints, at the start of a tick.
    pub(super) fn take_impulses(&mut self, hinges: &mut HingeSet, list: &mut JointList) {
        self.is_first_sub_step = true;
        self.blocks.iter_mut().for_each(|block| block.take_impulses(hinges, list));
    }

    pub(super) fn return_impulses(&mut self, hinges: &mut HingeSet, list: &mut JointList) {
        self.blocks.iter_mut().for_each(|block| block.return_impulses(hinges, list));
    }

    /// Starts a sub-step with impulses of 0. Equations that are solved exactly need no warm start. At a light body
    /// between heavy ones, large impulses of the last pose would not cancel at the new pose.
    pub(super) fn start_sub_step(
        &mut self,
        hinges: &HingeSet,
        list: &JointList,
        rotation_of: impl Fn(u32, i64) -> i64,
    ) {
        self.update_inertia(hinges, list, rotation_of);
        self.blocks.iter_mut().for_each(|block| block.impulses.fill(0));
    }

    fn refresh(&mut self, hinges: &HingeSet, list: &JointList) {
        if core::mem::take(&mut self.is_stale) {
            self.blocks.iter_mut().for_each(|block| block.refresh(hinges, list));
        }
    }

    pub(super) fn solve(
        &mut self,
        pass: Pass,
        hinges: &HingeSet,
        list: &JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
    ) {
        self.refresh(hinges, list);
        for block in &mut self.blocks {
            block.solve(pass, hinges, list, poses, context);
        }
    }
}

impl Block {
    /// `share` is the smallest reduced mass of the block divided by the reduced mass of the unit.
    fn push(&mut self, mut unit: Unit, share: i64) {
        unit.row = self.bias.scales.len();
        let mass = root_and_inverse(share);
        for softness in unit.rows() {
            let mass_scale = i64::from(softness.mass_scale.to_bits());
            let scale = if unit.is_point_spring() { (ONE, ONE) } else { root_and_inverse(mass_scale) };
            self.bias.push(scale, mass, ONE - mass_scale);
            self.relax.push(if softness.task == BlockedTask::Spring { (0, 0) } else { (ONE, ONE) }, mass, 0);
        }
        if let Some(at) = unit.list_row().filter(|_| unit.is_spring()) {
            self.springs.push(Spring { at, row: unit.row, mass });
        }
        if unit.is_bounded() {
            self.bounded.push(BoundedUnit { unit: self.units.len(), mass, is_active: false, held: [0; 2] });
        }
        self.units.push(unit);
    }

    fn arrange(&mut self) {
        let Block { units, pairs, rows, matrix, x, bias, impulses, wanted, bodies, places, .. } = self;
        let mut first_columns = Vec::with_capacity(bias.scales.len());
        for (at, unit) in (0..).zip(units.iter()) {
            let mut first = unit.row;
            for (earlier, other) in (0..=at).zip(units.iter()) {
                if earlier == at || unit.touches(other) {
                    first = first.min(other.row);
                    // The scaling of a spring between two points already makes its two rows independent.
                    if earlier != at || !unit.is_point_spring() {
                        pairs.push((at, earlier));
                    }
                }
            }
            first_columns.extend(unit.rows().map(|_| first));
        }
        *matrix = Matrix::new(first_columns);
        rows.resize(bias.scales.len(), ScaledRow::default());
        x.resize(bias.scales.len(), 0);
        impulses.resize(bias.scales.len(), 0);
        wanted.resize(bias.scales.len(), 0);
        places.extend(units.iter().map(|unit| {
            [0, 1].map(|side: usize| {
                unit.moved(side).map_or(0, |(body, _)| {
                    let known = bodies.iter().position(|&(other, _)| other == body);
                    let place = known.unwrap_or_else(|| {
                        bodies.push((body, [0; 3]));
                        bodies.len() - 1
                    });
                    u32::try_from(place).expect("a block has a handful of bodies")
                })
            })
        }));
    }

    fn refresh(&mut self, hinges: &HingeSet, list: &JointList) {
        let Block { units, pairs, rows, matrix, factored, bias, springs, .. } = self;
        *factored = None;
        for &Spring { at, row, mass } in springs.iter() {
            let mass_scale = i64::from(list.row(at).softness().mass_scale.to_bits());
            bias.set(row, root_and_inverse(mass_scale), mass, ONE - mass_scale);
        }
        for unit in units.iter_mut() {
            unit.refresh(hinges, list, rows);
        }
        for &(later, earlier) in pairs.iter() {
            let (unit, other) = (&units[later as usize], &units[earlier as usize]);
            let sides = unit.common_sides(other);
            for row in unit.range() {
                for column in other.range().filter(|&column| column < row) {
                    let parts = sides
                        .iter()
                        .flatten()
                        .map(|&(side, other)| dot(rows[row][side], rows[column][other]));
                    matrix.set(row, column, round_shift(parts.sum(), 30));
                }
            }
        }
    }

    fn take_impulses(&mut self, hinges: &mut HingeSet, list: &mut JointList) {
        for unit in &self.units {
            let impulses = unit.take_impulses(hinges, list);
            for (row, impulse) in unit.range().zip(impulses) {
                self.impulses[row] = i64::from(impulse) << EXTRA_BITS;
            }
        }
    }

    /// Returns the impulses to the joints, clamped to their format. Clamping is not a fault here: the impulses are used
    /// for geometric stiffness, or as initial guesses if the joint leaves the block.
    fn return_impulses(&mut self, hinges: &mut HingeSet, list: &mut JointList) {
        self.restore_inertia(hinges, list);
        for unit in &self.units {
            let mut impulses = [0; 3];
            for (part, row) in unit.range().enumerate() {
                let most = unit.impulse_max(part).to_bits();
                impulses[part] = saturate(round_shift(self.impulses[row], EXTRA_BITS)).clamp(-most, most);
            }
            unit.return_impulses(impulses, hinges, list);
        }
    }
}

/// Number of additional fraction bits of the numbers of a block, compared with a speed.
const EXTRA_BITS: u32 = 32 - Speed::FRAC_NBITS;

/// Scalar product with 60 fraction bits.
fn dot(a: [i32; 3], b: [i32; 3]) -> i64 {
    let products = a.into_iter().zip(b).map(|(a, b)| i64::from(a) * i64::from(b));
    products.sum()
}
