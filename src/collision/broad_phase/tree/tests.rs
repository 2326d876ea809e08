//! Tests of the tree.

use super::*;
use crate::body::Filter;
use crate::collision::contact::Pair;
use crate::fx;
use crate::math::{Fx, Rng, Vec2};

impl Tree {
    fn cost(&self) -> u64 {
        self.nodes.iter().filter(|node| !node.is_leaf()).map(|node| perimeter(node.aabb) >> 16).sum()
    }

    /// Panics unless the tree is valid. Returns the height.
    fn validate(&self) -> u8 {
        let mut reached = 0;
        let mut stack = Vec::new();
        if self.root != NONE {
            assert_eq!(self.at(self.root).parent, NONE, "the root should have no parent");
            stack.push(self.root);
        }
        while let Some(index) = stack.pop() {
            reached += 1;
            let node = self.at(index);
            if node.is_leaf() {
                assert_eq!(self.leaf_of(node.children[0]), Some(index), "a slot should map to its leaf");
                continue;
            }
            let [a, b] = node.children.map(|child| self.at(child));
            assert!(
                node.aabb.contains(a.aabb.union(b.aabb)),
                "a box should contain the boxes of its children"
            );
            assert!(!node.marked, "marks should be cleared after use");
            assert_eq!(node.class, a.class.common(b.class));
            let is_in_order = node.children.iter().all(|&child| child > index);
            assert!(
                self.relinked > 0 || is_in_order,
                "while no leaf was relinked, parents should come first"
            );
            assert_eq!(node.height, 1 + a.height.max(b.height));
            assert!(a.height.abs_diff(b.height) <= IMBALANCE_MAX, "siblings should be balanced");
            for child in node.children {
                assert_eq!(self.at(child).parent, index, "a child should refer to its parent");
                stack.push(child);
            }
        }
        let leaves = self.leaves.iter().filter(|&&leaf| leaf != NONE).count();
        assert_eq!(leaves, self.len());
        assert_eq!(reached, (2 * leaves).saturating_sub(1), "every leaf should be reachable");
        let mut vacant = 0;
        let mut at = self.vacant;
        while at != NONE {
            vacant += 1;
            at = self.at(at).parent;
        }
        assert_eq!(reached + vacant, self.nodes.len(), "every node should be in use or vacant");
        if self.root == NONE { 0 } else { self.at(self.root).height }
    }

    fn pairs_of(&self, slots: &[u32]) -> Vec<Pair> {
        let present = || (0u32..).zip(&self.leaves).filter(|&(_, &leaf)| leaf != NONE);
        let boxes = || present().map(|(slot, &leaf)| (slot, self.at(leaf).aabb));
        let all = boxes().flat_map(|a| boxes().map(move |b| (a, b)));
        let wanted = all.filter(|&((a, box_a), (b, box_b))| {
            a < b && box_a.overlaps(box_b) && (slots.contains(&a) || slots.contains(&b))
        });
        wanted.map(|((a, _), (b, _))| (a, b)).collect()
    }
}

fn random_class(rng: &mut Rng) -> CollisionClass {
    let group = -i32::try_from(rng.below(3)).expect("a small number");
    Filter { group, ..Filter::default() }.collision_class()
}

fn square(x: Fx, y: Fx, half: Fx) -> Aabb {
    let corner = Vec2::new(x, y);
    Aabb::new(corner, corner).expanded(half)
}

/// In the tree with the fewest leaves for a given height, one child of each node is as high as possible, and the other
/// is as low as the balance allows.
#[test]
fn the_stack_holds_a_search_of_the_highest_tree() {
    let imbalance = IMBALANCE_MAX as usize;
    let mut fewest = alloc::vec![1_u64];
    for height in 1..STACK_LEN - 1 {
        let lower = fewest[(height - 1).saturating_sub(imbalance)];
        fewest.push(fewest[height - 1] + lower);
    }
    let most = fewest[STACK_LEN - 2];
    assert!(
        most > u64::from(u32::MAX) / 2,
        "the stack should hold a tree of 2^31 boxes, but {most} boxes fill it"
    );
}

#[test]
fn it_stays_sound_while_boxes_come_go_and_move() {
    let mut rng = Rng::new(1);
    let mut tree = Tree::default();
    let mut meetings = Meetings::default();
    let mut pairs = 0;
    for round in 0..20_000 {
        let slot = rng.below(100);
        let fat = square(rng.range(fx!(-9), fx!(9)), rng.range(fx!(-9), fx!(9)), rng.range(fx!(0), fx!(1)));
        match rng.below(if round % 2000 < 1000 { 2 } else { 4 }) {
            0 => tree.set(slot, fat),
            _ if round % 50 == 6 => {
                tree.set_collision_class(slot, random_class(&mut rng));
            }
            _ if round % 50 == 7 => {
                let moved = |i: u32| fat.translated(Vec2::new(Fx::from_num(i), fx!(0)));
                tree.set_many((0..20).map(|i| ((slot + 3 * i) % 100, moved(i))));
                assert_eq!(tree.leaf_of(slot).map(|leaf| tree.at(leaf).aabb), Some(fat));
            }
            _ if round == 10_000 => tree.refill((0..50).map(|slot| (slot % 40, fat))),
            _ => tree.remove(slot),
        }
        if round % 5 == 0 {
            let slots: Vec<u32> = (0..rng.below(8)).map(|_| rng.below(120)).collect();
            let mut found = Vec::new();
            slots.iter().for_each(|&slot| tree.mark(slot, true));
            meetings.within(&tree, |node| node.marked, |pair| found.push(pair));
            slots.iter().for_each(|&slot| tree.mark(slot, false));
            found.sort_unstable();
            let class_of = |slot: u32| tree.at(tree.leaves[slot as usize]).class;
            let mut all = tree.pairs_of(&slots);
            all.retain(|&(a, b)| {
                class_of(a).common(class_of(b)) == CollisionClass::NONE
                    || found.binary_search(&(a, b)).is_ok()
            });
            assert_eq!(found, all, "only pairs within one collision class may be left out");
            pairs += found.len();
        }
        tree.validate();
        assert!(tree.leaf_of(slot).is_none_or(|leaf| tree.at(leaf).children[0] == slot));
    }
    (0..100).for_each(|slot| tree.remove(slot));
    assert_eq!((tree.validate(), tree.len(), tree.root), (0, 0, NONE));
    assert!(pairs > 1000, "expected over 1000 pairs, got {pairs}");
}

#[test]
fn orders_that_could_make_a_chain_do_not() {
    let whole = |x: u32| Fx::from_num(x);
    let doubled = |x: u32| Fx::from_bits(1 << (x % 63));
    let cases: [(&str, &dyn Fn(u32) -> Aabb); 7] = [
        ("on top of each other", &|_| square(fx!(3), fx!(4), fx!(1))),
        ("points on top of each other", &|_| square(fx!(3), fx!(4), fx!(0))),
        ("sorted", &|i| square(whole(i), fx!(0), fx!(1))),
        ("sorted backwards", &|i| square(-whole(i), whole(i), fx!(0))),
        ("one inside the other", &|i| square(fx!(0), fx!(0), whole(1000 - i))),
        ("one around the other", &|i| square(fx!(0), fx!(0), whole(i))),
        ("each twice as far as the last", &|i| square(doubled(i), doubled(i / 63), fx!(0))),
    ];
    for (name, fat) in cases {
        let mut tree = Tree::default();
        for slot in 0..1000 {
            tree.set(slot, fat(slot));
        }
        tree.validate();
        for slot in 0..1000 {
            tree.set(slot, fat(slot).translated(Vec2::new(fx!(0), fx!(0.5))));
        }
        tree.validate();
        tree.rebuild();
        assert_eq!(tree.validate(), 10, "{name}: the height after a rebuild should be the logarithm of 1000");
        for slot in 0..999 {
            tree.remove(slot);
        }
        assert_eq!(tree.validate(), 0);
    }
}

/// 10 000 boxes are inserted at random places. The smallest possible height of their tree is 14.
#[test]
fn ordinary_boxes_make_a_low_tree() {
    let mut rng = Rng::new(2);
    let mut tree = Tree::default();
    for slot in 0..10_000 {
        tree.set(slot, square(rng.range(fx!(-300), fx!(300)), rng.range(fx!(0), fx!(60)), fx!(0.5)));
    }
    let height = tree.validate();
    assert!(height <= 24, "the height should be at most 24, not {height}");
}

#[test]
fn many_boxes_at_once_keep_the_tree_sound_and_tight() {
    let mut rng = Rng::new(3);
    let mut tree = Tree::default();
    let place = |rng: &mut Rng| square(rng.range(fx!(-50), fx!(50)), rng.range(fx!(-50), fx!(50)), fx!(0.5));
    let mut boxes: Vec<(u32, Aabb)> = (0..1000).map(|slot| (slot, place(&mut rng))).collect();
    tree.refill(boxes.iter().copied());
    let fresh = tree.cost();
    for round in 0..40 {
        let some = if round % 2 == 0 { boxes.len() } else { 1 << (round / 4) };
        for (_, fat) in &mut boxes[..some] {
            *fat = if round % 4 == 3 { place(&mut rng) } else { fat.translated(Vec2::new(fx!(1), fx!(0))) };
        }
        tree.set_many(boxes[..some].iter().copied());
        (0..30).for_each(|_| tree.set_collision_class(rng.below(1000), random_class(&mut rng)));
        tree.validate();
        // Leaves that have moved away without being relinked may raise the cost until the next refit.
        assert!(
            tree.strays > 0 || tree.cost() < fresh * 3 / 2,
            "round {round}: cost {} of {fresh}",
            tree.cost()
        );
    }
}
