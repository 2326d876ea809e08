use super::*;
use crate::fx;
use crate::math::{Fx, Rng, Speed, Vec2, fx_div, fx_mul, narrow, widen};
use crate::solver::body::SolverBody;
use crate::solver::limits::IMPULSE_MAX;
use crate::solver::softness::Softness;

/// One update leaves no relative angular velocity. It conserves angular momentum: `MA kA duA = -MB kB duB`, with masses
/// `M`.
#[test]
fn an_update_removes_the_relative_angular_velocity_and_keeps_momentum() {
    let mut rng = Rng::new(7);
    let (mut faults, mut worst) = (0, 0);
    for _ in 0..100_000 {
        let share: Unit = match rng.below(4) {
            0 => Unit::ZERO,
            1 => narrow(rng.range(fx!(0), fx!(1))),
            2 => narrow(rng.range(fx!(0.0001), fx!(0.001))),
            _ => Unit::ONE - narrow::<fixed::types::extra::U30>(rng.range(fx!(0.0001), fx!(0.001))),
        };
        let fractions = MassFractions { a: share, b: Unit::ONE - share };
        let mut gyration = || match rng.below(3) {
            0 => rng.range(fx!(0.01), fx!(0.1)),
            1 => rng.range(fx!(0.1), fx!(5)),
            _ => rng.range(fx!(5), fx!(50)),
        };
        let (k_a, k_b) = (gyration(), gyration());
        let turns_a = rng.below(10) > 0;
        let inverse_a = if turns_a { Reciprocal::of(k_a) } else { Reciprocal::default() };
        let (row, denominator, s) = Row::angular(inverse_a, Reciprocal::of(k_b), fractions);
        if denominator == 0 {
            assert!(s == 0 && fractions.b == 0);
            continue;
        }
        // At most 20 rad/s, and at most 200 m/s along the row.
        let mut spin = |k: Fx, e: Ratio| {
            let omega = rng.range(fx!(-20), fx!(20));
            let most = fx_div(fx!(200), widen(e)).unwrap_or(fx!(20)).min(fx!(20));
            SolverBody { spin: narrow(fx_mul(omega, k).clamp(-most, most)), ..SolverBody::default() }
        };
        let (mut a, mut b) = (spin(k_a, row.e_a), spin(k_b, row.e_b));
        let (u_a, u_b) = (a.spin, b.spin);
        let bounds = (-IMPULSE_MAX, IMPULSE_MAX);
        let mut lambda = Speed::ZERO;
        row.solve(&mut a, &mut b, Speed::ZERO, &Softness::RIGID, bounds, &mut lambda, &mut faults);
        let left = row.velocity(&a, &b, &mut faults).to_bits().abs();
        let size = 1 + row.e_a.max(row.e_b).to_bits() / Ratio::ONE.to_bits();
        worst = worst.max(left / size);
        assert_eq!((a.velocity, b.velocity), (Vec2::ZERO, Vec2::ZERO));
        if turns_a {
            let gained = fx_mul(fx_mul(fractions.b.into(), k_a), widen(a.spin - u_a));
            let lost = fx_mul(fx_mul(fractions.a.into(), k_b), widen(b.spin - u_b));
            assert!((gained + lost).abs() < fx!(0.0001), "{gained} and {lost}");
        } else {
            assert_eq!(a.spin, u_a);
        }
    }
    assert_eq!(faults, 0);
    assert!(worst <= 8, "{worst} units left");
}
