//! Support shape for queries: a convex *core* of 1 to 8 points, widened by a radius.
//!
//! Points are on a grid of 2^-28 m (3.7 nm), so that sums of two products of differences are exact in 128 bits anywhere
//! in the world: coordinates are at most 2^60 units, differences of differences at most 2^62 units, and a sum of two
//! products of such differences is at most 2^125.

#[cfg(test)]
mod tests;

use fixed::FixedI64;
use fixed::types::extra::U28;

use super::posed::{Outline, PosedShape};
use crate::body::POLYGON_VERTICES_MAX;
use crate::collision::shape::link::Link;
use crate::fx;
use crate::math::{Fx, Rot, Unit, Vec2, div_round, round_shift, round_shift_wide, saturate_wide};

/// A coordinate or length on the grid, in metres.
pub(crate) type Grid = FixedI64<U28>;

/// Upper limit of the radius in metres, larger than that of any shape. With this limit, products of a radius and a
/// length in `query/ray.rs` fit 128 bits.
pub(crate) const RADIUS_MAX: Fx = fx!(512);

/// Fraction bits of a world coordinate beyond those of the grid.
const FINER: u32 = Fx::FRAC_NBITS - Grid::FRAC_NBITS;

/// All points within `radius` of the convex hull of up to 8 points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SupportShape {
    count: usize,
    points: [Vec2<Grid>; POLYGON_VERTICES_MAX],
    pub(crate) radius: Grid,
}

impl SupportShape {
    /// Support shape in world axes, relative to `origin`. All support shapes of a query have the same origin.
    pub(crate) fn of(shape: &PosedShape, origin: Vec2<Fx>) -> Self {
        let place = |offset| place(shape.centre, offset, origin);
        match &shape.outline {
            Outline::Circle { radius } => {
                SupportShape::from_grid_points([place(Vec2::ZERO)], (*radius).into())
            }
            Outline::Segment { a, b } | Outline::Link(Link { a, b, .. }) => {
                SupportShape::from_grid_points([place(*a), place(*b)], Fx::ZERO)
            }
            Outline::Polygon(hull) => {
                let vertices = hull.vertices().iter().map(|vertex| place(vertex.widen()));
                SupportShape::from_grid_points(vertices, hull.radius.into())
            }
        }
    }

    pub(crate) fn point(at: Vec2<Fx>) -> Self {
        SupportShape::disc(at, Fx::ZERO)
    }

    pub(crate) fn disc(centre: Vec2<Fx>, radius: Fx) -> Self {
        SupportShape::from_points([centre], radius)
    }

    /// Creates a support shape from 1 to 8 vertices, counter-clockwise. Clamps the radius to 0 to [`RADIUS_MAX`].
    pub(crate) fn from_points(points: impl IntoIterator<Item = Vec2<Fx>>, radius: Fx) -> Self {
        SupportShape::from_grid_points(points.into_iter().map(to_grid), radius)
    }

    fn from_grid_points(points: impl IntoIterator<Item = Vec2<Grid>>, radius: Fx) -> Self {
        let radius = Grid::from_bits(round_shift(radius.clamp(Fx::ZERO, RADIUS_MAX).to_bits(), FINER));
        let mut support = SupportShape { count: 0, points: [Vec2::ZERO; POLYGON_VERTICES_MAX], radius };
        for (slot, point) in support.points.iter_mut().zip(points) {
            *slot = point;
            support.count += 1;
        }
        support
    }

    pub(crate) fn points(&self) -> &[Vec2<Grid>] {
        &self.points[..self.count]
    }

    pub(crate) fn moved(&self, by: Vec2<Grid>) -> Self {
        self.mapped(|point| point + by)
    }

    /// Rotates about the origin.
    pub(crate) fn rotated(&self, rotation: Rot) -> Self {
        self.mapped(|point| from_raw(rotation.apply_wide(raw(point))))
    }

    fn mapped(mut self, map: impl Fn(Vec2<Grid>) -> Vec2<Grid>) -> Self {
        for point in &mut self.points[..self.count] {
            *point = map(*point);
        }
        self
    }

    /// Largest distance of a point of the core from the origin.
    pub(crate) fn reach(&self) -> Grid {
        // The exact squares suffice to find the longest vector, and only its length is rounded.
        let furthest = self.points().iter().max_by_key(|&&point| dot(point, point));
        furthest.map_or(Grid::ZERO, |&point| length(point))
    }

    /// Largest distance of a point of the shape from the origin, in metres.
    pub(crate) fn reach_with_radius(&self) -> Fx {
        to_fx(self.reach().saturating_add(self.radius))
    }

    /// Mean of the vertices.
    pub(crate) fn middle(&self) -> Vec2<Fx> {
        from_grid(self.mean())
    }

    fn mean(&self) -> Vec2<Grid> {
        let points = self.points();
        let count = i64::try_from(points.len()).unwrap_or(1);
        // Divides before summing, because the sum of 8 coordinates may exceed the grid's range.
        points.iter().fold(Vec2::ZERO, |sum, &point| sum + Vec2::new(point.x / count, point.y / count))
    }

    /// Extent of the shape along a direction in metres.
    pub(crate) fn extent(&self, direction: Vec2<Unit>) -> Fx {
        let along = self.points().iter().map(|&point| along(direction, point));
        let (least, most) = along.fold((Grid::MAX, Grid::MIN), |(a, b), x| (a.min(x), b.max(x)));
        to_fx(most.saturating_sub(least).saturating_add(self.radius + self.radius))
    }

    /// Radius in metres of a disc inside the shape, about the mean of the vertices. 0 for a segment.
    pub(crate) fn inner_radius(&self) -> Fx {
        let points = self.points();
        let mean = self.mean();
        let inside = |(p, q): (Vec2<Grid>, Vec2<Grid>)| {
            let edge = q - p;
            Some(height(cross(edge, mean - p), scaled_along(direction(edge)?, edge)))
        };
        let inside = edges(points).filter_map(inside).min().unwrap_or(Grid::ZERO);
        to_fx(self.radius + inside.max(Grid::ZERO))
    }
}

/// Edges of a core, counter-clockwise. Two points have one edge in each direction.
pub(in crate::collision) fn edges(points: &[Vec2<Grid>]) -> impl Iterator<Item = (Vec2<Grid>, Vec2<Grid>)> {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).filter(|_| points.len() > 1).map(|(&p, &q)| (p, q))
}

/// `centre + offset - origin`, rounded to nearest on the grid. Intermediate sums do not saturate.
fn place(centre: Vec2<Fx>, offset: Vec2<Fx>, origin: Vec2<Fx>) -> Vec2<Grid> {
    let component = |centre: Fx, offset: Fx, origin: Fx| {
        let sum = i128::from(centre.to_bits()) + i128::from(offset.to_bits()) - i128::from(origin.to_bits());
        Grid::from_bits(saturate_wide(round_shift_wide(sum, FINER)))
    };
    Vec2::new(component(centre.x, offset.x, origin.x), component(centre.y, offset.y, origin.y))
}

/// Converts to the grid, rounded to nearest.
pub(crate) fn to_grid(v: Vec2<Fx>) -> Vec2<Grid> {
    let component = |x: Fx| Grid::from_bits(round_shift(x.to_bits(), FINER));
    Vec2::new(component(v.x), component(v.y))
}

/// Converts from the grid: exact, saturated.
pub(crate) fn from_grid(v: Vec2<Grid>) -> Vec2<Fx> {
    Vec2::new(to_fx(v.x), to_fx(v.y))
}

/// Converts from the grid: exact, saturated.
pub(crate) fn to_fx(x: Grid) -> Fx {
    Fx::from_bits(saturate_wide(i128::from(x.to_bits()) << FINER))
}

/// Reinterprets the bits, for operations that do not depend on the unit.
fn raw(v: Vec2<Grid>) -> Vec2<Fx> {
    Vec2::new(Fx::from_bits(v.x.to_bits()), Fx::from_bits(v.y.to_bits()))
}

fn from_raw(v: Vec2<Fx>) -> Vec2<Grid> {
    Vec2::new(Grid::from_bits(v.x.to_bits()), Grid::from_bits(v.y.to_bits()))
}

/// `a . b`, exact, in units of 2^-56 m².
pub(in crate::collision) fn dot(a: Vec2<Grid>, b: Vec2<Grid>) -> i128 {
    product(a.x, b.x) + product(a.y, b.y)
}

/// `a x b`, exact, in units of 2^-56 m².
pub(in crate::collision) fn cross(a: Vec2<Grid>, b: Vec2<Grid>) -> i128 {
    product(a.x, b.y) - product(a.y, b.x)
}

fn product(a: Grid, b: Grid) -> i128 {
    i128::from(a.to_bits()) * i128::from(b.to_bits())
}

/// Length of a vector, rounded to nearest.
pub(in crate::collision) fn length(v: Vec2<Grid>) -> Grid {
    Grid::from_bits(raw(v).length().to_bits())
}

/// Unit vector in the direction of a vector. `None` for zero.
pub(in crate::collision) fn direction(v: Vec2<Grid>) -> Option<Vec2<Unit>> {
    raw(v).normalized()
}

/// `n . v` for a unit vector, rounded to nearest.
pub(in crate::collision) fn along(n: Vec2<Unit>, v: Vec2<Grid>) -> Grid {
    Grid::from_bits(saturate_wide(round_shift_wide(scaled_along(n, v), Unit::FRAC_NBITS)))
}

/// `n . v` in units of 2^-58 m. If `n` is the direction of `v`, this is the length of `v`, with a relative error of
/// 1.5e-9.
pub(in crate::collision) fn scaled_along(n: Vec2<Unit>, v: Vec2<Grid>) -> i128 {
    let product = |n: Unit, x: Grid| i128::from(n.to_bits()) * i128::from(x.to_bits());
    product(n.x, v.x) + product(n.y, v.y)
}

/// `n s`, rounded to nearest.
pub(in crate::collision) fn scaled(n: Vec2<Unit>, s: Grid) -> Vec2<Grid> {
    let part = |n: Unit| {
        let product = i128::from(n.to_bits()) * i128::from(s.to_bits());
        Grid::from_bits(saturate_wide(round_shift_wide(product, Unit::FRAC_NBITS)))
    };
    Vec2::new(part(n.x), part(n.y))
}

/// Distance of a point from a line. `cross` is the cross product of a vector along the line with the vector from the
/// line to the point, and `scaled_length` the length of the vector along the line, from [`scaled_along`].
pub(in crate::collision) fn height(cross: i128, scaled_length: i128) -> Grid {
    // A cross product above 2^97 gives a height above 180 m. No result needs the last bits of such a height, so the
    // product may lose bits.
    let bits = if cross.unsigned_abs() >> 97 == 0 {
        div_round(cross << Unit::FRAC_NBITS, scaled_length)
    } else {
        div_round(cross, (scaled_length >> Unit::FRAC_NBITS).max(1))
    };
    Grid::from_bits(saturate_wide(bits))
}

/// A fraction from 0 to 1 in units of 2^-62, fine enough to locate a point on a line across the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Fraction(i64);

impl Fraction {
    pub(crate) const ZERO: Self = Fraction(0);
    const FRAC_NBITS: u32 = 62;
    const ONE: i64 = 1 << Self::FRAC_NBITS;

    /// `numerator / denominator`, rounded down, for `0 <= numerator <= denominator != 0`. If the denominator has more
    /// than 64 bits, both numbers lose the excess bits.
    pub(in crate::collision) fn ratio(numerator: i128, denominator: i128) -> Self {
        let excess = (i128::BITS - denominator.leading_zeros()).saturating_sub(u64::BITS);
        let quotient = ((numerator >> excess) << Self::FRAC_NBITS) / (denominator >> excess).max(1);
        Fraction(saturate_wide(quotient).clamp(0, Self::ONE))
    }

    /// The fraction of a vector, rounded to nearest.
    pub(in crate::collision) fn of(self, v: Vec2<Grid>) -> Vec2<Grid> {
        let part = |x: Grid| {
            let product = i128::from(x.to_bits()) * i128::from(self.0);
            Grid::from_bits(saturate_wide(round_shift_wide(product, Self::FRAC_NBITS)))
        };
        Vec2::new(part(v.x), part(v.y))
    }

    /// Converts to world format, rounded down.
    pub(in crate::collision) fn to_fx(self) -> Fx {
        Fx::from_bits(self.0 >> (Self::FRAC_NBITS - Fx::FRAC_NBITS))
    }
}

#[cfg(test)]
pub(in crate::collision) mod samples;
