use super::*;
use crate::body::Polygon;
use crate::math::{PI, Rng};

fn pose(x: Fx, y: Fx, angle: Angle) -> RelativePose {
    RelativePose { centre: Vec2::new(x, y), rotation: Rot::from_angle(angle), local_centre: Vec2::ZERO }
}

fn square(half: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::square(half).unwrap())
}

fn close(a: Fx, b: Fx, tolerance: Fx) {
    assert!((a - b).abs() <= tolerance, "expected {b}, got {a}");
}

#[test]
fn a_box_is_cut_at_the_surface() {
    let sea = Ring::of(&square(fx!(10)), &pose(fx!(0), fx!(-10), Angle::ZERO));
    let half = Ring::of(&square(fx!(0.5)), &pose(fx!(1), fx!(0.25), Angle::ZERO)).inside(&sea);
    let extent = half.extent().unwrap();
    close(extent.size, fx!(0.25), fx!(0.0000001));
    close(extent.centre.x, fx!(1), fx!(0.0000001));
    close(extent.centre.y, fx!(-0.125), fx!(0.0000001));
    let above = Ring::of(&square(fx!(0.5)), &pose(fx!(1), fx!(0.75), Angle::ZERO)).inside(&sea);
    assert_eq!(above.extent(), None);
}

/// If the centre of a disc is `h` above the surface of the sea, the part of the disc below the surface has the area
/// `r^2 (acos(h / r) - h / r sqrt(1 - (h / r)^2))`.
#[test]
fn a_disc_is_cut_as_theory_says() {
    let sea = Ring::of(&square(fx!(50)), &pose(fx!(0), fx!(-50), Angle::ZERO));
    let disc = ShapeDef::new(Geometry::circle(fx!(2)).unwrap());
    // acos(1/2) = pi/3, acos(-1/2) = 2 pi / 3
    for (height, angle, sign) in
        [(fx!(1), PI / 3, fx!(-1)), (fx!(-1), PI * 2 / 3, fx!(1)), (fx!(0), PI / 2, fx!(0))]
    {
        let cut = Ring::of(&disc, &pose(fx!(3), height, Angle::ZERO)).inside(&sea).extent().unwrap();
        let expected = (angle + fx_mul(sign, fx!(0.433012701892))) * 4;
        close(cut.size, expected, fx!(0.02));
        close(cut.centre.x, fx!(3), fx!(0.000001));
    }
    let whole = Ring::of(&disc, &pose(fx!(0), fx!(-9), Angle::ZERO)).inside(&sea).extent().unwrap();
    close(whole.size, PI * 4, fx!(0.00001));
}

#[test]
fn the_part_of_a_line_is_a_length() {
    let sea = Ring::of(&square(fx!(10)), &pose(fx!(0), fx!(-10), Angle::ZERO));
    let line = ShapeDef::new(Geometry::segment(Vec2::ZERO, Vec2::new(fx!(0), fx!(4))).unwrap());
    let cut = Ring::of(&line, &pose(fx!(0), fx!(-1), Angle::ZERO)).inside(&sea).extent().unwrap();
    close(cut.size, fx!(1), fx!(0.000001));
    close(cut.centre.y, fx!(-0.5), fx!(0.000001));
}

#[test]
fn neighbouring_areas_divide_a_shape() {
    let mut rng = Rng::new(7);
    for round in 0..20_000 {
        let turn = rng.angle();
        let size = rng.range(fx!(0.01), fx!(3));
        let def = match round % 4 {
            0 => ShapeDef::new(Geometry::circle(size).unwrap()),
            1 => {
                let end = Vec2::new(size, fx!(0));
                ShapeDef::new(Geometry::capsule(-end, end, size / 2).unwrap())
            }
            2 => ShapeDef::new(Polygon::square(size).unwrap().rounded(size / 3).unwrap()),
            _ => ShapeDef::new(Polygon::regular(3 + rng.below(6), size).unwrap()),
        };
        let at = pose(rng.range(fx!(-4), fx!(4)), rng.range(fx!(-4), fx!(4)), turn);
        let whole = Ring::of(&def, &at).extent().unwrap();
        let half = |x: Fx| {
            let half = ShapeDef::new(Polygon::square(fx!(20)).unwrap());
            let half = Ring::of(&half, &pose(x, fx!(0), Angle::ZERO));
            Ring::of(&def, &at).inside(&half).extent()
        };
        let parts = [half(fx!(-20)), half(fx!(20))];
        let sum: Fx = parts.iter().flatten().map(|part| part.size).sum();
        close(sum, whole.size, fx!(0.0000001));
        let moment = |part: &Extent| part.centre.scale(part.size);
        let sum = parts.iter().flatten().map(moment).fold(Vec2::ZERO, |a, b| a + b);
        let expected = moment(&whole);
        close(sum.x, expected.x, fx!(0.000001));
        close(sum.y, expected.y, fx!(0.000001));
    }
}
