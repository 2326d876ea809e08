//! Roots are compared with the neighbouring squares, and unit vectors with a long division.

use super::*;
use crate::fx;
use crate::math::{Length, Rng, Speed, Step};

fn draw(rng: &mut Rng) -> i64 {
    let shift = rng.below(64);
    i64::from_ne_bytes(rng.next_u64().to_ne_bytes()) >> shift
}

/// Whether `(root - 1/2)^2 < n < (root + 1/2)^2`.
fn is_nearest_root(root: u128, n: u128) -> bool {
    (root == 0 || root * root - root < n) && n <= root * root + root
}

fn bits(x: Fx) -> u128 {
    u128::try_from(x.to_bits()).expect("a length should not be negative")
}

const EXTREMES: [i64; 9] = [0, 1, -1, 2, 1 << 32, i64::MAX, -i64::MAX, i64::MIN, i64::MIN + 2];

#[test]
fn square_roots_are_nearest() {
    let mut rng = Rng::new(1);
    for _ in 0..20_000 {
        let x = draw(&mut rng);
        match sqrt(Fx::from_bits(x)) {
            Some(root) => assert!(is_nearest_root(bits(root), u128::from(x.unsigned_abs()) << 32), "{x}"),
            None => assert!(x < 0),
        }
    }
    assert_eq!(sqrt(fx!(2)).map(Fx::to_bits), Some(6_074_001_000));
    assert_eq!(sqrt(Fx::ZERO), Some(Fx::ZERO));
}

#[test]
fn lengths_are_nearest_or_saturated() {
    let mut rng = Rng::new(2);
    let check = |x: i64, y: i64| {
        let sum = u128::from(x.unsigned_abs()).pow(2) + u128::from(y.unsigned_abs()).pow(2);
        let length = Vec2::new(Fx::from_bits(x), Fx::from_bits(y)).length();
        let largest = bits(Fx::MAX);
        assert!(is_nearest_root(bits(length), sum) || (bits(length) == largest && sum > largest * largest));
        let from = Vec2::new(Fx::from_bits(x >> 1), Fx::from_bits(y >> 1));
        let to = Vec2::new(Fx::from_bits((x >> 1) - x), Fx::from_bits((y >> 1) - y));
        assert_eq!(from.distance(to), length, "{x} {y}");
    };
    for _ in 0..20_000 {
        check(draw(&mut rng), draw(&mut rng));
    }
    for x in EXTREMES {
        EXTREMES.into_iter().for_each(|y| check(x, y));
    }
    let corner = Vec2::new(Fx::MIN, Fx::MAX);
    assert_eq!(corner.distance(-corner), Fx::MAX);
    assert_eq!(corner.length_squared(), Fx::MAX);
}

/// `|part| / sqrt(sum)` in units of 2^-63, by long division.
fn slow_component(part: u64, sum: u128) -> u128 {
    let square = u128::from(part).pow(2);
    if square == sum {
        return 1 << 63;
    }
    let (mut rest, mut quotient) = (square, 0_u128);
    for _ in 0..126 {
        rest *= 2;
        quotient *= 2;
        if rest >= sum {
            rest -= sum;
            quotient += 1;
        }
    }
    quotient.isqrt()
}

/// The larger of the two components' errors, in thousandths of 2^-30.
fn unit_error(x: i64, y: i64, unit: Vec2<Unit>) -> u128 {
    let sum = u128::from(x.unsigned_abs()).pow(2) + u128::from(y.unsigned_abs()).pow(2);
    let error = |part: i64, result: Unit| {
        assert!(result.to_bits() == 0 || (result < 0) == (part < 0), "the sign should be that of {part}");
        (u128::from(result.to_bits().unsigned_abs()) << 33).abs_diff(slow_component(part.unsigned_abs(), sum))
    };
    (error(x, unit.x).max(error(y, unit.y)) * 1000) >> 33
}

#[test]
fn unit_vectors_are_within_076_units() {
    let mut rng = Rng::new(3);
    let mut largest = 0;
    let mut check = |x: i64, y: i64| {
        let unit = Vec2::new(Fx::from_bits(x), Fx::from_bits(y)).normalized().expect("not zero");
        largest = largest.max(unit_error(x, y, unit));
        if let (Ok(x32), Ok(y32)) = (i32::try_from(x), i32::try_from(y)) {
            let narrow = Vec2::new(Length::from_bits(x32), Length::from_bits(y32));
            assert_eq!(narrow.normalized(), Some(unit), "the narrow path should agree at ({x}, {y})");
        }
    };
    for _ in 0..50_000 {
        let (x, y) = (draw(&mut rng), draw(&mut rng));
        if (x, y) != (0, 0) {
            check(x, y);
            check(x >> 32 | 1, y >> 32);
        }
    }
    for x in EXTREMES.into_iter().chain([i32::MIN.into(), i32::MAX.into()]) {
        check(x | 1, 0);
        check(x, 1);
        check(x, i64::MIN);
        check(x.max(-i64::MAX) / 2, x.max(-i64::MAX) / 2 + 1);
    }
    assert!(
        (500..=760).contains(&largest),
        "the largest error should be 500 to 760 thousandths, not {largest}"
    );
}

#[test]
fn the_inverse_root_is_within_its_bound() {
    let mut rng = Rng::new(4);
    let edges = [1 << 62, (1 << 62) + 1, (1 << 63) - 1, 1 << 63, u64::MAX];
    for n in edges.into_iter().chain((0..50_000).map(|_| rng.next_u64() | 1 << 62)) {
        // y = 2^63 / sqrt(n) means y^2 n = 2^126. All y are multiplied by 100, so that the tolerance of 0.51 is an
        // integer.
        let y = u128::from(inverse_root(n)) * 100;
        let squared = |y: u128| (y * y) >> 6;
        // Both sides are about 2^139. Without their last 22 bits (6 of the square and 16 of n), they fit 128 bits.
        let target = 10_000_u128 << 104;
        let n = u128::from(n >> 16);
        assert!(squared(y - 51) * n < target && target < squared(y + 51) * n, "{n}");
    }
}

#[test]
fn the_root_from_the_inverse_is_nearest_where_rounding_turns() {
    let mut rng = Rng::new(6);
    for _ in 0..50_000 {
        let root = (rng.next_u64() >> (33 + rng.below(31))).max(1);
        // The root of root^2 + root rounds down to `root`, and the root of the next integer rounds up.
        for n in [root * root, root * root + root, root * root + root + 1] {
            let shift = n.leading_zeros() & !1;
            let found = root_from_inverse(n, shift, inverse_root(n << shift));
            assert_eq!(found, sqrt_rounded(n), "{n}");
            assert!(is_nearest_root(found.into(), n.into()), "{n}");
        }
    }
}

#[test]
fn vectors_along_the_axes_are_exact() {
    for bits in EXTREMES.into_iter().filter(|&bits| bits != 0) {
        let v = Vec2::new(Fx::from_bits(bits), Fx::ZERO);
        let sign = if bits < 0 { -Unit::ONE } else { Unit::ONE };
        assert_eq!(v.normalized_with_length(), Some((Vec2::new(sign, Unit::ZERO), v.length())));
        assert_eq!(v.perp().normalized(), Some(Vec2::new(Unit::ZERO, sign)));
    }
    assert_eq!(Vec2::<Fx>::ZERO.normalized(), None);
    assert_eq!(Vec2::<Fx>::ZERO.normalized_with_length(), None);
    assert_eq!(Vec2::<Step>::ZERO.normalized(), None);
}

#[test]
fn narrow_lengths_are_nearest_or_saturated() {
    let mut rng = Rng::new(5);
    let check = |x: i32, y: i32| {
        let v = Vec2::new(Speed::from_bits(x), Speed::from_bits(y));
        let sum = u128::from(x.unsigned_abs()).pow(2) + u128::from(y.unsigned_abs()).pow(2);
        let length = u128::try_from(v.length().to_bits()).expect("a length should not be negative");
        assert!(is_nearest_root(length, sum) || (v.length() == Speed::MAX && sum > length * length), "{v:?}");
        assert_eq!(
            v.normalized_with_length().map(|(_, length)| length),
            (sum > 0).then(|| v.length()),
            "{v:?}"
        );
    };
    for _ in 0..20_000 {
        let mut part = || {
            let shift = rng.below(32);
            i32::from_ne_bytes(rng.next_u32().to_ne_bytes()) >> shift
        };
        check(part(), part());
    }
    let extremes = [0, 1, -1, i32::MAX, i32::MIN];
    extremes.into_iter().for_each(|x| extremes.into_iter().for_each(|y| check(x, y)));
}

#[test]
fn the_wide_root_is_that_of_the_standard_library() {
    let mut rng = Rng::new(4);
    let mut wide = || u128::from(rng.next_u64()) << 64 | u128::from(rng.next_u64());
    let random = (0..400_000).map(|i| (wide() >> 1) >> (i % 127));
    let squares = (0..63).flat_map(|bit| {
        let edge = 1u128 << bit;
        [edge, edge + 1, edge * 3 / 2, edge * 2 - 1].map(|root| root * root)
    });
    let near = squares.flat_map(|square| [square.saturating_sub(1), square, square + 1]);
    let small = 0..5000;
    for n in small.chain(near).chain(random).chain([1 << 127, (1 << 127) - 1]) {
        assert_eq!(root_wide(n), n.isqrt(), "{n}");
    }
}

#[test]
fn what_is_longer_than_a_limit_has_a_greater_length() {
    let mut rng = Rng::new(12);
    let mut undecided = 0;
    for _ in 0..20_000 {
        let v = Vec2::new(rng.range(fx!(-3), fx!(3)), rng.range(fx!(-3), fx!(3)));
        for limit in [v.length(), v.length() - Fx::DELTA, v.length() + Fx::DELTA, rng.range(fx!(-1), fx!(5))]
        {
            assert_eq!(v.is_longer_than(limit), v.length() > limit, "{v:?} {limit}");
            undecided += u32::from(v.x.abs().max(v.y.abs()) <= limit && v.x.abs() + v.y.abs() > limit);
        }
    }
    assert!(undecided > 20_000, "expected over 20000 cases that need a root, got {undecided}");
    for v in [Vec2::ZERO, Vec2::new(Fx::MIN, Fx::MIN), Vec2::new(Fx::MAX, fx!(0))] {
        for limit in [Fx::MIN, -Fx::DELTA, fx!(0), Fx::MAX - Fx::DELTA, Fx::MAX] {
            assert_eq!(v.is_longer_than(limit), v.length() > limit, "{v:?} {limit}");
        }
    }
}
