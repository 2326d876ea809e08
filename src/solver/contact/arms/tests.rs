use super::*;
use crate::fx;

#[test]
fn bodies_have_the_smaller_rotation_in_common() {
    for (a, b, common) in [(2, 3, 2), (3, 2, 2), (-2, -3, -2), (2, -3, 0), (-2, 3, 0), (0, 3, 0), (-3, 0, 0)]
    {
        let [a, b, common] = [a, b, common].map(|bits| Fx::from_bits(bits << 30));
        assert_eq!(common_rotation(a, b), common);
    }
}

#[test]
fn arms_keep_their_lengths_and_their_angles_to_the_normal() {
    let length = |x: Fx, y: Fx| Vec2::new(Length::from_num(x), Length::from_num(y));
    let mut arms = Arms {
        normal: Vec2::Y,
        to_a: length(fx!(1), fx!(2)),
        to_b: length(fx!(0), fx!(-3)),
        to_second: length(fx!(4), fx!(0)),
    };
    assert!(!arms.turn(Fx::ZERO));
    assert!(arms.turn(Angle::QUARTER.to_radians()));
    let close = |a: Vec2<Length>, b: Vec2<Length>| {
        (a - b).x.abs() < Length::DELTA * 9 && (a - b).y.abs() < Length::DELTA * 9
    };
    assert_eq!(arms.normal, Vec2::new(-Unit::ONE, Unit::ZERO));
    assert!(close(arms.to_a, length(fx!(-2), fx!(1))));
    assert!(close(arms.to_b, length(fx!(3), fx!(0))));
    assert!(close(arms.to_second, length(fx!(0), fx!(4))));
}
