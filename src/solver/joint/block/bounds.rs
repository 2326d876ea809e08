//! Rows with bounds in a block: limits, which may only push, and motors, whose force is limited. The block has to find
//! out which bounds are reached. It begins with all motors, and with those limits that would push if only their own two
//! bodies were there; a row that would be beyond a bound is held at it, until there is none.

use super::super::super::context::{Pass, StepContext};
use super::super::hinge::{HingeSet, Poses};
use super::super::list::JointList;
use super::scaling::root_and_inverse;
use super::{Block, ONE};

/// A row with bounds.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundedRow {
    pub(super) unit: usize,
    pub(super) row: usize,
    /// `Q` and `1 / Q`.
    pub(super) mass: (i64, i64),
    /// Whether its equation is solved in the current pass. Otherwise its impulse is `held`.
    pub(super) is_active: bool,
    /// The bound at which its impulse is held.
    pub(super) held: i64,
}

/// `S^2` of a limit that is not reached, with 30 fraction bits: 1, less so much that rows that depend on
/// it have a solution.
const OPEN_SCALE: i64 = ONE - (1 << 20);

/// `S^2` of a motor, with 30 fraction bits. Closer to 1 than that of a limit: under leverage the impulse is large, and
/// the error of the speed is the impulse times `1 - S^2`.
const DRIVE_SCALE: i64 = ONE - (1 << 16);

/// Number of rounds in which only the motors that are furthest beyond their force are held at it.
const ROUNDS_MAX: u32 = 4;

impl Block {
    /// Solves the equations of all rows that are not held at a bound.
    pub(super) fn solve_within_bounds(
        &mut self,
        pass: Pass,
        hinges: &HingeSet,
        list: &JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
    ) {
        self.want(pass, hinges, list, poses, context);
        self.activate(pass, hinges, list);
        // A row that was held at a bound stays there, so that the loop ends.
        for round in 0.. {
            if self.hold(context) {
                self.want(pass, hinges, list, poses, context);
            }
            self.set_current_scales(pass, hinges, list);
            self.factored = None;
            self.compute_factor(pass);
            self.compute_changes(pass);
            if !self.deactivate(round < ROUNDS_MAX, hinges, list) {
                return;
            }
        }
    }

    /// Activates all motors, and the limits that would push if nothing but their own bodies were there.
    fn activate(&mut self, pass: Pass, hinges: &HingeSet, list: &JointList) {
        let Block { bounded, units, impulses, wanted, .. } = self;
        for bounded in bounded.iter_mut() {
            let (impulse, change) = (impulses[bounded.row], wanted[bounded.row]);
            let unit = &units[bounded.unit];
            // As with contacts, a gap without an impulse is left to the next sub-step.
            let untouched = pass == Pass::Relax && impulse == 0 && unit.is_open(hinges, list);
            bounded.is_active = unit.is_drive() || !untouched && impulse.saturating_add(change) > 0;
            bounded.held = 0;
        }
    }

    /// Deactivates rows whose impulse would be beyond a bound: all limits, and the motors that are furthest beyond
    /// theirs, or all motors. A strong motor against a brake wants as much as the brake until the brake slips. Returns
    /// whether there were any.
    fn deactivate(&mut self, furthest_only: bool, hinges: &HingeSet, list: &JointList) -> bool {
        let Block { bounded, units, impulses, x, .. } = self;
        let impulse_of = |bounded: &BoundedRow| {
            let [change, ..] = units[bounded.unit].restore([x[bounded.row], 0, 0]);
            impulses[bounded.row].saturating_add(change)
        };
        let excess = |bounded: &BoundedRow| {
            let [_, max] = units[bounded.unit].bounds(hinges, list);
            impulse_of(bounded).unsigned_abs() / max.unsigned_abs().max(1)
        };
        let drives = bounded.iter().filter(|bounded| bounded.is_active && units[bounded.unit].is_drive());
        let furthest = drives.map(excess).max().unwrap_or(0);
        let mut any = false;
        for bounded in bounded.iter_mut().filter(|bounded| bounded.is_active) {
            let unit = &units[bounded.unit];
            let [lower, upper] = unit.bounds(hinges, list);
            let impulse = impulse_of(bounded);
            bounded.held = impulse.clamp(lower, upper);
            let is_beyond = bounded.held != impulse;
            if is_beyond && (!furthest_only || !unit.is_drive() || excess(bounded) >= furthest / 2) {
                bounded.is_active = false;
                any = true;
            }
        }
        any
    }

    /// Gives rows that are not active the impulses at which they are held. Returns whether an impulse has changed.
    fn hold(&mut self, context: &StepContext<'_>) -> bool {
        let Block { bounded, units, impulses, x, .. } = self;
        x.fill(0);
        let mut any = false;
        for bounded in bounded.iter().filter(|bounded| !bounded.is_active) {
            let before = core::mem::replace(&mut impulses[bounded.row], bounded.held);
            let change = bounded.held.saturating_sub(before);
            [x[bounded.row], ..] = units[bounded.unit].scale([change, 0, 0]);
            any |= change != 0;
        }
        if any {
            self.apply(context);
        }
        any
    }

    /// The scales of a pass for the rows that are active.
    fn set_current_scales(&mut self, pass: Pass, hinges: &HingeSet, list: &JointList) {
        let Block { bounded, units, bias, relax, current, .. } = self;
        current.clone_from(match pass {
            Pass::Bias => bias,
            Pass::Relax => relax,
        });
        for bounded in bounded.iter() {
            if !bounded.is_active {
                current.set(bounded.row, (0, 0), bounded.mass, 0);
            } else if units[bounded.unit].is_drive() {
                current.set(bounded.row, root_and_inverse(DRIVE_SCALE), bounded.mass, 0);
            } else if units[bounded.unit].is_open(hinges, list) {
                current.set(bounded.row, root_and_inverse(OPEN_SCALE), bounded.mass, 0);
            }
        }
    }
}
