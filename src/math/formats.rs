//! Number formats, one alias per quantity, and conversions between them.
//!
//! Operations round at most once, to nearest (ties towards +infinity; away from zero in divisions), and saturate. The
//! binary point of the result is inferred from its type. Ranges come from the values in large and heavily loaded scenes
//! (`docs/DESIGN.md`).

#[cfg(test)]
mod tests;

use fixed::types::extra::{LeEqU32, U18, U20, U21, U22, U24, U26, U27, U30, U32};
use fixed::{FixedI32, FixedI64};

/// World position in metres, and most public scalars: ±2.1e9, resolution 0.23 nm.
pub type Fx = FixedI64<U32>;
/// A vertex relative to its shape's centre, or a lever arm, in metres: ±512, resolution 0.24 µm.
pub type Length = FixedI32<U22>;
/// A speed in m/s: ±1024, resolution 4.8e-7. Also an angular velocity times the radius of gyration, and the impulse of
/// a constraint row divided by its effective mass.
pub type Speed = FixedI32<U21>;
/// Separation of a contact, or gap of a joint, in metres: ±16, resolution 7.5 nm.
pub type Step = FixedI32<U27>;
/// Displacement of a body within a tick, in metres: ±32, resolution 15 nm. The solver keeps displacements within ±16,
/// so that differences of two displacements fit.
pub type Shift = FixedI32<U26>;
/// Component of a unit vector, sine, cosine, mass fraction or gain: ±2, resolution 9.3e-10.
pub type Unit = FixedI32<U30>;
/// Lever arm over a radius of gyration: ±128, resolution 6e-8.
pub type Ratio = FixedI32<U24>;
/// Rate that turns a constraint error into speed, in 1/s: ±8192, resolution 3.8e-6.
pub type Rate = FixedI32<U18>;
/// Friction limit of a tangent row per unit of the normal impulse: ±2048, resolution 9.5e-7.
pub type FrictionRatio = FixedI32<U20>;

/// `x / 2^shift`, rounded to nearest, ties towards +infinity. `shift` is at most 63.
#[inline]
#[must_use]
pub const fn round_shift(x: i64, shift: u32) -> i64 {
    // Drops all but one of the `shift` bits before the addition, so that the addition could overflow only with a shift
    // of 1.
    match shift {
        0 => x,
        1 => (x >> 1) + (x & 1),
        _ => ((x >> (shift - 1)) + 1) >> 1,
    }
}

/// [`round_shift`] for 128-bit intermediates. `shift` is at most 127.
#[inline]
#[must_use]
pub const fn round_shift_wide(x: i128, shift: u32) -> i128 {
    match shift {
        0 => x,
        1 => (x >> 1) + (x & 1),
        _ => ((x >> (shift - 1)) + 1) >> 1,
    }
}

/// Saturates to `i32`.
#[inline]
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "clamped to the range of i32 first")]
pub const fn saturate(x: i64) -> i32 {
    if x > i32::MAX as i64 {
        i32::MAX
    } else if x < i32::MIN as i64 {
        i32::MIN
    } else {
        x as i32
    }
}

/// Saturates to `i64`.
#[inline]
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "clamped to the range of i64 first")]
pub const fn saturate_wide(x: i128) -> i64 {
    if x > i64::MAX as i128 {
        i64::MAX
    } else if x < i64::MIN as i128 {
        i64::MIN
    } else {
        x as i64
    }
}

/// `n / d` rounded to nearest, halves away from zero, saturated. `d` must not be 0.
#[inline]
#[must_use]
#[expect(clippy::cast_possible_wrap, reason = "compared with the largest value first")]
pub const fn div_round(n: i128, d: i128) -> i128 {
    let negative = (n < 0) != (d < 0);
    let (n, d) = (n.unsigned_abs(), d.unsigned_abs());
    let floor = n / d;
    let remainder = n - floor * d;
    // Adding d / 2 to n could overflow, so the remainder is compared instead.
    let quotient = if remainder >= d - remainder { floor + 1 } else { floor };
    match (quotient > i128::MAX as u128, negative) {
        (true, true) => i128::MIN,
        (true, false) => i128::MAX,
        (false, true) => -(quotient as i128),
        (false, false) => quotient as i128,
    }
}

/// `a b` in the format of the result, rounded once, saturated.
#[inline]
#[must_use]
pub fn mul<A: LeEqU32, B: LeEqU32, C: LeEqU32>(a: FixedI32<A>, b: FixedI32<B>) -> FixedI32<C> {
    FixedI32::from_bits(saturate(round_shift(
        i64::from(a.to_bits()) * i64::from(b.to_bits()),
        const { shift::<A, B, C>() },
    )))
}

/// `a x + b y`, rounded once, saturated.
#[inline]
#[must_use]
pub fn mul_add<A: LeEqU32, B: LeEqU32, C: LeEqU32>(
    a: FixedI32<A>,
    x: FixedI32<B>,
    b: FixedI32<A>,
    y: FixedI32<B>,
) -> FixedI32<C> {
    let ax = i64::from(a.to_bits()) * i64::from(x.to_bits());
    let by = i64::from(b.to_bits()) * i64::from(y.to_bits());
    FixedI32::from_bits(saturate(round_shift(ax.saturating_add(by), const { shift::<A, B, C>() })))
}

/// `a x - b y`, rounded once, saturated.
#[inline]
pub(super) fn mul_sub<A: LeEqU32, B: LeEqU32, C: LeEqU32>(
    a: FixedI32<A>,
    x: FixedI32<B>,
    b: FixedI32<A>,
    y: FixedI32<B>,
) -> FixedI32<C> {
    let ax = i64::from(a.to_bits()) * i64::from(x.to_bits());
    let by = i64::from(b.to_bits()) * i64::from(y.to_bits());
    FixedI32::from_bits(saturate(round_shift(ax.saturating_sub(by), const { shift::<A, B, C>() })))
}

/// Bits to drop from a product to reach format `C`.
const fn shift<A: LeEqU32, B: LeEqU32, C: LeEqU32>() -> u32 {
    let product = A::U32 + B::U32;
    assert!(product >= C::U32, "a product should have at least as many fraction bits as the result");
    product - C::U32
}

/// Converts to another 32-bit format, rounded to nearest, saturated.
#[inline]
#[must_use]
pub fn convert<A: LeEqU32, B: LeEqU32>(a: FixedI32<A>) -> FixedI32<B> {
    let bits = i64::from(a.to_bits());
    FixedI32::from_bits(saturate(if A::U32 > B::U32 {
        round_shift(bits, A::U32 - B::U32)
    } else {
        bits << (B::U32 - A::U32)
    }))
}

/// Converts to a 32-bit format, rounded to nearest, saturated.
#[inline]
#[must_use]
pub fn narrow<A: LeEqU32>(a: Fx) -> FixedI32<A> {
    FixedI32::from_bits(saturate(round_shift(a.to_bits(), 32 - A::U32)))
}

/// Converts to world format: exact.
#[inline]
#[must_use]
pub fn widen<A: LeEqU32>(a: FixedI32<A>) -> Fx {
    Fx::from_bits(i64::from(a.to_bits()) << (32 - A::U32))
}

/// `a b`, rounded to nearest, saturated.
#[inline]
#[must_use]
pub const fn fx_mul(a: Fx, b: Fx) -> Fx {
    Fx::from_bits(round_product(a.to_bits() as i128 * b.to_bits() as i128))
}

/// Converts a sum of products of [`Fx`] to the format of `Fx`, rounded to nearest, saturated.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "the truncated bits are compared")]
pub(super) const fn round_product(x: i128) -> i64 {
    // The sum in units of half the resolution. It nearly always fits 64 bits, where rounding is fast.
    let halves = x >> 31;
    let low = halves as i64;
    if low as i128 == halves { (low >> 1) + (low & 1) } else { saturate_wide(round_shift_wide(x, 32)) }
}

/// `a / b`, rounded to nearest, saturated; `None` if `b` is 0.
#[inline]
#[must_use]
pub const fn fx_div(a: Fx, b: Fx) -> Option<Fx> {
    if b.to_bits() == 0 {
        return None;
    }
    Some(Fx::from_bits(saturate_wide(div_round((a.to_bits() as i128) << 32, b.to_bits() as i128))))
}

/// `numerator / denominator`, rounded to nearest, saturated. The denominator must not be 0.
#[inline]
#[must_use]
pub const fn ratio(numerator: i64, denominator: i64) -> Fx {
    assert!(denominator != 0, "the denominator of a ratio must not be 0");
    Fx::from_bits(saturate_wide(div_round((numerator as i128) << 32, denominator as i128)))
}

/// A fixed-point constant from a literal or a fraction, at compile time without floats.
///
/// ```
/// use lockstep2d::{fx, math::Fx};
/// assert_eq!(fx!(0.5) + fx!(-2), Fx::lit("-1.5"));
/// assert_eq!(fx!(1 / 4), fx!(0.25));
/// ```
#[macro_export]
macro_rules! fx {
    ($value:literal) => {
        const { $crate::math::Fx::lit(stringify!($value)) }
    };
    ($numerator:literal / $denominator:literal) => {
        const { $crate::math::ratio($numerator, $denominator) }
    };
    ($($other:tt)*) => {
        ::core::compile_error!(
            "fx! takes a literal or a fraction of two literals; a variable converts with Fx::from(n)"
        )
    };
}
