//! What a step changes of bodies and of the boxes of their shapes, as bytes.
//!
//! Of every body 36 bytes: centre (2 x i64), angle (u32), velocity (2 x i32), spin (i32), rest ticks (u32). After all of
//! them, of those that are pushed, sleep or have a target, the slot (u32), which of the following there are (u8), and
//! these: force and torque (3 x i64), island (2 x u32), target (2 x i64, u32).
//!
//! Of every shape of a body that is not fixed 16 bytes: the corners of its fat box about the body's centre in units of
//! 2^-22 m (4 x i32). A box that is not on this grid or too far away has `i32::MIN` in the first place, and comes in full
//! (4 x i64) after all others.

use alloc::boxed::Box;
use alloc::vec::Vec;

use super::packing::{Fields, Reader, Record, Writer, low_half, put_records};
use crate::body::{Arena, Body, BodyId, BodyKind, Handle, IslandId, Pose, Shape, ShapeId};
use crate::math::{Aabb, Angle, Fx, Speed, Vec2};
use crate::world::change::FAT_GRID_SHIFT;

const FORCE: u8 = 1;
const ISLAND: u8 = 2;
const TARGET: u8 = 4;

const BODY_BYTES: usize = 36;
/// At most.
const SPECIAL_BYTES: usize = 5 + 24 + 8 + 20;
const BOX_BYTES: usize = 16;
/// In the place of the first step of a box that comes in full.
const NOT_NEAR: i32 = i32::MIN;

type Bodies = Arena<Body, BodyId>;
type Shapes = Arena<Shape, ShapeId>;

/// A body without what a step changes.
pub(super) fn lasting_body(body: &Body) -> Body {
    let mut body = body.clone();
    set_motion(&mut body, &mut Reader(&[0; BODY_BYTES]).record());
    (body.force, body.torque, body.island, body.target) = (Vec2::ZERO, Fx::ZERO, None, None);
    body
}

/// A shape without what a step changes: its box, unless its body is fixed.
pub(super) fn lasting_shape(shape: &Shape, bodies: &Bodies) -> Shape {
    let fat = if is_fixed(shape, bodies) { shape.fat } else { Aabb::default() };
    Shape { fat, ..shape.clone() }
}

fn is_fixed(shape: &Shape, bodies: &Bodies) -> bool {
    bodies.get(shape.body).is_some_and(|body| body.kind == BodyKind::Fixed)
}

/// Packs bodies, and the boxes of their shapes on the way if these come in the order of their slots: bodies are large, and
/// to go to each of them twice takes most of the time.
pub(super) fn pack_bodies(bodies: &Bodies, shapes: &Shapes, bytes: &mut Vec<u8>, box_bytes: &mut Vec<u8>) {
    let mut special = Vec::new();
    let mut boxes = BoxWriter::new(box_bytes, shapes);
    let (mut next, mut in_order) = (0, true);
    put_records(bytes, bodies.len(), bodies.iter(), |(id, body), record: &mut Record<'_, BODY_BYTES>| {
        for shape in body.shapes() {
            in_order &= shape.slot() >= next;
            next = shape.slot() + 1;
            if in_order && body.kind != BodyKind::Fixed {
                boxes.put(shapes.at(shape.slot()).fat, body.centre);
            }
        }
        put_place(record, body.centre, body.angle);
        record.put(body.velocity.x.to_bits());
        record.put(body.velocity.y.to_bits());
        record.put(body.spin.to_bits());
        record.put(body.rest_ticks);
        if specials(body) != 0 {
            special.push((id, body));
        }
    });
    boxes.finish();
    if !in_order {
        pack_boxes(shapes, bodies, box_bytes);
    }
    let mut rest = Vec::new();
    let mut writer = Writer::new(&mut rest, special.len() * SPECIAL_BYTES);
    special.into_iter().for_each(|(id, body)| writer.record(|record| pack_special(id, body, record)));
    drop(writer);
    bytes.extend_from_slice(&rest);
}

fn specials(body: &Body) -> u8 {
    let pushed = body.force != Vec2::ZERO || body.torque != Fx::ZERO;
    let mark = |there: bool, flag: u8| if there { flag } else { 0 };
    mark(pushed, FORCE) | mark(body.island.is_some(), ISLAND) | mark(body.target.is_some(), TARGET)
}

fn pack_special(id: BodyId, body: &Body, record: &mut Record<'_, SPECIAL_BYTES>) {
    let specials = specials(body);
    record.put(id.slot());
    record.put(specials);
    if specials & FORCE != 0 {
        record.put(body.force.x.to_bits());
        record.put(body.force.y.to_bits());
        record.put(body.torque.to_bits());
    }
    if let Some(island) = body.island {
        record.put(island.slot());
        record.put(island.generation());
    }
    if let Some(target) = &body.target {
        put_place(record, target.centre, target.angle);
    }
}

#[inline(always)]
fn put_place<const N: usize>(record: &mut Record<'_, N>, centre: Vec2<Fx>, angle: Angle) {
    record.put(centre.x.to_bits());
    record.put(centre.y.to_bits());
    record.put(angle.to_bits());
}

/// Gives the bodies back what was packed, and calls `moved` with the slots of those that it takes to another place: by
/// how much, unless it also turns them.
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
        let specials: u8 = head.take();
        if specials & FORCE != 0 {
            let mut force: Fields<'_, 24> = reader.record();
            body.force = take_point(&mut force);
            body.torque = Fx::from_bits(force.take());
        }
        if specials & ISLAND != 0 {
            let mut island: Fields<'_, 8> = reader.record();
            body.island = Some(IslandId::from_parts(island.take(), island.take()));
        }
        if specials & TARGET != 0 {
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
    body.rest_ticks = fields.take();
}

#[inline(always)]
fn take_place<const N: usize>(fields: &mut Fields<'_, N>) -> Pose {
    Pose { centre: take_point(fields), angle: Angle::from_bits(fields.take()) }
}

#[inline(always)]
fn take_point<const N: usize>(fields: &mut Fields<'_, N>) -> Vec2<Fx> {
    Vec2::new(Fx::from_bits(fields.take()), Fx::from_bits(fields.take()))
}

fn pack_boxes(shapes: &Shapes, bodies: &Bodies, bytes: &mut Vec<u8>) {
    let mut boxes = BoxWriter::new(bytes, shapes);
    for (_, shape) in shapes.iter() {
        let body = bodies.at(shape.body.slot());
        if body.kind != BodyKind::Fixed {
            boxes.put(shape.fat, body.centre);
        }
    }
    boxes.finish();
}

/// Writes boxes, in the order of the slots of their shapes.
struct BoxWriter<'a> {
    near: Writer<'a>,
    far: Vec<i64>,
}

impl<'a> BoxWriter<'a> {
    fn new(bytes: &'a mut Vec<u8>, shapes: &Shapes) -> Self {
        BoxWriter { near: Writer::new(bytes, shapes.len() * BOX_BYTES), far: Vec::new() }
    }

    /// The box of a shape whose body's centre is there.
    #[inline(always)]
    fn put(&mut self, fat: Aabb, centre: Vec2<Fx>) {
        let near = about(fat, centre);
        if near.is_none() {
            self.far.extend(corners(fat).map(Fx::to_bits));
        }
        let steps = near.unwrap_or([NOT_NEAR, 0, 0, 0]);
        let put = |record: &mut Record<'_, BOX_BYTES>| steps.into_iter().for_each(|step| record.put(step));
        self.near.record(put);
    }

    fn finish(mut self) {
        for corner in self.far {
            self.near.record(|record: &mut Record<'_, 8>| record.put(corner));
        }
    }
}

fn corners(fat: Aabb) -> [Fx; 4] {
    [fat.lower.x, fat.lower.y, fat.upper.x, fat.upper.y]
}

/// A box in steps of the grid from a point, if it is on the grid and the steps are few enough.
#[inline(always)]
fn about(fat: Aabb, centre: Vec2<Fx>) -> Option<[i32; 4]> {
    let [left, bottom, right, top] = corners(fat).map(Fx::to_bits);
    // Shifted right, so that differences cannot overflow.
    let (x, y) = (centre.x.to_bits() >> FAT_GRID_SHIFT, centre.y.to_bits() >> FAT_GRID_SHIFT);
    let steps = |bits: i64, origin: i64| (bits >> FAT_GRID_SHIFT) - origin;
    let steps = [steps(left, x), steps(bottom, y), steps(right, x), steps(top, y)];
    let off_grid = (left | bottom | right | top) & ((1 << FAT_GRID_SHIFT) - 1);
    // 0 if a step fits 32 bits and is not less; the first has to say as well that the box is near.
    let misfit = |step: i64, least: i32| (step - i64::from(least)) >> u32::BITS;
    let [a, b, c, d] = steps;
    let a = misfit(a, NOT_NEAR + 1);
    let [b, c, d] = [b, c, d].map(|step| misfit(step, i32::MIN));
    (off_grid | a | b | c | d == 0).then(|| steps.map(low_half))
}

/// Gives the shapes back the boxes that were packed, and calls `changed` with the slots and boxes of those that were other
/// ones.
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
