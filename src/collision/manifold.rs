//! What a pair of shapes has in contact: a normal and up to two points.

use crate::math::{Fx, Length, Step, Unit, Vec2};

/// Identifies a contact point across ticks, so that its impulse can be carried over: the pair (vertex of A,
/// vertex of B) of the matched ends, whichever shape the reference edge belongs to and wherever it was clipped.
///
/// Identities that encode the clipping as well change while a pile settles; every change loses a warm start and
/// the pile sinks (`docs/DESIGN.md` has the figures).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Feature(pub(crate) u16);

impl Feature {
    /// The only point of a contact with a circle.
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

/// A point where two shapes touch or are about to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ManifoldPoint {
    /// Half-way between the two surfaces, in metres from the manifold's origin, in world axes.
    pub anchor: Vec2<Length>,
    /// Distance between the surfaces along the normal in metres, negative where they overlap.
    pub separation: Step,
    /// Which features meet.
    pub feature: Feature,
}

/// The contact between shape A and shape B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Manifold {
    /// Unit vector from A to B.
    pub normal: Vec2<Unit>,
    /// The world position that anchors are measured from: the centre of one of the shapes.
    pub origin: Vec2<Fx>,
    points: [ManifoldPoint; 2],
    count: u8,
}

impl Manifold {
    const NO_POINT: ManifoldPoint =
        ManifoldPoint { anchor: Vec2::ZERO, separation: Step::ZERO, feature: Feature::SINGLE };

    /// No contact.
    pub(crate) const NONE: Self = Self::new(Vec2::Y);

    pub(crate) const fn new(normal: Vec2<Unit>) -> Self {
        Manifold { normal, origin: Vec2::new(Fx::ZERO, Fx::ZERO), points: [Self::NO_POINT; 2], count: 0 }
    }

    /// A contact with one point.
    pub(crate) fn single(normal: Vec2<Unit>, point: ManifoldPoint) -> Self {
        let mut manifold = Self::new(normal);
        manifold.push(point);
        manifold
    }

    /// A contact with the first so many of two points. Those that it does not have must be zero: contacts that are equal
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

    /// The points, none to two.
    #[inline]
    #[must_use]
    pub fn points(&self) -> &[ManifoldPoint] {
        &self.points[..usize::from(self.count.min(2))]
    }

    /// How many points there are.
    #[inline]
    pub(crate) fn count(&self) -> u8 {
        self.count.min(2)
    }

    /// Two points, of which what is not there is zero.
    #[inline]
    pub(crate) fn both_points(&self) -> &[ManifoldPoint; 2] {
        &self.points
    }

    #[inline]
    pub(crate) fn push(&mut self, point: ManifoldPoint) {
        self.points[usize::from(self.count)] = point;
        self.count += 1;
    }

    /// Keeps some of two points. Nothing is left of the others: contacts that are equal compare as equal.
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

    /// Keeps the points that pass a test.
    #[inline]
    pub(crate) fn retain(&mut self, mut keep: impl FnMut(&ManifoldPoint) -> bool) {
        let keeps = match self.points() {
            [] => [false; 2],
            [only] => [keep(only), false],
            [first, second, ..] => [keep(first), keep(second)],
        };
        // Nothing is written where all stay, which is nearly always.
        if keeps.iter().filter(|&&kept| kept).count() < self.points().len() {
            self.keep(keeps);
        }
    }

    /// The same contact with the roles of the shapes exchanged.
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

    /// Moves the anchors.
    #[inline]
    pub(crate) fn translate(&mut self, by: Vec2<Length>) {
        for point in &mut self.points[..usize::from(self.count.min(2))] {
            point.anchor += by;
        }
    }
}
