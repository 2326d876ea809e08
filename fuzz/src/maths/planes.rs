//! Geometry in the plane.

use lockstep2d::math::{
    Fx, Orientation, Vec2, closest_point_on_segment, orientation, point_in_polygon, segment_intersection,
};
use num_traits::{One, Signed, Zero};

use super::exact::{Exact, fixed, of};
use super::vector;
use crate::source::Source;

type Point = [Exact; 2];

pub(super) fn check(source: &mut Source<'_>) {
    let crowded = source.one_in(2);
    let mut point = || {
        if !crowded {
            return vector(source);
        }
        // With only six different coordinates, many points are equal or collinear.
        let few = [Fx::ZERO, Fx::ONE, Fx::DELTA, -Fx::ONE, Fx::MAX, Fx::MIN];
        Vec2::new(source.pick(&few), source.pick(&few))
    };
    let (a, b, c, d) = (point(), point(), point(), point());
    let turn = cross(&exact(a), &exact(b), &exact(c));
    let expected = if turn.is_positive() {
        Orientation::CounterClockwise
    } else if turn.is_negative() {
        Orientation::Clockwise
    } else {
        Orientation::Collinear
    };
    assert_eq!(orientation(a, b, c), expected, "{a:?} {b:?} {c:?}");
    nearest(a, b, c);
    crossing(a, b, c, d);
    let corners = [a, b, c];
    let mut turns = [0, 1, 2].map(|at| cross(&exact(corners[at]), &exact(corners[(at + 1) % 3]), &exact(d)));
    if turn.is_negative() {
        turns = turns.map(|turn| -turn);
    }
    if !turn.is_zero() {
        let inside = turns.iter().all(|turn| !turn.is_negative());
        assert_eq!(point_in_polygon(&corners, d), inside, "{d:?} in {corners:?}");
    }
}

fn exact(point: Vec2<Fx>) -> Point {
    [of(point.x), of(point.y)]
}

fn cross(a: &Point, b: &Point, c: &Point) -> Exact {
    (&b[0] - &a[0]) * (&c[1] - &a[1]) - (&b[1] - &a[1]) * (&c[0] - &a[0])
}

fn dot(a: &Point, b: &Point, c: &Point) -> Exact {
    (&b[0] - &a[0]) * (&c[0] - &a[0]) + (&b[1] - &a[1]) * (&c[1] - &a[1])
}

/// Checks that each coordinate of `found` is the one of `at`, rounded to nearest.
fn assert_near(found: Vec2<Fx>, at: &Point, what: &dyn Fn() -> String) {
    let half = fixed(1, 33);
    for (found, exact) in [found.x, found.y].into_iter().zip(at) {
        assert!((of(found) - exact).abs() <= half, "{}: {found}", what());
    }
}

fn along(a: &Point, b: &Point, t: &Exact) -> Point {
    [&a[0] + (&b[0] - &a[0]) * t, &a[1] + (&b[1] - &a[1]) * t]
}

fn nearest(point: Vec2<Fx>, a: Vec2<Fx>, b: Vec2<Fx>) {
    let (p, start, end) = (exact(point), exact(a), exact(b));
    let whole = dot(&start, &end, &end);
    let t = if whole.is_zero() { whole } else { dot(&start, &end, &p) / whole };
    let t = t.clamp(Exact::zero(), Exact::one());
    let found = closest_point_on_segment(point, a, b);
    assert_near(found, &along(&start, &end, &t), &|| format!("{point:?} from {a:?} to {b:?}"));
}

fn crossing(a0: Vec2<Fx>, a1: Vec2<Fx>, b0: Vec2<Fx>, b1: Vec2<Fx>) {
    let (a, b, c, d) = (exact(a0), exact(a1), exact(b0), exact(b1));
    let sides = [cross(&a, &b, &c), cross(&a, &b, &d), cross(&c, &d, &a), cross(&c, &d, &b)];
    let what = || format!("{a0:?} {a1:?} and {b0:?} {b1:?}");
    let found = segment_intersection(a0, a1, b0, b1);
    let reversed = segment_intersection(b1, b0, a1, a0);
    assert_eq!(found.is_some(), reversed.is_some(), "{}", what());
    let determinant = &sides[0] - &sides[1];
    if determinant.is_zero() {
        // Parallel segments intersect if an end point of one lies on the other.
        let ends = [(&c, &a, &b), (&d, &a, &b), (&a, &c, &d), (&b, &c, &d)];
        let shared = ends.iter().any(|(p, from, to)| on_segment(p, from, to));
        return assert_eq!(found.is_some(), shared, "{}", what());
    }
    let meets = !(&sides[0] * &sides[1]).is_positive() && !(&sides[2] * &sides[3]).is_positive();
    assert_eq!(found.is_some(), meets, "{}", what());
    if let Some(found) = found {
        assert_eq!(Some(found), reversed, "{}", what());
        let t = &sides[0] / determinant;
        assert_near(found, &along(&c, &d, &t), &what);
    }
}

fn on_segment(p: &Point, a: &Point, b: &Point) -> bool {
    let within = |at: usize| (&p[at] - &a[at]) * (&p[at] - &b[at]);
    cross(a, b, p).is_zero() && !within(0).is_positive() && !within(1).is_positive()
}
