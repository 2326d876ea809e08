//! One iteration over a block.

use super::super::super::context::{Pass, StepContext};
use super::super::hinge::{HingeSet, Poses};
use super::super::list::JointList;
use super::scales::Scales;
use super::scaling::product;
use super::{Block, EXCESS, EXTRA_BITS};
use crate::math::{Speed, round_shift, saturate};

impl Block {
    pub(super) fn solve(
        &mut self,
        pass: Pass,
        hinges: &HingeSet,
        list: &JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
    ) {
        if self.bounded.is_empty() {
            self.compute_factor(pass);
            self.want(pass, hinges, list, poses, context);
            self.compute_changes(pass);
        } else {
            self.solve_within_bounds(pass, hinges, list, poses, context);
        }
        self.accept(context);
    }

    fn scales(&self, pass: Pass) -> &Scales {
        match pass {
            _ if !self.bounded.is_empty() => &self.current,
            Pass::Bias => &self.bias,
            Pass::Relax => &self.relax,
        }
    }

    pub(super) fn compute_factor(&mut self, pass: Pass) {
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

    pub(super) fn want(
        &mut self,
        pass: Pass,
        hinges: &HingeSet,
        list: &JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
    ) {
        let Block { units, bias, bounded, impulses, wanted, .. } = self;
        let mut faults = 0;
        for unit in units.iter() {
            let changes = unit.wanted(pass, hinges, list, poses, context, &mut faults);
            let mut own = [0; 3];
            unit.range().zip(&mut own).for_each(|(row, impulse)| *impulse = impulses[row]);
            let yielding = unit.yielding(own);
            for (row, (change, impulse)) in unit.range().zip(changes.into_iter().zip(yielding)) {
                let give = if pass == Pass::Bias { bias.yields[row] } else { 0 };
                wanted[row] = (change << EXTRA_BITS).saturating_sub(product(impulse, give));
            }
        }
        let limits = bounded.iter().map(|bounded| &units[bounded.unit]);
        for row in limits.filter(|limit| limit.is_open(hinges, list)).map(|limit| limit.row) {
            // A limit that is not reached is not soft, so the term with its impulse scale is removed.
            if pass == Pass::Bias {
                wanted[row] = wanted[row].saturating_add(product(impulses[row], bias.yields[row]));
            }
        }
        context.add_faults(faults);
    }

    pub(super) fn compute_changes(&mut self, pass: Pass) {
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

    /// Changes the velocities by the scaled impulses `x`. Velocities are rounded and clamped once, because the impulses
    /// on a light body between heavy ones almost cancel.
    pub(super) fn apply(&mut self, context: &StepContext<'_>) {
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
                sum[2] = product(sum[2], unit.spin_root(side));
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
            let [d_x, d_y, d_spin] =
                change.map(|change| Speed::from_bits(saturate(round_shift(change, EXTRA_BITS))));
            let (x, y) = (body.velocity.x.saturating_add(d_x), body.velocity.y.saturating_add(d_y));
            body.set_velocity(x, y, body.spin.saturating_add(d_spin), &mut faults);
            cell.set(body);
        }
        context.add_faults(faults);
    }
}
