use super::*;
use crate::math::Rng;

fn wide(low: u128) -> Wide {
    Wide { high: 0, low }
}

#[test]
fn carries_cross_the_halves() {
    let top = wide(u128::MAX);
    let sum = top.plus(wide(1));
    assert_eq!(sum, Wide { high: 1, low: 0 });
    assert_eq!(sum.minus(wide(1)), top);
    assert!(sum > top);
}

/// A common factor of 2^64 forces the second call into the slow branch, except where `x numerator` is below 2^64.
#[test]
fn long_division_agrees_with_the_short_one() {
    let mut rng = Rng::new(1);
    for _ in 0..2000 {
        let denominator = u128::from(rng.next_u64() >> (rng.below(63))) + 1;
        let numerator = u128::from(rng.next_u64()) % (denominator + 1);
        let x = rng.next_u64() >> rng.below(64);
        let long = |n: u128| Wide { high: n >> 64, low: n << 64 };
        assert_eq!(
            scaled(x, wide(numerator), wide(denominator)),
            scaled(x, long(numerator), long(denominator)),
            "{x} {numerator} / {denominator}"
        );
    }
}

#[test]
fn the_widest_differences_are_exact() {
    let corner = |x: Fx, y: Fx| Vec2::new(x, y);
    let diagonal = Difference::new(corner(Fx::MIN, Fx::MIN), corner(Fx::MAX, Fx::MAX));
    let side = u128::from(u64::MAX);
    let square = diagonal.dot(diagonal);
    assert_eq!(square.magnitude, wide(side * side).plus(wide(side * side)));
    assert_eq!(diagonal.cross(diagonal).sign(), Ordering::Equal);
    let other = Difference::new(corner(Fx::MIN, Fx::MAX), corner(Fx::MAX, Fx::MIN));
    assert_eq!(diagonal.cross(other).sign(), Ordering::Less);
    assert_eq!(other.cross(diagonal).magnitude, square.magnitude);
    assert_eq!(diagonal.dot(other).sign(), Ordering::Equal);
}
