//! Computes the rows of a batch of contacts.
//!
//! ```text
//! c = r x n,   e = c / k,   D = aA (1 + eA^2) + aB (1 + eB^2),   g = a / D,   f = g e
//! friction ratio = mu Dt / Dn,   L = p D
//! ```

#[cfg(test)]
mod tests;

use super::super::body_list::lever_ratio;
use super::super::limits::IMPULSE_MAX;
use super::super::pair::{RATIO, UNIT, clamp, shift};
use super::super::row::RATIO_MAX;
use super::TANGENT_MAX;
use super::batch::{Batch, Row};
use super::input::{Input, columns};
use crate::math::{FrictionRatio, Fx, Length, Ratio, narrow, round_shift_wide, saturate, saturate_wide};
use crate::simd::{Ints, Lanes};

/// Shift from the format of a unit vector to the format of a lever ratio.
const UNIT_TO_RATIO: i32 = UNIT - RATIO;

#[derive(Clone, Copy)]
struct ContactSide<L: Lanes<N>, const N: usize> {
    fraction: L::Int,
    to_origin: [L::Int; 2],
    mantissa: L::Int,
    /// Shift from a product with the mantissa of `1 / k` to the format of a lever ratio.
    shift: L::Int,
}

#[derive(Clone, Debug)]
pub(super) struct Denominators<const N: usize> {
    pub(super) normals: [Denominator<N>; 2],
    pub(super) tangent: Denominator<N>,
}

/// `D` of a row, and its reciprocal.
#[derive(Clone, Debug)]
pub(super) struct Denominator<const N: usize> {
    pub(super) inverse: Ints<N>,
    whole: Ints<N>,
    part: Ints<N>,
}

impl<const N: usize> Denominators<N> {
    pub(super) const NONE: Self =
        Denominators { normals: [Denominator::NONE; 2], tangent: Denominator::NONE };
}

impl<const N: usize> Denominator<N> {
    const NONE: Self = Denominator { inverse: Ints::ZERO, whole: Ints::ZERO, part: Ints::ZERO };

    /// The impulse `p = L / D` of an accumulated `L`.
    #[inline(always)]
    pub(super) fn impulse<L: Lanes<N>>(&self, lambda: L::Int) -> L::Int {
        L::narrow::<UNIT>(L::mul(L::load(&self.inverse), lambda))
    }

    /// `L = p D`, for an initial guess along the normal.
    #[inline(always)]
    pub(super) fn normal_lambda<L: Lanes<N>>(&self, impulse: L::Int) -> L::Int {
        let lambda = product::<L, N>(impulse, &self.long::<L>());
        L::min(L::max(lambda, L::splat(0)), L::splat(IMPULSE_MAX.to_bits()))
    }

    /// `L = p D`, for an initial guess along the tangent.
    #[inline(always)]
    pub(super) fn tangent_lambda<L: Lanes<N>>(&self, impulse: L::Int) -> L::Int {
        let lambda = product::<L, N>(impulse, &self.long::<L>());
        clamp::<L, N>(lambda, L::splat(TANGENT_MAX.to_bits()))
    }

    #[inline(always)]
    fn long<L: Lanes<N>>(&self) -> Long<L, N> {
        Long { whole: L::load(&self.whole), part: L::load(&self.part) }
    }
}

#[inline(always)]
pub(super) fn fill<L: Lanes<N>, const N: usize>(
    inputs: &[Input; N],
    batch: &mut Batch<N>,
    denominators: &mut Denominators<N>,
) {
    let one = L::splat(1);
    let [x, y, fraction_a, fraction_b] = columns::<L, N>(inputs, |input| &input.shares);
    let n = [L::narrow::<UNIT_TO_RATIO>(L::mul(x, one)), L::narrow::<UNIT_TO_RATIO>(L::mul(y, one))];
    let t = [L::sub(L::splat(0), n[1]), n[0]];
    let [mantissa_a, mantissa_b, shift_a, shift_b] = columns::<L, N>(inputs, |input| &input.gyrations);
    let [ax, ay, bx, by] = columns::<L, N>(inputs, |input| &input.to_origin);
    let [x0, y0, x1, y1] = columns::<L, N>(inputs, |input| &input.anchors);
    let (first, mut second) = ([x0, y0], [x1, y1]);
    let ends = [
        ContactSide::<L, N>::new(fraction_a, [ax, ay], mantissa_a, shift_a),
        ContactSide::<L, N>::new(fraction_b, [bx, by], mantissa_b, shift_b),
    ];
    let [normal_0, normal_1, carried, counts] = columns::<L, N>(inputs, |input| &input.carried);
    let [separation_0, separation_1, friction, gap] = columns::<L, N>(inputs, |input| &input.rest);
    let both = L::greater(counts, one);
    L::store(L::to_int(both), &mut batch.both);
    for (second, first) in second.iter_mut().zip(first) {
        *second = L::select(both, *second, first);
    }
    L::store(n[0], &mut batch.n_x);
    L::store(n[1], &mut batch.n_y);
    let stiff = L::either(L::greater(one, fraction_a), L::greater(one, fraction_b));
    L::store(L::to_int(stiff), &mut batch.immovable);
    let middle = match batch.count {
        2 => [half_way::<L, N>(first[0], second[0]), half_way::<L, N>(first[1], second[1])],
        _ => first,
    };
    // While there is a gap, friction acts on each body at its own surface.
    let half = L::narrow::<1>(L::mul(gap, one));
    let lift_x = L::narrow::<RATIO>(L::mul(n[0], half));
    let lift_y = L::narrow::<RATIO>(L::mul(n[1], half));
    let surface_a = [L::sub(middle[0], lift_x), L::sub(middle[1], lift_y)];
    let surface_b = [L::add(middle[0], lift_x), L::add(middle[1], lift_y)];
    let Denominators { normals, tangent: denominator } = denominators;
    fill_row::<L, N>(&mut batch.tangent, t, &ends, [surface_a, surface_b], denominator);
    let tangent = denominator.long::<L>();
    // Clamping an initial guess is no fault.
    L::store(denominator.tangent_lambda::<L>(carried), &mut batch.tangent_lambda);
    let points = batch.points.iter_mut().zip(normals).take(batch.count);
    for ((point, denominator), (anchor, carried)) in points.zip([(first, normal_0), (second, normal_1)]) {
        fill_row::<L, N>(&mut point.normal, n, &ends, [anchor; 2], denominator);
        let ratio = ratio::<L, N>(&tangent, L::load(&denominator.inverse));
        L::store(product::<L, N>(friction, &ratio), &mut point.friction_ratio);
        L::store(denominator.normal_lambda::<L>(carried), &mut point.normal_lambda);
    }
    batch.separate::<L>([separation_0, separation_1]);
}

#[inline(always)]
fn half_way<L: Lanes<N>, const N: usize>(a: L::Int, b: L::Int) -> L::Int {
    let one = L::splat(1);
    L::narrow::<1>(L::add_wide(L::mul(a, one), L::mul(b, one)))
}

impl<L: Lanes<N>, const N: usize> ContactSide<L, N> {
    /// `mantissa` and `exponent` represent `1 / k`.
    #[inline(always)]
    fn new(fraction: L::Int, to_origin: [L::Int; 2], mantissa: L::Int, exponent: L::Int) -> Self {
        const DIFFERENCE: i32 = shift(Ratio::FRAC_NBITS - Length::FRAC_NBITS);
        // The difference would be below 1 only for a body that does not turn, whose mantissa is 0.
        let shift = L::max(L::sub(exponent, L::splat(DIFFERENCE)), L::splat(1));
        ContactSide { fraction, to_origin, mantissa, shift }
    }

    /// The lever ratios of impulses along `n` at the anchors.
    #[inline(always)]
    fn lever_ratio(&self, anchor: [L::Int; 2], n: [L::Int; 2]) -> L::Int {
        let x = L::add_saturating(anchor[0], self.to_origin[0]);
        let y = L::add_saturating(anchor[1], self.to_origin[1]);
        let cross = L::sub_wide(L::mul(x, n[1]), L::mul(y, n[0]));
        let (c, out) = L::narrow_saturating::<RATIO>(cross);
        if L::any(out) {
            return self.long_lever_ratio([x, y], n);
        }
        clamp::<L, N>(L::narrow_by(L::mul(c, self.mantissa), self.shift), L::splat(RATIO_MAX.to_bits()))
    }

    /// [`Self::lever_ratio`] for arms of more than 512 m.
    #[cold]
    fn long_lever_ratio(&self, arm: [L::Int; 2], n: [L::Int; 2]) -> L::Int {
        let numbers = [arm[0], arm[1], n[0], n[1], self.mantissa, self.shift].map(|number| {
            let mut ints = Ints::ZERO;
            L::store(number, &mut ints);
            ints.0
        });
        let [x, y, n_x, n_y, mantissa, shift] = numbers;
        L::load(&Ints(core::array::from_fn(|i| {
            lever_ratio([x[i], y[i]], [n_x[i], n_y[i]], mantissa[i], shift[i]).to_bits()
        })))
    }
}

/// Computes a row and its denominator, given the points at which its impulses act on A and on B.
#[inline(always)]
fn fill_row<L: Lanes<N>, const N: usize>(
    row: &mut Row<N>,
    n: [L::Int; 2],
    ends: &[ContactSide<L, N>; 2],
    anchors: [[L::Int; 2]; 2],
    denominator: &mut Denominator<N>,
) {
    let [e_a, e_b] = [ends[0].lever_ratio(anchors[0], n), ends[1].lever_ratio(anchors[1], n)];
    L::store(e_a, &mut row.e_a);
    L::store(e_b, &mut row.e_b);
    let fractions = [ends[0].fraction, ends[1].fraction];
    // Ratios and their products with a fraction have 24 fraction bits, and their squares have 48.
    let ae = L::narrow::<UNIT>(L::mul(fractions[0], e_a));
    let be = L::narrow::<UNIT>(L::mul(fractions[1], e_b));
    let squares = L::add_wide(L::mul(ae, e_a), L::mul(be, e_b));
    let ones = L::mul(L::add(fractions[0], fractions[1]), L::splat(1 << 18));
    let denominators = L::shift_down::<18>(L::add_wide(squares, ones));
    let inverse = L::reciprocal(denominators);
    L::store(inverse, &mut denominator.inverse);
    let Long { whole, part } = Long::<L, N>::of(denominators);
    L::store(whole, &mut denominator.whole);
    L::store(part, &mut denominator.part);
    for (gains, fraction, e) in [(&mut row.a, fractions[0], e_a), (&mut row.b, fractions[1], e_b)] {
        let g = L::narrow::<UNIT>(L::mul(fraction, inverse));
        L::store(L::narrow::<RATIO>(L::mul(g, n[0])), &mut gains[0]);
        L::store(L::narrow::<RATIO>(L::mul(g, n[1])), &mut gains[1]);
        L::store(L::narrow::<RATIO>(L::mul(g, e)), &mut gains[2]);
    }
}

/// Numbers from 0 to 2^15 with 30 fraction bits, in two parts, because they do not fit a lane.
#[derive(Clone, Copy)]
struct Long<L: Lanes<N>, const N: usize> {
    whole: L::Int,
    /// The fractional part, with 30 bits.
    part: L::Int,
}

impl<L: Lanes<N>, const N: usize> Long<L, N> {
    #[inline(always)]
    fn of(numbers: L::Wide) -> Self {
        let whole = L::low(L::shift_down::<30>(numbers));
        let part = L::low(L::sub_wide(numbers, L::mul(whole, L::splat(1 << 30))));
        Long { whole, part }
    }
}

/// `x D`, rounded and saturated.
#[inline(always)]
fn product<L: Lanes<N>, const N: usize>(x: L::Int, long: &Long<L, N>) -> L::Int {
    let Long { whole, part } = *long;
    // The product with the whole part is exact. Both products have the sign of x, so that the sum saturates if one
    // product does.
    let (whole, _) = L::narrow_saturating::<1>(L::mul(x, L::add(whole, whole)));
    L::add_saturating(whole, L::narrow::<30>(L::mul(x, part)))
}

#[inline(always)]
fn ratio<L: Lanes<N>, const N: usize>(tangent: &Long<L, N>, normal_inverse: L::Int) -> Long<L, N> {
    let part = L::narrow::<30>(L::mul(normal_inverse, tangent.part));
    Long::of(L::add_wide(L::mul(normal_inverse, tangent.whole), L::mul(part, L::splat(1))))
}

/// `mu r`, saturated, where `r = Dt / Dn` has 30 fraction bits.
pub(super) fn friction_ratio(friction: Fx, ratio: i64) -> FrictionRatio {
    let friction = i128::from(narrow::<fixed::types::extra::U20>(friction).to_bits());
    FrictionRatio::from_bits(saturate(saturate_wide(round_shift_wide(friction * i128::from(ratio), 30))))
}
