use super::*;
use crate::fx;
use crate::math::{Angle, Rot, narrow};

fn is_wedged(degrees: i64) -> bool {
    let rotation = Rot::from_angle(Angle::from_turns(fx!(1) * degrees / 360));
    let mut prospect = Prospect::default();
    prospect.add(Prospect::IMPACT);
    prospect.add_wall(Vec2::new(narrow(fx!(0)), narrow(fx!(1))));
    assert!(!prospect.is_wedged(), "a single wall");
    prospect.add_wall(rotation.apply(Vec2::new(narrow(fx!(0)), narrow(fx!(1)))));
    prospect.is_wedged()
}

#[test]
fn tiles_of_a_floor_are_no_wedge_but_the_walls_of_a_groove_are() {
    assert_eq!([0, 10, 59, 61, 90, 150, 170].map(is_wedged), [false, false, false, true, true, true, true]);
}
