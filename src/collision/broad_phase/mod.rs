//! Broad phase: pairs of overlapping fat AABBs. All implementations return the same pairs in sorted order, so their
//! data structures are caches and not part of the state.

mod box_list;
mod search;
mod sweep_and_prune;
mod tree;
mod trees;

use alloc::vec::Vec;
use core::ops::ControlFlow;

use crate::body::CollisionClass;
use crate::collision::contact::Pair;
use crate::math::{Aabb, Fx, Unit, Vec2};
use box_list::BoxList;
use search::{Along, Near, Overlap, Search};
use sweep_and_prune::SweepAndPrune;
use trees::Trees;

#[cfg(test)]
mod tests;

/// Data structure of the broad phase. The choice changes the speed, not the result.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::World};
/// use lockstep2d::collision::BroadPhaseKind;
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::fixed(), &[square])?;
/// # world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(2))), &[square])?;
/// let mut other = world.clone();
/// // Suitable for a world in which most boxes move by small distances.
/// other.set_broad_phase(BroadPhaseKind::SweepAndPrune);
/// (0..60).for_each(|_| [&mut world, &mut other].into_iter().for_each(World::step));
/// assert_eq!(world.state_hash(), other.state_hash());
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BroadPhaseKind {
    /// Dynamic AABB tree: the cost grows with the number of moving boxes, and queries are fast.
    #[default]
    Tree,
    /// Incremental sweep and prune: fast if most boxes move by small distances. Queries visit every box.
    SweepAndPrune,
    /// Tests every pair of boxes: slow, but so simple that tests compare the others with it.
    BruteForce,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Moved<'a> {
    /// All pairs.
    All,
    /// Pairs with at least one box in these slots. Slots may repeat or be vacant.
    Slots(&'a [u32]),
}

#[derive(Clone, Debug)]
pub(crate) struct BroadPhase {
    structure: Structure,
    /// Box of each slot, for lookups within a tick.
    boxes: Vec<Aabb>,
    /// For each slot, whether its body is fixed.
    fixed: Vec<bool>,
    moved: MovedSet,
}

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a world has one, and it is hardly ever moved")]
enum Structure {
    Trees(Trees),
    SweepAndPrune(SweepAndPrune),
    BruteForce(BoxList),
}

impl BroadPhase {
    pub(crate) fn new(kind: BroadPhaseKind) -> Self {
        let structure = match kind {
            BroadPhaseKind::Tree => Structure::Trees(Trees::default()),
            BroadPhaseKind::SweepAndPrune => Structure::SweepAndPrune(SweepAndPrune::default()),
            BroadPhaseKind::BruteForce => Structure::BruteForce(BoxList::default()),
        };
        BroadPhase { structure, boxes: Vec::new(), fixed: Vec::new(), moved: MovedSet::default() }
    }

    pub(crate) fn kind(&self) -> BroadPhaseKind {
        match self.structure {
            Structure::Trees(_) => BroadPhaseKind::Tree,
            Structure::SweepAndPrune(_) => BroadPhaseKind::SweepAndPrune,
            Structure::BruteForce(_) => BroadPhaseKind::BruteForce,
        }
    }

    /// Box of a slot. [`Aabb::NOWHERE`] if there is none.
    pub(crate) fn fat(&self, slot: u32) -> Aabb {
        self.boxes.get(slot as usize).copied().unwrap_or(Aabb::NOWHERE)
    }

    pub(crate) fn is_fixed(&self, slot: u32) -> bool {
        self.fixed.get(slot as usize).is_some_and(|&fixed| fixed)
    }

    fn record_box(&mut self, slot: u32, fat: Aabb) {
        if self.boxes.len() <= slot as usize {
            self.boxes.resize(slot as usize + 1, Aabb::NOWHERE);
            self.fixed.resize(slot as usize + 1, false);
        }
        self.boxes[slot as usize] = fat;
    }

    /// Inserts or moves the box of a slot.
    pub(crate) fn put(&mut self, slot: u32, fat: Aabb, fixed: bool) {
        self.record_box(slot, fat);
        self.fixed[slot as usize] = fixed;
        match &mut self.structure {
            Structure::Trees(trees) => trees.put(slot, fat, fixed),
            Structure::SweepAndPrune(sweep) => sweep.set(slot, fat),
            Structure::BruteForce(boxes) => boxes.set(slot, fat),
        }
    }

    /// Moves the box of a slot that has one.
    pub(crate) fn set(&mut self, slot: u32, fat: Aabb) {
        self.record_box(slot, fat);
        match &mut self.structure {
            Structure::Trees(trees) => trees.set(slot, fat),
            Structure::SweepAndPrune(sweep) => sweep.set(slot, fat),
            Structure::BruteForce(boxes) => boxes.set(slot, fat),
        }
    }

    /// Sets the collision class of a slot that has a box. Results may leave out pairs within one class.
    pub(crate) fn set_collision_class(&mut self, slot: u32, class: CollisionClass) {
        if let Structure::Trees(trees) = &mut self.structure {
            trees.set_collision_class(slot, class);
        }
    }

    pub(crate) fn set_many(&mut self, boxes: &[(u32, Aabb)]) {
        boxes.iter().for_each(|&(slot, fat)| self.record_box(slot, fat));
        match &mut self.structure {
            Structure::Trees(trees) => trees.set_many(boxes),
            Structure::SweepAndPrune(sweep) => boxes.iter().for_each(|&(slot, fat)| sweep.set(slot, fat)),
            Structure::BruteForce(list) => boxes.iter().for_each(|&(slot, fat)| list.set(slot, fat)),
        }
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        if let Some(fat) = self.boxes.get_mut(slot as usize) {
            *fat = Aabb::NOWHERE;
        }
        match &mut self.structure {
            Structure::Trees(trees) => trees.remove(slot),
            Structure::SweepAndPrune(sweep) => sweep.remove(slot),
            Structure::BruteForce(boxes) => boxes.remove(slot),
        }
    }

    /// Replaces all boxes, and clears their collision classes. An item is a slot, its box, and whether its body is
    /// fixed. If a slot repeats, its last box counts.
    pub(crate) fn refill(&mut self, boxes: impl IntoIterator<Item = (u32, Aabb, bool)>) {
        *self = BroadPhase::new(self.kind());
        let boxes = boxes.into_iter();
        if let Structure::Trees(_) = self.structure {
            for (slot, fat, fixed) in boxes {
                self.record_box(slot, fat);
                self.fixed[slot as usize] = fixed;
            }
            let mut trees = Trees::default();
            let all = (0..).zip(self.boxes.iter().zip(&self.fixed));
            let present = all.filter(|(_, (fat, _))| **fat != Aabb::NOWHERE);
            trees.refill(present.map(|(slot, (fat, fixed))| (slot, *fat, *fixed)));
            self.structure = Structure::Trees(trees);
        } else {
            boxes.for_each(|(slot, fat, fixed)| self.put(slot, fat, fixed));
        }
    }

    /// Finds the overlapping pairs that have at least one moved box and for which `accept` returns true, in sorted
    /// order. Keeps the `limit` smallest pairs and returns whether there are more. `accept` must reject every pair
    /// within one collision class, and every pair of fixed bodies.
    pub(crate) fn pairs(
        &mut self,
        moved: Moved<'_>,
        accept: impl Fn(Pair) -> bool,
        limit: usize,
        pairs: &mut Vec<Pair>,
    ) -> bool {
        pairs.clear();
        let mut smallest = SmallestPairs { pairs, limit, overflowed: false };
        let mut found = |pair: Pair| {
            if accept(pair) {
                smallest.push(pair);
            }
        };
        let BroadPhase { structure, moved: set, .. } = self;
        match moved {
            Moved::All => match structure {
                Structure::Trees(trees) => trees.each_pair(found),
                Structure::SweepAndPrune(sweep) => sweep.each_pair(found),
                Structure::BruteForce(boxes) => boxes.each_pair(found),
            },
            Moved::Slots(slots) => {
                set.replace(slots);
                let found_moved = |(a, b): Pair| {
                    if set.has(a) || set.has(b) {
                        found((a, b));
                    }
                };
                match structure {
                    // Marking pays off only if the marked slots are fewer than half of the moving boxes.
                    Structure::Trees(trees) if set.slots.len() < trees.moving_len() / 2 => {
                        trees.each_pair_of(&set.slots, found);
                    }
                    Structure::Trees(trees) => trees.each_pair(found_moved),
                    Structure::SweepAndPrune(sweep) => sweep.each_pair(found_moved),
                    Structure::BruteForce(boxes) => boxes.each_pair(found_moved),
                }
            }
        }
        smallest.finish()
    }

    /// Largest number of pairs of boxes that [`BroadPhase::pairs`] compares.
    pub(crate) fn comparisons(&self, moved: Moved<'_>) -> u64 {
        // A world has fewer than 2^21 boxes, so no product overflows.
        let all = |boxes: &BoxList| (boxes.len() as u64).pow(2) / 2;
        let trees = match &self.structure {
            Structure::Trees(trees) => trees,
            Structure::SweepAndPrune(sweep) => return all(sweep.boxes()),
            Structure::BruteForce(boxes) => return all(boxes),
        };
        let (moving, fixed) = trees.lens();
        match moved {
            Moved::Slots(slots) if slots.len() < moving / 2 => slots.len() as u64 * (moving + fixed) as u64,
            _ => moving as u64 * (moving / 2 + fixed) as u64,
        }
    }

    /// Boxes of the trees' inner nodes with their depths. Empty for broad phases without trees.
    pub(crate) fn inner_boxes(&self) -> Vec<(Aabb, u32)> {
        match &self.structure {
            Structure::Trees(trees) => trees.inner_boxes(),
            Structure::SweepAndPrune(_) | Structure::BruteForce(_) => Vec::new(),
        }
    }

    /// Whether a slot was in the list of the last search with [`Moved::Slots`].
    pub(crate) fn has_moved(&self, slot: u32) -> bool {
        self.moved.has(slot)
    }

    /// Visits every slot whose box overlaps the area, until `visit` breaks.
    pub(crate) fn each_overlap(&self, area: Aabb, visit: impl FnMut(u32) -> ControlFlow<()>) {
        self.search(Overlap { area, visit });
    }

    /// Like [`BroadPhase::each_overlap`], but visits only boxes of fixed bodies (if `fixed`) or only boxes of other
    /// bodies.
    pub(crate) fn each_overlap_of(
        &self,
        fixed: bool,
        area: Aabb,
        mut visit: impl FnMut(u32) -> ControlFlow<()>,
    ) {
        if let Structure::Trees(trees) = &self.structure {
            let _ended_early = trees.search_of(fixed, &mut Overlap { area, visit });
            return;
        }
        self.each_overlap(area, |slot| {
            if self.is_fixed(slot) == fixed { visit(slot) } else { ControlFlow::Continue(()) }
        });
    }

    /// Visits every slot whose box the moving area touches, and perhaps some whose box the area just misses. Nearer
    /// boxes tend to come first. `visit` returns the largest fraction of the translation that is still of interest, and
    /// 0 ends the search.
    pub(crate) fn each_along(&self, area: Aabb, translation: Vec2<Fx>, visit: impl FnMut(u32) -> Unit) {
        self.search(Along::new(area, translation, visit));
    }

    /// Visits every slot whose box is within the radius of the point. Nearer boxes tend to come first. `visit` returns
    /// the radius that is still of interest, and a negative radius ends the search.
    pub(crate) fn each_near(&self, point: Vec2<Fx>, radius: Fx, visit: impl FnMut(u32) -> Fx) {
        self.search(Near { point, radius, visit });
    }

    fn search(&self, mut search: impl Search) {
        let _ended_early = match &self.structure {
            Structure::Trees(trees) => trees.search(&mut search),
            Structure::SweepAndPrune(sweep) => sweep.boxes().search(&mut search),
            Structure::BruteForce(boxes) => boxes.search(&mut search),
        };
    }
}

#[derive(Clone, Debug, Default)]
struct MovedSet {
    slots: Vec<u32>,
    marks: Vec<bool>,
}

impl MovedSet {
    fn replace(&mut self, slots: &[u32]) {
        for &slot in &self.slots {
            self.marks[slot as usize] = false;
        }
        self.slots.clear();
        let end = slots.iter().max().map_or(0, |&last| last as usize + 1);
        self.marks.resize(end.max(self.marks.len()), false);
        let MovedSet { slots: list, marks } = self;
        list.extend(slots.iter().filter(|&&slot| !core::mem::replace(&mut marks[slot as usize], true)));
    }

    fn has(&self, slot: u32) -> bool {
        self.marks.get(slot as usize).is_some_and(|&mark| mark)
    }
}

/// Keeps the smallest pairs in bounded memory. The order in which they are added does not matter.
struct SmallestPairs<'a> {
    pairs: &'a mut Vec<Pair>,
    limit: usize,
    overflowed: bool,
}

impl SmallestPairs<'_> {
    fn push(&mut self, pair: Pair) {
        self.pairs.push(pair);
        // Trims only when the list has twice its limit, so that the cost of a sort is spread over many pushes.
        if self.pairs.len() >= self.limit.saturating_mul(2).max(64) {
            self.trim();
        }
    }

    fn trim(&mut self) {
        self.pairs.sort_unstable();
        self.overflowed |= self.pairs.len() > self.limit;
        self.pairs.truncate(self.limit);
    }

    fn finish(mut self) -> bool {
        self.trim();
        self.overflowed
    }
}
