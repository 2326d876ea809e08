//! Exchanges of neighbouring nodes.

use super::{IMBALANCE_MAX, Tree, perimeter};

impl Tree {
    /// If one child is too low, exchanges it with the higher child of its sibling.
    pub(super) fn balance(&mut self, at: u32) {
        let [a, b] = self.at(at).children;
        let (low, high) = if self.at(a).height < self.at(b).height { (a, b) } else { (b, a) };
        if self.at(high).height - self.at(low).height > IMBALANCE_MAX {
            let [c, d] = self.at(high).children;
            let up = if self.at(c).height > self.at(d).height { c } else { d };
            self.swap(at, low, high, up);
        }
    }

    /// Exchanges a child of `at` with a child of its sibling, if this shrinks the sibling's box. Of the exchanges that
    /// keep the nodes balanced, chooses the one that shrinks it most. An exchange after which the height of `at` would
    /// differ from `height_before` by more than one is not allowed, because [`Tree::balance`] of an ancestor could not
    /// make up for the difference.
    pub(super) fn tighten(&mut self, at: u32, height_before: u8) {
        let [a, b] = self.at(at).children;
        let (mut best_gain, mut best) = (0, None);
        for (child, sibling) in [(a, b), (b, a)] {
            if self.at(sibling).is_leaf() {
                continue;
            }
            let [c, d] = self.at(sibling).children;
            for (up, stays) in [(c, d), (d, c)] {
                let smaller = self.at(child).aabb.union(self.at(stays).aabb);
                let gain = perimeter(self.at(sibling).aabb).saturating_sub(perimeter(smaller));
                if gain > best_gain && self.stays_balanced([up, child, stays], height_before) {
                    (best_gain, best) = (gain, Some((child, sibling, up)));
                }
            }
        }
        if let Some((child, sibling, up)) = best {
            self.swap(at, child, sibling, up);
        }
    }

    /// Whether a node stays balanced if the first of three nodes becomes its child, and the other two its
    /// grandchildren. Its height must then differ from `height_before` by at most one.
    fn stays_balanced(&self, three: [u32; 3], height_before: u8) -> bool {
        let [up, a, b] = three.map(|index| self.at(index).height);
        let sibling = 1 + a.max(b);
        let height = 1 + up.max(sibling);
        a.abs_diff(b) <= IMBALANCE_MAX
            && up.abs_diff(sibling) <= IMBALANCE_MAX
            && height.abs_diff(height_before) <= 1
    }

    fn swap(&mut self, at: u32, child: u32, sibling: u32, up: u32) {
        self.replace_child(at, child, up);
        self.replace_child(sibling, up, child);
        self.at_mut(up).parent = at;
        self.at_mut(child).parent = sibling;
        self.refit(sibling);
        self.refit(at);
    }
}
