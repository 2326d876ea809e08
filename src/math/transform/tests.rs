use super::*;
use crate::fx;
use crate::math::{Angle, Rng};

#[test]
fn precision_is_the_same_far_from_the_origin() {
    let mut rng = Rng::new(1);
    let far = Vec2::new(fx!(2_000_000_000), fx!(-1_999_999_999.25));
    for _ in 0..5000 {
        let rotation = Rot::from_angle(rng.angle());
        let point = Vec2::new(rng.range(fx!(-100), fx!(100)), rng.range(fx!(-100), fx!(100)));
        let there = Transform::new(far, rotation).apply(point);
        assert_eq!(there - far, rotation.apply_wide(point));
        let back = Transform::new(far, rotation).apply_inverse(there) - point;
        // cos^2 + sin^2 is off by at most 2.24 units of 2^-30: 896 units of 2^-32 for 100 m, plus rounding.
        assert!(back.x.abs().to_bits() <= 898 && back.y.abs().to_bits() <= 898, "{back:?}");
    }
}

#[test]
fn saturates_once() {
    // The rotated point is out of range; the sum is not.
    let pose = Transform::new(Vec2::new(Fx::ZERO, Fx::MIN), Rot::from_angle(Angle::EIGHTH));
    let point = pose.apply(Vec2::new(Fx::MAX, Fx::MAX));
    assert!((point.y - fx!(889_516_852)).abs() < fx!(2), "{}", point.y);
    assert_eq!(Transform::IDENTITY.apply(point), point);
    assert_eq!(Transform::default(), Transform::IDENTITY);
}
