use super::*;
use crate::fx;

#[test]
fn sums_saturate() {
    let corner = Vec2::new(Fx::MAX, Fx::MIN);
    assert_eq!(corner + corner, corner);
    assert_eq!(-corner, Vec2::new(Fx::from_bits(-i64::MAX), Fx::MAX));
    assert_eq!(corner.dot(corner), Fx::MAX);
    assert_eq!(corner.cross(corner.perp()), Fx::MAX);
    let corner = Vec2::new(Unit::MIN, Unit::MIN);
    assert_eq!(corner.dot::<_, fixed::types::extra::U30>(corner), Unit::MAX);
}

#[test]
fn a_cross_product_of_the_least_number_is_exact() {
    use fixed::types::extra::{U0, U32};
    let (a, b) = (FixedI32::<U0>::MIN, FixedI32::<U32>::MIN);
    let zero = FixedI32::ZERO;
    // Half of the least number, which is -2^31.
    let expected = FixedI32::<U0>::from_num(-(1i64 << 30));
    assert_eq!(Vec2::new(zero, a).cross::<U32, U0>(Vec2::new(b, FixedI32::ZERO)), expected);
    assert_eq!(Vec2::new(a, zero).cross::<U32, U0>(Vec2::new(FixedI32::ZERO, b)), -expected);
}

#[test]
fn lerp_meets_both_ends_at_any_distance() {
    let (a, b) = (Vec2::new(Fx::MIN, fx!(1)), Vec2::new(Fx::MAX, fx!(3)));
    assert_eq!(a.lerp(b, Unit::ZERO), a);
    assert_eq!(a.lerp(b, Unit::ONE), b);
    assert_eq!(a.lerp(b, Unit::lit("0.5")), Vec2::new(Fx::ZERO, fx!(2)));
    assert_eq!(b.lerp(a, Unit::lit("-0.5")), Vec2::new(Fx::MAX, fx!(4)));
}
