//! Events of the last tick.

use lockstep2d::world::World;

use crate::border::Out;
use crate::describe::api;
use crate::records::{RawContactEvent, RawHitEvent, RawJointEvent, RawPose, RawSensorEvent};
use crate::status::Outcome;
use crate::table::with;

fn copy<E: 'static, T: crate::border::Plain>(
    world: u32,
    list: impl FnOnce(&World) -> &[E],
    of: impl Fn(&E) -> T,
    mut events: Out<'_, T>,
    capacity: usize,
    mut count: Out<'_, usize>,
) -> Outcome {
    with(world, |world: &mut World| {
        let all: Vec<T> = list(world).iter().map(of).collect();
        events.set_all(capacity, &mut count, &all)
    })
}

api! {
    /// Bodies that moved or fell asleep, in slot order, with their poses.
    fn ls2d_events_moved(world: u32, events: Out<'_, RawPose>, capacity: usize, count: Out<'_, usize>) {
        copy(world, |world| &world.events().moved, RawPose::of_move, events, capacity, count)
    }

    /// Pairs of shapes that began to touch, sorted by shape A, then by shape B.
    fn ls2d_events_contact_begin(
        world: u32,
        events: Out<'_, RawContactEvent>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        copy(world, |world| &world.events().contact_begin, RawContactEvent::of, events, capacity, count)
    }

    /// Pairs of shapes that ceased to touch, sorted by shape A, then by shape B.
    fn ls2d_events_contact_end(
        world: u32,
        events: Out<'_, RawContactEvent>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        copy(world, |world| &world.events().contact_end, RawContactEvent::of, events, capacity, count)
    }

    /// Pairs of shapes that hit each other at the world's `hit_speed` or faster, if one of them has
    /// `LS2D_SHAPE_HIT_EVENTS`. Sorted by shape A, then by shape B.
    fn ls2d_events_hits(world: u32, events: Out<'_, RawHitEvent>, capacity: usize, count: Out<'_, usize>) {
        copy(world, |world| &world.events().hits, RawHitEvent::of, events, capacity, count)
    }

    /// Shapes that began to overlap a sensor, sorted by `fraction`.
    fn ls2d_events_sensor_begin(
        world: u32,
        events: Out<'_, RawSensorEvent>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        copy(world, |world| &world.events().sensor_begin, RawSensorEvent::of, events, capacity, count)
    }

    /// Shapes that ceased to overlap a sensor, sorted by `fraction`.
    fn ls2d_events_sensor_end(
        world: u32,
        events: Out<'_, RawSensorEvent>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        copy(world, |world| &world.events().sensor_end, RawSensorEvent::of, events, capacity, count)
    }

    /// Joints whose force or torque exceeded its threshold in the last sub-step of the tick, in slot order.
    fn ls2d_events_joints(world: u32, events: Out<'_, RawJointEvent>, capacity: usize, count: Out<'_, usize>) {
        copy(world, |world| &world.events().joints, RawJointEvent::of, events, capacity, count)
    }
}
