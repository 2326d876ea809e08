//! Axis-aligned bounding boxes.

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use super::formats::Fx;
use super::vec2::Vec2;

/// An axis-aligned bounding box in metres. The border belongs to the box.
///
/// ```
/// use lockstep2d::{fx, math::{Aabb, Vec2}};
/// let unit = Aabb::new(Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(1), fx!(1)));
/// let moved = unit.translated(Vec2::new(fx!(1), fx!(0)));
/// assert!(unit.overlaps(moved) && !unit.contains(moved));
/// assert!(unit.swept(Vec2::new(fx!(1), fx!(0))).contains(moved));
/// assert_eq!(unit.union(moved).centre(), Vec2::new(fx!(1), fx!(0.5)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Aabb {
    /// Corner with the smallest coordinates.
    pub lower: Vec2<Fx>,
    /// Corner with the largest coordinates.
    pub upper: Vec2<Fx>,
}

impl Aabb {
    /// A box that overlaps no box within the world.
    pub(crate) const NOWHERE: Self =
        Aabb { lower: Vec2::new(Fx::MAX, Fx::MAX), upper: Vec2::new(Fx::MIN, Fx::MIN) };

    /// Creates a box from its corners, without checking that it [`is_valid`](Self::is_valid).
    #[inline]
    #[must_use]
    pub const fn new(lower: Vec2<Fx>, upper: Vec2<Fx>) -> Self {
        Aabb { lower, upper }
    }

    /// Smallest box around points; `None` if there are no points.
    #[must_use]
    pub fn from_points(points: impl IntoIterator<Item = Vec2<Fx>>) -> Option<Self> {
        points.into_iter().map(|point| Aabb::new(point, point)).reduce(Self::union)
    }

    /// Whether the lower corner is at most the upper corner on both axes. Other methods require a valid box.
    #[inline]
    #[must_use]
    pub fn is_valid(self) -> bool {
        self.lower.x <= self.upper.x && self.lower.y <= self.upper.y
    }

    /// Smallest box around this one with corners at multiples of `2^shift` units of [`Fx`].
    #[inline]
    #[must_use]
    pub(crate) fn rounded_out(self, shift: u32) -> Self {
        let rest = (1i64 << shift) - 1;
        let down = |x: Fx| Fx::from_bits(x.to_bits() & !rest);
        let up = |x: Fx| Fx::from_bits(x.to_bits().saturating_add(rest) & !rest);
        let Aabb { lower, upper } = self;
        Aabb { lower: Vec2::new(down(lower.x), down(lower.y)), upper: Vec2::new(up(upper.x), up(upper.y)) }
    }

    /// Whether the boxes share a point.
    #[inline]
    #[must_use]
    pub fn overlaps(self, other: Self) -> bool {
        // `&` rather than `&&`: four comparisons are cheaper than one mispredicted branch.
        (self.lower.x <= other.upper.x)
            & (other.lower.x <= self.upper.x)
            & (self.lower.y <= other.upper.y)
            & (other.lower.y <= self.upper.y)
    }

    /// Whether the other box lies inside this one.
    #[inline]
    #[must_use]
    pub fn contains(self, other: Self) -> bool {
        (self.lower.x <= other.lower.x)
            & (self.lower.y <= other.lower.y)
            & (other.upper.x <= self.upper.x)
            & (other.upper.y <= self.upper.y)
    }

    /// Whether a point lies inside the box.
    #[inline]
    #[must_use]
    pub fn contains_point(self, point: Vec2<Fx>) -> bool {
        self.contains(Aabb::new(point, point))
    }

    /// Smallest box around both boxes.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Aabb::new(self.lower.min(other.lower), self.upper.max(other.upper))
    }

    /// Grows the box by a margin in metres on all sides, saturated. A negative margin may make the box invalid.
    #[inline]
    #[must_use]
    pub fn expanded(self, margin: Fx) -> Self {
        let margin = Vec2::new(margin, margin);
        Aabb::new(self.lower - margin, self.upper + margin)
    }

    /// [`Aabb::expanded`] without saturation, for a box and a margin whose sums do not overflow.
    #[inline]
    #[must_use]
    pub(crate) fn expanded_nearby(self, margin: Fx) -> Self {
        let margin = Vec2::new(margin, margin);
        Aabb::new(self.lower.wrapping_sub(margin), self.upper.wrapping_add(margin))
    }

    /// Moves the box by an offset in metres, saturated.
    #[inline]
    #[must_use]
    pub fn translated(self, offset: Vec2<Fx>) -> Self {
        Aabb::new(self.lower + offset, self.upper + offset)
    }

    /// The smallest box around the box before and after a displacement in metres, saturated.
    #[inline]
    #[must_use]
    pub fn swept(self, displacement: Vec2<Fx>) -> Self {
        Aabb::new(
            self.lower + displacement.min(<Vec2<Fx>>::ZERO),
            self.upper + displacement.max(<Vec2<Fx>>::ZERO),
        )
    }

    /// Centre in metres, rounded down.
    #[inline]
    #[must_use]
    pub fn centre(self) -> Vec2<Fx> {
        Vec2::new(midpoint(self.lower.x, self.upper.x), midpoint(self.lower.y, self.upper.y))
    }

    /// Half the width and height in metres, rounded up, saturated.
    #[inline]
    #[must_use]
    pub fn extents(self) -> Vec2<Fx> {
        self.upper - self.centre()
    }
}

/// `floor((a + b) / 2)` without overflow.
#[inline]
const fn midpoint(a: Fx, b: Fx) -> Fx {
    let (a, b) = (a.to_bits(), b.to_bits());
    Fx::from_bits((a & b) + ((a ^ b) >> 1))
}
