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

#[cfg(test)]
mod tests {
    use super::super::super::body::SolverBody;
    use super::super::super::limits::IMPULSE_MAX;
    use super::super::super::softness::Softness;
    use super::*;
    use crate::fx;
    use crate::math::{Fx, Rng, Rot, Speed, narrow};

    /// One update removes the velocity of a row whose `D` is not too small.
    #[test]
    fn an_update_removes_the_velocity_along_both_directions() {
        let mut rng = Rng::new(11);
        let mut worst = 0;
        for _ in 0..50_000 {
            let mut direction = |length: Fx| -> Vec2<Unit> {
                Rot::from_angle(rng.angle()).apply_wide(Vec2::new(length, fx!(0))).narrow()
            };
            let n = [direction(fx!(0.5)), direction(fx!(1.98))];
            let a: Unit = narrow(rng.range(fx!(0.001), fx!(0.999)));
            let fractions = MassFractions { a, b: Unit::ONE - a };
            let arms = [0; 2].map(|_| narrow(rng.range(fx!(-2), fx!(2))));
            let inverse = [0; 2].map(|_| Reciprocal::of(rng.range(fx!(0.3), fx!(3))));
            let (row, denominator) = Row::coupled(n, arms, inverse, fractions);
            assert!(denominator > 0);
            let mut body = || {
                let mut speed = || -> Speed { narrow(rng.range(fx!(-20), fx!(20))) };
                SolverBody { velocity: Vec2::new(speed(), speed()), spin: speed(), ..SolverBody::default() }
            };
            let (mut a, mut b) = (body(), body());
            let (mut lambda, mut faults) = (Speed::ZERO, 0);
            let bounds = (-IMPULSE_MAX, IMPULSE_MAX);
            row.solve(&mut a, &mut b, Speed::ZERO, &Softness::RIGID, bounds, &mut lambda, &mut faults);
            assert_eq!(faults, 0);
            worst = worst.max(row.velocity(&a, &b, &mut faults).to_bits().abs());
        }
        assert!(worst <= 12, "{worst} units left");
    }

    #[test]
    fn a_row_that_moves_neither_body_does_nothing() {
        let none = MassFractions { a: Unit::ZERO, b: Unit::ZERO };
        let n = [Vec2::X, Vec2::Y];
        let (row, denominator) = Row::coupled(n, [Length::ONE; 2], [Reciprocal::ZERO; 2], none);
        assert_eq!((denominator, row.g_a, row.g_b), (0, 0, 0));
    }
}
