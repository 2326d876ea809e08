//! Scales rows and point blocks so that the diagonal blocks of the matrix are identities.
//!
//! With the Jacobian `J` of a row or point and the mass fractions `a`, `K = sum a J J^T` relates an impulse (times the
//! sum of the inverse masses) to the change of velocity. With a lower triangular `R` and `K = R R^T`:
//!
//! ```text
//! H = R^-1 sqrt(a) J,    sum H H^T = 1,    A = H H'^T + ...   for each body that two rows share
//! ```
//!
//! Entries of `H` are at most 1. Impulses, which are stored as speeds, are scaled by `R^-1` and scaled back by `R`.
//!
//! A spring between two points is isotropic (`point_block.rs`): it yields by `impulseScale p`, not by
//! `impulseScale K p`. Its softness is therefore part of its scale `R`, and its `S` in the equations of
//! `mod.rs` is 1. With a lower triangular `T`:
//!
//! ```text
//! impulseScale I + massScale K = T T^T,   H = sqrt(massScale a) T^-1 J,   R = sqrt(massScale) T
//! ```

use crate::math::{Ratio, Unit, Vec2, round_shift_wide, saturate, saturate_wide};

use super::matrix::ONE;
use super::mobility::Mobility;

/// The scaled Jacobian for each body, along x, along y and about the centre of mass, with 30 fraction bits.
pub(super) type ScaledRow = [[i32; 3]; 2];

/// The entries `11`, `21` and `22` of `R` and `R^-1`, with 30 fraction bits. A row has only the entry `11`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Scaling {
    root: [i64; 3],
    inverse: [i64; 3],
}

/// Signs of the velocities of A and B in the relative velocity, that of B minus that of A.
const SIGNS: [i64; 2] = [-1, 1];

impl Scaling {
    pub(super) fn of_point(e: [Vec2<Ratio>; 2], mobility: &Mobility) -> (Self, [ScaledRow; 2]) {
        Self::of_point_with(ONE, e, mobility, mobility.roots)
    }

    pub(super) fn of_spring(
        mass_scale: Unit,
        e: [Vec2<Ratio>; 2],
        mobility: &Mobility,
    ) -> (Self, [ScaledRow; 2]) {
        let mass_scale = i64::from(mass_scale.to_bits());
        let (factor, inverse_factor) = root_and_inverse(mass_scale);
        let roots = mobility.roots.map(|root| product(root, factor));
        let (Scaling { root, inverse }, rows) = Self::of_point_with(mass_scale, e, mobility, roots);
        let root = root.map(|entry| product(entry, factor));
        (Scaling { root, inverse: inverse.map(|entry| product(entry, inverse_factor)) }, rows)
    }

    fn of_point_with(
        mass_scale: i64,
        e: [Vec2<Ratio>; 2],
        mobility: &Mobility,
        roots: [i64; 2],
    ) -> (Self, [ScaledRow; 2]) {
        let &Mobility { fractions, spin_roots, .. } = mobility;
        let moving = i64::from(fractions.a.to_bits()) + i64::from(fractions.b.to_bits());
        let diagonal = ONE - mass_scale + product(moving, mass_scale);
        let (e_x, e_y) = (e.map(|e| e.x), e.map(|e| e.y));
        let sum = |i: [Ratio; 2], j: [Ratio; 2]| product(mobility.turning(i, j), mass_scale);
        let (xx, xy, yy) = (diagonal + sum(e_x, e_x), sum(e_x, e_y), diagonal + sum(e_y, e_y));
        let (root_11, inverse_11) = root_and_inverse(xx);
        let root_21 = product(xy, inverse_11);
        let (root_22, inverse_22) = root_and_inverse(yy - product(root_21, root_21));
        let inverse_21 = -product(product(root_21, inverse_11), inverse_22);
        let scaled = |x: i64, y: i64| -> ScaledRow {
            [0, 1].map(|side: usize| {
                let (sign, e) = (SIGNS[side], e[side]);
                let turn =
                    i128::from(x) * i128::from(e.x.to_bits()) + i128::from(y) * i128::from(e.y.to_bits());
                let turn = product(saturate_wide(round_shift_wide(turn, 24)), spin_roots[side]);
                [x, y, turn].map(|part| saturate(sign * product(part, roots[side])))
            })
        };
        let scaling =
            Scaling { root: [root_11, root_21, root_22], inverse: [inverse_11, inverse_21, inverse_22] };
        (scaling, [scaled(inverse_11, 0), scaled(inverse_21, inverse_22)])
    }

    /// Scales a row with the directions `n`, the lever ratios `e` and the denominator `D`.
    pub(super) fn of_row(
        n: [Vec2<Unit>; 2],
        e: [Ratio; 2],
        denominator: i64,
        mobility: &Mobility,
    ) -> (Self, ScaledRow) {
        let (root, inverse) = root_and_inverse(denominator);
        let row = [0, 1].map(|side: usize| {
            let [x, y] = [n[side].x, n[side].y].map(|part| i64::from(part.to_bits()));
            let turn = product(i64::from(e[side].to_bits()) << 6, mobility.spin_roots[side]);
            [x, y, turn]
                .map(|part| saturate(SIGNS[side] * product(product(part, inverse), mobility.roots[side])))
        });
        (Scaling { root: [root, 0, 0], inverse: [inverse, 0, 0] }, row)
    }

    /// `R^-1 d`.
    pub(super) fn scale(&self, d: [i64; 2]) -> [i64; 2] {
        apply(self.inverse, d)
    }

    /// `R d`.
    pub(super) fn restore(&self, d: [i64; 2]) -> [i64; 2] {
        apply(self.root, d)
    }

    /// `R^-T R^-1 d`.
    pub(super) fn divide(&self, d: [i64; 2]) -> [i64; 2] {
        apply_transposed(self.inverse, apply(self.inverse, d))
    }

    /// `R R^T d`.
    pub(super) fn multiply(&self, d: [i64; 2]) -> [i64; 2] {
        apply(self.root, apply_transposed(self.root, d))
    }
}

/// A lower triangular matrix times a vector.
fn apply(triangle: [i64; 3], d: [i64; 2]) -> [i64; 2] {
    let [t_11, t_21, t_22] = triangle.map(i128::from);
    let [x, y] = d.map(i128::from);
    [t_11 * x, t_21 * x + t_22 * y].map(|wide| saturate_wide(round_shift_wide(wide, 30)))
}

/// The transpose of a lower triangular matrix times a vector.
fn apply_transposed(triangle: [i64; 3], d: [i64; 2]) -> [i64; 2] {
    let [t_11, t_21, t_22] = triangle.map(i128::from);
    let [x, y] = d.map(i128::from);
    [t_11 * x + t_21 * y, t_22 * y].map(|wide| saturate_wide(round_shift_wide(wide, 30)))
}

/// The product of two numbers. One of them has 30 fraction bits, and the product has the format of the other.
pub(super) fn product(a: i64, b: i64) -> i64 {
    saturate_wide(round_shift_wide(i128::from(a) * i128::from(b), 30))
}

pub(super) fn length(v: [i64; 2]) -> i128 {
    let [x, y] = v.map(|part| u128::from(part.unsigned_abs()).pow(2));
    (x + y).isqrt().cast_signed()
}

/// `sqrt(x)` and `1 / sqrt(x)`. All numbers have 30 fraction bits, and an `x` below 2^-24 is replaced by 2^-24.
pub(super) fn root_and_inverse(x: i64) -> (i64, i64) {
    let x = x.max(1 << 6).unsigned_abs();
    // An even shift fills 63 or 64 bits, so that the root has 32 bits.
    let shift = x.leading_zeros() & !1;
    let root = (x << shift).isqrt();
    // The root has `15 + shift / 2` fraction bits.
    let (inverse, half) = (u64::MAX / root, shift / 2);
    let inverse = if half >= 19 { inverse << (half - 19) } else { inverse >> (19 - half) };
    let root = if half >= 15 { root >> (half - 15) } else { root << (15 - half) };
    (root.cast_signed(), inverse.cast_signed())
}
