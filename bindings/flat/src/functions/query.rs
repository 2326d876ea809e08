//! Queries.

use lockstep2d::body::ShapeId;
use lockstep2d::world::World;

use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::{NO_ID, RawBody, RawFx, RawShape, RawVec2};
use crate::records::{RawAabb, RawCastHit, RawClosest, RawProbe, RawQueryFilter, RawRayHit};
use crate::status::{Failure, Outcome};
use crate::table::with;

fn body_of(world: &World, shape: ShapeId) -> RawBody {
    world.shape(shape).map_or(RawBody(NO_ID), |shape| RawBody::of(shape.body()))
}

fn copy_shapes(
    found: Vec<ShapeId>,
    mut shapes: Out<'_, RawShape>,
    capacity: usize,
    mut count: Out<'_, usize>,
) -> Outcome {
    let all: Vec<RawShape> = found.into_iter().map(RawShape::of).collect();
    shapes.set_all(capacity, &mut count, &all)
}

api! {
    /// Sets the defaults of a query filter, with which a query sees all shapes except sensors.
    fn ls2d_query_filter_init(filter: Out<'_, RawQueryFilter>) {
        let mut filter = filter;
        filter.set(RawQueryFilter::default_filter())
    }

    /// Sets the defaults of a probe with a shape of the given kind, at the origin. The caller sets the geometry.
    fn ls2d_probe_init(kind: u32, probe: Out<'_, RawProbe>) {
        let mut probe = probe;
        probe.set(RawProbe::of_kind(kind))
    }

    /// The first shape that a ray meets. The ray starts at the point (`x`, `y`) of the world and has the length and
    /// direction of the vector (`along_x`, `along_y`), in metres. `LS2D_NONE` if there is no hit.
    fn ls2d_cast_ray(
        world: u32,
        x: RawFx,
        y: RawFx,
        along_x: RawFx,
        along_y: RawFx,
        filter: In<'_, RawQueryFilter>,
        hit: Out<'_, RawRayHit>,
    ) {
        let mut hit = hit;
        let filter = RawQueryFilter::of(&filter)?;
        let (origin, along) = (RawVec2 { x, y }.vec(), RawVec2 { x: along_x, y: along_y }.vec());
        with(world, |world: &mut World| {
            let found = world.cast_ray(origin, along, filter).ok_or_else(Failure::none)?;
            hit.set(RawRayHit::of(&found, body_of(world, found.shape)))
        })
    }

    /// Every shape that a ray meets, in order along the ray. The ray is given as in `ls2d_cast_ray`.
    fn ls2d_cast_ray_all(
        world: u32,
        x: RawFx,
        y: RawFx,
        along_x: RawFx,
        along_y: RawFx,
        filter: In<'_, RawQueryFilter>,
        hits: Out<'_, RawRayHit>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        let (mut hits, mut count) = (hits, count);
        let filter = RawQueryFilter::of(&filter)?;
        let (origin, along) = (RawVec2 { x, y }.vec(), RawVec2 { x: along_x, y: along_y }.vec());
        with(world, |world: &mut World| {
            let found = world.cast_ray_all(origin, along, filter);
            let all: Vec<_> = found.iter().map(|hit| RawRayHit::of(hit, body_of(world, hit.shape))).collect();
            hits.set_all(capacity, &mut count, &all)
        })
    }

    /// The first shape that a probe meets when it moves by the vector (`along_x`, `along_y`), in metres. `LS2D_NONE` if
    /// there is no hit.
    fn ls2d_cast_shape(
        world: u32,
        probe: In<'_, RawProbe>,
        along_x: RawFx,
        along_y: RawFx,
        filter: In<'_, RawQueryFilter>,
        hit: Out<'_, RawCastHit>,
    ) {
        let mut hit = hit;
        let (probe, filter) = (probe.get()?.probe()?, RawQueryFilter::of(&filter)?);
        with(world, |world: &mut World| {
            let along = RawVec2 { x: along_x, y: along_y }.vec();
            let found = world.cast_shape(&probe, along, filter).ok_or_else(Failure::none)?;
            hit.set(RawCastHit::of(&found, body_of(world, found.shape)))
        })
    }

    /// Shapes that overlap a probe, in slot order.
    fn ls2d_overlap_shape(
        world: u32,
        probe: In<'_, RawProbe>,
        filter: In<'_, RawQueryFilter>,
        shapes: Out<'_, RawShape>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        let (probe, filter) = (probe.get()?.probe()?, RawQueryFilter::of(&filter)?);
        with(world, |world: &mut World| copy_shapes(world.overlap_shape(&probe, filter), shapes, capacity, count))
    }

    /// Shapes that overlap a box, in slot order.
    fn ls2d_overlap_box(
        world: u32,
        area: In<'_, RawAabb>,
        filter: In<'_, RawQueryFilter>,
        shapes: Out<'_, RawShape>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        let (area, filter) = (area.get()?.aabb(), RawQueryFilter::of(&filter)?);
        with(world, |world: &mut World| copy_shapes(world.overlap_box(area, filter), shapes, capacity, count))
    }

    /// Shapes that contain a point, in slot order.
    fn ls2d_overlap_point(
        world: u32,
        x: RawFx,
        y: RawFx,
        filter: In<'_, RawQueryFilter>,
        shapes: Out<'_, RawShape>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        let filter = RawQueryFilter::of(&filter)?;
        with(world, |world: &mut World| {
            copy_shapes(world.overlap_point(RawVec2 { x, y }.vec(), filter), shapes, capacity, count)
        })
    }

    /// The shape nearest to the point (`x`, `y`) of the world, in metres. `LS2D_NONE` if no shape is at most `within`
    /// metres away.
    fn ls2d_closest(
        world: u32,
        x: RawFx,
        y: RawFx,
        within: RawFx,
        filter: In<'_, RawQueryFilter>,
        closest: Out<'_, RawClosest>,
    ) {
        let mut closest = closest;
        let filter = RawQueryFilter::of(&filter)?;
        with(world, |world: &mut World| {
            let found = world.closest(RawVec2 { x, y }.vec(), within.fx(), filter);
            let (shape, points) = found.ok_or_else(Failure::none)?;
            closest.set(RawClosest::of(RawShape::of(shape), body_of(world, shape), &points))
        })
    }

    /// Distance between two shapes in metres, negative if they overlap. `LS2D_NONE` if one of the shapes is disabled or
    /// not in the world.
    fn ls2d_shape_distance(world: u32, a: RawShape, b: RawShape, distance: Out<'_, RawFx>) {
        let mut distance = distance;
        let (a, b) = (a.id()?, b.id()?);
        with(world, |world: &mut World| {
            let found = world.distance(a, b).ok_or_else(Failure::none)?;
            distance.set(RawFx::of(found.distance))
        })
    }
}
