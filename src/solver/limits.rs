//! Limits of velocities and impulses. A velocity within its limit plus a change of up to [`STEP_MAX`] fits the 32-bit
//! format. Impulses of joints in blocks (`joint/block`) are not clamped within a tick. The velocity changes that they
//! cause saturate instead.

pub(crate) use crate::body::SPEED_MAX;
use crate::math::{Fx, Speed, Vec2, round_shift, saturate, saturate_wide};

/// Number of results that were clamped. The state of the world contains the sum over all ticks.
pub(crate) type Faults = u64;

/// Largest impulse, in m/s, that is applied at once. Rows apply a larger impulse in several steps. Point blocks shorten
/// a larger impulse, and hinges clamp each of its components.
pub(crate) const STEP_MAX: Speed = Speed::lit("512");
/// Largest accumulated impulse, in m/s.
pub(crate) const IMPULSE_MAX: Speed = Speed::lit("1023");

/// A velocity in units of [`Speed`]. The result may exceed the range of [`Speed`].
#[inline]
pub(crate) fn units(velocity: Fx) -> i64 {
    round_shift(velocity.to_bits(), Fx::FRAC_NBITS - Speed::FRAC_NBITS)
}

/// Shortens a vector in units of [`Speed`] so that both components are within `most`. Each shortening counts as a
/// fault.
#[inline]
pub(crate) fn shortened(vector: [i64; 2], most: Speed, faults: &mut Faults) -> Vec2<Speed> {
    let largest = vector[0].unsigned_abs().max(vector[1].unsigned_abs());
    let is_longer = largest > u64::from(most.unsigned_abs().to_bits());
    *faults += u64::from(is_longer);
    let [x, y] = vector.map(|part| {
        let shorter = || saturate_wide(i128::from(part) * i128::from(most.to_bits()) / i128::from(largest));
        Speed::from_bits(saturate(if is_longer { shorter() } else { part }))
    });
    Vec2::new(x, y)
}
