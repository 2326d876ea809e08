//! Limits of velocities and impulses. A velocity within its limit plus a change of up to [`STEP_MAX`] fits the 32-bit
//! format. Impulses of joints in blocks (`joint/block`) are not clamped within a tick: their velocity changes saturate.

pub(crate) use crate::body::SPEED_MAX;
use crate::math::Speed;

/// Number of results that a clamp has changed. The state of the world contains the sum over all ticks.
pub(crate) type Faults = u64;

/// Largest impulse that is applied at once, in m/s. A larger impulse of a row is applied in steps. A larger impulse of
/// a point block is clamped.
pub(crate) const STEP_MAX: Speed = Speed::lit("512");
/// Largest accumulated impulse, in m/s.
pub(crate) const IMPULSE_MAX: Speed = Speed::lit("1023");

/// Clamps an impulse of a point block to [`STEP_MAX`] before it is applied.
#[inline]
pub(crate) fn clamp_lambda(lambda: &mut Speed, faults: &mut Faults) {
    let within = (*lambda).clamp(-STEP_MAX, STEP_MAX);
    *faults += u64::from(within != *lambda);
    *lambda = within;
}
