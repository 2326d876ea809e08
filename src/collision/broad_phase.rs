//! The broad phase: which fat boxes overlap. The pairs are a function of the boxes alone, so that every
//! implementation returns the same sorted list, and the structure behind it is a cache.

use alloc::vec::Vec;

use super::sweep_and_prune::SweepAndPrune;
use crate::math::Aabb;

/// A pair of shape slots, the smaller one first.
pub(crate) type Pair = (u32, u32);

/// A shape slot and its fat box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proxy {
    pub(crate) slot: u32,
    pub(crate) fat: Aabb,
}

/// How overlapping pairs are found. The choice changes how fast, never which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BroadPhaseKind {
    /// Incremental sweep and prune: fast while boxes move little.
    #[default]
    SweepAndPrune,
    /// Every box against every other: the oracle of the rest.
    BruteForce,
}

/// The broad phase in use.
#[derive(Clone, Debug)]
pub(crate) enum BroadPhase {
    SweepAndPrune(SweepAndPrune),
    BruteForce,
}

impl BroadPhase {
    pub(crate) fn new(kind: BroadPhaseKind) -> Self {
        match kind {
            BroadPhaseKind::SweepAndPrune => BroadPhase::SweepAndPrune(SweepAndPrune::default()),
            BroadPhaseKind::BruteForce => BroadPhase::BruteForce,
        }
    }

    /// All pairs of overlapping boxes that `accept` wants, sorted; of more than `limit`, the smallest. Says whether
    /// any were left out. `proxies` are in slot order.
    pub(crate) fn pairs(
        &mut self,
        proxies: &[Proxy],
        accept: impl Fn(Pair) -> bool,
        limit: usize,
        pairs: &mut Vec<Pair>,
    ) -> bool {
        pairs.clear();
        let mut found = SmallestPairs { pairs, limit, overflowed: false };
        let accepted = |pair: Pair| {
            if accept(pair) {
                found.push(pair);
            }
        };
        match self {
            BroadPhase::SweepAndPrune(sweep) => sweep.each_pair(proxies, accepted),
            BroadPhase::BruteForce => each_pair(proxies, accepted),
        }
        found.finish()
    }
}

/// Keeps the smallest pairs in bounded memory, in whatever order they are found.
struct SmallestPairs<'a> {
    pairs: &'a mut Vec<Pair>,
    limit: usize,
    overflowed: bool,
}

impl SmallestPairs<'_> {
    fn push(&mut self, pair: Pair) {
        self.pairs.push(pair);
        // Twice the limit, so that the sort is paid for by as many pushes.
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

/// Brute force.
fn each_pair(proxies: &[Proxy], mut found: impl FnMut(Pair)) {
    for (i, a) in proxies.iter().enumerate() {
        for b in &proxies[i + 1..] {
            if a.fat.overlaps(b.fat) {
                found((a.slot, b.slot));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fx;
    use crate::math::{Rng, Vec2};

    /// Boxes come, go and move; the sweep keeps its order from call to call, brute force has none to keep.
    #[test]
    fn both_find_the_same_pairs_while_boxes_move() {
        let mut rng = Rng::new(3);
        let mut sweep = BroadPhase::new(BroadPhaseKind::SweepAndPrune);
        let mut oracle = BroadPhase::new(BroadPhaseKind::BruteForce);
        let mut boxes: Vec<Option<Aabb>> = alloc::vec![None; 120];
        let (mut found, mut expected, mut total) = (Vec::new(), Vec::new(), 0);
        for round in 0..300 {
            for slot in &mut boxes {
                match (rng.below(20), &slot) {
                    (0, _) => *slot = None,
                    (1, None) => {
                        let lower = Vec2::new(rng.range(fx!(-9), fx!(9)), rng.range(fx!(-30), fx!(30)));
                        let size = Vec2::new(rng.range(fx!(0), fx!(4)), rng.range(fx!(0), fx!(4)));
                        *slot = Some(Aabb::new(lower, lower + size));
                    }
                    (2..8, Some(aabb)) => {
                        let step = Vec2::new(rng.range(fx!(-1), fx!(1)), rng.range(fx!(-1), fx!(1)));
                        *slot = Some(aabb.translated(step));
                    }
                    _ => {}
                }
            }
            let proxies: Vec<Proxy> =
                boxes.iter().zip(0..).filter_map(|(fat, slot)| fat.map(|fat| Proxy { slot, fat })).collect();
            let accept = |(a, b): Pair| (a + b) % 7 != 0;
            let limit = if round % 3 == 0 { 10 } else { 1000 };
            let overflowed = sweep.pairs(&proxies, accept, limit, &mut found);
            assert_eq!(oracle.pairs(&proxies, accept, limit, &mut expected), overflowed);
            assert_eq!(found, expected);
            assert!(found.len() <= limit && found.is_sorted());
            total += found.len();
        }
        assert!(total > 1000, "only {total} pairs");
    }
}
