//! The clamps of the kernels, chosen so that no sum of two clamped values leaves its 32-bit format.

pub(crate) use crate::body::SPEED_MAX;
use crate::math::Speed;

/// How often a clamp changed a result. Part of the hashed state, and 0 as long as physics makes sense.
pub(crate) type Faults = u64;

/// Largest change of an impulse in one update, and the largest warm start, in m/s.
pub(crate) const STEP_MAX: Speed = Speed::lit("512");
/// Largest accumulated impulse, in m/s.
pub(crate) const IMPULSE_MAX: Speed = Speed::lit("1023");

/// Keeps an impulse that has accumulated over several sub-steps, each within [`STEP_MAX`], within it as a whole:
/// it is applied at once, to a velocity of up to [`SPEED_MAX`].
#[inline]
pub(crate) fn clamp_warm_start(lambda: &mut Speed, faults: &mut Faults) {
    let within = (*lambda).clamp(-STEP_MAX, STEP_MAX);
    *faults += u64::from(within != *lambda);
    *lambda = within;
}
