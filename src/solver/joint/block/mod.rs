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
use super::list::{BlockedPart, BlockedTask, JointList};
use choice::Choice;
pub(super) use choice::Candidate;
use matrix::{Factor, Matrix, ONE};
use scaling::{ScaledRow, product, root_and_inverse};
use unit::Unit;
use crate::math::{Fx, Speed, div_round, round_shift, saturate, saturate_wide};

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
    limits: Vec<Limit>,
    /// The scales of the current pass, if the block has limits.
    current: Scales,
    /// `L` of each row, a speed with 32 fraction bits. It may be larger than a joint can store.
    impulses: Vec<i64>,
    /// The bodies, and changes of their velocities with 32 fraction bits.
    bodies: Vec<(u32, [i64; 3])>,
    /// For each unit, the places of its bodies in `bodies`.
    places: Vec<[u32; 2]>,
    /// The changes that each row by itself would make.
    wanted: Vec<i64>,
    /// The unknowns, with 32 fraction bits.
    x: Vec<i64>,
}

/// A limit in a block.
#[derive(Clone, Copy, Debug)]
struct Limit {
    unit: usize,
    row: usize,
    /// `Q` and `1 / Q`.
    mass: (i64, i64),
    /// Whether it acts in the current pass.
    is_active: bool,
}

/// `S^2` of a limit that is not reached, with 30 fraction bits: 1, less so much that rows that depend on it have a
/// solution.
const OPEN_SCALE: i64 = ONE - (1 << 20);

/// Scales of each row, with 30 fraction bits. All are 0 for rows that the pass leaves out.
#[derive(Clone, Debug, Default)]
struct Scales {
    /// `S`.
    scales: Vec<i64>,
    /// `1 / (S Q)`, by which changes are multiplied before the equations are solved.
    inwards: Vec<i64>,
    /// `S Q`, by which the results are multiplied.
    outwards: Vec<i64>,
    /// `impulseScale`.
    yields: Vec<i64>,
}

impl Scales {
    /// Adds a row with `S` and `1 / S`, and with `Q` and `1 / Q`.
    fn push(&mut self, scale: (i64, i64), mass: (i64, i64), give: i64) {
        for numbers in [&mut self.scales, &mut self.inwards, &mut self.outwards, &mut self.yields] {
            numbers.push(0);
        }
        self.set(self.scales.len() - 1, scale, mass, give);
    }

    fn set(&mut self, row: usize, (scale, inverse): (i64, i64), (mass_root, mass_inverse): (i64, i64), give: i64) {
        self.scales[row] = scale;
        self.inwards[row] = product(inverse, mass_inverse);
        self.outwards[row] = product(scale, mass_root);
        self.yields[row] = give;
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
                    Ok(number) => {
                        Unit::of_hinge(number, hinges, tuning).for_each(|unit| block.push(unit, share));
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

    /// Invalidates the matrices, because bodies have moved.
    pub(super) fn expire(&mut self) {
        self.is_stale = true;
    }

    /// Takes the impulses of the last tick from the joints, at the start of a tick.
    pub(super) fn take_impulses(&mut self, hinges: &mut HingeSet, list: &mut JointList) {
        self.blocks.iter_mut().for_each(|block| block.take_impulses(hinges, list));
    }

    /// Returns the impulses to the joints, at the end of a tick.
    pub(super) fn return_impulses(&mut self, hinges: &mut HingeSet, list: &mut JointList) {
        self.blocks.iter().for_each(|block| block.return_impulses(hinges, list));
    }

    /// Starts a sub-step with impulses of 0. Equations that are solved exactly need no warm start, and softness has the
    /// same result without. At a light body between heavy ones the impulses are large and cancel, but those of the last
    /// pose do not cancel at the new one.
    pub(super) fn start_sub_step(&mut self) {
        self.blocks.iter_mut().for_each(|block| block.impulses.fill(0));
    }

    fn refresh(&mut self, hinges: &HingeSet, list: &JointList) {
        if core::mem::take(&mut self.is_stale) {
            self.blocks.iter_mut().for_each(|block| block.refresh(hinges, list));
        }
    }

    /// Solves all blocks, one after the other.
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
    /// Adds a unit. `share` is the smallest reduced mass of the block divided by that of the unit.
    fn push(&mut self, mut unit: Unit, share: i64) {
        unit.row = self.bias.scales.len();
        let mass = root_and_inverse(share);
        for softness in unit.rows() {
            let mass_scale = i64::from(softness.mass_scale.to_bits());
            self.bias.push(root_and_inverse(mass_scale), mass, ONE - mass_scale);
            self.relax.push(if softness.task == BlockedTask::Spring { (0, 0) } else { (ONE, ONE) }, mass, 0);
        }
        if unit.is_limit() {
            self.limits.push(Limit { unit: self.units.len(), row: unit.row, mass, is_active: false });
        }
        self.units.push(unit);
    }

    /// Finds the pairs of units with a common body, and the envelope of the matrix.
    fn arrange(&mut self) {
        let Block { units, pairs, rows, matrix, x, bias, impulses, wanted, bodies, places, .. } = self;
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
        impulses.resize(bias.scales.len(), 0);
        wanted.resize(bias.scales.len(), 0);
        places.extend(units.iter().map(|unit| {
            [0, 1].map(|side: usize| unit.moved(side).map_or(0, |(body, _)| {
                let known = bodies.iter().position(|&(other, _)| other == body);
                let place = known.unwrap_or_else(|| {
                    bodies.push((body, [0; 3]));
                    bodies.len() - 1
                });
                u32::try_from(place).expect("a block has a handful of bodies")
            }))
        }));
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
                    matrix.set(row, column, round_shift(parts.sum(), 30));
                }
            }
        }
    }

    /// Takes the impulses of the last tick from the joints.
    fn take_impulses(&mut self, hinges: &mut HingeSet, list: &mut JointList) {
        for unit in &self.units {
            let impulses = unit.take_impulses(hinges, list);
            for (row, impulse) in unit.range().zip(impulses) {
                self.impulses[row] = i64::from(impulse) << EXTRA_BITS;
            }
        }
    }

    /// Returns the impulses to the joints, for the next tick. What does not fit their format is dropped: the impulses
    /// are only where the next tick begins.
    fn return_impulses(&self, hinges: &mut HingeSet, list: &mut JointList) {
        for unit in &self.units {
            let mut impulses = [0; 3];
            for (part, row) in unit.range().enumerate() {
                let most = unit.impulse_max(part).to_bits();
                impulses[part] = saturate(round_shift(self.impulses[row], EXTRA_BITS)).clamp(-most, most);
            }
            unit.return_impulses(impulses, hinges, list);
        }
    }

    fn solve(
        &mut self,
        pass: Pass,
        hinges: &HingeSet,
        list: &JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
    ) {
        if self.limits.is_empty() {
            self.compute_factor(pass);
            self.want(pass, hinges, list, poses, context);
            self.compute_changes(pass);
        } else {
            self.solve_with_limits(pass, hinges, list, poses, context);
        }
        self.accept(context);
    }

    /// Finds the limits that act, by releasing those that would pull. What is released has no impulse.
    fn solve_with_limits(
        &mut self,
        pass: Pass,
        hinges: &HingeSet,
        list: &JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
    ) {
        self.want(pass, hinges, list, poses, context);
        self.activate(pass, hinges, list);
        // A limit that was released stays so, so that the loop ends.
        loop {
            if self.release(context) {
                self.want(pass, hinges, list, poses, context);
            }
            self.set_current_scales(pass, hinges, list);
            self.factored = None;
            self.compute_factor(pass);
            self.compute_changes(pass);
            let Block { limits, units, impulses, x, .. } = self;
            let mut pulls = false;
            for limit in limits.iter_mut().filter(|limit| limit.is_active) {
                let [change, ..] = units[limit.unit].restore([x[limit.row], 0, 0]);
                limit.is_active = impulses[limit.row].saturating_add(change) >= 0;
                pulls |= !limit.is_active;
            }
            if !pulls {
                return;
            }
        }
    }

    /// Activates the limits that would push if nothing but their own bodies were there.
    fn activate(&mut self, pass: Pass, hinges: &HingeSet, list: &JointList) {
        let Block { limits, units, impulses, wanted, .. } = self;
        for limit in limits.iter_mut() {
            let (impulse, change) = (impulses[limit.row], wanted[limit.row]);
            let unit = &units[limit.unit];
            // As with contacts, a gap without an impulse is left to the next sub-step.
            let untouched = pass == Pass::Relax && impulse == 0 && unit.is_open(hinges, list);
            limit.is_active = !untouched && impulse.saturating_add(change) > 0;
        }
    }

    /// Takes the impulses of limits that do not act away. Returns whether there were any.
    fn release(&mut self, context: &StepContext<'_>) -> bool {
        let Block { limits, units, impulses, x, .. } = self;
        x.fill(0);
        let mut any = false;
        for limit in limits.iter().filter(|limit| !limit.is_active) {
            let impulse = core::mem::take(&mut impulses[limit.row]);
            [x[limit.row], ..] = units[limit.unit].scale([impulse.saturating_neg(), 0, 0]);
            any |= impulse != 0;
        }
        if any {
            self.apply(context);
        }
        any
    }

    /// The scales of a pass for the limits that act.
    fn set_current_scales(&mut self, pass: Pass, hinges: &HingeSet, list: &JointList) {
        let Block { limits, units, bias, relax, current, .. } = self;
        current.clone_from(match pass {
            Pass::Bias => bias,
            Pass::Relax => relax,
        });
        for limit in limits.iter() {
            if !limit.is_active {
                current.set(limit.row, (0, 0), limit.mass, 0);
            } else if units[limit.unit].is_open(hinges, list) {
                current.set(limit.row, root_and_inverse(OPEN_SCALE), limit.mass, 0);
            }
        }
    }

    fn scales(&self, pass: Pass) -> &Scales {
        match pass {
            _ if !self.limits.is_empty() => &self.current,
            Pass::Bias => &self.bias,
            Pass::Relax => &self.relax,
        }
    }

    fn compute_factor(&mut self, pass: Pass) {
        if self.factored != Some(pass) {
            let excess = match pass {
                Pass::Bias => 0,
                Pass::Relax => EXCESS,
            };
            let mut factor = core::mem::take(&mut self.factor);
            factor.compute(&self.matrix, &self.scales(pass).scales, excess);
            self.factor = factor;
            self.factored = Some(pass);
        }
    }

    /// Computes the changes that each row by itself would make.
    fn want(
        &mut self,
        pass: Pass,
        hinges: &HingeSet,
        list: &JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
    ) {
        let Block { units, bias, limits, impulses, wanted, .. } = self;
        let mut faults = 0;
        for unit in units.iter() {
            let changes = unit.wanted(pass, hinges, list, poses, context, &mut faults);
            for (row, change) in unit.range().zip(changes) {
                let give = if pass == Pass::Bias { bias.yields[row] } else { 0 };
                wanted[row] = (change << EXTRA_BITS).saturating_sub(product(impulses[row], give));
            }
        }
        for limit in limits.iter().filter(|limit| units[limit.unit].is_open(hinges, list)) {
            // A limit that is not reached is not soft.
            if pass == Pass::Bias {
                wanted[limit.row] = wanted[limit.row].saturating_add(product(impulses[limit.row], bias.yields[limit.row]));
            }
        }
        context.add_faults(faults);
    }

    /// Solves the equations for the scaled changes of the impulses, `x`.
    fn compute_changes(&mut self, pass: Pass) {
        let mut x = core::mem::take(&mut self.x);
        let Scales { inwards, outwards, .. } = self.scales(pass);
        for unit in &self.units {
            let mut wanted = [0; 3];
            unit.range().zip(&mut wanted).for_each(|(row, part)| *part = self.wanted[row]);
            for (row, scaled) in unit.range().zip(unit.scale(wanted)) {
                x[row] = product(scaled, inwards[row]);
            }
        }
        self.factor.solve(&self.matrix, &mut x);
        x.iter_mut().zip(outwards).for_each(|(x, &outward)| *x = product(*x, outward));
        self.x = x;
    }

    /// Adds the changes to the impulses and applies them.
    fn accept(&mut self, context: &StepContext<'_>) {
        for unit in &self.units {
            let mut changes = [0; 3];
            unit.range().zip(&mut changes).for_each(|(row, change)| *change = self.x[row]);
            for (row, change) in unit.range().zip(unit.restore(changes)) {
                self.impulses[row] = self.impulses[row].saturating_add(change);
            }
        }
        self.apply(context);
    }

    /// Changes the velocities by the scaled impulses in `x`. Each velocity is rounded and clamped once: the impulses on
    /// a light body between heavy ones are large, and almost cancel.
    fn apply(&mut self, context: &StepContext<'_>) {
        let Block { units, rows, bodies, places, x, .. } = self;
        bodies.iter_mut().for_each(|(_, change)| *change = [0; 3]);
        for (unit, places) in units.iter().zip(places) {
            for side in 0..2 {
                let Some((_, root)) = unit.moved(side) else { continue };
                let mut sum = [0i64; 3];
                for row in unit.range() {
                    for (sum, &entry) in sum.iter_mut().zip(&rows[row][side]) {
                        *sum = sum.saturating_add(product(x[row], entry.into()));
                    }
                }
                let (_, change) = &mut bodies[places[side] as usize];
                for (change, sum) in change.iter_mut().zip(sum) {
                    *change = change.saturating_add(product(sum, root));
                }
            }
        }
        let mut faults = 0;
        for &(index, change) in bodies.iter() {
            let cell = &context.bodies[index as usize];
            let mut body = cell.get();
            let [d_x, d_y, d_spin] = change.map(|change| Speed::from_bits(saturate(round_shift(change, EXTRA_BITS))));
            let (x, y) = (body.velocity.x.saturating_add(d_x), body.velocity.y.saturating_add(d_y));
            body.set_velocity(x, y, body.spin.saturating_add(d_spin), &mut faults);
            cell.set(body);
        }
        context.add_faults(faults);
    }
}

/// Fraction bits of the numbers of a block beyond those of a speed.
const EXTRA_BITS: u32 = 32 - Speed::FRAC_NBITS;

/// The scalar product of two scaled Jacobians, with 60 fraction bits.
fn dot(a: [i32; 3], b: [i32; 3]) -> i64 {
    let products = a.into_iter().zip(b).map(|(a, b)| i64::from(a) * i64::from(b));
    products.sum()
}
