//! The reference values come from Taylor series in units of 2^-60, with an error below 2^-54.

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
    // Thousandths of 2^-30, rounded down: 789 means below 0.79 units. The lower bound of the assertion shows that the
    // sweep finds large errors, although it does not visit all angles.
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
        // The length of the vector has an error of at most 0.79 sqrt 2 units of 2^-30, and the square of the length has
        // twice this error.
        let excess = sin * sin + cos * cos - (1 << 60);
        assert!(excess.abs() * 100 <= 224 << 30, "{angle}: {excess}");
    }
}

/// Error of [`arc_tangent`] in thousandths of 2^-32 turn.
fn arc_tangent_error(x: i64, y: i64) -> i128 {
    let (sin, cos) = slow_sin_cos(arc_tangent(x, y));
    // Scales the vector up, so that its length has at least 62 bits.
    let shift = (x.unsigned_abs() | y.unsigned_abs()).leading_zeros().saturating_sub(1);
    let (x, y) = (i128::from(x) << shift, i128::from(y) << shift);
    let length = (x.unsigned_abs().pow(2) + y.unsigned_abs().pow(2)).isqrt();
    let length = i128::try_from(length).expect("64 bits");
    assert!((cos * x + sin * y) / length > ONE / 2, "the direction of ({x}, {y}) should be roughly right");
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
                largest = largest.max(arc_tangent_error(long, short)).max(arc_tangent_error(short, -long));
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
    assert_eq!([(low, 0), (low, low), (0, low)].map(|(x, y)| arc_tangent(x, y)), [4 << 29, 5 << 29, 6 << 29]);
    assert_eq!(arc_tangent(0, 0), 0);
}
