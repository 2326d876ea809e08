//! Contact manifolds.

use crate::math::{Fx, Length, Step, Unit, Vec2};

/// Identifies a contact point across ticks, so that its accumulated impulse carries over. It consists of the two
/// vertices of A and B that meet at the point. It does not encode how the edges were clipped: it would then change
/// while a pile settles, each change would lose a warm start, and the pile would sink (`docs/DESIGN.md`).
///
/// ```
/// use lockstep2d::{body::Polygon, fx, math::Vec2, world::Probe};
/// use lockstep2d::collision::Feature;
/// let crate_ = Probe::new(Polygon::square(fx!(0.5))?, Vec2::ZERO)?;
/// let features = |x| -> Vec<Feature> {
///     let other = crate_.at(Vec2::new(x, fx!(1)));
///     crate_.manifold(&other, fx!(0.01)).points().iter().map(|point| point.feature).collect()
/// };
/// // The corners stay the same while one crate slides on the other.
/// assert_eq!(features(fx!(0.2)), features(fx!(0.3)));
/// # Ok::<(), lockstep2d::body::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Feature(pub(crate) u16);

impl Feature {
    /// Feature of a circle's contact.
    pub(crate) const SINGLE: Feature = Feature(0);

    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "at most 8 vertices")]
    pub(crate) fn of_vertices(a: usize, b: usize) -> Self {
        Feature((((a % 8) << 8) | (b % 8)) as u16)
    }

    fn swapped(self) -> Self {
        Feature(self.0.rotate_left(8))
    }
}

/// A point where two shapes touch or are about to touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ManifoldPoint {
    /// Position half-way between the surfaces, relative to the manifold's origin, in metres along the world's axes.
    pub anchor: Vec2<Length>,
    /// Distance between the surfaces along the normal in metres. Negative if they overlap.
    pub separation: Step,
    /// Vertices that meet at the point.
    pub feature: Feature,
}

/// Contact manifold of shapes A and B at the start of the tick, or at the time of impact for shapes that approach fast.
/// Separations are those at the start of the tick. While the shapes hardly move relative to each other, the normal and
/// the points may be those of an earlier tick, moved with the bodies.
///
/// ```
/// use lockstep2d::{body::Polygon, fx, math::Vec2, world::Probe};
/// use lockstep2d::collision::{Manifold, ManifoldPoint};
/// // Two crates, one on top of the other and 1 mm into it.
/// let lower = Probe::new(Polygon::square(fx!(0.5))?, Vec2::new(fx!(0), fx!(0)))?;
/// let upper = lower.at(Vec2::new(fx!(0.25), fx!(0.999)));
/// let manifold: Manifold = lower.manifold(&upper, fx!(0.01));
/// assert_eq!(manifold.normal, Vec2::Y);
/// // Two points, at the ends of the edge along which the crates touch.
/// let of_point = |point: &ManifoldPoint| (manifold.origin + point.anchor.widen()).x;
/// let mut ends: Vec<_> = manifold.points().iter().map(of_point).collect();
/// ends.sort();
/// assert_eq!(ends, [fx!(-0.25), fx!(0.5)]);
/// # Ok::<(), lockstep2d::body::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Manifold {
    /// Unit vector from A to B.
    pub normal: Vec2<Unit>,
    /// World position that anchors are relative to.
    pub origin: Vec2<Fx>,
    points: [ManifoldPoint; 2],
    count: u8,
}

impl Manifold {
    const NO_POINT: ManifoldPoint =
        ManifoldPoint { anchor: Vec2::ZERO, separation: Step::ZERO, feature: Feature::SINGLE };

    pub(crate) const NONE: Self = Self::new(Vec2::Y);

    pub(crate) const fn new(normal: Vec2<Unit>) -> Self {
        let origin = Vec2::new(Fx::ZERO, Fx::ZERO);
        Manifold { normal, origin, points: [Self::NO_POINT; 2], count: 0 }
    }

    pub(crate) fn single(normal: Vec2<Unit>, point: ManifoldPoint) -> Self {
        let mut manifold = Self::new(normal);
        manifold.push(point);
        manifold
    }

    /// Unused points must be zero, so that equal manifolds compare as equal.
    #[inline]
    pub(crate) fn of_points(
        normal: Vec2<Unit>,
        origin: Vec2<Fx>,
        points: [ManifoldPoint; 2],
        count: u8,
    ) -> Self {
        Manifold { normal, origin, points, count }
    }

    /// Contact points, none to two.
    #[inline]
    #[must_use]
    pub fn points(&self) -> &[ManifoldPoint] {
        &self.points[..usize::from(self.count.min(2))]
    }

    #[inline]
    pub(crate) fn count(&self) -> u8 {
        self.count.min(2)
    }

    /// Both points. Unused ones are zero.
    #[inline]
    pub(crate) fn both_points(&self) -> &[ManifoldPoint; 2] {
        &self.points
    }

    #[inline]
    pub(crate) fn push(&mut self, point: ManifoldPoint) {
        self.points[usize::from(self.count)] = point;
        self.count += 1;
    }

    /// Keeps the marked points, in order, and zeroes the rest.
    #[inline]
    fn keep(&mut self, kept: [bool; 2]) {
        let [first, second] = self.points;
        (self.points, self.count) = match kept {
            [true, true] => (self.points, 2),
            [true, false] => ([first, Self::NO_POINT], 1),
            [false, true] => ([second, Self::NO_POINT], 1),
            [false, false] => ([Self::NO_POINT; 2], 0),
        };
    }

    #[inline]
    pub(crate) fn retain(&mut self, mut keep: impl FnMut(&ManifoldPoint) -> bool) {
        let keeps = match self.points() {
            [] => [false; 2],
            [only] => [keep(only), false],
            [first, second, ..] => [keep(first), keep(second)],
        };
        // Writes nothing in the common case that all points stay.
        if keeps.iter().filter(|&&kept| kept).count() < self.points().len() {
            self.keep(keeps);
        }
    }

    pub(crate) fn separate(&mut self, separation_of: impl Fn(&ManifoldPoint) -> Step) {
        for point in &mut self.points[..usize::from(self.count.min(2))] {
            point.separation = separation_of(point);
        }
    }

    #[inline]
    pub(crate) fn swapped(mut self) -> Self {
        self.swap();
        self
    }

    #[inline]
    pub(crate) fn swap(&mut self) {
        self.normal = -self.normal;
        for point in &mut self.points[..usize::from(self.count.min(2))] {
            point.feature = point.feature.swapped();
        }
    }

    #[inline]
    pub(crate) fn translate(&mut self, by: Vec2<Length>) {
        for point in &mut self.points[..usize::from(self.count.min(2))] {
            point.anchor += by;
        }
    }
}
