//! Sine, cosine and arc tangent in integer arithmetic.
//!
//! `sin(pi x / 2) = x (c0 - c1 z + c2 z^2 - ... - c5 z^5)` with `z = x^2`, for `x` from 0 to 1 quarter turn, to which
//! the turn is folded by symmetry. The sine is odd, the cosine even, and both are exact at the quarter turns.
//! `atan(t) = t (c0 - c1 z + ... + c6 z^6)` with `z = t^2`, for `|t| <= tan(1/16 turn)`. The plane is folded at the
//! diagonal and by `atan t = pi/4 - atan((1 - t) / (1 + t))`.
//!
//! The coefficients are minimax, from a Remez exchange with 50 digits weighted by absolute error, with the sine
//! constrained to 1 at the quarter turn. The two leading coefficients of the sine were moved by one unit, which a sweep
//! showed to be better. An interpolated table would need 130 KiB for the same error, and CORDIC 30 iterations.
//!
//! Largest error: 0.79 units of 2^-30 for sine and cosine (over all 2^32 angles), 0.68 units of 2^-32 turn for the arc
//! tangent (over 2e8 random vectors).

/// A quarter turn in units of 2^-32 turn.
const QUARTER: u32 = 1 << 30;

/// Sine in units of 2^-30 of `angle` in units of 2^-32 turn. Branch-free, because branches would be unpredictable.
#[inline]
pub(super) const fn sine(angle: u32) -> i32 {
    let angle = signed(angle);
    // x and half a turn minus x have the same sine.
    let folded = QUARTER - angle.unsigned_abs().abs_diff(QUARTER);
    let minus = angle >> 31; // all bits set for a negative angle
    (sine_of_quarter_turn(folded) ^ minus) - minus
}

/// Sine of `0 <= angle <= 2^30`, in units of 2^-30.
#[inline]
const fn sine_of_quarter_turn(angle: u32) -> i32 {
    /// Coefficients in units of 2^-33, 2^-32, 2^-35, 2^-39, 2^-44 and 2^-48, with which each product fits 64 bits. All
    /// but the last include half a unit, so that dropping bits rounds to nearest.
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
    // The top bit of `long` is moved to bit 62, so that `long + short` fits.
    let spare = long.leading_zeros();
    let (short, long) =
        if spare == 0 { (short >> 1, long >> 1) } else { (short << (spare - 1), long << (spare - 1)) };
    // Above 53/128, just under tan(1/16 turn), the angle is measured from the diagonal.
    let from_diagonal = short > (long >> 7) * 53;
    let (numerator, denominator) = if from_diagonal { (long - short, long + short) } else { (short, long) };

    // The quotient is below one half, so the doubled numerator fits, and one division gives 32 bits.
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
mod tests {
    //! Taylor series in units of 2^-60, with an error below 2^-54, are the reference.

    use super::*;
    use crate::math::Rng;

    /// 2 pi in units of 2^-60.
    const TAU: i128 = 7_244_019_458_077_122_842;
    const ONE: i128 = 1 << 60;

    /// Sine and cosine in units of 2^-60.
    fn slow_sin_cos(angle: u32) -> (i128, i128) {
        let x = (i128::from(signed(angle)) * TAU) >> 32;
        let (mut sin, mut cos, mut term) = (0, 0, ONE);
        for order in 1..40 {
            match order % 4 {
                1 => cos += term,
                2 => sin += term,
                3 => cos -= term,
                _ => sin -= term,
            }
            term = ((term * x) >> 60) / order;
        }
        (sin, cos)
    }

    /// Angles at a constant stride over the turn, and all angles near each multiple of an eighth of a turn.
    fn angles() -> impl Iterator<Item = u32> {
        let all = (0..60_000_u32).map(|i| i.wrapping_mul(71_583));
        let borders = (0..8_u32)
            .flat_map(|eighth| (0..2001).map(move |i| (eighth << 29).wrapping_add(i).wrapping_sub(1000)));
        all.chain(borders)
    }

    #[test]
    fn sine_is_within_079_units() {
        let mut largest = 0;
        for angle in angles() {
            let (sin, _) = slow_sin_cos(angle);
            largest = largest.max((i128::from(sine(angle)) * (1 << 30) - sin).abs());
        }
        // Thousandths of 2^-30. The limit is below 0.79 units, because this sweep is not exhaustive.
        let thousandths = (largest * 1000) >> 30;
        assert!(
            (500..=789).contains(&thousandths),
            "the largest error should be 500 to 789 thousandths, not {thousandths}"
        );
    }

    #[test]
    fn symmetries_are_exact() {
        for angle in angles() {
            assert_eq!(sine(angle.wrapping_neg()), -sine(angle), "the sine should be odd at {angle}");
            assert_eq!(
                sine((2 * QUARTER).wrapping_sub(angle)),
                sine(angle),
                "the sine should be symmetric at {angle}"
            );
            assert!(sine(angle).abs() <= 1 << 30);
        }
        assert_eq!([0, 1, 2, 3].map(|quarters| sine(quarters * QUARTER)), [0, 1 << 30, 0, -1 << 30]);
    }

    #[test]
    fn cosine_and_sine_are_on_the_circle() {
        for angle in angles() {
            let (sin, cos) = (i64::from(sine(angle)), i64::from(sine(angle.wrapping_add(QUARTER))));
            // The tolerance is twice 0.79 sqrt 2 units.
            let excess = sin * sin + cos * cos - (1 << 60);
            assert!(excess.abs() * 100 <= 224 << 30, "{angle}: {excess}");
        }
    }

    /// Error of [`arc_tangent`] in thousandths of 2^-32 turn.
    fn arc_tangent_error(x: i64, y: i64) -> i128 {
        let (sin, cos) = slow_sin_cos(arc_tangent(x, y));
        // Scaled up, so that the length has at least 62 bits.
        let shift = (x.unsigned_abs() | y.unsigned_abs()).leading_zeros().saturating_sub(1);
        let (x, y) = (i128::from(x) << shift, i128::from(y) << shift);
        let length = (x.unsigned_abs().pow(2) + y.unsigned_abs().pow(2)).isqrt();
        let length = i128::try_from(length).expect("64 bits");
        assert!(
            (cos * x + sin * y) / length > ONE / 2,
            "the direction of ({x}, {y}) should be roughly right"
        );
        ((cos * y - sin * x) / length).abs() * 1000 / (TAU >> 32)
    }

    #[test]
    fn arc_tangent_is_within_068_units() {
        let mut rng = Rng::new(1);
        let mut largest = 0;
        for _ in 0..100_000 {
            let mut part = || {
                let shift = rng.below(64);
                i64::from_ne_bytes(rng.next_u64().to_ne_bytes()) >> shift
            };
            let (x, y) = (part(), part());
            if (x, y) != (0, 0) {
                largest = largest.max(arc_tangent_error(x, y));
            }
        }
        // Borders of the range reduction: tan(1/16 turn) is 0.41421, and the formula changes at 53/128.
        for long in [128_i64, 1 << 31, 1 << 40, i64::MAX] {
            for near in -200..200 {
                for short in [long / 128 * 53 + near, long + near.min(0), near] {
                    largest =
                        largest.max(arc_tangent_error(long, short)).max(arc_tangent_error(short, -long));
                }
            }
        }
        assert!(
            (500..=680).contains(&largest),
            "the largest error should be 500 to 680 thousandths, not {largest}"
        );
    }

    #[test]
    fn arc_tangent_is_exact_on_axes_and_diagonals() {
        for r in [1, 2, 3, 1 << 31, (1 << 32) + 1, i64::MAX - 1, i64::MAX] {
            let directions = [(r, 0), (r, r), (0, r), (-r, r), (-r, 0), (-r, -r), (0, -r), (r, -r)];
            for (eighth, (x, y)) in (0..).zip(directions) {
                assert_eq!(arc_tangent(x, y), eighth << 29, "({x}, {y})");
            }
        }
        let low = i64::MIN;
        assert_eq!(
            [(low, 0), (low, low), (0, low)].map(|(x, y)| arc_tangent(x, y)),
            [4 << 29, 5 << 29, 6 << 29]
        );
        assert_eq!(arc_tangent(0, 0), 0);
    }
}
