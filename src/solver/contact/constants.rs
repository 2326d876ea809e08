use super::super::settings::Tuning;
use super::super::softness::Softness;
use super::overflow_policy::unchecked_at;
use crate::math::{Rate, Shift};

/// The settings of a tick in the number formats of the operations on contacts.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Constants {
    /// Sub-steps per second, in the format of [`Rate`].
    pub(super) rate: i32,
    /// Largest gap or overlap, in the format of [`Shift`], for which the speed that removes it in a sub-step fits the
    /// format of speeds.
    pub(super) separation_max: i32,
    pub(super) slop: i32,
    pub(super) push_speed: i32,
    pub(super) soft: Softness,
    /// Softness against a body that impulses do not move.
    pub(super) stiff: Softness,
    /// Whether the bounds of [`super::overflow_policy::Unchecked`] hold for these settings.
    pub(super) unchecked: bool,
}

impl Constants {
    #[expect(clippy::cast_possible_truncation, reason = "a rate is at most 4000")]
    pub(in crate::solver) fn new(tuning: &Tuning) -> Self {
        let widest = (1023i64 << Shift::FRAC_NBITS) / i64::from(tuning.rate);
        let rate = Rate::from_bits((i64::from(tuning.rate) << Rate::FRAC_NBITS) as i32);
        Constants {
            rate: rate.to_bits(),
            separation_max: widest.min(i64::from(i32::MAX)) as i32,
            slop: crate::math::convert::<_, fixed::types::extra::U26>(tuning.slop).to_bits(),
            push_speed: tuning.push_speed.to_bits(),
            soft: tuning.contact,
            stiff: tuning.contact_immovable,
            unchecked: unchecked_at([rate, tuning.contact.bias_rate, tuning.contact_immovable.bias_rate]),
        }
    }
}
