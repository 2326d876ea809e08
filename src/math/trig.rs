//! Sine, cosine and arc tangent in integer arithmetic.
//!
//! `sin(pi x / 2) = x (c0 - c1 z + c2 z^2 - ... - c5 z^5)` with `z = x^2`, for `x` from 0 to 1 quarter turn. Symmetry
//! reduces all other angles to this range. The sine is odd, the cosine even, and both are exact at the quarter turns.
//! `atan(t) = t (c0 - c1 z + ... + c6 z^6)` with `z = t^2`, for `|t| <= tan(1/16 turn)`. Reflections at the axes and at
//! the diagonal, and `atan t = pi/4 - atan((1 - t) / (1 + t))`, reduce all directions to this range.
//!
//! The coefficients are minimax, from a Remez exchange with 50 digits weighted by absolute error, with the sine
//! constrained to 1 at the quarter turn. The two leading coefficients of the sine differ from the result of the
//! exchange by one unit, because a sweep over the angles then found smaller errors. An interpolated table would need
//! 130 KiB for the same error, and CORDIC 30 iterations.
//!
//! Largest error: 0.79 units of 2^-30 for sine and cosine (over all 2^32 angles), 0.68 units of 2^-32 turn for the arc
//! tangent (over 2e8 random vectors).

/// A quarter turn in units of 2^-32 turn.
const QUARTER: u32 = 1 << 30;

/// Sine in units of 2^-30 of `angle` in units of 2^-32 turn. Branch-free, because branches would be unpredictable.
#[inline]
pub(super) const fn sine(angle: u32) -> i32 {
    let angle = signed(angle);
    // The sine of `x` equals the sine of half a turn minus `x`.
    let folded = QUARTER - angle.unsigned_abs().abs_diff(QUARTER);
    let minus = angle >> 31; // all bits set for a negative angle
    (sine_of_quarter_turn(folded) ^ minus) - minus
}

/// Sine of `0 <= angle <= 2^30`, in units of 2^-30.
#[inline]
const fn sine_of_quarter_turn(angle: u32) -> i32 {
    /// Coefficients in units of 2^-33, 2^-32, 2^-35, 2^-39, 2^-44 and 2^-48. In these units, each product fits 64 bits.
    /// All coefficients but the last include half a unit, so that the shifts, which drop bits, round to nearest.
    const C: [u64; 6] =
        [13_493_037_702, 2_774_394_650, 2_738_216_371, 2_573_744_741, 2_818_456_289, 961_408_605];
    let x = angle as u64;
    let z = (x * x + (1 << 27)) >> 28; // units of 2^-32
    let mut sum = C[4] - ((z * C[5]) >> 36);
    sum = C[3] - ((z * sum) >> 37);
    sum = C[2] - ((z * sum) >> 36);
    sum = C[1] - ((z * sum) >> 35);
    sum = C[0] - ((z * sum) >> 31);
    ((x * sum + (1 << 32)) >> 33) as i32
}

/// Direction in units of 2^-32 turn; 0 for the zero vector. Exact on the axes and the diagonals.
pub(super) const fn arc_tangent(x: i64, y: i64) -> u32 {
    let (width, height) = (x.unsigned_abs(), y.unsigned_abs());
    let steep = height > width;
    let eighth = if steep { eighth_turn(width, height) } else { eighth_turn(height, width) };
    let quarter = if steep { QUARTER - eighth } else { eighth };
    let half = if x < 0 { 2 * QUARTER - quarter } else { quarter };
    if y < 0 { half.wrapping_neg() } else { half }
}

/// `atan(short / long)` in units of 2^-32 turn, for `short <= long`; 0 if both are 0.
const fn eighth_turn(short: u64, long: u64) -> u32 {
    /// Coefficients in units of 2^-35.
    const C: [u64; 7] =
        [5_468_522_204, 1_822_840_555, 1_093_692_894, 780_888_461, 602_750_356, 457_771_138, 249_084_370];
    if long == 0 {
        return 0;
    }
    // Moves the top bit of `long` to bit 62, so that `long + short` fits.
    let spare = long.leading_zeros();
    let (short, long) =
        if spare == 0 { (short >> 1, long >> 1) } else { (short << (spare - 1), long << (spare - 1)) };
    // For ratios above 53/128, which is just under tan(1/16 turn), the angle is measured from the diagonal.
    let from_diagonal = short > (long >> 7) * 53;
    let (numerator, denominator) = if from_diagonal { (long - short, long + short) } else { (short, long) };

    // The quotient is below one half, so the doubled numerator fits 64 bits, and one division gives 32 bits of the
    // quotient.
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

#[inline]
#[expect(clippy::cast_possible_wrap, reason = "angles wrap by definition")]
pub(super) const fn signed(angle: u32) -> i32 {
    angle as i32
}

#[cfg(test)]
mod tests;
