//! Geometric stiffness: the torque of a pull changes while its arm turns.
//!
//! A force `F` that pulls a body outwards at an arm `r` exerts a restoring torque with the stiffness `F . r`, as on a
//! pendulum. If this torque is computed from the pose at the start of each sub-step, the body is a kicked rotor with
//! the kick `kappa = h^2 F . r / I`, whose energy grows if `kappa` is above about 1 (B. Chirikov, "A universal
//! instability of many-dimensional oscillator systems", 1979). A body whose kick is above [`KICK_MIN`] therefore
//! responds to the impulses of its block with the inertia `I + h^2 F . r`, as in a step that is implicit in the
//! rotation (S. Andrews, M. Teichmann and P. Kry, "Geometric Stiffness for Real-time Constrained Multibody Dynamics",
//! 2017). `F` is the force of the last sub-step.

use super::super::hinge::HingeSet;
use super::super::list::JointList;
use super::matrix::ONE;
use super::scaling::{length, product};
use super::{Block, Blocks};
use crate::math::{Ratio, Vec2, round_shift_wide, saturate_wide};

/// Smallest kick that changes the inertia, with 30 fraction bits. Bodies with smaller kicks are stable, and a larger
/// inertia would not conserve angular momentum.
const KICK_MIN: i64 = ONE / 2;

const KICK_MAX: i64 = 1000 * ONE;

/// The change of the torque of a force while its body rotates.
#[derive(Clone, Copy, Debug)]
pub(super) enum Leverage {
    /// No change: for a torque, and for a spring between two points, whose change is neglected.
    None,
    /// The point turns with the body, but the force does not: the derivative is `F . r`. Contains the lever ratios.
    AtPoint([Vec2<Ratio>; 2]),
    /// The force along an axis turns with A, and acts at a point of B. For either body, the stiffness is estimated as
    /// `|F|` times the length of its arm, an upper bound of the derivative with respect to its rotation. Contains the
    /// lengths of the lever ratios.
    AlongAxis([Ratio; 2]),
}

impl Leverage {
    /// The change of an impulse's torque per radian of rotation, divided by the radius of gyration.
    fn stiffness(&self, side: usize, impulse: [i64; 2]) -> i64 {
        let [x, y] = impulse.map(i128::from);
        let product = match self {
            Leverage::None => 0,
            Leverage::AtPoint(e) => x * i128::from(e[side].y.to_bits()) - y * i128::from(e[side].x.to_bits()),
            Leverage::AlongAxis(reach) => length(impulse) * i128::from(reach[side].to_bits()),
        };
        saturate_wide(round_shift_wide(product, 24))
    }
}

impl Blocks {
    /// Computes the inertia from the impulses of the last sub-step. `rotation_of` converts the scaled angular velocity
    /// of a body, with 32 fraction bits, to its rotation in a sub-step, with 30 fraction bits.
    pub(super) fn update_inertia(
        &mut self,
        hinges: &HingeSet,
        list: &JointList,
        rotation_of: impl Fn(u32, i64) -> i64,
    ) {
        // In the first sub-step, the impulses of the last tick are known, but the rows on which they act are not
        // computed yet.
        if core::mem::take(&mut self.is_first_sub_step) {
            self.refresh(hinges, list);
        }
        for block in &mut self.blocks {
            if block.update_inertia(&rotation_of) {
                self.is_stale = true;
            }
        }
    }
}

impl Block {
    /// Returns whether the inertia of a body has changed.
    fn update_inertia(&mut self, rotation_of: &impl Fn(u32, i64) -> i64) -> bool {
        let Block { units, rows, bodies, places, impulses, spins, .. } = self;
        bodies.iter_mut().for_each(|(_, sum)| *sum = [0; 3]);
        for (unit, places) in units.iter().zip(places.iter()) {
            let mut own = [0; 3];
            unit.range().zip(&mut own).for_each(|(row, impulse)| *impulse = impulses[row]);
            let scaled = unit.scale(own);
            for side in 0..2 {
                let Some((_, root)) = unit.moved(side) else { continue };
                let mut change = [0i64; 2];
                for (row, x) in unit.range().zip(scaled).take(2) {
                    for (change, &entry) in change.iter_mut().zip(&rows[row][side]) {
                        *change = change.saturating_add(product(product(x, entry.into()), root));
                    }
                }
                let (_, [sum, ..]) = &mut bodies[places[side] as usize];
                *sum = sum.saturating_add(unit.leverage.stiffness(side, change));
            }
        }
        spins.clear();
        spins.extend(bodies.iter().map(|&(body, [outward, ..])| {
            let kick = rotation_of(body, outward).min(KICK_MAX);
            if kick > KICK_MIN { ONE * ONE / (ONE + kick) } else { ONE }
        }));
        let mut changed = false;
        for (unit, places) in units.iter_mut().zip(places.iter()) {
            changed |= unit.set_spins([0, 1].map(|side: usize| match unit.moved(side) {
                Some(_) => spins[places[side] as usize],
                None => ONE,
            }));
        }
        changed
    }

    /// Removes geometric stiffness from the impulses, because joints store impulses without it.
    pub(super) fn restore_inertia(&mut self, hinges: &HingeSet, list: &JointList) {
        let Block { units, rows, impulses, .. } = self;
        for unit in units.iter_mut().filter(|unit| unit.is_stiffened()) {
            let mut own = [0; 3];
            unit.range().zip(&mut own).for_each(|(row, impulse)| *impulse = impulses[row]);
            let exerted = unit.exerted(own);
            unit.set_spins([ONE; 2]);
            unit.refresh(hinges, list, rows);
            for (row, impulse) in unit.range().zip(unit.scaled_by_denominator(exerted)) {
                impulses[row] = impulse;
            }
        }
    }
}
