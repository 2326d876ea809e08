//! Limits of velocities and impulses, chosen so that a velocity within its limit plus a change of up to [`STEP_MAX`]
//! does not overflow the 32-bit format.

pub(crate) use crate::body::SPEED_MAX;
use crate::math::Speed;

/// Number of results that a clamp has changed. It is part of the hashed state, and 0 in any physically sensible world.
pub(crate) type Faults = u64;

/// Largest change of an impulse in one update, and largest impulse of a warm start, in m/s.
pub(crate) const STEP_MAX: Speed = Speed::lit("512");
/// Largest accumulated impulse, in m/s.
pub(crate) const IMPULSE_MAX: Speed = Speed::lit("1023");

/// Clamps an accumulated impulse to [`STEP_MAX`] for the warm start, which applies it at once to a velocity of up to
/// [`SPEED_MAX`]. The impulse may be larger, because it has accumulated in several updates of up to [`STEP_MAX`].
#[inline]
pub(crate) fn clamp_warm_start(lambda: &mut Speed, faults: &mut Faults) {
    let within = (*lambda).clamp(-STEP_MAX, STEP_MAX);
    *faults += u64::from(within != *lambda);
    *lambda = within;
}
