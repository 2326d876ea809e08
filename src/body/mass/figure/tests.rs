//! Expected values come from formulas, from polygons with thousands of vertices, or from counted grid points.

use alloc::vec::Vec;

use super::*;
use crate::body::Polygon;
use crate::fx;
use crate::math::{PI, Rng, Rot};

const ONE: i128 = 1 << 44;

fn figure(polygon: &Polygon) -> Figure {
    Figure::of_polygon(polygon.vertices()).rounded(polygon.vertices(), polygon.radius())
}

/// Asserts that the error of `actual` is at most `expected / parts`.
fn close(actual: i128, expected: i128, parts: i128) {
    let error = (actual - expected).abs();
    assert!(error * parts <= expected.abs(), "expected {expected} to 1 in {parts}, got {actual}");
}

fn near(actual: (i128, i128), expected: (i128, i128), tolerance: Fx) {
    let error = (actual.0 - expected.0).abs().max((actual.1 - expected.1).abs());
    assert!(error <= i128::from(tolerance.to_bits()), "expected {expected:?}, got {actual:?}");
}

fn vertex(x: Fx, y: Fx) -> Vec2<Fx> {
    Vec2::new(x, y)
}

fn random_rounded_hull(rng: &mut Rng, extent: Fx) -> Option<Polygon> {
    let points: Vec<_> = (0..rng.below(6) + 3)
        .map(|_| vertex(rng.range(-extent, extent), rng.range(-extent, extent)))
        .collect();
    Polygon::hull(&points).ok()?.rounded(rng.range(fx!(0.002), extent)).ok()
}

/// Returns `(2 A, k²)` of a rectangle with half extents `a` and `b`, rounded by `r`. The arguments are in units of
/// `unit`, and the results in m² with 44 fraction bits.
fn rounded_rectangle(a: i128, b: i128, r: i128, unit: Fx) -> (i128, i128) {
    const PI_NUMERATOR: i128 = 1_068_966_896;
    const PI_DENOMINATOR: i128 = 340_262_731;
    // All terms are numerators over the common denominator `over`. `pi` is the numerator of pi.
    let (over, pi) = (12 * PI_DENOMINATOR, 12 * PI_NUMERATOR);
    let area = over * (4 * a * b + 4 * (a + b) * r) + pi * r * r;
    let core = over / 3 * 4 * a * b * (a * a + b * b);
    let pair = |along: i128, across: i128| {
        let squares = 4 * along * along + r * r + 3 * (2 * across + r) * (2 * across + r);
        over / 12 * 4 * along * r * squares
    };
    let quarters = pi * r * r * (a * a + b * b) + over / 3 * 8 * r * r * r * (a + b) + pi / 2 * r * r * r * r;
    let moment = core + pair(a, b) + pair(b, a) + quarters;
    let square = i128::from(unit.to_bits()).pow(2) >> 20;
    (div_round(2 * area * square, over), div_round(moment * square, area))
}

#[test]
fn a_rounded_rectangle_is_that_of_the_formula() {
    for (a, b, r) in
        [(1, 1, 1), (2, 100, 1), (40, 1, 4), (1, 1, 50), (300, 200, 3), (700, 10, 100), (800, 800, 80)]
    {
        // An eighth of a metre, and about 2 mm: both exact in `Length`.
        for unit in [fx!(0.125), fx!(0.001953125)] {
            let of = |n: i128| Fx::from_bits(unit.to_bits() * i64::try_from(n).unwrap());
            let polygon = Polygon::rectangle(of(a), of(b)).unwrap().rounded(of(r)).unwrap();
            let (doubled_area, gyration_squared) = rounded_rectangle(a, b, r, unit);
            let actual = figure(&polygon);
            close(actual.doubled_area, doubled_area, 10_000_000);
            close(actual.gyration_squared, gyration_squared, 10_000_000);
            assert_eq!(actual.centre, (0, 0));
        }
    }
}

#[test]
fn without_a_radius_the_polygon_is_bit_for_bit_the_same() {
    let mut rng = Rng::new(1);
    for _ in 0..500 {
        let Some(polygon) = random_rounded_hull(&mut rng, fx!(50)) else { continue };
        let core = Figure::of_polygon(polygon.vertices());
        assert_eq!(core.rounded(polygon.vertices(), Length::ZERO), core);
    }
}

#[test]
fn a_triangle_in_a_large_radius_is_nearly_a_disc() {
    let points = [vertex(fx!(0), fx!(0)), vertex(fx!(0.001), fx!(0)), vertex(fx!(0), fx!(0.001))];
    let triangle = Polygon::new(&points).unwrap().rounded(fx!(100)).unwrap();
    let actual = figure(&triangle);
    // The core has a perimeter of 3.4 mm, which adds 0.34 m² to the 31416 m² of the disc.
    close(actual.doubled_area, i128::from(PI.to_bits() * 20000) << 12, 50_000);
    close(actual.gyration_squared, 5000 * ONE, 50_000);
    near(actual.centre, (0, 0), fx!(0.001));
}

#[test]
fn the_arcs_of_all_corners_make_one_turn() {
    let mut rng = Rng::new(2);
    for _ in 0..500 {
        let Some(polygon) = random_rounded_hull(&mut rng, fx!(5)) else { continue };
        let vertices = polygon.vertices();
        let count = vertices.len();
        let turns: i64 = (0..count)
            .map(|i| {
                let (before, after) = (vertices[(i + count - 1) % count], vertices[(i + 1) % count]);
                i64::from(turn_between(vertices[i] - before, after - vertices[i]).to_bits())
            })
            .sum();
        assert!((turns - (1 << 32)).abs() <= 8, "the turns should sum to 2^32, not {turns}");
    }
}

#[test]
fn symmetric_shapes_keep_their_centre() {
    for count in [4, 6, 8] {
        let polygon = Polygon::regular(count, fx!(0.75)).unwrap().rounded(fx!(0.25)).unwrap();
        // The vertices themselves are rounded to 2.4e-7 m.
        near(figure(&polygon).centre, (0, 0), fx!(0.0000002));
    }
    for offset in [fx!(0.5), fx!(-60)] {
        let square = Polygon::square(fx!(0.25)).unwrap().rounded(fx!(0.1)).unwrap();
        let moved = figure(&square.translated(vertex(offset, fx!(3))).unwrap());
        assert_eq!(moved.centre, (offset.to_bits().into(), fx!(3).to_bits().into()));
        assert_eq!(moved.doubled_area, figure(&square).doubled_area);
        assert_eq!(moved.gyration_squared, figure(&square).gyration_squared);
    }
    let points = [vertex(fx!(0), fx!(0)), vertex(fx!(2), fx!(0)), vertex(fx!(0), fx!(2))];
    let (x, y) = figure(&Polygon::new(&points).unwrap().rounded(fx!(0.3)).unwrap()).centre;
    assert!((x - y).abs() <= 1, "the coordinates of the centre should be equal: {x} {y}");
}

/// The outline, with at least 4096 chords per turn of its arcs. The relative error of a sector's area is at most 4e-7.
fn fine_outline(polygon: &Polygon) -> Vec<Vec2<Length>> {
    let (vertices, normals) = (polygon.vertices(), polygon.normals());
    let count = vertices.len();
    let mut outline = Vec::new();
    for i in 0..count {
        let [from, to] =
            [normals[(i + count - 1) % count], normals[i]].map(|normal| Angle::of(normal.widen()));
        let turn = u64::from((to - from).to_bits());
        let chords = (turn >> 20) + 1;
        for step in 0..=chords {
            let angle = from + Angle::from_bits(u32::try_from(turn * step / chords).unwrap());
            let spoke = Rot::from_angle(angle).apply_wide(vertex(polygon.radius().into(), Fx::ZERO));
            outline.push((vertices[i].widen() + spoke).narrow());
        }
    }
    outline
}

#[test]
fn a_polygon_along_the_outline_has_the_same_mass() {
    let mut rng = Rng::new(3);
    let mut compared = 0;
    for round in 0..300 {
        let extent = [fx!(5), fx!(15), fx!(50)][round % 3];
        let Some(polygon) = random_rounded_hull(&mut rng, extent) else { continue };
        compared += 1;
        let (actual, expected) = (figure(&polygon), Figure::of_polygon(&fine_outline(&polygon)));
        close(actual.doubled_area, expected.doubled_area, 1_000_000);
        close(actual.gyration_squared, expected.gyration_squared, 1_000_000);
        near(actual.centre, expected.centre, fx_mul(extent, fx!(0.000001)));
    }
    assert!(compared > 250, "expected over 250 hulls, got {compared}");
}

/// Whether a point is in the polygon. Coordinates are in units of 2^-22 m.
fn contains(polygon: &Polygon, (x, y): (i128, i128)) -> bool {
    let vertices = polygon.vertices();
    let r = i128::from(polygon.radius().to_bits());
    let mut in_core = true;
    for (i, start) in vertices.iter().enumerate() {
        let end = vertices[(i + 1) % vertices.len()];
        let (ex, ey) = (i128::from((end.x - start.x).to_bits()), i128::from((end.y - start.y).to_bits()));
        let (px, py) = (x - i128::from(start.x.to_bits()), y - i128::from(start.y.to_bits()));
        let (dot, cross, square) = (ex * px + ey * py, ex * py - ey * px, ex * ex + ey * ey);
        let beside = (0..=square).contains(&dot) && cross * cross <= r * r * square;
        if beside || px * px + py * py <= r * r {
            return true;
        }
        in_core &= cross >= 0;
    }
    in_core
}

#[test]
fn counted_grid_points_agree() {
    let mut rng = Rng::new(4);
    let mut compared = 0;
    for _ in 0..16 {
        let Some(polygon) = random_rounded_hull(&mut rng, fx!(4)) else { continue };
        compared += 1;
        // Cells of 1/64 m, from -10 m to 10 m.
        const CELL: i128 = 1 << 16;
        let (mut count, mut first_x, mut first_y, mut second) = (0i128, 0i128, 0i128, 0i128);
        for (x, y) in (-640..640).flat_map(|x| (-640..640).map(move |y| (x, y))) {
            if contains(&polygon, (x * CELL, y * CELL)) {
                count += 1;
                first_x += x;
                first_y += y;
                second += x * x + y * y;
            }
        }
        let actual = figure(&polygon);
        close(actual.doubled_area, count << 33, 1000);
        let centre = (div_round(first_x << 26, count), div_round(first_y << 26, count));
        near(actual.centre, centre, fx!(0.004));
        let squared = div_round(second << 32, count) - ((centre.0 * centre.0 + centre.1 * centre.1) >> 20);
        close(actual.gyration_squared, squared, 1000);
    }
    assert!(compared > 8, "expected over 8 hulls, got {compared}");
}
