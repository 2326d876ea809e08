//! Products, quotients and conversions between formats.

use lockstep2d::math::{
    Fx, Length, Mat2, Ratio, Reciprocal, Speed, Step, Unit, Vec2, convert, div_round, fx_div, fx_mul, mul,
    mul_add, narrow, ratio, round_shift, round_shift_wide, saturate, saturate_wide, widen,
};
use num_bigint::BigInt;
use num_traits::{Signed, Zero};

use super::exact::{self, Exact, fixed, halves_away, halves_up, integer, of, saturated};
use super::{number, small, vector};
use crate::source::Source;

pub(super) fn check(source: &mut Source<'_>) {
    match source.below(7) {
        0 => products(source),
        1 => quotients(source),
        2 => shifts(source),
        3 => formats(source),
        4 => sums(source),
        5 => reciprocals(source),
        _ => matrices(source),
    }
}

fn products(source: &mut Source<'_>) {
    let (a, b) = (number(source), number(source));
    let exact = of(a) * of(b);
    assert_eq!(BigInt::from(fx_mul(a, b).to_bits()), saturated(halves_up(&exact, 32), 64), "{a} {b}");

    let (a, b) = (small(source), small(source));
    let (length, unit) = (Length::from_bits(a), Unit::from_bits(b));
    let exact = fixed(a, 22) * fixed(b, 30);
    let step: Step = mul(length, unit);
    assert_eq!(BigInt::from(step.to_bits()), saturated(halves_up(&exact, 27), 32), "{a} {b}");
    let again: Length = mul(length, unit);
    assert_eq!(BigInt::from(again.to_bits()), saturated(halves_up(&exact, 22), 32), "{a} {b}");
    let (x, y) = (small(source), small(source));
    let sum: Speed = mul_add(length, unit, Length::from_bits(x), Unit::from_bits(y));
    let exact = exact + fixed(x, 22) * fixed(y, 30);
    assert_eq!(BigInt::from(sum.to_bits()), saturated(halves_up(&exact, 21), 32), "{a} {b} {x} {y}");
}

fn quotients(source: &mut Source<'_>) {
    let (a, b) = (number(source), number(source));
    match fx_div(a, b) {
        None => assert_eq!(b, Fx::ZERO),
        Some(quotient) => {
            let exact = of(a) / of(b);
            assert_eq!(BigInt::from(quotient.to_bits()), saturated(halves_away(&exact, 32), 64), "{a} / {b}");
            let quotient = ratio(a.to_bits(), b.to_bits());
            assert_eq!(BigInt::from(quotient.to_bits()), saturated(halves_away(&exact, 32), 64));
        }
    }
    let wide = |source: &mut Source<'_>| {
        let any = i128::from(source.word() as i64) << 64 | i128::from(source.word());
        let small = any >> source.below(127);
        source.pick(&[any, small, i128::MIN, i128::MAX, 1, -1])
    };
    let (n, d) = (wide(source), wide(source));
    if d != 0 {
        let exact = Exact::new(n.into(), d.into());
        assert_eq!(BigInt::from(div_round(n, d)), saturated(halves_away(&exact, 0), 128), "{n} / {d}");
    }
}

fn shifts(source: &mut Source<'_>) {
    let (x, shift) = (number(source).to_bits(), source.below(63) as u32);
    assert_eq!(BigInt::from(round_shift(x, shift)), halves_up(&fixed(x, shift), 0), "{x} >> {shift}");
    assert_eq!(BigInt::from(saturate(x)), saturated(x.into(), 32));
    let wide = i128::from(x) * i128::from(source.word() as i64);
    let shift = source.below(127) as u32;
    assert_eq!(BigInt::from(round_shift_wide(wide, shift)), halves_up(&fixed(wide, shift), 0));
    assert_eq!(BigInt::from(saturate_wide(wide)), saturated(wide.into(), 64));
}

fn formats(source: &mut Source<'_>) {
    let bits = small(source);
    let finer: Step = convert(Length::from_bits(bits));
    assert_eq!(BigInt::from(finer.to_bits()), saturated(halves_up(&fixed(bits, 22), 27), 32));
    let coarser: Length = convert(Step::from_bits(bits));
    assert_eq!(BigInt::from(coarser.to_bits()), saturated(halves_up(&fixed(bits, 27), 22), 32));
    assert_eq!(of(widen(Length::from_bits(bits))), fixed(bits, 22), "widening is exact");
    let wide = number(source);
    let narrowed: Unit = narrow(wide);
    assert_eq!(BigInt::from(narrowed.to_bits()), saturated(halves_up(&of(wide), 30), 32), "{wide}");
}

fn sums(source: &mut Source<'_>) {
    let (a, b) = (vector(source), vector(source));
    let (ax, ay, bx, by) = (of(a.x), of(a.y), of(b.x), of(b.y));
    let rounded = |exact: &Exact| saturated(halves_up(exact, 32), 64);
    assert_eq!(BigInt::from(a.dot(b).to_bits()), rounded(&(&ax * &bx + &ay * &by)), "{a:?} . {b:?}");
    assert_eq!(BigInt::from(a.cross(b).to_bits()), rounded(&(&ax * &by - &ay * &bx)), "{a:?} x {b:?}");
    let t = small(source);
    let exact = &ax + (&bx - &ax) * fixed(t, 30);
    let between = a.lerp(b, Unit::from_bits(t));
    assert_eq!(BigInt::from(between.x.to_bits()), rounded(&exact), "{a:?} {b:?} {t}");
    let s = number(source);
    assert_eq!(BigInt::from(a.scale(s).y.to_bits()), rounded(&(ay * of(s))), "{a:?} {s}");
    let (a, b) = ([small(source), small(source)], [small(source), small(source)]);
    let dot: Step = Vec2::new(Length::from_bits(a[0]), Length::from_bits(a[1]))
        .dot(Vec2::new(Unit::from_bits(b[0]), Unit::from_bits(b[1])));
    let exact = fixed(a[0], 22) * fixed(b[0], 30) + fixed(a[1], 22) * fixed(b[1], 30);
    assert_eq!(BigInt::from(dot.to_bits()), saturated(halves_up(&exact, 27), 32), "{a:?} . {b:?}");
}

/// Checks that the error is at most half a unit of the result plus 2^-31 times the result.
fn reciprocals(source: &mut Source<'_>) {
    let bits = source.within(4, (1 << 62) - 1);
    let a = small(source);
    let reciprocal = Reciprocal::of(Fx::from_bits(bits));
    let exact = fixed(a, 22) / fixed(bits, 32) * integer(1 << 24);
    let found: Ratio = reciprocal.times(Length::from_bits(a));
    let end = integer(i32::MAX);
    if exact.abs() > end {
        let expected = if a > 0 { Ratio::MAX } else { Ratio::MIN };
        let near = (integer(found.to_bits()) - integer(expected.to_bits())).abs() <= integer(1);
        assert!(near, "{a} / {bits}: {found}");
    } else {
        let error = (integer(found.to_bits()) - &exact).abs();
        let bound = exact::ratio(1, 2) + exact.abs() / integer(1i64 << 31);
        assert!(error <= bound, "{a} / {bits}: {found}, {error} units away");
    }
}

fn matrices(source: &mut Source<'_>) {
    let matrix = Mat2::new(number(source), number(source), number(source), number(source));
    let (a, b, c, d) = (of(matrix.a11), of(matrix.a12), of(matrix.a21), of(matrix.a22));
    let exact = &a * &d - &b * &c;
    let rounded = |exact: &Exact| saturated(halves_up(exact, 32), 64);
    assert_eq!(BigInt::from(matrix.determinant().to_bits()), rounded(&exact), "{matrix:?}");
    let v = vector(source);
    assert_eq!(
        BigInt::from(matrix.apply(v).y.to_bits()),
        rounded(&(&c * of(v.x) + &d * of(v.y))),
        "{matrix:?}"
    );
    let Some(inverse) = matrix.inverse() else {
        return assert!(exact.is_zero(), "{matrix:?} has an inverse");
    };
    for (found, numerator) in [(inverse.a11, d), (inverse.a12, -b), (inverse.a21, -c), (inverse.a22, a)] {
        let quotient = numerator / &exact;
        let error = (BigInt::from(found.to_bits()) - saturated(halves_away(&quotient, 32), 64)).abs();
        // If all entries are at the limits, the determinant would be 2^127. It saturates to one unit less.
        assert!(error <= BigInt::from(1), "{matrix:?}: {found}");
    }
}
