//! Box against box, [`WIDTH`] pairs at a time with SIMD. A manifold with points equals the manifold of
//! [`hull_hull`](super::hull_hull) bit for bit. Pairs with the incident edge beside the reference face, or with two
//! corners as nearest features, are left to the scalar path.

mod kernel;
#[cfg(test)]
mod tests;
mod vector;

use alloc::vec::Vec;
use core::ops::Deref;

use crate::collision::contact::Pair;
use crate::collision::manifold::{Feature, Manifold, ManifoldPoint};
use crate::collision::shape::posed::{Faces, PosedShape};
use crate::fx;
use crate::math::{Fx, Length, Rot, Step, Unit, Vec2};
use crate::simd::{Ints, Machine, Quad, WIDTH, prefetch};
use crate::threads::split_at_ends;

/// Largest distance in metres between the centres of two boxes, on each axis. Each corner is at most 3 m from the
/// centre of its box, so corners are at most `5 sqrt(2) + 2 * 3 < 14` m apart, which fits a `Step` (below 16 m).
const DISTANCE_MAX: Fx = fx!(5);

/// Largest speculative margin in metres.
const MARGIN_MAX: Length = Length::lit("2");

/// Compact copies of the boxes, by shape slot. A copy takes half a cache line; a [`PosedShape`] takes four.
#[derive(Clone, Debug, Default)]
pub(crate) struct SmallBoxes {
    turned: Vec<Turned>,
    /// Faces in the frame of the body, for boxes whose centre is their body's centre of mass.
    centred: Vec<Option<Faces>>,
}

/// Aligned, so that no entry straddles two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
struct Turned([Quad; 2]);

pub(crate) struct SmallBoxesRange<'a> {
    turned: &'a mut [Turned],
    centred: &'a [Option<Faces>],
}

impl Turned {
    #[inline(always)]
    fn new(Faces { vertices: [v0, v1], normals: [n0, n1] }: &Faces) -> Self {
        Turned([
            Quad([v0.x, v0.y, v1.x, v1.y].map(Length::to_bits)),
            Quad([n0.x, n0.y, n1.x, n1.y].map(Unit::to_bits)),
        ])
    }
}

impl SmallBoxesRange<'_> {
    #[inline]
    pub(crate) fn renew(&mut self, index: usize, shape: &PosedShape) {
        if let Some(faces) = shape.as_small_box() {
            self.turned[index] = Turned::new(&faces);
        }
    }

    /// Rotates a centred box. `None` for any other shape, which stays unchanged.
    #[inline(always)]
    pub(crate) fn turn(&mut self, index: usize, rotation: &impl Deref<Target = Rot>) -> Option<Faces> {
        let faces = self.centred[index].as_ref()?.rotated(**rotation);
        self.turned[index] = Turned::new(&faces);
        Some(faces)
    }
}

impl SmallBoxes {
    pub(crate) fn resize(&mut self, slot_count: usize) {
        self.turned.resize(slot_count, Turned::default());
        self.centred.resize(slot_count, None);
    }

    /// `centred` is the result of [`PosedShape::as_centred_box`].
    pub(crate) fn place(&mut self, slot: u32, shape: &PosedShape, centred: Option<Faces>) {
        self.centred[slot as usize] = centred;
        if let Some(faces) = shape.as_small_box() {
            self.turned[slot as usize] = Turned::new(&faces);
        }
    }

    /// Divides the boxes into consecutive ranges. For each slot in the ascending list `ends`, one range ends before it.
    pub(crate) fn split(
        &mut self,
        ends: impl Iterator<Item = usize> + Clone,
    ) -> impl Iterator<Item = SmallBoxesRange<'_>> {
        let centred = split_at_ends(&mut self.centred, ends.clone());
        split_at_ends(&mut self.turned, ends)
            .zip(centred)
            .map(|(turned, centred)| SmallBoxesRange { turned, centred })
    }

    #[inline]
    pub(crate) fn prefetch(&self, slot: u32) {
        prefetch(&self.turned[slot as usize]);
    }
}

#[derive(Clone, Debug, Default)]
pub(crate) struct BoxPairs {
    count: usize,
    batches: Vec<Batch>,
}

/// Up to [`WIDTH`] pairs, one in each lane. Unused lanes contain the boxes of the first pair.
#[derive(Clone, Debug)]
struct Batch {
    at: [[u32; WIDTH]; 2],
    /// Vectors from the centres of A to the centres of B.
    d: [Ints<WIDTH>; 2],
    radius: [Ints<WIDTH>; 2],
    margin: Ints<WIDTH>,
    manifolds: Manifolds,
}

#[derive(Clone, Debug)]
#[repr(C, align(32))]
struct Manifolds {
    normal: [Ints<WIDTH>; 2],
    count: Ints<WIDTH>,
    /// Points beyond a pair's count are zero.
    points: [Points; 2],
    /// Bit mask of the pairs left to the scalar path.
    open: u32,
}

/// Anchor (x, y), separation and feature.
#[derive(Clone, Debug)]
struct Points([Ints<WIDTH>; 4]);

impl BoxPairs {
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds a pair. `d` is the vector from the centre of A to that of B. Returns false, without adding the pair, if the
    /// distance or the margin is out of range.
    #[inline]
    pub(crate) fn push(&mut self, (a, b): Pair, d: Vec2<Fx>, radii: [Length; 2], margin: Length) -> bool {
        if d.x.saturating_abs().max(d.y.saturating_abs()) > DISTANCE_MAX || margin > MARGIN_MAX {
            return false;
        }
        let (place, lane) = (self.count, self.count % WIDTH);
        if place / WIDTH == self.batches.len() {
            self.batches.push(Batch::EMPTY);
        }
        let batch = &mut self.batches[place / WIDTH];
        if lane == 0 {
            // Slots of an earlier tick may no longer exist.
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
        true
    }

    /// Computes the manifolds of the added pairs. If there are any, `machine` must have vector instructions.
    pub(crate) fn collide(&mut self, machine: Machine, boxes: &SmallBoxes) {
        let batches = &mut self.batches[..self.count.div_ceil(WIDTH)];
        if let (false, Some(vectors)) = (batches.is_empty(), machine.vectors()) {
            vectors.run(kernel::Collide { batches, boxes: &boxes.turned });
        }
    }

    /// Appends the manifold of a pair, with the centre of its first box as the origin. Returns false if the pair is
    /// left to the scalar path.
    #[inline(always)]
    pub(crate) fn append_to(&self, manifolds: &mut Vec<Manifold>, place: usize, origin: Vec2<Fx>) -> bool {
        let (batch, lane) = (&self.batches[place / WIDTH], place % WIDTH);
        let is_closed = batch.manifolds.open >> lane & 1 == 0;
        if is_closed {
            manifolds.push(batch.manifolds.manifold(lane, origin));
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
        manifolds: Manifolds {
            open: 0,
            normal: [Ints::ZERO; 2],
            count: Ints::ZERO,
            points: [Points([Ints::ZERO; 4]), Points([Ints::ZERO; 4])],
        },
    };
}

impl Manifolds {
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
