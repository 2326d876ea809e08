//! Geometric stiffness: the torque of a pull changes while its arm turns.
//!
//! A force `F` that pulls a body outwards at an arm `r` returns the body like a pendulum with the stiffness `F . r`.
//! Computed from the pose at the start of each sub-step, this is a kicked rotor with the kick `kappa = h^2 F . r / I`,
//! and its energy grows if `kappa` is above about 1 (B. Chirikov, "A universal instability of many-dimensional
//! oscillator systems", 1979). A body above [`KICK_MIN`] therefore answers the impulses of its block with the inertia
//! `I + h^2 F . r`, as in a step that is implicit in the rotation (S. Andrews, M. Teichmann and P. Kry, "Geometric
//! Stiffness for Real-time Constrained Multibody Dynamics", 2017). `F` is that of the last sub-step.

use super::super::hinge::HingeSet;
use super::super::list::JointList;
use super::matrix::ONE;
use super::scaling::product;
use super::{Block, Blocks};
use crate::math::{round_shift_wide, saturate_wide};

/// Smallest kick that changes the inertia, with 30 fraction bits. The larger inertia costs angular momentum, so that
/// bodies below the instability keep theirs.
const KICK_MIN: i64 = ONE / 2;

/// Largest kick that is told from larger ones.
const KICK_MAX: i64 = 1000 * ONE;

impl Blocks {
    /// Computes the inertia of all bodies for the next sub-step from the impulses of the last. `rotation_of` is the
    /// rotation of a body in a sub-step, with 30 fraction bits, at a scaled angular velocity with 32.
    pub(super) fn update_inertia(
        &mut self,
        hinges: &HingeSet,
        list: &JointList,
        rotation_of: impl Fn(u32, i64) -> i64,
    ) {
        // The impulses of the last tick are known, but not yet the rows on which they act.
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
                // The lever ratio is the arm over the radius of gyration, turned by a right angle.
                let e = unit.levers[side];
                let [x, y] = change.map(i128::from);
                let outward = x * i128::from(e.y.to_bits()) - y * i128::from(e.x.to_bits());
                let (_, [sum, ..]) = &mut bodies[places[side] as usize];
                *sum = sum.saturating_add(saturate_wide(round_shift_wide(outward, 24)));
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

    /// Takes geometric stiffness out of the impulses, which are scaled by the denominators of their rows: joints store
    /// them as they are for the inertia alone.
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
