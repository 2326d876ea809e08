//! A symmetric positive definite matrix in an envelope, and its Cholesky factor.
//!
//! Rows are scaled so that the diagonal is 1 (`scaling.rs`). Entries of the matrix and of its factor `C` are then at
//! most 1. By the Cauchy-Schwarz inequality, partial sums of the product of two rows of `C` are at most 1, too. 32-bit
//! entries with 30 fraction bits and 64-bit sums therefore cannot overflow.
//!
//! ```text
//! A = C C^T,   Cij = (Aij - sum Cik Cjk) / Cjj,   Cii = sqrt(Aii - sum Cik^2),   k < j
//! ```
//!
//! Rows are stored from their first entry that is not 0 to the diagonal. The factor has the same envelope (A. George
//! and J. Liu, "Computer Solution of Large Sparse Positive Definite Systems", 1981, chapter 4).

use alloc::{vec, vec::Vec};

use crate::math::{round_shift, round_shift_wide, saturate, saturate_wide};

pub(super) const ONE: i64 = 1 << 30;

/// Smallest square of a diagonal entry of a factor, with 60 fraction bits: 2^-16. `EXCESS`, which the relax pass adds
/// to the diagonal, is four times as much.
const PIVOT_MIN: i64 = 1 << 44;

/// Entries below the diagonal. The diagonal is 1 and not stored.
#[derive(Clone, Debug, Default)]
pub(super) struct Matrix {
    first: Vec<usize>,
    starts: Vec<usize>,
    /// Row by row, with 30 fraction bits.
    entries: Vec<i32>,
}

impl Matrix {
    /// A matrix of zeros, given the column of the first entry of each row. Reserves no spare memory, because there may
    /// be thousands of blocks.
    pub(super) fn new(mut first: Vec<usize>) -> Self {
        let (mut starts, mut count) = (Vec::with_capacity(first.len()), 0);
        for (row, first) in first.iter_mut().enumerate() {
            *first = row.min(*first);
            starts.push(count);
            count += row - *first;
        }
        Matrix { first, starts, entries: vec![0; count] }
    }

    /// Sets an entry within the envelope.
    pub(super) fn set(&mut self, row: usize, column: usize, value: i64) {
        let at = self.starts[row] + column - self.first[row];
        self.entries[at] = saturate(value);
    }

    #[cfg(test)]
    pub(super) fn get(&self, row: usize, column: usize) -> i32 {
        if column < self.first[row] { 0 } else { self.entries[self.starts[row] + column - self.first[row]] }
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Factor {
    entries: Vec<i32>,
    /// Reciprocals of the diagonal entries, with 30 fraction bits: at most 256.
    inverses: Vec<i64>,
}

impl Factor {
    /// Factors `S A S` with a diagonal of `1 + excess`, where `S` is the diagonal matrix of `scales`, at most 1.
    pub(super) fn compute(&mut self, matrix: &Matrix, scales: &[i64], excess: i64) {
        let Matrix { first, starts, entries } = matrix;
        let Factor { entries: factor, inverses } = self;
        factor.clear();
        factor.resize(entries.len(), 0);
        inverses.clear();
        for (row, (&from, &start)) in first.iter().zip(starts).enumerate() {
            let (done, own) = factor.split_at_mut(start);
            let own = &mut own[..row - from];
            for column in from..row {
                let (from_column, start_column) = (first[column], starts[column]);
                let both = from.max(from_column);
                let upper =
                    &done[start_column + both.min(column) - from_column..start_column + column - from_column];
                let entry = i64::from(entries[start + column - from]);
                let scaled = round_shift(entry * scales[row], 30) * scales[column];
                let sum = dot(upper, &own[both.min(column) - from..column - from]);
                let rest = scaled.saturating_sub(sum);
                let quotient = round_shift_wide(i128::from(rest) * i128::from(inverses[column]), 60);
                own[column - from] = saturate(saturate_wide(quotient));
            }
            let pivot = ((ONE + excess) << 30).saturating_sub(dot(own, own));
            inverses.push(inverse_root(pivot.max(PIVOT_MIN)));
        }
    }

    /// Replaces `x`, with 32 fraction bits, by the solution of `C C^T y = x`.
    pub(super) fn solve(&self, matrix: &Matrix, x: &mut [i64]) {
        let Factor { entries, inverses } = self;
        let Matrix { first, starts, .. } = matrix;
        for row in 0..x.len() {
            let (known, rest) = x.split_at_mut(row);
            let own = &entries[starts[row]..starts[row] + row - first[row]];
            let sum: i128 =
                own.iter().zip(&known[first[row]..]).map(|(&c, &x)| i128::from(c) * i128::from(x)).sum();
            rest[0] = divided((i128::from(rest[0]) << 30) - sum, inverses[row]);
        }
        for row in (0..x.len()).rev() {
            let (others, rest) = x.split_at_mut(row);
            let value = divided(i128::from(rest[0]) << 30, inverses[row]);
            rest[0] = value;
            let own = &entries[starts[row]..starts[row] + row - first[row]];
            for (&c, other) in own.iter().zip(&mut others[first[row]..]) {
                let part = round_shift_wide(i128::from(c) * i128::from(value), 30);
                *other = other.saturating_sub(saturate_wide(part));
            }
        }
    }
}

/// The product of two rows of a factor, with 60 fraction bits. The sum may wrap if a pivot has been clamped.
fn dot(a: &[i32], b: &[i32]) -> i64 {
    a.iter().zip(b).map(|(&a, &b)| i64::from(a) * i64::from(b)).fold(0, i64::wrapping_add)
}

/// `value / 2^30` times `inverse`.
fn divided(value: i128, inverse: i64) -> i64 {
    let value = saturate_wide(round_shift_wide(value, 30));
    saturate_wide(round_shift_wide(i128::from(value) * i128::from(inverse), 30))
}

/// `1 / sqrt(x)` with 30 fraction bits, where `x` has 60 fraction bits and is between 2^-16 and 2.
fn inverse_root(x: i64) -> i64 {
    let x = x.unsigned_abs();
    // An even shift fills 62 or 63 bits, so that the root has 31 or 32 bits.
    let shift = (x.leading_zeros() - 1) & !1;
    let root = (x << shift).isqrt();
    // The root has `30 + shift / 2` fraction bits.
    let inverse = (1u64 << 62) / root;
    (inverse << (shift / 2)).cast_signed() >> 2
}
