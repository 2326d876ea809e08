//! Two boxes, eight pairs at a time: what most shapes of most worlds are. Each pair gets the manifold that
//! [`hull_hull`](super::hull_hull) finds, bit by bit; the few that are near at two corners are left to that.

mod kernel;
#[cfg(test)]
mod tests;

use alloc::vec::Vec;
use core::ops::Deref;

use super::broad_phase::Pair;
use super::manifold::{Feature, Manifold, ManifoldPoint};
use super::pose::{Faces, PosedShape};
use crate::fx;
use crate::lanes::{Ints, Machine, Quad, WIDTH, prefetch};
use crate::math::{Fx, Length, Rot, Step, Unit, Vec2};

/// Furthest corner of a box that lanes take, radius included, in metres from its centre.
pub(super) const BOX_REACH_MAX: Length = Length::lit("3");

/// Furthest apart that two centres may be along either axis, in metres. Then no corner of a pair is more than
/// `5 sqrt(2) + 2 * 3 < 14` m from a corner of the other: that has room in a `Step`, which goes to 16.
const DISTANCE_MAX: Fx = fx!(5);

/// Largest margin of a pair that lanes take, in metres.
const MARGIN_MAX: Length = Length::lit("2");

/// The boxes of a world that lanes take, by the slots of their shapes: half a cache line for each, where a
/// [`PosedShape`] has four.
#[derive(Clone, Debug, Default)]
pub(crate) struct SmallBoxes {
    /// In world axes, by slot; zeros for what is no such box.
    turned: Vec<Turned>,
    /// The same in the frames of their bodies, of boxes about whose centres those turn.
    centred: Vec<Option<Faces>>,
}

/// The first two vertices of a box, and its first two normals: the others are opposite to them. Aligned, so that none lies
/// in two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
struct Turned([Quad; 2]);

impl SmallBoxes {
    /// Makes room for so many slots.
    pub(crate) fn resize(&mut self, slot_count: usize) {
        self.turned.resize(slot_count, Turned::default());
        self.centred.resize(slot_count, None);
    }

    /// Takes up a shape that is posed for the first time, or has become another one. `centred` is
    /// [`PosedShape::as_centred_box`].
    pub(crate) fn place(&mut self, slot: u32, shape: &PosedShape, centred: Option<Faces>) {
        self.centred[slot as usize] = centred;
        self.renew(slot, shape);
    }

    /// Takes up a shape that has been turned.
    #[inline]
    pub(crate) fn renew(&mut self, slot: u32, shape: &PosedShape) {
        if let Some(faces) = shape.as_small_box() {
            self.set(slot, &faces);
        }
    }

    /// Turns a box whose body turns about its centre, and returns it. Nothing happens to any other shape.
    #[inline(always)]
    pub(crate) fn turn(&mut self, slot: u32, rotation: &impl Deref<Target = Rot>) -> Option<Faces> {
        let faces = self.centred[slot as usize].as_ref()?.rotated(**rotation);
        self.set(slot, &faces);
        Some(faces)
    }

    #[inline(always)]
    fn set(&mut self, slot: u32, Faces { vertices: [v0, v1], normals: [n0, n1] }: &Faces) {
        self.turned[slot as usize] = Turned([
            Quad([v0.x, v0.y, v1.x, v1.y].map(Length::to_bits)),
            Quad([n0.x, n0.y, n1.x, n1.y].map(Unit::to_bits)),
        ]);
    }

    /// Asks for a box that will soon be looked at.
    #[inline]
    pub(crate) fn prefetch(&self, slot: u32) {
        prefetch(&self.turned[slot as usize]);
    }
}

/// Pairs of small boxes, and what has been found of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoxPairs {
    count: usize,
    batches: Vec<Batch>,
}

/// Up to eight pairs. Lanes that are left over have the boxes of the first pair.
#[derive(Clone, Debug)]
struct Batch {
    /// The slots of the boxes of each pair.
    at: [[u32; WIDTH]; 2],
    /// From the centres of A to those of B.
    d: [Ints<WIDTH>; 2],
    radius: [Ints<WIDTH>; 2],
    margin: Ints<WIDTH>,
    found: Found,
}

/// The manifolds of eight pairs.
#[derive(Clone, Debug)]
struct Found {
    /// A bit for each pair that is left to others.
    open: u32,
    normal: [Ints<WIDTH>; 2],
    /// How many points each has.
    count: Ints<WIDTH>,
    /// What a pair does not have is zero.
    points: [Points; 2],
}

/// A point of each pair: anchor, separation and feature.
#[derive(Clone, Debug)]
struct Points([Ints<WIDTH>; 4]);

impl BoxPairs {
    /// Forgets all pairs.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds the small boxes in two slots, by the vector from the centre of the first to that of the second. Returns the place
    /// of the pair, or nothing if it is not for lanes.
    #[inline]
    pub(crate) fn push(
        &mut self,
        (a, b): Pair,
        d: Vec2<Fx>,
        radii: [Length; 2],
        margin: Length,
    ) -> Option<usize> {
        if d.x.saturating_abs().max(d.y.saturating_abs()) > DISTANCE_MAX || margin > MARGIN_MAX {
            return None;
        }
        let (place, lane) = (self.count, self.count % WIDTH);
        if place / WIDTH == self.batches.len() {
            self.batches.push(Batch::EMPTY);
        }
        let batch = &mut self.batches[place / WIDTH];
        if lane == 0 {
            // The slots of an earlier tick may be gone.
            batch.at = [[a; WIDTH], [b; WIDTH]];
        }
        let d: Vec2<Length> = d.narrow();
        for side in 0..2 {
            batch.at[side][lane] = [a, b][side];
            batch.radius[side].0[lane] = radii[side].to_bits();
        }
        (batch.d[0].0[lane], batch.d[1].0[lane]) = (d.x.to_bits(), d.y.to_bits());
        batch.margin.0[lane] = margin.to_bits();
        self.count += 1;
        Some(place)
    }

    /// Finds the manifolds of all pairs.
    pub(crate) fn collide(&mut self, machine: Machine, boxes: &SmallBoxes) {
        let batches = &mut self.batches[..self.count.div_ceil(WIDTH)];
        if !batches.is_empty() {
            machine.run(kernel::Collide { batches, boxes: &boxes.turned });
        }
    }

    /// Adds the manifold of the pair at a place to others, with the centre of its first box for an origin. Does nothing and
    /// says so if the pair is left to others.
    #[inline(always)]
    pub(crate) fn append_to(&self, manifolds: &mut Vec<Manifold>, place: usize, origin: Vec2<Fx>) -> bool {
        let (found, lane) = (&self.batches[place / WIDTH].found, place % WIDTH);
        let is_closed = found.open >> lane & 1 == 0;
        if is_closed {
            manifolds.push(found.manifold(lane, origin));
        }
        is_closed
    }
}

impl Batch {
    const EMPTY: Self = Batch {
        at: [[0; WIDTH]; 2],
        d: [Ints::ZERO; 2],
        radius: [Ints::ZERO; 2],
        margin: Ints::ZERO,
        found: Found {
            open: 0,
            normal: [Ints::ZERO; 2],
            count: Ints::ZERO,
            points: [Points([Ints::ZERO; 4]), Points([Ints::ZERO; 4])],
        },
    };
}

impl Found {
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most 2 points of 4 corners"
    )]
    fn manifold(&self, lane: usize, origin: Vec2<Fx>) -> Manifold {
        let at = |ints: &Ints<WIDTH>| ints.0[lane];
        let point = |Points([x, y, separation, feature]): &Points| ManifoldPoint {
            anchor: Vec2::new(Length::from_bits(at(x)), Length::from_bits(at(y))),
            separation: Step::from_bits(at(separation)),
            feature: Feature(at(feature) as u16),
        };
        let normal = Vec2::new(Unit::from_bits(at(&self.normal[0])), Unit::from_bits(at(&self.normal[1])));
        let [first, second] = &self.points;
        Manifold::of_points(normal, origin, [point(first), point(second)], at(&self.count) as u8)
    }
}
