//! Predicates are compared with integer and rational arithmetic on a small grid, on which segments often touch, overlap
//! or cross at corners. The grid is scaled up to the edge of the number range.

use super::*;
use crate::fx;
use crate::math::Rng;
use alloc::vec::Vec;

/// Coordinates from -6 to 6.
type Grid = (i128, i128);

/// Scale and offset: a grid coordinate is placed at `coordinate * scale + offset`, in units of 2^-32 m.
const PLACES: [(i128, i128); 5] =
    [(1, 0), (3, i64::MIN as i128 + 18), (1 << 33, 7), ((1 << 60) + 1, 5), ((1 << 60) - 77, 1 << 60)];

fn place((x, y): Grid, (scale, offset): (i128, i128)) -> Vec2<Fx> {
    let bits =
        |v: i128| Fx::from_bits(i64::try_from(v * scale + offset).expect("a position within the world"));
    Vec2::new(bits(x), bits(y))
}

/// The point at the fraction `n / d` of the way, rounded to nearest, ties up.
fn point_between(from: Grid, to: Grid, n: i128, d: i128, placed: (i128, i128)) -> Vec2<Fx> {
    let (n, d) = (n * d.signum(), d.abs());
    let part = |from: i128, to: i128| {
        let exact = placed.0 * (from * d + (to - from) * n);
        let rounded = (2 * exact + d).div_euclid(2 * d) + placed.1;
        Fx::from_bits(i64::try_from(rounded).expect("a position within the world"))
    };
    Vec2::new(part(from.0, to.0), part(from.1, to.1))
}

fn cross(a: Grid, b: Grid, c: Grid) -> i128 {
    (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)
}

fn draw(rng: &mut Rng) -> Grid {
    let mut part = || i128::from(rng.below(13)) - 6;
    (part(), part())
}

#[test]
fn orientation_is_the_sign_of_the_exact_area() {
    let mut rng = Rng::new(1);
    for round in 0..5000 {
        let (a, b, c) = (draw(&mut rng), draw(&mut rng), draw(&mut rng));
        let expected = match cross(a, b, c).signum() {
            1 => Orientation::CounterClockwise,
            -1 => Orientation::Clockwise,
            _ => Orientation::Collinear,
        };
        let at = PLACES[round % PLACES.len()];
        assert_eq!(orientation(place(a, at), place(b, at), place(c, at)), expected, "{a:?} {b:?} {c:?}");
    }
    // A line across the whole world, a point one unit above this line, and a point on the line.
    let (low, high) = (Vec2::new(Fx::MIN, Fx::MIN), Vec2::new(Fx::MAX, Fx::MAX));
    let above = Vec2::new(Fx::ZERO, Fx::DELTA);
    assert_eq!(orientation(low, high, above), Orientation::CounterClockwise);
    assert_eq!(orientation(high, low, above), Orientation::Clockwise);
    assert_eq!(orientation(low, high, Vec2::new(Fx::ZERO, Fx::ZERO)), Orientation::Collinear);
}

/// The first shared point of two segments, as a fraction along the first segment.
fn shared(a0: Grid, a1: Grid, b0: Grid, b1: Grid) -> Option<(i128, i128)> {
    let (a, b) = ((a1.0 - a0.0, a1.1 - a0.1), (b1.0 - b0.0, b1.1 - b0.1));
    let determinant = a.0 * b.1 - a.1 * b.0;
    let between = (b0.0 - a0.0, b0.1 - a0.1);
    let unit = |n: i128, d: i128| n * d.signum() >= 0 && n * d.signum() <= d.abs();
    if determinant != 0 {
        let s = between.0 * b.1 - between.1 * b.0;
        let t = between.0 * a.1 - between.1 * a.0;
        return (unit(s, determinant) && unit(t, determinant)).then_some((s, determinant));
    }
    // Parallel segments: the steps visit every grid point on `a`.
    let steps = a.0.abs().max(a.1.abs()).max(1);
    (0..=steps).find_map(|step| {
        let exact =
            |from: i128, along: i128| (along * step % steps == 0).then(|| from + along * step / steps);
        let p = (exact(a0.0, a.0)?, exact(a0.1, a.1)?);
        let on_b = cross(b0, b1, p) == 0
            && p.0.clamp(b0.0.min(b1.0), b0.0.max(b1.0)) == p.0
            && p.1.clamp(b0.1.min(b1.1), b0.1.max(b1.1)) == p.1;
        on_b.then_some((step, steps))
    })
}

#[test]
fn segments_meet_where_rational_arithmetic_says() {
    let mut rng = Rng::new(2);
    let (mut hits, mut parallel) = (0, 0);
    for round in 0..20_000 {
        // Every other round uses a smaller grid, on which segments often touch at their ends or overlap.
        let part = |v: i128| if round % 2 == 0 { v } else { v / 3 };
        let [a0, a1, b0, b1] = [(); 4].map(|()| draw(&mut rng)).map(|(x, y)| (part(x), part(y)));
        let at = PLACES[round % PLACES.len()];
        let [p0, p1, q0, q1] = [a0, a1, b0, b1].map(|grid| place(grid, at));
        let expected = shared(a0, a1, b0, b1).map(|(n, d)| point_between(a0, a1, n, d, at));
        assert_eq!(segment_intersection(p0, p1, q0, q1), expected, "{a0:?} {a1:?} {b0:?} {b1:?} {at:?}");

        let is_parallel = cross(a0, a1, b1) == cross(a0, a1, b0);
        hits += u32::from(expected.is_some());
        parallel += u32::from(is_parallel && expected.is_some());
        if !is_parallel {
            assert_eq!(segment_intersection(p1, p0, q1, q0), expected);
            assert_eq!(segment_intersection(q0, q1, p0, p1), expected);
        }
    }
    assert!(hits > 5000 && parallel > 500, "both cases should be frequent: {hits} hits, {parallel} parallel");
}

#[test]
fn the_diagonals_of_the_world_meet() {
    let [a, b, c, d] = [(Fx::MIN, Fx::MIN), (Fx::MAX, Fx::MAX), (Fx::MIN, Fx::MAX), (Fx::MAX, Fx::MIN)]
        .map(|(x, y)| Vec2::new(x, y));
    // The exact coordinate is minus half a unit, and ties round up to 0.
    assert_eq!(segment_intersection(a, b, c, d), Some(Vec2::new(Fx::ZERO, Fx::ZERO)));
    assert_eq!(segment_intersection(b, a, d, c), Some(Vec2::new(Fx::ZERO, Fx::ZERO)));
    assert_eq!(closest_point_on_segment(c, a, b), Vec2::new(Fx::ZERO, Fx::ZERO));
    assert_eq!(closest_point_on_segment(b, a, b), b);
}

#[test]
fn the_closest_point_is_the_rounded_projection() {
    let mut rng = Rng::new(3);
    for round in 0..10_000 {
        let (p, a, b) = (draw(&mut rng), draw(&mut rng), draw(&mut rng));
        let along = (b.0 - a.0, b.1 - a.1);
        let length_squared = along.0 * along.0 + along.1 * along.1;
        let dot = (p.0 - a.0) * along.0 + (p.1 - a.1) * along.1;
        let at = PLACES[round % PLACES.len()];
        let expected = point_between(a, b, dot.clamp(0, length_squared), length_squared.max(1), at);
        let (point, start, end) = (place(p, at), place(a, at), place(b, at));
        assert_eq!(closest_point_on_segment(point, start, end), expected, "{p:?} {a:?} {b:?}");
        assert_eq!(closest_point_on_segment(point, end, start), expected);
    }
}

/// A star-shaped polygon about the origin: grid points in order of their direction.
fn star(rng: &mut Rng) -> Option<Vec<Grid>> {
    let mut corners: Vec<Grid> = (0..3 + rng.below(8)).map(|_| draw(rng)).filter(|&p| p != (0, 0)).collect();
    let lower_half = |p: Grid| (p.1, p.0) < (0, 0);
    corners.sort_by(|&p, &q| lower_half(p).cmp(&lower_half(q)).then_with(|| 0.cmp(&cross((0, 0), p, q))));
    corners.dedup_by(|p, q| lower_half(*p) == lower_half(*q) && cross((0, 0), *p, *q) == 0);
    let next = |i: usize| corners[(i + 1) % corners.len()];
    (corners.len() > 2 && (0..corners.len()).all(|i| cross((0, 0), corners[i], next(i)) > 0))
        .then_some(corners)
}

#[test]
fn a_star_is_the_union_of_its_triangles() {
    let mut rng = Rng::new(4);
    let mut inside = 0;
    for round in 0..3000 {
        let Some(corners) = star(&mut rng) else { continue };
        let at = PLACES[round % PLACES.len()];
        let mut placed: Vec<Vec2<Fx>> = corners.iter().map(|&corner| place(corner, at)).collect();
        if rng.chance(1, 2) {
            placed.reverse();
        }
        for _ in 0..20 {
            let p = draw(&mut rng);
            let expected = (0..corners.len()).any(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
                cross((0, 0), a, p) >= 0 && cross(a, b, p) >= 0 && cross(b, (0, 0), p) >= 0
            });
            assert_eq!(point_in_polygon(&placed, place(p, at)), expected, "{p:?} in {corners:?}");
            inside += u32::from(expected);
        }
    }
    assert!(inside > 5000, "expected over 5000 points inside, got {inside}");
}

#[test]
fn combs_and_their_teeth() {
    // The teeth point up, so that a ray to the right touches corners without crossing the border, and runs along edges.
    let comb = [(0, 0), (6, 0), (6, 3), (5, 1), (4, 3), (3, 3), (2, 1), (1, 3), (0, 1)];
    let picture = [
        // x = -1 to 7, from y = 4 down to -1
        ".........",
        "..#.##.#.",
        "..#.##.#.",
        ".#######.",
        ".#######.",
        ".........",
    ];
    let corners = comb.map(|grid| place(grid, (1 << 32, 0)));
    for (row, line) in (0..).zip(picture) {
        for (column, cell) in (0..).zip(line.chars()) {
            let point = place((column - 1, 4 - row), (1 << 32, 0));
            assert_eq!(point_in_polygon(&corners, point), cell == '#', "column {column}, row {row}");
        }
    }
}

#[test]
fn polygons_without_area() {
    let [a, b, middle] = [(0, 0), (4, 2), (2, 1)].map(|grid| place(grid, (1 << 32, 0)));
    assert!(!point_in_polygon(&[], a));
    assert!(point_in_polygon(&[a], a) && !point_in_polygon(&[a], b));
    assert!(point_in_polygon(&[a, b], middle) && !point_in_polygon(&[a, b], Vec2::new(fx!(2), fx!(2))));
}
