//! Packed bodies and fat boxes.
//!
//! Each body takes 36 bytes: centre (2 x i64), angle (u32), velocity (2 x i32), spin (i32), rest ticks (u32). After all
//! bodies, a record follows for each body with a force, an island or a target: the slot (u32), flags for the parts that
//! follow (u8), and these parts: force and torque (3 x i64), island (2 x u32), target (2 x i64, u32).
//!
//! Each shape of a body that is not fixed takes 16 bytes: the corners of its fat box in units of 2^-22 m (4 x i32),
//! relative to the body's centre, rounded down to this grid. For a box off the grid or too far away, the first
//! coordinate is `i32::MIN`, and the whole box (4 x i64) follows after the records of all shapes.

use alloc::boxed::Box;
use alloc::vec::Vec;

use super::packing::{Fields, Reader, Record, low_half};
use crate::body::{Arena, Body, BodyId, BodyKind, Handle, IslandId, Pose, RestTicks, Shape, ShapeId};
use crate::hash::StateHash;
use crate::math::{Aabb, Angle, Fx, Speed, Vec2};
use crate::world::derived::FAT_GRID_SHIFT;
use crate::world::state::State;

const FORCE: u8 = 1;
const ISLAND: u8 = 2;
const TARGET: u8 = 4;

const BODY_BYTES: usize = 36;
const OPTIONAL_BYTES: usize = 5 + 24 + 8 + 20;
const BOX_BYTES: usize = 16;
/// Number of bodies in a block. The boxes of a block are packed right after its bodies, while the centres of the bodies
/// are in the processor's cache.
const BLOCK: usize = 32;
/// Marker in place of the first coordinate of a box that is stored in full after the records.
const NOT_NEAR: i32 = i32::MIN;

type Bodies = Arena<Body, BodyId>;
type Shapes = Arena<Shape, ShapeId>;

/// A copy of a body without the parts that ticks change: these are 0 or `None`.
pub(super) fn lasting_body(body: &Body) -> Body {
    let mut body = body.clone();
    set_motion(&mut body, &mut Reader(&[0; BODY_BYTES]).record());
    (body.force, body.torque, body.island, body.target) = (Vec2::ZERO, Fx::ZERO, None, None);
    body
}

/// A copy of a shape. If its body is not fixed, the copy has the default box in place of the fat box.
pub(super) fn lasting_shape(shape: &Shape, bodies: &Bodies) -> Shape {
    let fat = if is_fixed(shape, bodies) { shape.fat } else { Aabb::default() };
    Shape { fat, ..shape.clone() }
}

fn is_fixed(shape: &Shape, bodies: &Bodies) -> bool {
    bodies.get(shape.body).is_some_and(|body| body.kind == BodyKind::Fixed)
}

/// Packed bodies and fat boxes, as bytes or as the digests of these bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PackedBodies<T = Vec<u8>> {
    pub(super) bodies: T,
    pub(super) boxes: T,
}

impl PackedBodies {
    /// Packs bodies and fat boxes into the existing memory.
    pub(super) fn pack(&mut self, state: &State) {
        let State { bodies, shapes, .. } = state;
        let PackedBodies { bodies: motions, boxes } = self;
        motions.resize(bodies.len() * BODY_BYTES, 0);
        let mut boxes = BoxWriter::new(boxes, shapes);
        let (mut bodies_left, mut shapes_left) = (bodies.iter(), shapes.iter().peekable());
        for start in (0..bodies.len()).step_by(BLOCK) {
            let block = start * BODY_BYTES..bodies.len().min(start + BLOCK) * BODY_BYTES;
            let (mut with_parts, mut count, mut end) = ([0; BLOCK], 0, 0);
            for (bytes, (id, body)) in motions[block].as_chunks_mut().0.iter_mut().zip(bodies_left.by_ref()) {
                pack_motion(body, Record::new(bytes));
                if optional_parts(body) != 0 {
                    with_parts[count] = id.slot();
                    count += 1;
                }
                end = id.slot();
            }
            for &slot in &with_parts[..count] {
                pack_optional(slot, bodies.at(slot), motions);
            }
            while let Some((_, shape)) = shapes_left.next_if(|(_, shape)| shape.body.slot() <= end) {
                boxes.pack(shape, bodies);
            }
        }
        shapes_left.for_each(|(_, shape)| boxes.pack(shape, bodies));
        boxes.finish();
    }

    pub(super) fn digests(&self) -> PackedBodies<StateHash> {
        PackedBodies { bodies: StateHash::of_bytes(&self.bodies), boxes: StateHash::of_bytes(&self.boxes) }
    }
}

#[inline(always)]
fn pack_motion(body: &Body, mut record: Record<'_, BODY_BYTES>) {
    put_place(&mut record, body.centre, body.angle);
    record.put(body.velocity.x.to_bits());
    record.put(body.velocity.y.to_bits());
    record.put(body.spin.to_bits());
    record.put(body.rest_ticks.to_bits());
}

/// The flags of a body's record, computed without branches.
#[inline(always)]
fn optional_parts(body: &Body) -> u8 {
    let force = body.force.x.to_bits() | body.force.y.to_bits() | body.torque.to_bits();
    let flag_if = |present: bool, flag: u8| u8::from(present) * flag;
    flag_if(force != 0, FORCE)
        | flag_if(body.island.is_some(), ISLAND)
        | flag_if(body.target.is_some(), TARGET)
}

fn pack_optional(slot: u32, body: &Body, bytes: &mut Vec<u8>) {
    let (parts, mut record) = (optional_parts(body), [0; OPTIONAL_BYTES]);
    let mut record = Record::new(&mut record);
    record.put(slot);
    record.put(parts);
    if parts & FORCE != 0 {
        record.put(body.force.x.to_bits());
        record.put(body.force.y.to_bits());
        record.put(body.torque.to_bits());
    }
    if let Some(island) = body.island {
        record.put(island.slot());
        record.put(island.generation());
    }
    if let Some(target) = &body.target {
        put_place(&mut record, target.centre, target.angle);
    }
    bytes.extend_from_slice(record.written());
}

#[inline(always)]
fn put_place<const N: usize>(record: &mut Record<'_, N>, centre: Vec2<Fx>, angle: Angle) {
    record.put(centre.x.to_bits());
    record.put(centre.y.to_bits());
    record.put(angle.to_bits());
}

/// Restores bodies. Calls `moved` with the slot of each body whose pose changes: with `None` if its rotation changes,
/// otherwise with its displacement.
pub(super) fn unpack_bodies(bodies: &mut Bodies, bytes: &[u8], mut moved: impl FnMut(u32, Option<Vec2<Fx>>)) {
    let mut reader = Reader(bytes);
    let mut motions = reader.part(bodies.len() * BODY_BYTES);
    for (id, body) in bodies.iter_mut() {
        let before = Pose { centre: body.centre, angle: body.angle };
        set_motion(body, &mut motions.record());
        (body.force, body.torque, body.island, body.target) = (Vec2::ZERO, Fx::ZERO, None, None);
        let by = body.centre - before.centre;
        if body.angle != before.angle {
            moved(id.slot(), None);
        } else if by != Vec2::ZERO {
            moved(id.slot(), Some(by));
        }
    }
    while !reader.is_empty() {
        let mut head: Fields<'_, 5> = reader.record();
        let body = bodies.at_mut(head.take());
        let parts: u8 = head.take();
        if parts & FORCE != 0 {
            let mut force: Fields<'_, 24> = reader.record();
            body.force = take_point(&mut force);
            body.torque = Fx::from_bits(force.take());
        }
        if parts & ISLAND != 0 {
            let mut island: Fields<'_, 8> = reader.record();
            body.island = Some(IslandId::from_parts(island.take(), island.take()));
        }
        if parts & TARGET != 0 {
            let mut target: Fields<'_, 20> = reader.record();
            body.target = Some(Box::new(take_place(&mut target)));
        }
    }
}

#[inline(always)]
fn set_motion(body: &mut Body, fields: &mut Fields<'_, BODY_BYTES>) {
    Pose { centre: body.centre, angle: body.angle } = take_place(fields);
    body.velocity = Vec2::new(Speed::from_bits(fields.take()), Speed::from_bits(fields.take()));
    body.spin = Speed::from_bits(fields.take());
    body.rest_ticks = RestTicks::from_bits(fields.take());
}

#[inline(always)]
fn take_place<const N: usize>(fields: &mut Fields<'_, N>) -> Pose {
    Pose { centre: take_point(fields), angle: Angle::from_bits(fields.take()) }
}

#[inline(always)]
fn take_point<const N: usize>(fields: &mut Fields<'_, N>) -> Vec2<Fx> {
    Vec2::new(Fx::from_bits(fields.take()), Fx::from_bits(fields.take()))
}

struct BoxWriter<'a> {
    bytes: &'a mut Vec<u8>,
    count: usize,
    far: Vec<Aabb>,
}

impl<'a> BoxWriter<'a> {
    fn new(bytes: &'a mut Vec<u8>, shapes: &Shapes) -> Self {
        bytes.resize(shapes.len() * BOX_BYTES, 0);
        BoxWriter { bytes, count: 0, far: Vec::new() }
    }

    /// Packs the box of the next shape, unless its body is fixed.
    #[inline(always)]
    fn pack(&mut self, shape: &Shape, bodies: &Bodies) {
        let body = bodies.at(shape.body.slot());
        if body.kind == BodyKind::Fixed {
            return;
        }
        let near = about(shape.fat, body.centre);
        if near.is_none() {
            self.far.push(shape.fat);
        }
        let mut record = Record::new(&mut self.bytes.as_chunks_mut::<BOX_BYTES>().0[self.count]);
        near.unwrap_or([NOT_NEAR, 0, 0, 0]).into_iter().for_each(|step| record.put(step));
        self.count += 1;
    }

    fn finish(self) {
        self.bytes.truncate(self.count * BOX_BYTES);
        let corners = self.far.into_iter().flat_map(corners);
        self.bytes.extend(corners.flat_map(|corner| corner.to_bits().to_le_bytes()));
    }
}

fn corners(fat: Aabb) -> [Fx; 4] {
    [fat.lower.x, fat.lower.y, fat.upper.x, fat.upper.y]
}

/// The corners of a box as numbers of grid steps from a world point. `None` if a corner is off the grid or too far
/// away.
#[inline(always)]
fn about(fat: Aabb, centre: Vec2<Fx>) -> Option<[i32; 4]> {
    const GRID: i64 = 1 << FAT_GRID_SHIFT;
    const LOWEST: i64 = (i32::MIN as i64) << FAT_GRID_SHIFT;
    /// A coordinate can be packed if its difference from the lowest packable coordinate has no bits outside of this
    /// mask.
    const NEAR: i64 = (u32::MAX as i64) << FAT_GRID_SHIFT;
    let lowest = |centre: Fx| (centre.to_bits() & -GRID) + LOWEST;
    let (x, y) = (lowest(centre.x), lowest(centre.y));
    let [left, bottom, right, top] = corners(fat).map(Fx::to_bits);
    // Subtraction may wrap around for a box far away. The difference is then still out of range, because `centre` is
    // within the world extent.
    let above = |bits: i64, lowest: i64| bits.wrapping_sub(lowest);
    let above = [above(left, x), above(bottom, y), above(right, x), above(top, y)];
    let [a, b, c, d] = above;
    // Also rejects the lowest value of the first coordinate, which would be packed as the marker `NOT_NEAR`.
    let bits = a | a.wrapping_sub(GRID) | b | c | d;
    (bits & !NEAR == 0).then(|| above.map(|above| low_half(above >> FAT_GRID_SHIFT) ^ i32::MIN))
}

/// Restores fat boxes. Calls `changed` with the slot and the box of each changed box.
pub(super) fn unpack_boxes(
    shapes: &mut Shapes,
    bodies: &Bodies,
    bytes: &[u8],
    mut changed: impl FnMut(u32, Aabb),
) {
    let mut reader = Reader(bytes);
    let mut far = Vec::new();
    let mut set = |slot: u32, shape: &mut Shape, fat: Aabb| {
        if shape.fat != fat {
            shape.fat = fat;
            changed(slot, fat);
        }
    };
    for (id, shape) in shapes.iter_mut() {
        let body = bodies.at(shape.body.slot());
        if body.kind == BodyKind::Fixed {
            continue;
        }
        let mut fields: Fields<'_, BOX_BYTES> = reader.record();
        let steps: [i32; 4] = core::array::from_fn(|_| fields.take());
        if steps[0] == NOT_NEAR {
            far.push(id.slot());
            continue;
        }
        let corner = |x: i32, y: i32| Vec2::new(at_step(body.centre.x, x), at_step(body.centre.y, y));
        set(id.slot(), shape, Aabb::new(corner(steps[0], steps[1]), corner(steps[2], steps[3])));
    }
    for slot in far {
        let mut fields: Fields<'_, 32> = reader.record();
        let fat = Aabb::new(take_point(&mut fields), take_point(&mut fields));
        set(slot, shapes.at_mut(slot), fat);
    }
}

fn at_step(centre: Fx, step: i32) -> Fx {
    Fx::from_bits(((centre.to_bits() >> FAT_GRID_SHIFT) + i64::from(step)) << FAT_GRID_SHIFT)
}
