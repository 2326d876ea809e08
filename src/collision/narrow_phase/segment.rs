//! Segments may be as long as the world. This module clips a segment, in 64 bits, to a window around the other shape.
//! The clipped part becomes an outline of two opposite faces, in 32-bit coordinates relative to the centre of the other
//! shape.

#[cfg(test)]
mod tests;

use crate::collision::shape::posed::Hull;
use crate::fx;
use crate::math::{Fx, Vec2, div_round, saturate_wide};

/// Half the side of the window in metres: more than the extent of any shape plus the largest margin (171 m in total),
/// but small enough that the coordinates of the ends, and the differences of these coordinates, fit `Length`.
const WINDOW: Fx = fx!(200);

/// The part of a segment in the window about the centre of the other shape, relative to that centre. `None` if the
/// segment misses the window or has no length.
pub(crate) fn near_hull(a: Vec2<Fx>, b: Vec2<Fx>, centre: Vec2<Fx>) -> Option<Hull> {
    let direction = a.towards(b).normalized()?;
    let (p, q) = clipped_to_window(a, b, centre)?;
    Some(Hull::segment(p.narrow(), q.narrow(), direction))
}

pub(crate) fn clipped_to_window(a: Vec2<Fx>, b: Vec2<Fx>, centre: Vec2<Fx>) -> Option<(Vec2<Fx>, Vec2<Fx>)> {
    clip(a, b, centre, WINDOW)
}

/// The part of a segment in a square, relative to the centre of the square. `None` if the segment misses the square.
/// Also correct if the ends are so far from the centre that differences of coordinates saturate.
pub(in crate::collision) fn clip(
    a: Vec2<Fx>,
    b: Vec2<Fx>,
    centre: Vec2<Fx>,
    half_side: Fx,
) -> Option<(Vec2<Fx>, Vec2<Fx>)> {
    let is_inside = |v: Vec2<Fx>| v.x.unsigned_abs().max(v.y.unsigned_abs()) <= half_side.unsigned_abs();
    if is_inside(a - centre) && is_inside(b - centre) {
        return Some((a - centre, b - centre));
    }
    let (mut p, mut q) = (a, b);
    for sign in [1, -1] {
        for axis in [|v: Vec2<Fx>| v.x, |v: Vec2<Fx>| v.y] {
            (p, q) = clip_to_half_plane(p, q, |v| {
                let along = i128::from(axis(v).to_bits()) - i128::from(axis(centre).to_bits());
                along * sign - i128::from(half_side.to_bits())
            })?;
        }
    }
    Some((p - centre, q - centre))
}

/// The part of a segment where the linear function `outside` is not positive.
fn clip_to_half_plane(
    p: Vec2<Fx>,
    q: Vec2<Fx>,
    outside: impl Fn(Vec2<Fx>) -> i128,
) -> Option<(Vec2<Fx>, Vec2<Fx>)> {
    let (at_p, at_q) = (outside(p), outside(q));
    match (at_p > 0, at_q > 0) {
        (true, true) => None,
        (true, false) => Some((crossing(p, q, at_p, at_q), q)),
        (false, true) => Some((p, crossing(q, p, at_q, at_p))),
        (false, false) => Some((p, q)),
    }
}

/// Point between `p` and `q` at which a linear function is 0. Its values at the ends are `at_p > 0 >= at_q`.
fn crossing(p: Vec2<Fx>, q: Vec2<Fx>, at_p: i128, at_q: i128) -> Vec2<Fx> {
    // Inside the world, coordinates are at most 2^62 units, so `way` and `at_p` are at most 2^63 units and their
    // product fits. It saturates only for coordinates near the limits of the number range.
    let part = |p: Fx, q: Fx| {
        let way = i128::from(q.to_bits()) - i128::from(p.to_bits());
        let moved = div_round(way.saturating_mul(at_p), at_p - at_q);
        Fx::from_bits(saturate_wide(i128::from(p.to_bits()) + moved))
    };
    Vec2::new(part(p.x, q.x), part(p.y, q.y))
}
