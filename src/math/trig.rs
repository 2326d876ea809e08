//! Sine, cosine and arc tangent on integers.
//!
//! `sin(pi x / 2) = x (c0 - c1 z + c2 z^2 - ... - c5 z^5)` with `z = x^2`, for `x` in one quarter turn, folded from the whole
//! turn by symmetry: the sine is exactly odd, the cosine exactly even, and both are exact at the quarter turns.
//! `atan(t) = t (c0 - c1 z + ... + c6 z^6)` for `|t| <= tan(1/16 turn)`, reached by folding the plane at the diagonal
//! and by `atan t = pi/4 - atan((1 - t) / (1 + t))`.
//!
//! The coefficients are minimax (Remez exchange with 50 digits, absolute error of the result as weight; the sine's
//! under the constraint that it is 1 at the quarter turn), then rounded to the scale given at each. The two leading
//! ones of the sine were moved by one unit where a sweep showed a smaller error.
//! A table with interpolation would need 64 KiB for the same error; CORDIC loops 30 times.
//!
//! Largest error: sine and cosine 0.79 units of 2^-30 (over all 2^32 angles), arc tangent 0.68 units of 2^-32 turn (over 2e8 random vectors).

/// A quarter turn in units of 2^-32 turn.
const QUARTER: u32 = 1 << 30;

/// Sine of `angle` (2^-32 turn) in units of 2^-30.
#[inline]
pub(super) const fn sine(angle: u32) -> i32 {
    let magnitude = sine_of_half_turn(signed(angle).unsigned_abs());
    if signed(angle) < 0 { -magnitude } else { magnitude }
}

/// Sine of an angle from 0 to one half turn, `0 <= angle <= 2^31`, in units of 2^-30.
#[inline]
const fn sine_of_half_turn(angle: u32) -> i32 {
    /// Units of 2^-33, 2^-32, 2^-35, 2^-39, 2^-44, 2^-48: each product below just fits 64 bits. All but the last
    /// contain one half, so that dropping bits rounds.
    const C: [u64; 6] =
        [13_493_037_702, 2_774_394_650, 2_738_216_371, 2_573_744_741, 2_818_456_289, 961_408_605];
    let x = (if angle > QUARTER { 2 * QUARTER - angle } else { angle }) as u64;
    let z = (x * x + (1 << 27)) >> 28; // units of 2^-32
    let mut sum = C[4] - ((z * C[5]) >> 36);
    sum = C[3] - ((z * sum) >> 37);
    sum = C[2] - ((z * sum) >> 36);
    sum = C[1] - ((z * sum) >> 35);
    sum = C[0] - ((z * sum) >> 31);
    ((x * sum + (1 << 32)) >> 33) as i32
}

/// The direction of `(x, y)` in units of 2^-32 turn, counter-clockwise from the x axis; 0 for the zero vector.
/// Exact on the axes and the diagonals.
pub(super) const fn arc_tangent(x: i64, y: i64) -> u32 {
    let (width, height) = (x.unsigned_abs(), y.unsigned_abs());
    let steep = height > width;
    let eighth = if steep { eighth_turn(width, height) } else { eighth_turn(height, width) };
    let quarter = if steep { QUARTER - eighth } else { eighth };
    let half = if x < 0 { 2 * QUARTER - quarter } else { quarter };
    if y < 0 { half.wrapping_neg() } else { half }
}

/// `atan(short / long)` in units of 2^-32 turn, for `short <= long`; 0 when both are 0.
const fn eighth_turn(short: u64, long: u64) -> u32 {
    /// Units of 2^-35.
    const C: [u64; 7] =
        [5_468_522_204, 1_822_840_555, 1_093_692_894, 780_888_461, 602_750_356, 457_771_138, 249_084_370];
    if long == 0 {
        return 0;
    }
    // The top bit of `long` goes to bit 62, so that the sum of two fits.
    let spare = long.leading_zeros();
    let (short, long) =
        if spare == 0 { (short >> 1, long >> 1) } else { (short << (spare - 1), long << (spare - 1)) };
    // Above 53/128, just under tan(1/16 turn), the angle is measured from the diagonal.
    let from_diagonal = short > (long >> 7) * 53;
    let (numerator, denominator) = if from_diagonal { (long - short, long + short) } else { (short, long) };

    // 32 bits of quotient from one 64-bit division: the quotient is below one half, so the doubled numerator fits.
    let spare = denominator.leading_zeros();
    let divisor = (denominator << spare) >> 31;
    let t = (((numerator << spare) << 1) + divisor / 2) / divisor;

    let z = (t * t) >> 32;
    let mut sum = C[5] - ((z * C[6]) >> 32);
    sum = C[4] - ((z * sum) >> 32);
    sum = C[3] - ((z * sum) >> 32);
    sum = C[2] - ((z * sum) >> 32);
    sum = C[1] - ((z * sum) >> 32);
    sum = C[0] - ((z * sum) >> 32);
    let angle = ((t * sum + (1 << 34)) >> 35) as u32;
    if from_diagonal { QUARTER / 2 - angle } else { angle }
}

/// The same angle between minus and plus one half turn.
#[inline]
#[expect(clippy::cast_possible_wrap, reason = "wrapping is the meaning of an angle")]
pub(super) const fn signed(angle: u32) -> i32 {
    angle as i32
}
