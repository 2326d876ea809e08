//! Compares the kinds of broad phase with each other, and their queries with exact arithmetic.

use super::*;
use crate::body::Filter;
use crate::fx;
use crate::math::Rng;
use alloc::vec;

const KINDS: [BroadPhaseKind; 3] =
    [BroadPhaseKind::Tree, BroadPhaseKind::SweepAndPrune, BroadPhaseKind::BruteForce];

/// A random multiple of 2^16 units of the last place, so that the oracle's products fit 128 bits.
fn random_fx(rng: &mut Rng, half: i64) -> Fx {
    let step = 1 << 16;
    let range = (Fx::from_bits(-(half / step)), Fx::from_bits(half / step));
    Fx::from_bits(rng.range(range.0, range.1).to_bits() * step)
}

fn random_vector(rng: &mut Rng, half: i64) -> Vec2<Fx> {
    Vec2::new(random_fx(rng, half), random_fx(rng, half))
}

fn random_box(rng: &mut Rng, world: i64) -> Aabb {
    let corner = random_vector(rng, world);
    let size = match rng.below(8) {
        0 => 0,
        1 => world,
        _ => world / 16,
    };
    Aabb::new(corner, corner).union(Aabb::new(corner, corner).translated(random_vector(rng, size)))
}

/// Half the size of each world in units of the last place. The last world fills the number range.
const WORLDS: [i64; 3] = [8 << 32, 1 << 62, i64::MAX];

fn random_class(rng: &mut Rng, count: u32) -> CollisionClass {
    let group = -i32::try_from(rng.below(count + 1)).expect("a small number");
    Filter { group, ..Filter::default() }.collision_class()
}

struct Crowd {
    boxes: Vec<Option<Aabb>>,
    class: Vec<CollisionClass>,
    fixed: Vec<bool>,
    kinds: Vec<BroadPhase>,
}

impl Crowd {
    fn new(slots: usize) -> Self {
        Crowd {
            boxes: vec![None; slots],
            class: vec![CollisionClass::NONE; slots],
            fixed: vec![false; slots],
            kinds: KINDS.map(BroadPhase::new).into(),
        }
    }

    fn random(rng: &mut Rng, slots: usize, world: i64) -> Self {
        let mut crowd = Crowd::new(slots);
        for slot in 0..slots {
            if rng.below(5) > 0 {
                crowd.put(slot, random_box(rng, world), rng.below(3) == 0);
            }
        }
        crowd
    }

    fn set(&mut self, slot: usize, fat: Aabb) {
        self.put(slot, fat, self.fixed[slot]);
    }

    fn put(&mut self, slot: usize, fat: Aabb, fixed: bool) {
        let is_new = self.boxes[slot].is_none() || self.fixed[slot] != fixed;
        (self.boxes[slot], self.fixed[slot]) = (Some(fat), fixed);
        for kind in &mut self.kinds {
            match u32::try_from(slot).expect("a small number") {
                slot if is_new => kind.put(slot, fat, fixed),
                slot => kind.set(slot, fat),
            }
        }
    }

    fn set_many(&mut self, many: &[(u32, Aabb)]) {
        many.iter().for_each(|&(slot, fat)| self.boxes[slot as usize] = Some(fat));
        self.kinds.iter_mut().for_each(|kind| kind.set_many(many));
    }

    fn set_collision_class(&mut self, slot: usize, class: CollisionClass) {
        self.class[slot] = class;
        self.kinds
            .iter_mut()
            .for_each(|kind| kind.set_collision_class(u32::try_from(slot).expect("a small number"), class));
    }

    fn remove(&mut self, slot: usize) {
        (self.boxes[slot], self.class[slot]) = (None, CollisionClass::NONE);
        self.kinds.iter_mut().for_each(|kind| kind.remove(u32::try_from(slot).expect("a small number")));
    }

    fn refill(&mut self) {
        let boxes: Vec<_> =
            self.occupied().map(|(slot, fat)| (slot, fat, self.fixed[slot as usize])).collect();
        self.class.fill(CollisionClass::NONE);
        self.kinds.iter_mut().for_each(|kind| kind.refill(boxes.iter().copied()));
    }

    fn occupied(&self) -> impl Iterator<Item = (u32, Aabb)> + Clone {
        (0..).zip(&self.boxes).filter_map(|(slot, fat)| fat.map(|fat| (slot, fat)))
    }

    fn slots_where(&self, wanted: impl Fn(Aabb) -> bool) -> Vec<u32> {
        self.occupied().filter(|&(_, fat)| wanted(fat)).map(|(slot, _)| slot).collect()
    }

    fn pairs(&self, moved: Moved<'_>, accept: impl Fn(Pair) -> bool) -> Vec<Pair> {
        let has_moved = |slot| match moved {
            Moved::All => true,
            Moved::Slots(slots) => slots.contains(&slot),
        };
        let all = self.occupied().flat_map(|a| self.occupied().map(move |b| (a, b)));
        let wanted = all.filter(|&((a, box_a), (b, box_b))| {
            a < b && box_a.overlaps(box_b) && (has_moved(a) || has_moved(b)) && accept((a, b))
        });
        wanted.map(|((a, _), (b, _))| (a, b)).collect()
    }
}

#[test]
fn all_kinds_find_the_same_pairs_while_boxes_move() {
    let mut rng = Rng::new(3);
    let mut crowd = Crowd::new(120);
    let (mut found, mut total) = (Vec::new(), 0);
    for round in 0..300 {
        let mut moved = Vec::new();
        for slot in 0..crowd.boxes.len() {
            match (rng.below(20), crowd.boxes[slot]) {
                (0, _) => crowd.remove(slot),
                (1, None) => {
                    let lower = Vec2::new(rng.range(fx!(-9), fx!(9)), rng.range(fx!(-30), fx!(30)));
                    let size = Vec2::new(rng.range(fx!(0), fx!(4)), rng.range(fx!(0), fx!(4)));
                    crowd.put(slot, Aabb::new(lower, lower + size), rng.below(3) == 0);
                }
                (2..8, Some(fat)) => {
                    crowd.set(slot, fat.translated(random_vector(&mut rng, 1 << 32)));
                }
                (19, Some(fat)) if rng.below(4) == 0 => crowd.put(slot, fat, !crowd.fixed[slot]),
                (8, Some(_)) => crowd.set_collision_class(slot, random_class(&mut rng, 3)),
                (9..19, Some(_)) if round % 10 == 0 => {
                    crowd.set_collision_class(slot, random_class(&mut rng, 1 + u32::from(round > 150)));
                }
                _ => {}
            }
            // Even rounds move few boxes, so that the tree marks their slots. Odd rounds move many boxes.
            if rng.below(if round % 2 == 0 { 40 } else { 4 }) == 0 {
                moved.extend([rng.below(150), rng.below(150)]);
                moved.push(moved[0]);
            }
        }
        if round % 50 == 49 {
            crowd.refill();
        }
        let share = rng.below(8);
        let many: Vec<_> = crowd.occupied().filter(|_| rng.below(8) < share).collect();
        let shift = random_vector(&mut rng, 1 << 32);
        let many: Vec<_> = many.into_iter().map(|(slot, fat)| (slot, fat.translated(shift))).collect();
        crowd.set_many(&many);
        for (slot, fat) in (0..).zip(&crowd.boxes) {
            let expected = fat.unwrap_or(Aabb::NOWHERE);
            assert!(crowd.kinds.iter().all(|kind| kind.fat(slot) == expected));
        }
        let accept = |(a, b): Pair| {
            assert!(a < b);
            (a + b) % 7 != 0
                && !(crowd.fixed[a as usize] && crowd.fixed[b as usize])
                && crowd.class[a as usize].common(crowd.class[b as usize]) == CollisionClass::NONE
        };
        let limit = if round % 3 == 0 { 10 } else { 1000 };
        for moved in [Moved::All, Moved::Slots(&moved), Moved::Slots(&[])] {
            let mut expected = crowd.pairs(moved, accept);
            let left_out = expected.len() > limit;
            expected.truncate(limit);
            for kind in &mut crowd.kinds {
                assert_eq!(kind.pairs(moved, accept, limit, &mut found), left_out);
                assert_eq!(found, expected, "{:?}", kind.kind());
            }
            total += expected.len();
        }
    }
    assert!(total > 3000, "expected over 3000 pairs, got {total}");
}

#[test]
fn pairs_beyond_the_limit_take_no_memory() {
    let mut crowd = Crowd::new(400);
    (0..400).for_each(|slot| crowd.set(slot, Aabb::default()));
    for kind in &mut crowd.kinds {
        let mut found = Vec::new();
        assert!(kind.pairs(Moved::All, |_| true, 100, &mut found));
        assert_eq!(found, (1..=100).map(|b| (0, b)).collect::<Vec<Pair>>());
        assert!(found.capacity() < 1000, "expected a capacity below 1000 pairs, got {}", found.capacity());
    }
}

#[test]
fn overlaps_are_those_of_every_box() {
    let mut rng = Rng::new(4);
    for world in WORLDS {
        let crowd = Crowd::random(&mut rng, 300, world);
        for _ in 0..200 {
            let area = random_box(&mut rng, world);
            let expected = crowd.slots_where(|fat| fat.overlaps(area));
            for kind in &crowd.kinds {
                let mut found = Vec::new();
                kind.each_overlap(area, |slot| {
                    found.push(slot);
                    ControlFlow::Continue(())
                });
                found.sort_unstable();
                assert_eq!(found, expected, "{:?}", kind.kind());

                for fixed in [true, false] {
                    found.clear();
                    kind.each_overlap_of(fixed, area, |slot| {
                        found.push(slot);
                        ControlFlow::Continue(())
                    });
                    found.sort_unstable();
                    let slots = expected.iter().filter(|&&slot| crowd.fixed[slot as usize] == fixed);
                    assert!(slots.eq(&found), "{:?}", kind.kind());
                }

                let mut visits = 0;
                kind.each_overlap(area, |_| {
                    visits += 1;
                    ControlFlow::Break(())
                });
                assert_eq!(visits, expected.len().min(1));
            }
        }
    }
}

/// Fraction `n / d` with `d > 0` at which the moving area first touches the box. Values are in units of 2^-16 m, so
/// that the product of two fits 128 bits.
fn first_touch(area: Aabb, translation: Vec2<Fx>, fat: Aabb) -> Option<(i128, i128)> {
    let bits = |x: Fx| i128::from(x.to_bits() >> 16);
    let mut start = (0, 1);
    let mut end = (1, 1);
    let less = |a: (i128, i128), b: (i128, i128)| a.0 * b.1 < b.0 * a.1;
    for (low, high, way, box_low, box_high) in [
        (area.lower.x, area.upper.x, translation.x, fat.lower.x, fat.upper.x),
        (area.lower.y, area.upper.y, translation.y, fat.lower.y, fat.upper.y),
    ] {
        let (near, far) = (bits(box_low) - bits(high), bits(box_high) - bits(low));
        let way = bits(way);
        if way == 0 {
            if near > 0 || far < 0 {
                return None;
            }
            continue;
        }
        let (enter, leave) = if way > 0 { ((near, way), (far, way)) } else { ((-far, -way), (-near, -way)) };
        start = if less(start, enter) { enter } else { start };
        end = if less(leave, end) { leave } else { end };
    }
    (!less(end, start)).then_some(start)
}

#[test]
fn a_moving_area_misses_nothing_on_its_way() {
    let mut rng = Rng::new(5);
    let (mut hits, mut visits) = (0, 0);
    for world in WORLDS {
        let crowd = Crowd::random(&mut rng, 300, world);
        for round in 0..300 {
            let area = random_box(&mut rng, world);
            let area = if round % 2 == 0 { Aabb::new(area.lower, area.lower) } else { area };
            let mut translation = random_vector(&mut rng, world);
            match round % 10 {
                0 => translation.x = Fx::ZERO,
                1 => translation.y = Fx::ZERO,
                2 => translation = Vec2::ZERO,
                _ => {}
            }
            let touched = crowd.slots_where(|fat| first_touch(area, translation, fat).is_some());
            for kind in &crowd.kinds {
                let mut found = Vec::new();
                kind.each_along(area, translation, |slot| {
                    found.push(slot);
                    Unit::ONE
                });
                found.sort_unstable();
                assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "each slot should be visited once");
                assert!(touched.iter().all(|slot| found.binary_search(slot).is_ok()), "{:?}", kind.kind());
                hits += touched.len();
                visits += found.len();
            }
        }
    }
    assert!(
        hits > 1000 && visits < hits + hits / 100,
        "expected few visits beyond {hits} hits, got {visits}"
    );
}

#[test]
fn the_closest_hit_is_found_while_the_way_shrinks() {
    let mut rng = Rng::new(6);
    let (mut all, mut visits) = (0, 0);
    for world in WORLDS {
        let crowd = Crowd::random(&mut rng, 300, world);
        for _ in 0..200 {
            let area = Aabb::from_points([random_vector(&mut rng, world)]).expect("a point");
            let translation = random_vector(&mut rng, world);
            // Rounds up to the next unit, so that the search does not cut off a hit.
            let fraction_of = |fat: Aabb| {
                let (n, d) = first_touch(area, translation, fat)?;
                let bits = (n << Unit::FRAC_NBITS).div_euclid(d) + 1;
                Some(Unit::from_bits(i32::try_from(bits).expect("at most 1")).min(Unit::ONE))
            };
            let expected = crowd.occupied().filter_map(|(_, fat)| fraction_of(fat)).min();
            for kind in &crowd.kinds {
                let mut best = None;
                kind.each_along(area, translation, |slot| {
                    let fat = crowd.boxes[slot as usize].expect("occupied");
                    visits += usize::from(kind.kind() == BroadPhaseKind::Tree);
                    best = best.into_iter().chain(fraction_of(fat)).min();
                    best.unwrap_or(Unit::ONE)
                });
                assert_eq!(best, expected, "{:?}", kind.kind());

                let mut visits_when_stopped = 0;
                kind.each_along(area, translation, |_| {
                    visits_when_stopped += 1;
                    Unit::ZERO
                });
                assert!(visits_when_stopped <= 1);
            }
            all += crowd.slots_where(|fat| fraction_of(fat).is_some()).len();
        }
    }
    assert!(visits < all / 2, "expected under half of {all} boxes to be visited, got {visits} visits");
}

#[test]
fn what_is_near_is_found_while_the_radius_shrinks() {
    let mut rng = Rng::new(7);
    let distance = |point: Vec2<Fx>, fat: Aabb| {
        let nearest = point.max(fat.lower).min(fat.upper);
        let axis = |a: Fx, b: Fx| u128::from(a.to_bits().abs_diff(b.to_bits()) >> 1);
        let (x, y) = (axis(point.x, nearest.x), axis(point.y, nearest.y));
        // The root is in units of 2^-31 m, because squares in finer units would not fit 128 bits. It is rounded up.
        let root = (x * x + y * y).isqrt() + 1;
        Fx::from_bits(i64::try_from(root.saturating_mul(2)).unwrap_or(i64::MAX))
    };
    for world in WORLDS {
        let crowd = Crowd::random(&mut rng, 300, world);
        for round in 0..200 {
            let point = random_vector(&mut rng, world);
            let radius = if round % 3 == 0 { Fx::MAX } else { random_fx(&mut rng, world) };
            let within = crowd.slots_where(|fat| distance(point, fat) <= radius);
            let nearest = crowd.occupied().map(|(_, fat)| distance(point, fat)).min();
            for kind in &crowd.kinds {
                let mut found = Vec::new();
                kind.each_near(point, radius, |slot| {
                    found.push(slot);
                    radius
                });
                found.sort_unstable();
                assert!(radius >= Fx::ZERO || found.is_empty());
                assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "each slot should be visited once");
                assert!(within.iter().all(|slot| found.binary_search(slot).is_ok()), "{:?}", kind.kind());
                let far = |&slot: &u32| {
                    let fat = crowd.boxes[slot as usize].expect("occupied");
                    distance(point, fat) > radius.saturating_add(Fx::from_bits(8))
                };
                assert!(!found.iter().any(far));

                let mut best = Fx::MAX;
                kind.each_near(point, Fx::MAX, |slot| {
                    best = best.min(distance(point, crowd.boxes[slot as usize].expect("occupied")));
                    best
                });
                assert_eq!(Some(best), nearest, "{:?}", kind.kind());
            }
        }
    }
}
