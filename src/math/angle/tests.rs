use super::*;
use crate::fx;
use crate::math::Rng;

#[test]
fn conversions_are_exact_or_nearest() {
    assert_eq!(Angle::from_turns(fx!(-3.75)), Angle::QUARTER);
    assert_eq!(Angle::from_degrees(fx!(405)), Angle::EIGHTH);
    assert_eq!(Angle::from_degrees(fx!(-90)), -Angle::QUARTER);
    assert_eq!(Angle::from_radians(PI), Angle::HALF);
    assert_eq!(Angle::HALF.to_radians(), PI);
    assert_eq!(Angle::HALF.to_degrees(), fx!(180));
    assert_eq!(Angle::HALF.to_turns(), fx!(0.5));
    assert_eq!(Angle::from_bits((1 << 31) + 1).to_turns(), fx!(-0.5) + Fx::DELTA);
    assert!((DEGREE * 180 - PI).abs().to_bits() <= 90 && (PI * 2 - TAU).abs().to_bits() <= 1);

    // One unit of an angle is 360 * 2^-32 degrees. Half a unit rounds away from zero.
    let units = |degrees: i64| Angle::from_degrees(Fx::from_bits(degrees)).to_bits();
    assert_eq!([179, 180, -179, -180].map(units), [0, 1, 0, u32::MAX]);

    // 2147483647 rad are 341782637.62906085... turns.
    let far = Angle::from_radians(fx!(2_147_483_647));
    assert_eq!(far, Angle::from_turns(fx!(0.62906085179925)));
}

#[test]
fn every_conversion_round_trips() {
    let mut rng = Rng::new(1);
    for _ in 0..10_000 {
        let angle = rng.angle();
        assert_eq!(Angle::from_turns(angle.to_turns()), angle);
        assert_eq!(Angle::from_degrees(angle.to_degrees()), angle);
        assert_eq!(Angle::from_radians(angle.to_radians()), angle);
        assert_eq!(angle.cos(), (angle + Angle::QUARTER).sin());
        assert!(angle.to_radians() > -PI && angle.to_radians() <= PI);
    }
}

#[test]
fn direction_undoes_sine_and_cosine() {
    let mut rng = Rng::new(2);
    for _ in 0..10_000 {
        let angle = rng.angle();
        let (sin, cos) = angle.sin_cos();
        let apart = (Angle::of(Vec2::new(cos, sin).widen()) - angle).to_turns();
        // In units of 2^-32 turn, the errors of sine and cosine change the direction by at most 0.71, and the error
        // of `Angle::of` is at most 0.68. The sum is below 2, so the difference, which is an integer, is at most 1.
        assert!(apart.abs().to_bits() <= 1, "{angle:?} {apart}");
    }
}

#[test]
fn sums_wrap() {
    let mut angle = Angle::HALF;
    angle += Angle::HALF;
    assert_eq!(angle, Angle::ZERO);
    angle -= Angle::QUARTER;
    assert_eq!(angle, -Angle::QUARTER);
    assert_eq!(-Angle::HALF, Angle::HALF);
    assert_eq!(Angle::of(Vec2::new(Fx::MIN, Fx::MIN)), -(Angle::QUARTER + Angle::EIGHTH));
}
