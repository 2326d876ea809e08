//! Floats for drawing, which never enter a world.
#![expect(
    clippy::disallowed_types,
    clippy::float_arithmetic,
    reason = "for drawing, never for the simulation"
)]

use lockstep2d::body::Body;
use lockstep2d::math::Fx;
use lockstep2d::world::World;

use crate::border::{Out, Plain};
use crate::describe::{CType, api};
use crate::numbers::RawBody;
use crate::table::with;

// SAFETY: every byte pattern is a float, and there is no padding.
unsafe impl Plain for f64 {}

impl CType for f64 {
    const BASE: &'static str = "double";
}

/// Resolution of the numbers of a world: 2^-32.
const UNIT: f64 = 1.0 / 4_294_967_296.0;

#[expect(clippy::cast_precision_loss, reason = "rounded to nearest, for drawing")]
fn float(value: Fx) -> f64 {
    value.to_bits() as f64 * UNIT
}

/// A handle as a float, exactly, because a handle has at most 53 bits.
#[expect(clippy::cast_precision_loss, reason = "at most 53 bits")]
fn number(id: RawBody) -> f64 {
    id.0 as f64
}

/// A row of `ls2d_draw_poses`.
fn row(id: RawBody, body: &Body) -> [f64; 5] {
    let (position, angle) = (body.position(), body.angle().to_radians());
    let awake = if body.is_asleep() { 0.0 } else { 1.0 };
    [number(id), float(position.x), float(position.y), float(angle), awake]
}

api! {
    /// Poses of all enabled bodies in slot order, for drawing. A pose has five numbers: handle, x and y in metres,
    /// angle in rad, and 1 if the body is awake, otherwise 0. `capacity` and `count` are numbers of `double`s.
    fn ls2d_draw_poses(world: u32, rows: Out<'_, f64>, capacity: usize, count: Out<'_, usize>) {
        let (mut rows, mut count) = (rows, count);
        with(world, |world: &mut World| {
            let enabled = world.bodies().filter(|(_, body)| body.is_enabled());
            let all: Vec<f64> = enabled.flat_map(|(id, body)| row(RawBody::of(id), body)).collect();
            rows.set_all(capacity, &mut count, &all)
        })
    }
}
