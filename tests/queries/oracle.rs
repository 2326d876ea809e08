//! Oracle of queries: brute force over shapes, each given as corners in world coordinates and a radius.

use lockstep2d::body::{Geometry, ShapeId, Sides};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2, closest_point_on_segment, point_in_polygon};
use lockstep2d::world::{QueryFilter, World};

/// Tolerance in metres for the rounding of corner coordinates.
pub(crate) const TOLERANCE: Fx = fx!(0.000002);

pub(crate) struct Solid {
    pub(crate) id: ShapeId,
    corners: Vec<Vec2<Fx>>,
    radius: Fx,
    pub(crate) one_sided: bool,
}

impl Solid {
    fn of(world: &World, id: ShapeId) -> Self {
        let shape = world.shape(id).expect("there");
        let transform = world.body(shape.body()).expect("there").transform();
        let one_sided = matches!(shape.geometry(), Geometry::Link { sides: Sides::Right, .. });
        let (corners, radius) = match shape.geometry() {
            Geometry::Circle { radius } => (vec![Vec2::ZERO], *radius),
            Geometry::Segment { a, b } | Geometry::Link { a, b, .. } => (vec![*a, *b], Fx::ZERO),
            Geometry::Capsule { a, b, radius } => (vec![*a, *b], *radius),
            Geometry::Polygon(polygon) => {
                (polygon.vertices().iter().map(|v| v.widen()).collect(), polygon.radius().into())
            }
        };
        let corners = corners.into_iter().map(|corner| transform.apply(shape.offset() + corner)).collect();
        Solid { id, corners, radius, one_sided }
    }

    /// Distance of a point in metres, negative inside.
    pub(crate) fn distance(&self, point: Vec2<Fx>) -> Fx {
        let next = self.corners.iter().cycle().skip(1);
        let edges = self.corners.iter().zip(next);
        let nearest = edges.map(|(&a, &b)| closest_point_on_segment(point, a, b).distance(point)).min();
        let nearest = nearest.expect("corners");
        let inside = self.corners.len() > 2 && point_in_polygon(&self.corners, point);
        (if inside { -nearest } else { nearest }) - self.radius
    }

    /// Distance along a ray to the surface, by sphere tracing. `Some(None)` is a miss, and `None` means undecided.
    pub(crate) fn trace(&self, origin: Vec2<Fx>, translation: Vec2<Fx>) -> Option<Option<Fx>> {
        let length = translation.length();
        let mut way = Fx::ZERO;
        for _ in 0..200 {
            let gap = self.distance(along(origin, translation, way));
            if gap < TOLERANCE {
                return (gap < -TOLERANCE || way > 0).then_some(Some(way));
            }
            way += gap;
            if way > length + TOLERANCE {
                return Some(None);
            }
        }
        None
    }
}

pub(crate) fn along(origin: Vec2<Fx>, translation: Vec2<Fx>, way: Fx) -> Vec2<Fx> {
    let fraction = lockstep2d::math::fx_div(way, translation.length()).unwrap_or(Fx::ZERO);
    origin + translation.scale(fraction)
}

/// Shapes that pass a filter, in slot order.
pub(crate) fn seen(world: &World, filter: QueryFilter) -> Vec<Solid> {
    let sees = |id: ShapeId| {
        let shape = world.shape(id).expect("there");
        let enabled = world.body(shape.body()).expect("there").is_enabled();
        let accepted =
            shape.filter().category & filter.mask != 0 && shape.filter().mask & filter.category != 0;
        enabled && accepted && (filter.sensors || !shape.is_sensor()) && filter.except != Some(shape.body())
    };
    world.shapes().map(|(id, _)| id).filter(|&id| sees(id)).map(|id| Solid::of(world, id)).collect()
}
