//! Two boxes, eight pairs at a time: what most shapes of most worlds are. Each pair gets the manifold that
//! [`hull_hull`](super::hull_hull) finds, bit by bit; the few that are near at two corners are left to that.

mod kernel;
#[cfg(test)]
mod tests;

use super::manifold::{Feature, Manifold, ManifoldPoint};
use super::pose::{Outline, PosedShape};
use crate::fx;
use crate::lanes::{Ints, Machine, Quad, WIDTH};
use crate::math::{Fx, Length, Step, Unit, Vec2};

/// Furthest corner of a box that lanes take, radius included, in metres from its centre.
pub(super) const BOX_REACH_MAX: Length = Length::lit("3");

/// Furthest apart that two centres may be along either axis, in metres. Then no corner of a pair is more than
/// `5 sqrt(2) + 2 * 3 < 14` m from a corner of the other: that has room in a `Step`, which goes to 16.
const DISTANCE_MAX: Fx = fx!(5);

/// Largest margin of a pair that lanes take, in metres.
const MARGIN_MAX: Length = Length::lit("2");

/// Up to eight pairs of boxes, and where their manifolds go.
#[derive(Clone, Debug)]
pub(crate) struct BoxPairs {
    count: usize,
    places: [usize; WIDTH],
    /// The centres of the boxes A.
    origins: [Vec2<Fx>; WIDTH],
    boxes: [Boxes; 2],
    /// From the centres of A to those of B.
    d: [Ints<WIDTH>; 2],
    margin: Ints<WIDTH>,
}

/// One of the boxes of each pair: the other halves of its normals and its vertices are opposite to these.
#[derive(Clone, Debug)]
struct Boxes {
    normals: [Quad; WIDTH],
    vertices: [Quad; WIDTH],
    radius: Ints<WIDTH>,
}

/// What has been found of eight pairs.
#[derive(Debug)]
struct Found {
    /// A bit for each pair that is not further apart than its margin.
    near: u32,
    /// Of these, a bit for each that is left to others.
    open: u32,
    /// Whether the reference face is one of B.
    swapped: u32,
    /// The edges of the reference and the incident box.
    edges: [Ints<WIDTH>; 2],
    normal: [Ints<WIDTH>; 2],
    points: [Points; 2],
}

/// A point of each pair.
#[derive(Debug)]
struct Points {
    /// A bit for each that is near enough.
    kept: u32,
    anchor: [Ints<WIDTH>; 2],
    separation: Ints<WIDTH>,
}

impl BoxPairs {
    pub(crate) const NONE: Self = BoxPairs {
        count: 0,
        places: [0; WIDTH],
        origins: [Vec2::new(Fx::ZERO, Fx::ZERO); WIDTH],
        boxes: [Boxes::NONE, Boxes::NONE],
        d: [Ints::ZERO; 2],
        margin: Ints::ZERO,
    };

    /// Adds two boxes, of which both are small. False if they are not for lanes, or if there are eight.
    #[inline]
    pub(crate) fn push(&mut self, a: &PosedShape, b: &PosedShape, margin: Length, place: usize) -> bool {
        let lane = self.count;
        // Both are in the world.
        let d = b.centre.wrapping_sub(a.centre);
        let is_far = d.x.saturating_abs().max(d.y.saturating_abs()) > DISTANCE_MAX;
        if lane >= WIDTH || is_far || margin > MARGIN_MAX {
            return false;
        }
        let [boxes_a, boxes_b] = &mut self.boxes;
        if !(boxes_a.set(lane, a) && boxes_b.set(lane, b)) {
            return false;
        }
        let d: Vec2<Length> = d.narrow();
        self.places[lane] = place;
        self.origins[lane] = a.centre;
        (self.d[0].0[lane], self.d[1].0[lane]) = (d.x.to_bits(), d.y.to_bits());
        self.margin.0[lane] = margin.to_bits();
        self.count += 1;
        true
    }

    pub(crate) fn is_full(&self) -> bool {
        self.count == WIDTH
    }

    /// Writes the manifolds of all pairs to their places, where there is [`Manifold::NONE`], and forgets the pairs. Tells the
    /// places of those that are left to others.
    #[inline]
    pub(crate) fn collide(
        &mut self,
        machine: Machine,
        manifolds: &mut [Manifold],
        mut left: impl FnMut(usize),
    ) {
        if self.count == 0 {
            return;
        }
        let mut found = Found::NONE;
        machine.run(kernel::Collide { pairs: self, found: &mut found });
        for lane in 0..self.count.min(WIDTH) {
            if found.open >> lane & 1 != 0 {
                left(self.places[lane]);
            } else if found.near >> lane & 1 != 0 {
                found.write(lane, self.origins[lane], &mut manifolds[self.places[lane]]);
            }
        }
        self.count = 0;
    }
}

impl Boxes {
    const NONE: Self =
        Boxes { normals: [Quad([0; 4]); WIDTH], vertices: [Quad([0; 4]); WIDTH], radius: Ints::ZERO };

    #[inline]
    fn set(&mut self, lane: usize, shape: &PosedShape) -> bool {
        let Outline::Polygon(hull) = &shape.outline else { return false };
        let Some(([v0, v1], [n0, n1])) = hull.as_box() else { return false };
        self.normals[lane] = Quad([n0.x, n0.y, n1.x, n1.y].map(Unit::to_bits));
        self.vertices[lane] = Quad([v0.x, v0.y, v1.x, v1.y].map(Length::to_bits));
        self.radius.0[lane] = hull.radius.to_bits();
        true
    }
}

impl Found {
    const NONE: Self = Found {
        near: 0,
        open: 0,
        swapped: 0,
        edges: [Ints::ZERO; 2],
        normal: [Ints::ZERO; 2],
        points: [Points::NONE, Points::NONE],
    };

    #[inline(always)]
    fn write(&self, lane: usize, origin: Vec2<Fx>, to: &mut Manifold) {
        let at = |ints: &Ints<WIDTH>| ints.0[lane];
        let [reference, incident] = [0, 1].map(|i| at(&self.edges[i]).unsigned_abs() as usize);
        let swapped = self.swapped >> lane & 1 != 0;
        let point = |point: &Points, reference, incident| ManifoldPoint {
            anchor: Vec2::new(
                Length::from_bits(at(&point.anchor[0])),
                Length::from_bits(at(&point.anchor[1])),
            ),
            separation: Step::from_bits(at(&point.separation)),
            feature: if swapped {
                Feature::of_vertices(incident, reference)
            } else {
                Feature::of_vertices(reference, incident)
            },
        };
        to.origin = origin;
        to.normal = Vec2::new(Unit::from_bits(at(&self.normal[0])), Unit::from_bits(at(&self.normal[1])));
        let next = |edge: usize| (edge + 1) % 4;
        let [first, second] = &self.points;
        // The incident edge runs against the reference edge.
        let points = [point(first, reference, next(incident)), point(second, next(reference), incident)];
        to.set_points(points, [first, second].map(|point| point.kept >> lane & 1 != 0));
    }
}

impl Points {
    const NONE: Self = Points { kept: 0, anchor: [Ints::ZERO; 2], separation: Ints::ZERO };
}
