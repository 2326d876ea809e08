use super::*;
use crate::fx;
use crate::math::{Length, Ratio, Speed, Step};

#[test]
fn divides_to_31_significant_bits() {
    let one_metre: Length = Length::ONE;
    let ratio: Ratio = Reciprocal::of(fx!(0.015625)).times(one_metre);
    assert_eq!(ratio, Ratio::from_num(64));
    let step: Step = Reciprocal::of_integer(240).times(Speed::from_num(120));
    assert_eq!(step, Step::from_num(1) / 2);
    let tiny: Ratio = Reciprocal::of(fx!(512)).times(one_metre);
    assert_eq!(tiny, Ratio::ONE / 512);
    let saturated: Ratio = Reciprocal::of(fx!(0.002)).times(one_metre);
    assert_eq!(saturated, Ratio::MAX);
}

#[test]
fn powers_of_two_and_their_neighbours_are_right() {
    for exponent in 3..61 {
        for bits in [(1i64 << exponent) - 1, 1 << exponent, (1 << exponent) + 1] {
            let Reciprocal { mantissa, shift } = Reciprocal::of(Fx::from_bits(bits));
            assert!(mantissa >= 1 << 30, "{bits}");
            // The product is 2^(shift+32) with a relative error of at most 2^-30.
            let product = i128::from(mantissa) * i128::from(bits);
            let error = (product - (1i128 << (shift + 32))).abs();
            assert!(error <= product >> 30, "{bits}: {error}");
        }
    }
}
