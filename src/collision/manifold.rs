//! Contact manifold of a pair of shapes: a normal and up to two points.

use crate::math::{Fx, Length, Step, Unit, Vec2};

/// Identifies a contact point across ticks, so that its accumulated impulse can be carried over: the pair of the
/// vertices of A and B that meet at the point, independent of which shape has the reference edge and of the clipping.
///
/// Identifiers that also encoded the clipping would change while a pile settles. Every change would lose a warm start,
/// and the pile would sink (`docs/DESIGN.md` has the figures).
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
    /// Feature of the only point of a contact with a circle.
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
    /// Position half-way between the two surfaces, in metres from the manifold's origin, in world axes.
    pub anchor: Vec2<Length>,
    /// Distance between the surfaces along the normal in metres; negative if they overlap.
    pub separation: Step,
    /// Features that meet at the point.
    pub feature: Feature,
}

/// Contact manifold of shape A and shape B at the start of the tick, or at the time of impact for shapes that approach
/// fast and first touch later in the tick. The separations are always those at the start of the tick.
///
/// While shapes hardly move relative to each other, their contact keeps the normal and the points of an earlier tick.
/// The points move with the bodies, and may be off by up to a 64th of the smaller shape's extent.
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
    /// World position that anchors are relative to: the centre of one of the shapes or, if the contact keeps the
    /// manifold of an earlier tick, its first contact point.
    pub origin: Vec2<Fx>,
    points: [ManifoldPoint; 2],
    count: u8,
}

impl Manifold {
    const NO_POINT: ManifoldPoint =
        ManifoldPoint { anchor: Vec2::ZERO, separation: Step::ZERO, feature: Feature::SINGLE };

    /// A manifold without points.
    pub(crate) const NONE: Self = Self::new(Vec2::Y);

    pub(crate) const fn new(normal: Vec2<Unit>) -> Self {
        let origin = Vec2::new(Fx::ZERO, Fx::ZERO);
        Manifold { normal, origin, points: [Self::NO_POINT; 2], count: 0 }
    }

    /// Creates a manifold with one point.
    pub(crate) fn single(normal: Vec2<Unit>, point: ManifoldPoint) -> Self {
        let mut manifold = Self::new(normal);
        manifold.push(point);
        manifold
    }

    /// Creates a manifold with the first `count` of two points. Unused points must be zero, so that equal manifolds
    /// compare as equal.
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

    /// Number of contact points.
    #[inline]
    pub(crate) fn count(&self) -> u8 {
        self.count.min(2)
    }

    /// Both points; unused points are zero.
    #[inline]
    pub(crate) fn both_points(&self) -> &[ManifoldPoint; 2] {
        &self.points
    }

    #[inline]
    pub(crate) fn push(&mut self, point: ManifoldPoint) {
        self.points[usize::from(self.count)] = point;
        self.count += 1;
    }

    /// Keeps the selected points and zeroes the others, so that equal manifolds compare as equal.
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

    /// Keeps the points for which `keep` returns true.
    #[inline]
    pub(crate) fn retain(&mut self, mut keep: impl FnMut(&ManifoldPoint) -> bool) {
        let keeps = match self.points() {
            [] => [false; 2],
            [only] => [keep(only), false],
            [first, second, ..] => [keep(first), keep(second)],
        };
        // The common case, in which all points stay, writes nothing.
        if keeps.iter().filter(|&&kept| kept).count() < self.points().len() {
            self.keep(keeps);
        }
    }

    /// Sets the separation of each point.
    pub(crate) fn separate(&mut self, separation_of: impl Fn(&ManifoldPoint) -> Step) {
        for point in &mut self.points[..usize::from(self.count.min(2))] {
            point.separation = separation_of(point);
        }
    }

    /// Returns the manifold with the roles of the shapes exchanged.
    #[inline]
    pub(crate) fn swapped(mut self) -> Self {
        self.swap();
        self
    }

    /// Exchanges the roles of the shapes.
    #[inline]
    pub(crate) fn swap(&mut self) {
        self.normal = -self.normal;
        for point in &mut self.points[..usize::from(self.count.min(2))] {
            point.feature = point.feature.swapped();
        }
    }

    /// Translates the anchors.
    #[inline]
    pub(crate) fn translate(&mut self, by: Vec2<Length>) {
        for point in &mut self.points[..usize::from(self.count.min(2))] {
            point.anchor += by;
        }
    }
}
