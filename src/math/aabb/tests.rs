//! The tests compare relations between boxes with relations between the sets of grid points that the boxes contain.

use super::*;
use crate::fx;
use crate::math::Rng;

fn point(x: u32, y: u32) -> Vec2<Fx> {
    Vec2::new(Fx::from_num(x), Fx::from_num(y))
}

fn grid() -> impl Iterator<Item = Vec2<Fx>> {
    (0..8).flat_map(|x| (0..8).map(move |y| point(x, y)))
}

fn draw(rng: &mut Rng) -> Aabb {
    let points = [(); 2].map(|()| point(rng.below(8), rng.below(8)));
    Aabb::from_points(points).expect("two points")
}

#[test]
fn relations_follow_from_their_points() {
    let mut rng = Rng::new(1);
    for _ in 0..3000 {
        let (a, b) = (draw(&mut rng), draw(&mut rng));
        let union = a.union(b);
        assert!(a.is_valid() && union.is_valid());
        let shared = grid().any(|p| a.contains_point(p) && b.contains_point(p));
        assert_eq!(a.overlaps(b), shared, "{a:?} {b:?}");
        let inside = grid().filter(|&p| b.contains_point(p)).all(|p| a.contains_point(p));
        assert_eq!(a.contains(b), inside, "{a:?} {b:?}");
        assert!(union.contains(a) && union.contains(b));
        assert!([a, b].iter().any(|part| part.lower.x == union.lower.x));

        let offset = b.lower - a.upper;
        let swept = a.swept(offset);
        assert_eq!(swept, a.union(a.translated(offset)));
        assert_eq!(swept.centre() + swept.extents(), swept.upper);
    }
}

#[test]
fn centre_and_extents_cover_odd_boxes() {
    let unit = Fx::DELTA;
    for (lower, upper) in [(fx!(0), unit), (-unit, fx!(0)), (fx!(-1), unit), (Fx::MIN, -unit)] {
        let aabb = Aabb::new(Vec2::new(lower, lower), Vec2::new(upper, upper));
        let (centre, extents) = (aabb.centre(), aabb.extents());
        assert!(Aabb::new(centre - extents, centre + extents).contains(aabb), "{aabb:?}");
    }
}

#[test]
fn the_edge_of_the_world_saturates() {
    let all = Aabb::new(Vec2::new(Fx::MIN, Fx::MIN), Vec2::new(Fx::MAX, Fx::MAX));
    assert_eq!(all.expanded(fx!(1)), all);
    assert_eq!(all.extents(), Vec2::new(Fx::MAX, Fx::MAX));
    assert_eq!(all.swept(Vec2::new(Fx::MIN, Fx::MAX)), all);
    assert!(all.translated(Vec2::new(Fx::MAX, Fx::MIN)).is_valid());
    assert!(!Aabb::default().expanded(fx!(-1)).is_valid());
    assert_eq!(Aabb::from_points([]), None);
}
