//! Exact planar predicates: orientation, point in polygon, segment intersection.
//!
//! Predicates use the signs of cross products without rounding, so results for neighbouring inputs do not contradict
//! each other (J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates",
//! 1997). Returned points are rounded once, to nearest, ties towards +infinity.

use super::formats::Fx;
use super::vec2::Vec2;
use super::wide::{Difference, point_at};
use core::cmp::Ordering;

/// Direction in which a path through three points turns.
///
/// ```
/// use lockstep2d::{fx, math::{Orientation, Vec2, orientation}};
/// // Which side of the finish line is the car on? Exact, however close it is.
/// let (left, right) = (Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(10), fx!(1)));
/// let car = Vec2::new(fx!(5), fx!(0.5000000003));
/// assert_eq!(orientation(left, right, car), Orientation::CounterClockwise);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Orientation {
    /// The path turns to the right.
    Clockwise,
    /// The points lie on a line, or some of them coincide.
    Collinear,
    /// The path turns to the left.
    CounterClockwise,
}

/// Orientation of the path from `a` over `b` to `c`: exact.
///
/// ```
/// use lockstep2d::{fx, math::{Orientation, Vec2, orientation}};
/// let (a, b) = (Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(1), fx!(1)));
/// assert_eq!(orientation(a, b, Vec2::new(fx!(0), fx!(1))), Orientation::CounterClockwise);
/// assert_eq!(orientation(a, b, Vec2::new(fx!(-7), fx!(-7))), Orientation::Collinear);
/// ```
#[must_use]
pub fn orientation(a: Vec2<Fx>, b: Vec2<Fx>, c: Vec2<Fx>) -> Orientation {
    match Difference::new(a, b).cross(Difference::new(a, c)).sign() {
        Ordering::Less => Orientation::Clockwise,
        Ordering::Equal => Orientation::Collinear,
        Ordering::Greater => Orientation::CounterClockwise,
    }
}

/// Whether a point lies in a simple polygon, convex or not, of either winding: exact.
///
/// The border belongs to the polygon. Fewer than three corners are a segment, a point or the empty set.
///
/// ```
/// use lockstep2d::{fx, math::{Vec2, point_in_polygon}};
/// let corners = [(fx!(0), fx!(0)), (fx!(4), fx!(0)), (fx!(1), fx!(1)), (fx!(0), fx!(4))];
/// let corners = corners.map(|(x, y)| Vec2::new(x, y));
/// assert!(point_in_polygon(&corners, Vec2::new(fx!(1), fx!(1))));
/// assert!(!point_in_polygon(&corners, Vec2::new(fx!(2), fx!(2))));
/// ```
#[must_use]
pub fn point_in_polygon(corners: &[Vec2<Fx>], point: Vec2<Fx>) -> bool {
    let Some(&last) = corners.last() else {
        return false;
    };
    let mut inside = false;
    let mut start = last;
    for &end in corners {
        let (lower, upper) = if start.y <= end.y { (start, end) } else { (end, start) };
        start = end;
        if point.y < lower.y || upper.y < point.y {
            continue;
        }
        // Counts the edges that a ray to the right crosses. An edge includes only its lower end, so a corner at which
        // the border crosses the ray counts once.
        match orientation(lower, upper, point) {
            Orientation::Collinear if in_box(point, lower, upper) => return true,
            Orientation::CounterClockwise if point.y < upper.y => inside = !inside,
            _ => {}
        }
    }
    inside
}

/// Intersection of two segments, ends included, rounded to nearest: `None` exactly if they share no point.
///
/// If the segments overlap along a line, the result is the shared point nearest to `a0`. Otherwise the result does not
/// depend on the order of the segments or of their ends.
///
/// ```
/// use lockstep2d::{fx, math::{Vec2, segment_intersection}};
/// let at = |x, y| Vec2::new(x, y);
/// let (a0, a1) = (at(fx!(0), fx!(0)), at(fx!(4), fx!(4)));
/// let found = segment_intersection(a0, a1, at(fx!(0), fx!(2)), at(fx!(2), fx!(0)));
/// assert_eq!(found, Some(at(fx!(1), fx!(1))));
/// let found = segment_intersection(a0, a1, at(fx!(9), fx!(9)), at(fx!(3), fx!(3)));
/// assert_eq!(found, Some(at(fx!(3), fx!(3))));
/// ```
#[must_use]
pub fn segment_intersection(a0: Vec2<Fx>, a1: Vec2<Fx>, b0: Vec2<Fx>, b1: Vec2<Fx>) -> Option<Vec2<Fx>> {
    // a0 + s a = b0 + t b gives s = (b0 - a0) x b / (a x b) and t = (b0 - a0) x a / (a x b).
    let (a, b, between) = (Difference::new(a0, a1), Difference::new(b0, b1), Difference::new(a0, b0));
    let determinant = a.cross(b);
    if determinant.sign() == Ordering::Equal {
        return parallel_intersection(a0, a1, b0, b1);
    }
    let on_a = point_at(a0, a, between.cross(b), determinant)?;
    point_at(b0, b, between.cross(a), determinant).map(|_| on_a)
}

/// [`segment_intersection`] of segments that are parallel or of zero length.
fn parallel_intersection(a0: Vec2<Fx>, a1: Vec2<Fx>, b0: Vec2<Fx>, b1: Vec2<Fx>) -> Option<Vec2<Fx>> {
    if on_segment(a0, b0, b1) {
        return Some(a0);
    }
    // The shared part, if there is one, begins at the end of `b` that lies on `a` nearest to `a0`.
    [b0, b1]
        .into_iter()
        .filter(|&end| on_segment(end, a0, a1))
        .min_by_key(|&end| Difference::new(a0, end).manhattan())
}

/// Nearest point of a segment, ends included, rounded to nearest.
///
/// ```
/// use lockstep2d::{fx, math::{Vec2, closest_point_on_segment}};
/// let (a, b) = (Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(4), fx!(2)));
/// assert_eq!(closest_point_on_segment(Vec2::new(fx!(1), fx!(3)), a, b), Vec2::new(fx!(2), fx!(1)));
/// assert_eq!(closest_point_on_segment(Vec2::new(fx!(9), fx!(3)), a, b), b);
/// ```
#[must_use]
pub fn closest_point_on_segment(point: Vec2<Fx>, a: Vec2<Fx>, b: Vec2<Fx>) -> Vec2<Fx> {
    let along = Difference::new(a, b);
    let projection = along.dot(Difference::new(a, point));
    if projection.sign() != Ordering::Greater {
        return a;
    }
    point_at(a, along, projection, along.dot(along)).unwrap_or(b)
}

fn on_segment(point: Vec2<Fx>, a: Vec2<Fx>, b: Vec2<Fx>) -> bool {
    in_box(point, a, b) && orientation(a, b, point) == Orientation::Collinear
}

fn in_box(point: Vec2<Fx>, a: Vec2<Fx>, b: Vec2<Fx>) -> bool {
    let (lower, upper) = (a.min(b), a.max(b));
    lower.x <= point.x && point.x <= upper.x && lower.y <= point.y && point.y <= upper.y
}

#[cfg(test)]
mod tests;
