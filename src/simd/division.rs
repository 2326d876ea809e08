//! Scalar division, for the scalar backend and for vector backends that divide lane by lane.

/// `1 / d`, rounded down, where `d` and the result have 30 fraction bits. `d` is clamped to at least 1.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "d is 1 or more, so that 1 / d is at most 1"
)]
pub(super) fn reciprocal(d: i64) -> i32 {
    ((1u64 << 60) / d.max(1 << 30) as u64) as i32
}

/// [`super::Lanes::inverse`] for one lane.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "1 <= det < 2^27, and G is at most 1"
)]
#[expect(clippy::cast_possible_wrap, reason = "a reciprocal is at most 2^33")]
pub(super) fn inverse([xx, xy, yy]: [i64; 3]) -> [i32; 3] {
    const ONE: i64 = 1 << 46;
    let (k11, k22) = (ONE + xx, ONE + yy);
    // The products have 92 fraction bits. The shift leaves 30.
    let det = ((i128::from(k11) * i128::from(k22) - i128::from(xy) * i128::from(xy)) >> 62) as u64;
    // The determinant is shifted down to 32 bits, so that the products with its reciprocal fit 64 bits.
    let excess = 32u32.saturating_sub((det | 1).leading_zeros());
    let reciprocal = ((1u64 << 62) / (det >> excess).max(1 << 29)) as i64;
    let entry = |value: i64| ((((value >> (16 + excess)) * reciprocal) + (1 << 31)) >> 32) as i32;
    [entry(k22), entry(-xy), entry(k11)]
}
