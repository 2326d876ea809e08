//! Searches over boxes. A tree skips subtrees that are out of a search's reach, and the reach may shrink as results are
//! found. [`Search::reaches`] accepts every box within reach, and may accept a box that is a few units of the last
//! place out of reach.

use core::ops::ControlFlow;

use crate::math::{Aabb, Fx, Unit, Vec2, saturate_wide};

pub(crate) trait Search {
    /// Whether the box may contain a result.
    fn reaches(&self, aabb: Aabb) -> bool;

    /// Whether `a` should be searched before `b`. Affects the speed, not the result.
    fn prefers(&self, _a: Aabb, _b: Aabb) -> bool {
        true
    }

    fn visit(&mut self, slot: u32) -> ControlFlow<()>;
}

pub(crate) struct Overlap<F> {
    pub(crate) area: Aabb,
    pub(crate) visit: F,
}

impl<F: FnMut(u32) -> ControlFlow<()>> Search for Overlap<F> {
    fn reaches(&self, aabb: Aabb) -> bool {
        self.area.overlaps(aabb)
    }

    fn visit(&mut self, slot: u32) -> ControlFlow<()> {
        (self.visit)(slot)
    }
}

pub(crate) struct Along<F> {
    area: Aabb,
    translation: Vec2<Fx>,
    /// Fraction of the translation that is still of interest.
    fraction: Unit,
    around: Aabb,
    visit: F,
}

impl<F: FnMut(u32) -> Unit> Along<F> {
    pub(crate) fn new(area: Aabb, translation: Vec2<Fx>, visit: F) -> Self {
        let around = area_around(area, translation, Unit::ONE);
        Along { area, translation, fraction: Unit::ONE, around, visit }
    }

    /// Separating axis test perpendicular to the translation `d`: the line `t d` misses the Minkowski difference of the
    /// boxes if `d x p` has the same sign for all corners `p` of the difference.
    fn strip_meets(&self, aabb: Aabb) -> bool {
        let (lower, upper) = (coarse(self.area.lower), coarse(self.area.upper));
        let (box_lower, box_upper) = (coarse(aabb.lower), coarse(aabb.upper));
        let (dx, dy) = coarse(self.translation);
        // Rounding down has moved each corner, and the end of the translation, by less than one unit. Two units of
        // margin on each side of the difference make up for it.
        let (left, right) = (box_lower.0 - upper.0 - 2, box_upper.0 - lower.0 + 2);
        let (bottom, top) = (box_lower.1 - upper.1 - 2, box_upper.1 - lower.1 + 2);
        let (y_least, y_most) = if dx < 0 { (top, bottom) } else { (bottom, top) };
        let (x_least, x_most) = if dy < 0 { (left, right) } else { (right, left) };
        let cross = |x: i64, y: i64| i128::from(dx) * i128::from(y) - i128::from(dy) * i128::from(x);
        cross(x_least, y_least) <= 0 && cross(x_most, y_most) >= 0
    }
}

impl<F: FnMut(u32) -> Unit> Search for Along<F> {
    fn reaches(&self, aabb: Aabb) -> bool {
        self.around.overlaps(aabb) && self.strip_meets(aabb)
    }

    /// Prefers the box that is reached first on the axis of the larger displacement.
    fn prefers(&self, a: Aabb, b: Aabb) -> bool {
        let Vec2 { x, y } = self.translation;
        match (x.unsigned_abs() >= y.unsigned_abs(), x >= Fx::ZERO, y >= Fx::ZERO) {
            (true, true, _) => a.lower.x <= b.lower.x,
            (true, false, _) => a.upper.x >= b.upper.x,
            (false, _, true) => a.lower.y <= b.lower.y,
            (false, _, false) => a.upper.y >= b.upper.y,
        }
    }

    fn visit(&mut self, slot: u32) -> ControlFlow<()> {
        let fraction = (self.visit)(slot);
        if fraction <= Unit::ZERO {
            return ControlFlow::Break(());
        }
        if fraction < self.fraction {
            self.fraction = fraction;
            self.around = area_around(self.area, self.translation, fraction);
        }
        ControlFlow::Continue(())
    }
}

/// Coordinates at a quarter of the resolution, rounded down: differences fit 64 bits, and sums of products of
/// differences fit 128 bits.
fn coarse(point: Vec2<Fx>) -> (i64, i64) {
    (point.x.to_bits() >> 2, point.y.to_bits() >> 2)
}

/// The area swept up to a fraction of the translation, rounded outwards.
fn area_around(area: Aabb, translation: Vec2<Fx>, fraction: Unit) -> Aabb {
    let floor = |way: Fx| (i128::from(way.to_bits()) * i128::from(fraction.to_bits())) >> Unit::FRAC_NBITS;
    let (x, y) = (floor(translation.x), floor(translation.y));
    let vector =
        |x: i128, y: i128| Vec2::new(Fx::from_bits(saturate_wide(x)), Fx::from_bits(saturate_wide(y)));
    Aabb::new(area.lower + vector(x.min(0), y.min(0)), area.upper + vector((x + 1).max(0), (y + 1).max(0)))
}

pub(crate) struct Near<F> {
    pub(crate) point: Vec2<Fx>,
    /// Radius in metres. A negative radius reaches no box, and `Fx::MAX` every box.
    pub(crate) radius: Fx,
    pub(crate) visit: F,
}

impl<F> Near<F> {
    /// Distance of the point from a box on each axis, in units of the last place.
    fn distances(&self, aabb: Aabb) -> (u64, u64) {
        let outside = |at: Fx, lower: Fx, upper: Fx| at.to_bits().abs_diff(at.clamp(lower, upper).to_bits());
        (outside(self.point.x, aabb.lower.x, aabb.upper.x), outside(self.point.y, aabb.lower.y, aabb.upper.y))
    }
}

impl<F: FnMut(u32) -> Fx> Search for Near<F> {
    fn reaches(&self, aabb: Aabb) -> bool {
        let Ok(radius) = u64::try_from(self.radius.to_bits()) else { return false };
        let square = |x: u64| u128::from(x) * u128::from(x);
        let (x, y) = self.distances(aabb);
        // The radius `Fx::MAX` reaches every box, because larger distances saturate to it. With a smaller radius, the
        // squares are added only if both distances are below 2^63, so that the sum fits.
        self.radius == Fx::MAX || (x <= radius && y <= radius && square(x) + square(y) <= square(radius))
    }

    fn prefers(&self, a: Aabb, b: Aabb) -> bool {
        let sum = |(x, y): (u64, u64)| u128::from(x) + u128::from(y);
        sum(self.distances(a)) <= sum(self.distances(b))
    }

    fn visit(&mut self, slot: u32) -> ControlFlow<()> {
        self.radius = self.radius.min((self.visit)(slot));
        if self.radius < Fx::ZERO { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
