//! The two bodies of a joint that is not a hinge, while the joint is solved.
//!
//! A velocity change is rounded to the resolution of [`Speed`]. Over thousands of updates the roundings would add up to
//! a force: a spring and a motor that balance each other would change the spin of the heavier body by one unit of
//! [`Speed`] in every sub-step. The rounding error is therefore carried over to the next change by the same joint
//! (error feedback, as in first-order noise shaping), so that the sum of the changes in a tick is rounded once.

#[cfg(test)]
mod tests;

use super::body::SolverBody;
use super::limits::Faults;
use crate::body::Body;
use crate::math::{Speed, saturate};

/// A change of velocity and spin with 51 fraction bits: the product of a gain and an impulse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Change {
    pub(crate) x: i64,
    pub(crate) y: i64,
    pub(crate) spin: i64,
}

impl Change {
    const EXTRA: u32 = 30;
}

/// The part of a joint's velocity changes that the velocity of a body does not contain yet, in units of 2^-51 m/s: at
/// most half a unit of [`Speed`].
#[derive(Clone, Copy, Debug, Default)]
struct Remainder {
    x: i32,
    y: i32,
    spin: i32,
}

/// The remainders of both bodies of a joint, for one tick.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Remainders {
    a: Remainder,
    b: Remainder,
}

impl Remainders {
    /// Remainders at the start of a tick: arbitrary numbers, so that the rounding at the end of a tick differs from
    /// tick to tick in a steady rotation (dither). The numbers depend only on the poses, so that they do not change
    /// while the bodies are at rest.
    pub(crate) fn starting([a, b]: [&Body; 2]) -> Self {
        Remainders { a: Remainder::starting(a), b: Remainder::starting(b) }
    }
}

pub(crate) struct BodyPair<'a> {
    pub(crate) a: &'a mut SolverBody,
    pub(crate) b: &'a mut SolverBody,
    pub(crate) remainders: &'a mut Remainders,
    pub(crate) faults: &'a mut Faults,
}

impl BodyPair<'_> {
    #[inline]
    pub(crate) fn change(&mut self, a: Change, b: Change) {
        self.remainders.a.add(a, self.a, self.faults);
        self.remainders.b.add(b, self.b, self.faults);
    }
}

impl Remainder {
    fn starting(body: &Body) -> Self {
        // Knuth's multiplicative hash, with the multiplier of his MMIX generator.
        const MULTIPLIER: i64 = 6_364_136_223_846_793_005;
        let centre = body.centre_of_mass();
        let mix = |seed: i64| seed.wrapping_mul(MULTIPLIER);
        let seed = mix(mix(centre.x.to_bits()).wrapping_add(centre.y.to_bits()));
        let seed = mix(seed.rotate_left(32).wrapping_add(body.angle().to_bits().into()));
        // The highest bits are the most random ones. The shift leaves 30 bits, which span one unit of a speed.
        let next = |round: i64| saturate(mix(seed.wrapping_add(round).rotate_left(32)) >> 34);
        Remainder { x: next(1), y: next(2), spin: next(3) }
    }

    #[inline]
    fn add(&mut self, change: Change, body: &mut SolverBody, faults: &mut Faults) {
        let x = rounded_sum(body.velocity.x, change.x, &mut self.x);
        let y = rounded_sum(body.velocity.y, change.y, &mut self.y);
        let spin = rounded_sum(body.spin, change.spin, &mut self.spin);
        body.set_velocity(x, y, spin, faults);
    }
}

/// The sum of a speed, a change and the last remainder, rounded and saturated. Stores the new remainder.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "the remainder is at most half a unit, 2^29")]
fn rounded_sum(speed: Speed, change: i64, remainder: &mut i32) -> Speed {
    let exact = change.saturating_add((*remainder).into());
    let units = crate::math::round_shift(exact, Change::EXTRA);
    *remainder = exact.wrapping_sub(units << Change::EXTRA) as i32;
    Speed::from_bits(saturate(i64::from(speed.to_bits()) + units))
}
