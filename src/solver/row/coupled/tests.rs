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
