use super::*;
use crate::fx;
use fixed::types::extra::U31;

#[test]
fn rounds_to_nearest_on_both_sides_of_zero() {
    let cases = [(5, 1, 3), (-5, 1, -2), (7, 2, 2), (-7, 2, -2), (-6, 2, -1), (6, 2, 2), (9, 0, 9)];
    for (x, shift, expected) in cases {
        assert_eq!(round_shift(x, shift), expected, "{x} >> {shift}");
        assert_eq!(round_shift_wide(i128::from(x), shift), i128::from(expected));
    }
    assert_eq!(div_round(7, 2), 4);
    assert_eq!(div_round(-7, 2), -4);
    assert_eq!(div_round(7, -3), -2);
    assert_eq!(div_round(i128::MAX, i128::MAX - 1), 1);
    assert_eq!(div_round(i128::MIN, -1), i128::MAX);
    assert_eq!(div_round(i128::MIN, 1), i128::MIN);
    assert_eq!(div_round(i128::MIN, i128::MAX), -1);
}

#[test]
fn saturates_instead_of_wrapping() {
    let big = Speed::MAX;
    let product: Speed = mul(big, Ratio::MAX);
    assert_eq!(product, Speed::MAX);
    let product: Speed = mul(big, Ratio::MIN);
    assert_eq!(product, Speed::MIN);
    assert_eq!(narrow::<U27>(Fx::from_num(1000)), Step::MAX);
    assert_eq!(narrow::<U31>(Fx::MAX), FixedI32::<U31>::MAX);
    assert_eq!(narrow::<U31>(Fx::MIN), FixedI32::<U31>::MIN);
    assert_eq!(round_shift(i64::MAX, 1), 1 << 62);
    assert_eq!(round_shift_wide(i128::MAX, 1), 1 << 126);
    assert_eq!(fx_mul(Fx::MAX, Fx::MIN), Fx::MIN);
    assert_eq!(fx_div(Fx::MAX, fx!(0.25)), Some(Fx::MAX));
    assert_eq!(fx_div(Fx::MAX, Fx::ZERO), None);
}

#[test]
fn literals_are_exact_to_half_a_unit() {
    assert_eq!(fx!(0.1).to_bits(), 429_496_730);
    assert_eq!(fx!(1 / 3).to_bits(), 1_431_655_765);
    assert_eq!(fx!(-1.5).to_bits(), -(3 << 31));
}
