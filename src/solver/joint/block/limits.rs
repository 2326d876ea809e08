//! Limits in a block. A limit may only push, so that the block has to find out which of its limits act: it begins with
//! those that would push if only their own two bodies were there, and releases those that would pull until none does.

use super::super::super::context::{Pass, StepContext};
use super::super::hinge::{HingeSet, Poses};
use super::super::list::JointList;
use super::scaling::root_and_inverse;
use super::{Block, ONE};

/// A limit in a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit {
    pub(super) unit: usize,
    pub(super) row: usize,
    /// `Q` and `1 / Q`.
    pub(super) mass: (i64, i64),
    /// Whether it acts in the current pass.
    pub(super) is_active: bool,
}

/// `S^2` of a limit that is not reached, with 30 fraction bits: 1, less so much that rows that depend on it have a
/// solution.
const OPEN_SCALE: i64 = ONE - (1 << 20);

impl Block {
    /// Finds the limits that act, by releasing those that would pull. What is released has no impulse.
    pub(super) fn solve_with_limits(
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
}
