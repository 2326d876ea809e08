//! Exact arithmetic.

use std::sync::LazyLock;

use lockstep2d::math::Fx;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

pub(crate) type Exact = BigRational;

pub(crate) fn integer(value: impl Into<BigInt>) -> Exact {
    Exact::from_integer(value.into())
}

pub(crate) fn fixed(bits: impl Into<BigInt>, fraction_bits: u32) -> Exact {
    Exact::new(bits.into(), BigInt::one() << fraction_bits)
}

pub(crate) fn of(value: Fx) -> Exact {
    fixed(value.to_bits(), 32)
}

pub(crate) fn ratio(numerator: i64, denominator: i64) -> Exact {
    Exact::new(numerator.into(), denominator.into())
}

/// `value * 2^fraction_bits`, rounded to nearest. Halves are rounded towards +infinity.
pub(crate) fn halves_up(value: &Exact, fraction_bits: u32) -> BigInt {
    (value * integer(BigInt::one() << fraction_bits) + ratio(1, 2)).floor().to_integer()
}

/// `value * 2^fraction_bits`, rounded to nearest. Halves are rounded away from zero.
pub(crate) fn halves_away(value: &Exact, fraction_bits: u32) -> BigInt {
    let magnitude = halves_up(&value.abs(), fraction_bits);
    if value.is_negative() { -magnitude } else { magnitude }
}

pub(crate) fn saturated(value: BigInt, bits: u32) -> BigInt {
    let end: BigInt = BigInt::one() << (bits - 1);
    value.clamp(-end.clone(), end - 1)
}

/// Square root, rounded down.
pub(crate) fn root(value: &BigInt) -> BigInt {
    value.sqrt()
}

/// Number of fractional bits of [`PI`] and of the results of [`sin_cos`].
pub(crate) const PRECISION: u32 = 160;

/// Pi, by Machin's formula: `pi / 4 = 4 atan(1/5) - atan(1/239)`.
pub(crate) static PI: LazyLock<BigInt> =
    LazyLock::new(|| (arc_tangent_of_inverse(5) * 4 - arc_tangent_of_inverse(239)) * 4);

fn arc_tangent_of_inverse(n: i64) -> BigInt {
    let mut power = (BigInt::one() << PRECISION) / n;
    let (mut sum, mut divisor, mut sign) = (BigInt::zero(), 1, 1);
    while !power.is_zero() {
        sum += &power / divisor * sign;
        power /= n * n;
        divisor += 2;
        sign = -sign;
    }
    sum
}

/// Sine and cosine of `bits / 2^32` turns.
pub(crate) fn sin_cos(bits: u32) -> (BigInt, BigInt) {
    // The angle is reduced to at most an eighth of a turn, because the series then needs few terms.
    let quarter = bits.wrapping_add(1 << 29) >> 30;
    let rest = i64::from(bits.wrapping_sub(quarter << 30) as i32);
    let angle: BigInt = (&*PI * rest) >> 31;
    let (sin, cos) = (series(&angle, 1), series(&angle, 0));
    match quarter & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Returns `x^n/n! - x^(n+2)/(n+2)! + ...`, where `n` is `first`.
fn series(x: &BigInt, first: i64) -> BigInt {
    let mut term = if first == 0 { BigInt::one() << PRECISION } else { x.clone() };
    let (mut sum, mut n) = (BigInt::zero(), first);
    while !term.is_zero() {
        sum += &term;
        term = -(((&term * x) >> PRECISION) * x >> PRECISION) / ((n + 1) * (n + 2));
        n += 2;
        // A right shift rounds down, so a negative term ends at -1 and never becomes zero.
        if term == -BigInt::one() {
            break;
        }
    }
    sum
}
