//! Picks the body under the pointer.

use lockstep2d::body::{Body, BodyId, Geometry, ShapeId};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Probe, QueryFilter, World};

use super::act::Aim;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Picked {
    pub(super) body: BodyId,
    /// Picked point, in world coordinates, in metres.
    pub(super) point: Vec2<Fx>,
}

/// Picks a body for which `wanted` is true. If several bodies contain the point, picks the body whose shape is in the
/// last slot. If no body contains the point, picks the nearest body within `aim.within`. Solid shapes take precedence
/// over sensors.
pub(super) fn pick(world: &World, aim: Aim, wanted: impl Fn(&Body) -> bool) -> Option<Picked> {
    let solid = QueryFilter::default();
    let all = QueryFilter { sensors: true, ..solid };
    let is_wanted =
        |shape: &ShapeId| world.body_of(*shape).and_then(|id| world.body(id)).is_some_and(&wanted);
    [solid, all].into_iter().find_map(|filter| {
        // The shape in the last slot is usually drawn on top.
        let here = world.overlap_point(aim.at, filter).into_iter().rev().find(is_wanted);
        let here = here.and_then(|shape| Some(Picked { body: world.body_of(shape)?, point: aim.at }));
        here.or_else(|| nearest(world, aim, filter, is_wanted))
    })
}

fn nearest(
    world: &World,
    aim: Aim,
    filter: QueryFilter,
    is_wanted: impl Fn(&ShapeId) -> bool,
) -> Option<Picked> {
    let disc = Probe::new(Geometry::circle(aim.within).ok()?, aim.at).ok()?;
    let near = world.overlap_shape(&disc, filter).into_iter().filter(is_wanted);
    let found = near.filter_map(|shape| Some((world.probe_distance(&disc, shape)?, shape)));
    let (proximity, shape) = found.min_by_key(|(proximity, shape)| (proximity.distance, *shape))?;
    Some(Picked { body: world.body_of(shape)?, point: proximity.point_b })
}

#[cfg(test)]
mod tests {
    use lockstep2d::body::{BodyDef, ShapeDef, WorldError};
    use lockstep2d::fx;

    use super::*;

    /// Two circles of 1 m radius at the origin, inside a larger sensor.
    fn world() -> Result<(World, [BodyId; 3]), WorldError> {
        let mut world = World::default();
        let disc = ShapeDef::new(Geometry::circle(fx!(1))?);
        let lower = world.spawn(&BodyDef::fixed(), &[disc])?;
        let upper = world.spawn(&BodyDef::dynamic(), &[disc])?;
        let sensor = ShapeDef::new(Geometry::circle(fx!(5))?).sensor();
        let sensor = world.spawn(&BodyDef::fixed(), &[sensor])?;
        Ok((world, [lower, upper, sensor]))
    }

    #[test]
    fn the_uppermost_of_those_that_are_wanted_is_picked_and_sensors_last() {
        let (world, [lower, upper, sensor]) = world().unwrap();
        let at = |x: Fx, wanted: fn(&Body) -> bool| {
            pick(&world, Aim::at(Vec2::new(x, fx!(0))), wanted).map(|picked| picked.body)
        };
        assert_eq!(at(fx!(0.5), |_| true), Some(upper));
        assert_eq!(at(fx!(0.5), |body| !body.is_dynamic()), Some(lower));
        assert_eq!(at(fx!(2), |_| true), Some(sensor));
        assert_eq!(at(fx!(2), Body::is_dynamic), None);
        assert_eq!(at(fx!(6), |_| true), None);
    }

    #[test]
    fn beside_a_body_it_is_picked_at_its_nearest_point() {
        let (world, [_, upper, _]) = world().unwrap();
        let aim = |x, within| Aim { at: Vec2::new(x, fx!(0)), within };
        let picked = pick(&world, aim(fx!(1.25), fx!(0.5)), Body::is_dynamic);
        let Some(Picked { body, point }) = picked else { panic!("expected a body") };
        assert!(body == upper && point.distance(Vec2::new(fx!(1), fx!(0))) < fx!(0.001), "{point:?}");
        assert_eq!(pick(&world, aim(fx!(1.6), fx!(0.5)), Body::is_dynamic), None);
    }
}
