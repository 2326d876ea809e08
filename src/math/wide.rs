//! Exact wide integers for geometric predicates.
//!
//! The difference of two coordinates has 65 bits, and a cross product of differences 130. A point along a segment needs
//! the product of a difference and a cross product. With separate signs, a difference fits a `u64`, and a product of
//! two differences fits a `u128`.

#[cfg(test)]
mod tests;

use core::cmp::Ordering;

use super::formats::Fx;
use super::vec2::Vec2;

/// `2^128 high + low`. The derived order is numeric.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Wide {
    high: u128,
    low: u128,
}

impl Wide {
    const ZERO: Self = Wide { high: 0, low: 0 };

    /// The sum must fit.
    fn plus(self, other: Self) -> Self {
        let (low, carry) = self.low.overflowing_add(other.low);
        Wide { high: self.high + other.high + u128::from(carry), low }
    }

    /// The difference must not be negative.
    fn minus(self, other: Self) -> Self {
        let (low, borrow) = self.low.overflowing_sub(other.low);
        Wide { high: self.high - other.high - u128::from(borrow), low }
    }
}

/// Sign and magnitude. Zero is not negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Signed {
    negative: bool,
    magnitude: Wide,
}

impl Signed {
    pub(super) fn sign(self) -> Ordering {
        match (self.magnitude == Wide::ZERO, self.negative) {
            (true, _) => Ordering::Equal,
            (false, true) => Ordering::Less,
            (false, false) => Ordering::Greater,
        }
    }
}

/// Exact vector between two points, in units of 2^-32 m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference {
    x: Part,
    y: Part,
}

#[derive(Clone, Copy, Debug)]
struct Part {
    negative: bool,
    magnitude: u64,
}

impl Difference {
    /// `to - from`.
    pub(super) fn new(from: Vec2<Fx>, to: Vec2<Fx>) -> Self {
        let part =
            |from: Fx, to: Fx| Part { negative: to < from, magnitude: to.to_bits().abs_diff(from.to_bits()) };
        Difference { x: part(from.x, to.x), y: part(from.y, to.y) }
    }

    /// `self x other`.
    pub(super) fn cross(self, other: Self) -> Signed {
        let minus_x = Part { negative: !other.x.negative, ..other.x };
        sum_of_products(self.x, other.y, self.y, minus_x)
    }

    /// `self . other`.
    pub(super) fn dot(self, other: Self) -> Signed {
        sum_of_products(self.x, other.x, self.y, other.y)
    }

    /// `|x| + |y|`, a distance that grows along any ray from the origin.
    pub(super) fn manhattan(self) -> u128 {
        u128::from(self.x.magnitude) + u128::from(self.y.magnitude)
    }
}

/// `a x + b y`.
fn sum_of_products(a: Part, x: Part, b: Part, y: Part) -> Signed {
    let product = |p: Part, q: Part| Signed {
        negative: p.negative != q.negative,
        magnitude: Wide { high: 0, low: u128::from(p.magnitude) * u128::from(q.magnitude) },
    };
    let (first, second) = (product(a, x), product(b, y));
    let (larger, smaller) =
        if first.magnitude < second.magnitude { (second, first) } else { (first, second) };
    let magnitude = if larger.negative == smaller.negative {
        larger.magnitude.plus(smaller.magnitude)
    } else {
        larger.magnitude.minus(smaller.magnitude)
    };
    Signed { negative: larger.negative && magnitude != Wide::ZERO, magnitude }
}

/// `origin + along numerator / denominator`, rounded to nearest. Ties round towards +infinity, so that the point does
/// not depend on which end of the segment is the origin. `None` if the fraction is not between 0 and 1.
pub(super) fn point_at(
    origin: Vec2<Fx>,
    along: Difference,
    numerator: Signed,
    denominator: Signed,
) -> Option<Vec2<Fx>> {
    if denominator.magnitude == Wide::ZERO
        || numerator.magnitude > denominator.magnitude
        || (numerator.magnitude != Wide::ZERO && numerator.negative != denominator.negative)
    {
        return None;
    }
    let component = |origin: Fx, part: Part| {
        let (floor, position) = scaled(part.magnitude, numerator.magnitude, denominator.magnitude);
        let forward = match position {
            Ordering::Less => floor,
            Ordering::Equal => floor + u64::from(!part.negative),
            Ordering::Greater => floor + 1,
        };
        let bits = origin.to_bits();
        // The result is between the ends of the segment, so it is in range. The offset may have 64 bits, but the
        // wrapping operations still give the right result.
        Fx::from_bits(if part.negative {
            bits.wrapping_sub_unsigned(forward)
        } else {
            bits.wrapping_add_unsigned(forward)
        })
    };
    Some(Vec2::new(component(origin.x, along.x), component(origin.y, along.y)))
}

/// `floor(x numerator / denominator)` for a fraction of at most 1, and the remainder compared with one half.
#[expect(clippy::cast_possible_truncation, reason = "at most x")]
fn scaled(x: u64, numerator: Wide, denominator: Wide) -> (u64, Ordering) {
    // Fast path for points less than a kilometre apart.
    if numerator.high == 0
        && denominator.high == 0
        && let Some(product) = numerator.low.checked_mul(u128::from(x))
    {
        let quotient = product / denominator.low;
        let rest = product - quotient * denominator.low;
        return (quotient as u64, rest.cmp(&(denominator.low - rest)));
    }
    // Multiplies and divides bit by bit, from the top of x: `rest < denominator < 2^130`.
    let (mut quotient, mut rest) = (0_u64, Wide::ZERO);
    for bit in (0..64).rev() {
        quotient <<= 1;
        rest = rest.plus(rest);
        if x >> bit & 1 == 1 {
            rest = rest.plus(numerator);
        }
        while rest >= denominator {
            rest = rest.minus(denominator);
            quotient += 1;
        }
    }
    (quotient, rest.cmp(&denominator.minus(rest)))
}
