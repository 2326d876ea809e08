//! Angles, sines and rotations.

use lockstep2d::math::{Angle, Fx, Length, Rot, Transform, Unit, Vec2};
use num_bigint::BigInt;
use num_traits::{One, Signed};

use super::exact::{self, Exact, PI, PRECISION, fixed, halves_away, halves_up, of, saturated, sin_cos};
use super::{number, small, vector};
use crate::source::Source;

pub(super) fn check(source: &mut Source<'_>) {
    let edges = [0u32, 1, u32::MAX, 1 << 29, 1 << 30, 1 << 31, 3 << 30, 3 << 29];
    let bits = match source.below(3) {
        0 => source.pick(&edges).wrapping_add(u32::from(source.byte())).wrapping_sub(128),
        _ => source.word() as u32,
    };
    let angle = Angle::from_bits(bits);
    match source.below(4) {
        0 => sines(angle),
        1 => units(source, angle),
        2 => directions(source),
        _ => rotations(source, angle),
    }
}

/// Checks that sine and cosine have an error of at most 0.8 units of 2^-30.
fn sines(angle: Angle) {
    let (sin, cos) = sin_cos(angle.to_bits());
    for (found, exact) in [(angle.sin(), sin), (angle.cos(), cos)] {
        let error = ((BigInt::from(found.to_bits()) << (PRECISION - 30)) - exact).abs();
        assert!(error * 10 <= (BigInt::one() << (PRECISION - 30)) * 8, "{angle:?}: {found}");
    }
    assert_eq!(angle.sin_cos(), (angle.sin(), angle.cos()));
}

fn units(source: &mut Source<'_>, angle: Angle) {
    // The signed angle is in (-1/2, 1/2] turns.
    let signed = match i64::from(angle.to_bits()) {
        bits if bits > 1 << 31 => bits - (1 << 32),
        bits => bits,
    };
    assert_eq!(of(angle.to_turns()), fixed(signed, 32));
    assert_eq!(of(angle.to_degrees()), fixed(signed * 360, 32));
    let turn = Exact::new(PI.clone() * 2, BigInt::one() << PRECISION);
    let radians = BigInt::from(angle.to_radians().to_bits());
    assert_eq!(radians, halves_up(&(fixed(signed, 32) * &turn), 32), "{angle:?} in radians");

    let x = number(source);
    let wrapped = |bits: BigInt| {
        let turn: BigInt = BigInt::one() << 32;
        ((bits % &turn) + &turn) % turn
    };
    let bits = |angle: Angle| BigInt::from(angle.to_bits());
    assert_eq!(bits(Angle::from_turns(x)), wrapped(x.to_bits().into()));
    assert_eq!(bits(Angle::from_degrees(x)), wrapped(halves_away(&(of(x) / exact::integer(360)), 32)), "{x}");
    let exact = halves_up(&(of(x) / turn), 32);
    // The engine multiplies by a rounded constant. This adds an error of up to a sixteenth of a unit, so the rounded
    // result may be off by one unit.
    let off = wrapped(bits(Angle::from_radians(x)) - exact + 1);
    assert!(off <= BigInt::from(2), "{x} rad");
}

/// Checks that the angle of a vector has an error of at most 0.7 units of 2^-32 turn.
fn directions(source: &mut Source<'_>) {
    let v = if source.one_in(2) {
        vector(source)
    } else {
        Vec2::new(Fx::from_bits(small(source).into()), Fx::from_bits(small(source).into()))
    };
    let angle = Angle::of(v);
    if v == Vec2::ZERO {
        return assert_eq!(angle, Angle::ZERO);
    }
    let (sin, cos) = sin_cos(angle.to_bits());
    let (x, y) = (BigInt::from(v.x.to_bits()), BigInt::from(v.y.to_bits()));
    let across: BigInt = (&y * &cos - &x * &sin).abs();
    assert!((&x * &cos + &y * &sin).is_positive(), "{v:?} points away from {angle:?}");
    // `across` is `|v| sin(error)`. The error is so small that it equals its sine.
    let length = exact::root(&((x.pow(2) + y.pow(2)) << 128));
    let unit: BigInt = (&*PI * 2) >> 32;
    assert!((across << 64) * 1000 <= unit * length * 701, "{v:?}: {angle:?}");
}

fn rotations(source: &mut Source<'_>, angle: Angle) {
    let rotation = Rot::from_angle(angle);
    let (cos, sin) = (fixed(rotation.cos.to_bits(), 30), fixed(rotation.sin.to_bits(), 30));
    let v = vector(source);
    let (x, y) = (of(v.x), of(v.y));
    let turned = [&cos * &x - &sin * &y, &sin * &x + &cos * &y];
    let found = rotation.apply_wide(v);
    for (found, exact) in [found.x, found.y].into_iter().zip(&turned) {
        assert_eq!(BigInt::from(found.to_bits()), saturated(halves_up(exact, 32), 64), "{angle:?} of {v:?}");
    }
    let position = vector(source);
    let placed = Transform::new(position, rotation).apply(v);
    for (found, exact, offset) in [(placed.x, &turned[0], position.x), (placed.y, &turned[1], position.y)] {
        let expected = halves_up(exact, 32) + offset.to_bits();
        assert_eq!(BigInt::from(found.to_bits()), saturated(expected, 64), "{v:?} at {position:?}");
    }
    let (a, b) = (small(source), small(source));
    let found = rotation.apply(Vec2::new(Length::from_bits(a), Length::from_bits(b)));
    let exact = cos * fixed(a, 22) - sin * fixed(b, 22);
    assert_eq!(BigInt::from(found.x.to_bits()), saturated(halves_up(&exact, 22), 32), "{a} {b} {angle:?}");
    // The composition of two rotations equals the rotation by the sum of their angles, within 4 units of 2^-30.
    let other = Angle::from_bits(source.word() as u32);
    let (both, sum) = (rotation.then(Rot::from_angle(other)), Rot::from_angle(angle + other));
    let off = |a: Unit, b: Unit| (i64::from(a.to_bits()) - i64::from(b.to_bits())).abs();
    assert!(off(both.cos, sum.cos) <= 4 && off(both.sin, sum.sin) <= 4, "{angle:?} and {other:?}");
}
