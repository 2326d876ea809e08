use alloc::vec::Vec;

/// Disjoint sets of body slots (R. Tarjan, "Efficiency of a Good But Not Linear Set Union Algorithm", 1975). The root
/// is the smallest slot, so that the result does not depend on the order of unions.
#[derive(Clone, Debug, Default)]
pub(crate) struct UnionFind {
    parents: Vec<u32>,
    stays_awake: Vec<bool>,
}

impl UnionFind {
    /// Makes each slot a set of its own. Slots must be below `slot_count`.
    pub(crate) fn reset(&mut self, slots: &[u32], slot_count: usize) {
        self.parents.resize(slot_count, 0);
        self.stays_awake.resize(slot_count, false);
        for &slot in slots {
            self.parents[slot as usize] = slot;
            self.stays_awake[slot as usize] = false;
        }
    }

    /// The smallest slot of the set that contains `slot`. Shortens the path to it (path halving).
    pub(crate) fn root(&mut self, mut slot: u32) -> u32 {
        while self.parents[slot as usize] != slot {
            let grandparent = self.parents[self.parents[slot as usize] as usize];
            self.parents[slot as usize] = grandparent;
            slot = grandparent;
        }
        slot
    }

    pub(crate) fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    pub(crate) fn keep_awake(&mut self, slot: u32) {
        let root = self.root(slot);
        self.stays_awake[root as usize] = true;
    }

    pub(crate) fn stays_awake(&self, root: u32) -> bool {
        self.stays_awake[root as usize]
    }
}
