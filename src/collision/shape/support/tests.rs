use super::*;
use crate::body::{Body, BodyDef, Geometry, MassProperties, Polygon, ShapeDef};
use crate::math::Angle;

fn support_of(geometry: Geometry, origin: Vec2<Fx>) -> SupportShape {
    let def = BodyDef::fixed().position((fx!(1000000003), fx!(-7))).angle(Angle::QUARTER);
    let body = Body::new(&def, MassProperties::immovable());
    SupportShape::of(&PosedShape::new(&ShapeDef::new(geometry), &body, body.rotation()), origin)
}

#[test]
fn shapes_become_points_and_a_radius() {
    let origin = Vec2::new(fx!(1000000000), fx!(-7));
    let point = |x, y| to_grid(Vec2::new(x, y));
    let disc = support_of(Geometry::circle(fx!(2)).unwrap(), origin);
    assert_eq!((disc.points(), disc.radius), (&[point(fx!(3), fx!(0))][..], Grid::from_num(2)));
    let ends = [Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(4), fx!(0))];
    let segment = support_of(Geometry::segment(ends[0], ends[1]).unwrap(), origin);
    assert_eq!(segment.points(), [point(fx!(3), fx!(0)), point(fx!(3), fx!(4))]);
    let rounded = Polygon::rectangle(fx!(2), fx!(1)).unwrap().rounded(fx!(0.5)).unwrap();
    let polygon = support_of(rounded.into(), origin);
    assert_eq!((polygon.points().len(), polygon.radius), (4, Grid::from_num(0.5)));
    assert_eq!(polygon.points()[0], point(fx!(4), fx!(-2)));
    assert_eq!(edges(polygon.points()).count(), 4);
    assert_eq!((edges(segment.points()).count(), edges(disc.points()).count()), (2, 0));
}

#[test]
fn fractions_find_points_across_the_world() {
    let end = to_grid(Vec2::new(fx!(2147483647), fx!(-2147483647)));
    let near = to_grid(Vec2::new(fx!(1234567.5), fx!(-1234567.5)));
    let fraction = Fraction::ratio(dot(near, end), dot(end, end));
    let apart = fraction.of(end) - near;
    assert!(
        apart.x.abs().to_bits() <= 1 && apart.y.abs().to_bits() <= 1,
        "the error should be at most 1 unit, not {apart:?}"
    );
    assert_eq!(Fraction::ratio(5, 5).to_fx(), Fx::ONE);
    assert_eq!(Fraction::ratio(0, 5).of(end), Vec2::ZERO);
}
