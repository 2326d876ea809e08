//! Random support shapes for the tests of queries.

use super::*;
use crate::body::Polygon;
use crate::math::Rng;
use alloc::vec::Vec;

pub(in crate::collision) fn vector(rng: &mut Rng, size: Fx) -> Vec2<Fx> {
    Vec2::new(rng.range(-size, size), rng.range(-size, size))
}

pub(in crate::collision) fn support(rng: &mut Rng) -> SupportShape {
    loop {
        let points: Vec<_> = (0..7).map(|_| vector(rng, fx!(1))).collect();
        let radius = if rng.chance(1, 2) { Fx::ZERO } else { rng.range(fx!(0.01), fx!(0.4)) };
        let count = rng.below(5);
        match count {
            0 => return SupportShape::disc(points[0], radius),
            1 => return SupportShape::from_points([points[0], points[1]], radius),
            _ => {}
        }
        let polygon = match count {
            2 => Polygon::rectangle(radius + fx!(0.1), fx!(0.3)),
            3 => Polygon::hull(&points[..3]),
            _ => Polygon::hull(&points),
        };
        if let Ok(polygon) = polygon {
            let turn = Rot::from_angle(rng.angle());
            let vertices = polygon.vertices().iter().map(|vertex| vertex.widen());
            return SupportShape::from_points(vertices, radius).rotated(turn);
        }
    }
}

/// A shape with points up to 107 m from the centre, and a radius of up to 30 m.
pub(in crate::collision) fn large(rng: &mut Rng) -> SupportShape {
    let support = support(rng);
    let points: Vec<_> = world_points(&support).into_iter().map(|point| point.scale(fx!(75))).collect();
    SupportShape::from_points(points, to_fx(support.radius) * 75)
}

pub(in crate::collision) fn placed(rng: &mut Rng, spread: Fx) -> SupportShape {
    support(rng).moved(to_grid(vector(rng, spread)))
}

/// Sphere tracing: distance along a path of `length` metres at which the path comes within 2e-7 m of a surface.
/// `Ok(None)` if the path misses the surface. `gap_at` returns the distance from the surface. `Err` if the path passes
/// within 2e-6 m of the surface without reaching it, or takes more than 2000 steps.
pub(in crate::collision) fn march(length: Fx, mut gap_at: impl FnMut(Fx) -> Fx) -> Result<Option<Fx>, ()> {
    let (mut travelled, mut nearest) = (Fx::ZERO, Fx::MAX);
    for _ in 0..2000 {
        let gap = gap_at(travelled);
        nearest = nearest.min(gap);
        if gap < fx!(0.0000002) {
            return Ok(Some(travelled));
        }
        travelled += gap;
        if travelled > length {
            return if nearest < fx!(0.000002) { Err(()) } else { Ok(None) };
        }
    }
    Err(())
}

/// Points whose coordinates are at the bounds of the world or of the number format.
pub(in crate::collision) fn extremes() -> impl Iterator<Item = Vec2<Fx>> {
    let ends = [Fx::MIN, fx!(-1073741824), fx!(1073741824), Fx::MAX];
    ends.into_iter().flat_map(move |x| ends.map(|y| Vec2::new(x, y)))
}

pub(in crate::collision) fn world_points(support: &SupportShape) -> Vec<Vec2<Fx>> {
    support.points().iter().map(|&point| from_grid(point)).collect()
}
