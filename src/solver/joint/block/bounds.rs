//! Units (`unit.rs`) with bounds in a block: limits, whose impulses are not negative, and motors and springs of limited
//! force.
//!
//! An active-set method finds the bounds that are reached. Each round solves the equations of the active units and of
//! the units without bounds. Then it deactivates the active units beyond a bound, and holds them at that bound. The
//! rounds end when no active unit is beyond a bound. In the first [`ROUNDS_MAX`] rounds, motors beyond their bounds
//! stay active, except those that are furthest beyond.

use super::super::super::context::{Pass, StepContext};
use super::super::hinge::{HingeSet, Poses};
use super::super::list::JointList;
use super::scaling::root_and_inverse;
use super::unit::Unit;
use super::{Block, ONE};

/// A unit with bounds: one row, or the two rows of a spring between two points.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundedUnit {
    pub(super) unit: usize,
    /// `Q` and `1 / Q` (see `mod.rs`).
    pub(super) mass: (i64, i64),
    /// Whether the equations of the unit are solved. Otherwise its impulse is `held`.
    pub(super) is_active: bool,
    pub(super) held: [i64; 2],
}

/// `S^2` of a limit that is not reached, with 30 fraction bits. It is below 1 so that there is a solution even if other
/// rows depend linearly on the limit.
const OPEN_SCALE: i64 = ONE - (1 << 20);

/// `S^2` of a motor, with 30 fraction bits. It is closer to 1 than [`OPEN_SCALE`], because the error of the speed is
/// the impulse times `1 - S^2`, and impulses at long lever arms are large.
const DRIVE_SCALE: i64 = ONE - (1 << 16);

/// Number of initial rounds in which, among the motors beyond their largest force, only those furthest beyond are
/// deactivated.
const ROUNDS_MAX: u32 = 4;

impl Block {
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
        // The loop ends, because a unit that is held at a bound stays held.
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

    /// Activates motors, limits whose impulse would be positive if solved alone, and springs that would be within their
    /// bounds if solved alone. Other limits get no impulse, and other springs are held at a bound. In the relax pass,
    /// springs keep their impulses.
    fn activate(&mut self, pass: Pass, hinges: &HingeSet, list: &JointList) {
        let Block { bounded, units, impulses, wanted, .. } = self;
        for bounded in bounded.iter_mut() {
            let unit = &units[bounded.unit];
            let (impulse, change) = (impulses[unit.row], wanted[unit.row]);
            // As with contacts, the relax pass leaves out a limit that is not reached and has no impulse.
            let untouched = pass == Pass::Relax && impulse == 0 && unit.is_open(hinges, list);
            (bounded.is_active, bounded.held) = match pass {
                _ if !unit.is_spring() => {
                    (unit.is_drive() || !untouched && impulse.saturating_add(change) > 0, [0; 2])
                }
                Pass::Bias => {
                    let ([x, y], [dx, dy]) = (unit.impulses(impulses), unit.impulses(wanted));
                    let alone = [x.saturating_add(dx), y.saturating_add(dy)];
                    let within = unit.within_bounds(alone, hinges, list);
                    (within == alone, within)
                }
                Pass::Relax => (false, unit.impulses(impulses)),
            };
        }
    }

    /// Deactivates active units beyond a bound. Returns whether a unit was deactivated.
    ///
    /// With `furthest_only`, a motor is deactivated only if its [`Unit::excess`] is at least half the largest excess.
    /// While a brake holds a strong motor, the equations give the brake and the motor the same impulse, but only the
    /// brake should slip.
    fn deactivate(&mut self, furthest_only: bool, hinges: &HingeSet, list: &JointList) -> bool {
        let Block { bounded, units, impulses, x, .. } = self;
        let impulses_of = |unit: &Unit| {
            let [x, y] = unit.impulses(x);
            let [x, y, _] = unit.restore([x, y, 0]);
            let [before_x, before_y] = unit.impulses(impulses);
            [before_x.saturating_add(x), before_y.saturating_add(y)]
        };
        let excess = |unit: &Unit| unit.excess(impulses_of(unit)[0], hinges, list);
        let active = bounded.iter().filter(|bounded| bounded.is_active).map(|bounded| &units[bounded.unit]);
        let furthest = active.filter(|unit| unit.is_drive()).map(excess).max().unwrap_or(0);
        let mut any = false;
        for bounded in bounded.iter_mut().filter(|bounded| bounded.is_active) {
            let unit = &units[bounded.unit];
            let impulses = impulses_of(unit);
            bounded.held = unit.within_bounds(impulses, hinges, list);
            let is_beyond = bounded.held != impulses;
            if is_beyond && (!furthest_only || !unit.is_drive() || excess(unit) >= furthest / 2) {
                bounded.is_active = false;
                any = true;
            }
        }
        any
    }

    /// Gives inactive units the impulses at which they are held. Returns whether an impulse has changed.
    fn hold(&mut self, context: &StepContext<'_>) -> bool {
        let Block { bounded, units, impulses, x, .. } = self;
        x.fill(0);
        let mut any = false;
        for bounded in bounded.iter().filter(|bounded| !bounded.is_active) {
            let unit = &units[bounded.unit];
            let mut changes = [0; 3];
            for (row, (held, change)) in unit.range().zip(bounded.held.into_iter().zip(&mut changes)) {
                *change = held.saturating_sub(core::mem::replace(&mut impulses[row], held));
                any |= *change != 0;
            }
            unit.range().zip(unit.scale(changes)).for_each(|(row, scaled)| x[row] = scaled);
        }
        if any {
            self.apply(context);
        }
        any
    }

    /// Sets the scales of a pass. They are 0 for inactive units.
    fn set_current_scales(&mut self, pass: Pass, hinges: &HingeSet, list: &JointList) {
        let Block { bounded, units, bias, relax, current, .. } = self;
        current.clone_from(match pass {
            Pass::Bias => bias,
            Pass::Relax => relax,
        });
        for bounded in bounded.iter() {
            let unit = &units[bounded.unit];
            let scale = if !bounded.is_active {
                (0, 0)
            } else if unit.is_drive() {
                root_and_inverse(DRIVE_SCALE)
            } else if unit.is_open(hinges, list) {
                root_and_inverse(OPEN_SCALE)
            } else {
                continue;
            };
            unit.range().for_each(|row| current.set(row, scale, bounded.mass, 0));
        }
    }
}
