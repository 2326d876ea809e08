//! Shape cast: B moved by `t v` touches A if the ray `t v` from the origin meets the Minkowski difference `A - B`. A
//! shape cast is therefore a ray cast, without iteration.
//!
//! A moving shape stops at the distance [`SKIN`] from A. Its next move must not be stopped by A if the shape slides
//! along A or leaves A. Therefore, if the shape starts within the skin or overlaps A, only a movement against the
//! normal is a hit. Other movements do not deepen the overlap, because the separation along the normal does not shrink.

use super::distance::{Distance, distance};
use super::ray::{approach, entry};
use crate::body::POLYGON_VERTICES_MAX;
use crate::collision::shape::support::{Fraction, Grid, SupportShape, cross, from_grid, to_grid};
use crate::fx;
use crate::math::{Fx, Unit, Vec2};

/// Distance in metres that a moving shape keeps from others.
pub(crate) const SKIN: Fx = fx!(0.0001);

/// Distance in metres beyond the skin that still counts as contact. It exceeds the rounding error of a hit, which is
/// 0.2 µm.
pub(crate) const TOLERANCE: Fx = fx!(0.000002);

/// A translation counts as sliding along a surface if it approaches the surface by at most 2^-24 times the larger
/// component of the translation, plus 2^-24 m. The constant is the right shift for this factor.
const SLIDING: u32 = 24;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ShapeHit {
    /// Fraction of the translation, 0 to 1, rounded down to 2^-32.
    pub(crate) fraction: Fx,
    /// The fraction with more bits, to order two hits.
    pub(crate) order: Fraction,
    /// Displacement up to the hit, more exact than the fraction for a long translation.
    pub(crate) travelled: Vec2<Fx>,
    /// Nearest point on the surface of A, relative to the origin of the support shapes.
    pub(crate) point: Vec2<Fx>,
    /// Unit vector from A to B.
    pub(crate) normal: Vec2<Unit>,
}

impl ShapeHit {
    pub(crate) fn at_start(start: &Distance) -> Self {
        let (fraction, order, travelled) = (Fx::ZERO, Fraction::ZERO, Vec2::ZERO);
        ShapeHit { fraction, order, travelled, point: start.point_a, normal: start.normal }
    }
}

/// Whether a translation goes against a normal by more than a rounding error.
pub(crate) fn goes_against(normal: Vec2<Unit>, translation: Vec2<Fx>) -> bool {
    let translation = to_grid(translation);
    let reach = translation.x.abs().max(translation.y.abs());
    let sliding = (reach >> SLIDING) + (Grid::ONE >> SLIDING);
    approach(normal, translation) > sliding
}

/// Casts B along `translation` until it is within [`SKIN`] of A. If B starts within the skin or overlapping, a movement
/// against the normal is a hit with the fraction 0, and any other movement has no hit.
pub(crate) fn cast_shape(a: &SupportShape, b: &SupportShape, translation: Vec2<Fx>) -> Option<ShapeHit> {
    let start = distance(a, b);
    if start.distance <= SKIN + TOLERANCE {
        return goes_against(start.normal, translation).then(|| ShapeHit::at_start(&start));
    }
    let translation = to_grid(translation);
    let radius = a.radius + b.radius + to_grid(Vec2::new(SKIN, SKIN)).x;
    let (points, count) = difference(a.points(), b.points());
    let (fraction, _) = entry(&points[..count], radius, Vec2::ZERO, translation)?;
    let travelled = fraction.of(translation);
    let hit = distance(a, &b.moved(travelled));
    Some(ShapeHit {
        fraction: fraction.to_fx(),
        order: fraction,
        travelled: from_grid(travelled),
        point: hit.point_a,
        normal: hit.normal,
    })
}

/// Minkowski difference `A - B`, counter-clockwise: the edges of A and of `-B`, merged by angle.
fn difference(a: &[Vec2<Grid>], b: &[Vec2<Grid>]) -> ([Vec2<Grid>; 2 * POLYGON_VERTICES_MAX], usize) {
    let lowest = |points: &[Vec2<Grid>], sign: i64| {
        let key = |i: &usize| (points[*i].y * sign, points[*i].x * sign);
        (0..points.len()).min_by_key(key).unwrap_or(0)
    };
    let (first_a, first_b) = (lowest(a, 1), lowest(b, -1));
    let edge = |points: &[Vec2<Grid>], i: usize| points[(i + 1) % points.len()] - points[i % points.len()];
    let edges_of = |points: &[Vec2<Grid>]| if points.len() == 1 { 0 } else { points.len() };
    let (edges_a, edges_b) = (edges_of(a), edges_of(b));

    let mut merged = [Vec2::ZERO; 2 * POLYGON_VERTICES_MAX];
    let (mut i, mut j, mut count) = (0, 0, 0);
    let mut at = a[first_a] - b[first_b];
    while i < edges_a || j < edges_b {
        merged[count] = at;
        count += 1;
        let (next_a, next_b) = (edge(a, first_a + i), -edge(b, first_b + j));
        let (use_a, use_b) = match (i < edges_a, j < edges_b) {
            (true, true) => (!is_before(next_b, next_a), !is_before(next_a, next_b)),
            only => only,
        };
        if use_a {
            at += next_a;
            i += 1;
        }
        if use_b {
            at += next_b;
            j += 1;
        }
    }
    if count == 0 {
        merged[0] = at;
    }
    (merged, count.max(1))
}

/// Whether the angle of `u` is smaller than that of `v`. Angles are measured from the x axis, from 0 to below a full
/// turn.
fn is_before(u: Vec2<Grid>, v: Vec2<Grid>) -> bool {
    let lower_half = |v: Vec2<Grid>| v.y < 0 || (v.y == 0 && v.x < 0);
    match (lower_half(u), lower_half(v)) {
        (false, true) => true,
        (true, false) => false,
        _ => cross(u, v) > 0,
    }
}

#[cfg(test)]
mod tests;
