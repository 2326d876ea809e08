//! Roots, lengths and unit vectors.

use lockstep2d::math::{Fx, Length, Unit, Vec2, hypot, sqrt};
use num_bigint::BigInt;
use num_traits::{One, Signed};

use super::exact::{root, saturated};
use super::{number, small, vector};
use crate::source::Source;

pub(super) fn check(source: &mut Source<'_>) {
    let x = number(source);
    match sqrt(x) {
        None => assert!(x < Fx::ZERO),
        Some(found) => assert_root(found.to_bits().into(), &(BigInt::from(x.to_bits()) << 32), 64),
    }
    let v = vector(source);
    let squares = square(v.x.to_bits()) + square(v.y.to_bits());
    assert_root(hypot(v.x, v.y).to_bits().into(), &squares, 64);
    let w = vector(source);
    let difference = |a: Fx, b: Fx| BigInt::from(a.to_bits()) - b.to_bits();
    let squares_between = difference(v.x, w.x).pow(2) + difference(v.y, w.y).pow(2);
    assert_root(v.distance(w).to_bits().into(), &squares_between, 64);
    match v.normalized_with_length() {
        None => assert_eq!(v, Vec2::ZERO),
        Some((unit, length)) => {
            assert_eq!((Some(unit), length), (v.normalized(), v.length()));
            assert_unit(unit, v.x.to_bits(), v.y.to_bits());
        }
    }
    let (a, b) = (small(source), small(source));
    let v = Vec2::new(Length::from_bits(a), Length::from_bits(b));
    assert_root(v.length().to_bits().into(), &(square(a.into()) + square(b.into())), 32);
    match v.normalized_with_length() {
        None => assert_eq!(v, Vec2::ZERO),
        Some((unit, length)) => {
            assert_eq!((Some(unit), length), (v.normalized(), v.length()));
            assert_unit(unit, a.into(), b.into());
        }
    }
}

fn square(bits: i64) -> BigInt {
    BigInt::from(bits).pow(2)
}

/// Checks that a root is rounded to nearest and saturated: `(2 r - 1)^2 <= 4 x <= (2 r + 1)^2`.
fn assert_root(found: BigInt, x: &BigInt, bits: u32) {
    let rounded: BigInt = (root(&(x * 4)) + 1) / 2;
    assert_eq!(found, saturated(rounded, bits), "the root of {x}");
}

/// Checks that each component of the unit vector of `(x, y)` has an error of at most 0.76 units of 2^-30.
fn assert_unit(unit: Vec2<Unit>, x: i64, y: i64) {
    // The length has 80 more fractional bits than the vector.
    let length = root(&((square(x) + square(y)) << 160));
    for (found, component) in [(unit.x, x), (unit.y, y)] {
        // The exact component is in units of 2^-70.
        let exact: BigInt = (BigInt::from(component) << (70 + 80)) / &length;
        let error: BigInt = (BigInt::from(found.to_bits()) << 40) - exact;
        assert!(error.abs() * 100 <= (BigInt::one() << 40) * 76 + 1000, "{unit:?} of ({x}, {y})");
    }
}
