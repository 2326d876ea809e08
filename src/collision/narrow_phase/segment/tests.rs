use super::*;
use crate::math::Length;

#[test]
fn a_long_segment_is_cut_on_its_own_line() {
    let a = Vec2::new(fx!(-1000000000), fx!(-500000000));
    let b = Vec2::new(fx!(1000000000), fx!(500000000));
    let hull = near_hull(a, b, Vec2::ZERO).unwrap();
    let expected = [Vec2::new(-200, -100), Vec2::new(200, 100)]
        .map(|v| Vec2::new(Length::from_num(v.x), Length::from_num(v.y)));
    assert_eq!(hull.vertices(), expected);
}

#[test]
fn a_short_segment_is_kept_and_a_distant_one_dropped() {
    let near = near_hull(Vec2::new(fx!(1), fx!(2)), Vec2::new(fx!(3), fx!(2)), Vec2::ZERO).unwrap();
    assert_eq!(near.vertices()[1].x, Length::from_num(3));
    assert!(near_hull(Vec2::new(fx!(-900), fx!(201)), Vec2::new(fx!(900), fx!(201)), Vec2::ZERO).is_none());
}
