use super::*;
use crate::fx;
use crate::math::{Fx, Rng, fx_mul, narrow, widen};

/// An impact does not change the energy of the leapfrog scheme, except for a loss by rounding.
#[test]
fn an_elastic_impact_conserves_the_energy_of_the_scheme() {
    let mut rng = Rng::new(1);
    for _ in 0..1000 {
        let g = rng.range(fx!(0), fx!(100));
        let before: Speed = narrow(rng.range(fx!(-100), fx!(-1)));
        let forced: Speed = narrow(-g / 256);
        let v = before + forced;
        let closing: Speed = mul(-v, narrow::<fixed::types::extra::U30>(rng.range(fx!(0), fx!(1))));
        let time = time_of_impact(closing, v);
        let Impact { after, .. } = Impact::of(v, forced, time, Unit::ONE);
        let rebound = mul(after, Unit::ONE - time);
        // Heights are divided by the time step, which gives speeds.
        let energy = |v: Speed, height: Speed| {
            let (v, forced) = (widen(v), widen(forced));
            fx_mul(v, v) / 2 - fx_mul(forced, widen(height)) + fx_mul(forced, v) / 2
        };
        let change = energy(after, rebound) - energy(before, closing);
        let least = -fx_mul(widen(Speed::DELTA), widen(after) * 2 + fx!(1));
        assert!((least..=Fx::ZERO).contains(&change), "{g}, {v}, {closing}: {change} J/kg");
    }
}

/// The velocity that gravity adds in a sub-step causes no rebound.
#[test]
fn a_point_at_rest_does_not_rebound() {
    let v = Speed::lit("-0.0417");
    let time = time_of_impact(Speed::ZERO, v);
    assert_eq!(time, Unit::ZERO);
    assert_eq!(Impact::of(v, v, time, Unit::ONE).after, Speed::ZERO);
}

#[test]
fn a_point_that_does_not_touch_is_at_the_end_of_the_sub_step() {
    assert_eq!(time_of_impact(Speed::lit("12"), Speed::lit("-10")), Unit::ONE);
    assert_eq!(time_of_impact(Speed::lit("-12"), Speed::lit("-10")), Unit::ZERO);
    assert_eq!(time_of_impact(Speed::lit("5"), Speed::lit("-10")), Unit::lit("0.5"));
}
