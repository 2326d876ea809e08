//! The reaction of a hinge point to impulses on the angle of the hinge.
//!
//! In the state, the impulse of the point does not contain the reaction `-q L` to an impulse `L` on the angle
//! (`hinge/angle/pinned.rs`). In a block it does, because the rows of a block are independent of each other.

use super::super::hinge::{ANGLE_MAX, HingeSet};
use super::super::list::JointList;
use super::unit::Source;
use super::{Block, Blocks, EXTRA_BITS, round_shift_wide, saturate_wide};

impl Blocks {
    /// Prepares the impulses of the last tick for geometric stiffness. The rows must be those of the current pose.
    pub(super) fn add_pin_reactions(&mut self, hinges: &HingeSet, list: &JointList) {
        self.refresh(hinges, list);
        self.blocks.iter_mut().for_each(|block| block.add_pin_reactions(hinges, -1));
    }
}

impl Block {
    /// Adds `sign q L` to the impulses of points.
    pub(super) fn add_pin_reactions(&mut self, hinges: &HingeSet, sign: i64) {
        let Block { units, impulses, .. } = self;
        let (mut point, mut spread) = (0, [0; 2]);
        for unit in units.iter() {
            // The limits and the motor of a hinge follow the hinge.
            let angle = match unit.source {
                Source::Hinge(number) => {
                    (point, spread) = (unit.row, hinges.blocked_spread(number));
                    impulses[unit.range()].get(2).copied().unwrap_or(0)
                }
                Source::HingeLimit(_, 1) => -impulses[unit.row],
                Source::HingeLimit(..) | Source::HingeDrive(_) => impulses[unit.row],
                Source::Part(_) => continue,
            };
            // The state has no larger impulse on the angle, so neither has the reaction that belongs to it.
            let most = i64::from(ANGLE_MAX.to_bits()) << EXTRA_BITS;
            let angle = angle.clamp(-most, most);
            for (impulse, spread) in impulses[point..].iter_mut().zip(spread) {
                let reaction = round_shift_wide(i128::from(spread) * i128::from(sign * angle), 24);
                *impulse = impulse.saturating_add(saturate_wide(reaction));
            }
        }
    }
}
