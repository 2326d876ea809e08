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

    /// All pairs of overlapping boxes that `accept` wants, sorted. `proxies` are in slot order.
    pub(crate) fn pairs(&mut self, proxies: &[Proxy], accept: impl Fn(Pair) -> bool, pairs: &mut Vec<Pair>) {
        pairs.clear();
        match self {
            BroadPhase::SweepAndPrune(sweep) => sweep.pairs(proxies, accept, pairs),
            BroadPhase::BruteForce => brute_force(proxies, accept, pairs),
        }
        pairs.sort_unstable();
    }
}

fn brute_force(proxies: &[Proxy], accept: impl Fn(Pair) -> bool, pairs: &mut Vec<Pair>) {
    for (i, a) in proxies.iter().enumerate() {
        for b in &proxies[i + 1..] {
            if a.fat.overlaps(b.fat) && accept((a.slot, b.slot)) {
                pairs.push((a.slot, b.slot));
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
        for _ in 0..300 {
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
            sweep.pairs(&proxies, accept, &mut found);
            oracle.pairs(&proxies, accept, &mut expected);
            assert_eq!(found, expected);
            total += found.len();
        }
        assert!(total > 1000, "only {total} pairs");
    }
}
