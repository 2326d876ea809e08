//! Rows of gears, racks and pulleys, whose directions on A and B may differ and need not be unit vectors.
//!
//! ```text
//! vn = nB.vB + eB uB - nA.vA - eA uA
//! D  = aA (nA^2 + eA^2) + aB (nB^2 + eB^2)
//! ```
//!
//! Callers choose units in which `D` is about 1. If `D` is so small that gains would exceed 4.1, a larger `D` replaces
//! it. One update then removes only a part of the velocity. This happens in gears whose anchors are off their wheels'
//! centres, not in pulleys.

#[cfg(test)]
mod tests;

use super::{Denominator, MassFractions, RATIO_MAX, Row, turning};
use crate::math::{Length, Ratio, Reciprocal, Unit, Vec2};

impl Row {
    /// A row with a direction on each body, at most 2 long, and the lever arm of each body in metres.
    pub(crate) fn coupled(
        n: [Vec2<Unit>; 2],
        arms: [Length; 2],
        inverse_gyrations: [Reciprocal; 2],
        fractions: MassFractions,
    ) -> (Row, Denominator) {
        let ratio = |side: usize| -> Ratio {
            inverse_gyrations[side]
                .times::<_, fixed::types::extra::U24>(arms[side])
                .clamp(-RATIO_MAX, RATIO_MAX)
        };
        let (e_a, e_b) = (ratio(0), ratio(1));
        let linear = |fraction: Unit, n: Vec2<Unit>| {
            let square: Unit = n.dot(n);
            // The squared length of a direction is up to 4. It may not fit a `Unit`, but half of it does.
            let half: Unit = Vec2::new(n.x / 2, n.y / 2).dot(n);
            let square = if half < Unit::ONE / 2 {
                i64::from(square.to_bits())
            } else {
                2 * i64::from(half.to_bits())
            };
            crate::math::round_shift(square * i64::from(fraction.to_bits()), 30)
        };
        let exact = linear(fractions.a, n[0])
            + linear(fractions.b, n[1])
            + turning(fractions.a, e_a, e_a)
            + turning(fractions.b, e_b, e_b);
        if exact == 0 {
            return (Row { n: n[0], n_b: n[1], e_a, e_b, ..Row::NONE }, 0);
        }
        // A gain of 4.1 times an impulse of 512 m/s fits 63 bits.
        let denominator = exact.max(i64::from(fractions.a.max(fractions.b).to_bits()) * 31 / 127);
        (Row::with_gains(n, [e_a, e_b], fractions, denominator), denominator)
    }
}
