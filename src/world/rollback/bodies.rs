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

use super::packing::{Fields, Reader, Record, low_half};
use crate::body::{Arena, Body, BodyId, BodyKind, Handle, IslandId, Pose, Shape, ShapeId};
use crate::hash::StateHash;
use crate::math::{Aabb, Angle, Fx, Speed, Vec2};
use crate::world::change::FAT_GRID_SHIFT;
use crate::world::state::State;

const FORCE: u8 = 1;
const ISLAND: u8 = 2;
const TARGET: u8 = 4;

const BODY_BYTES: usize = 36;
/// At most.
const SPECIAL_BYTES: usize = 5 + 24 + 8 + 20;
const BOX_BYTES: usize = 16;
/// Bodies that are packed before their boxes.
const BLOCK: usize = 32;
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

/// Bodies and the boxes of their shapes, each as bytes, or the digests of these.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::world) struct PackedBodies<T = Vec<u8>> {
    pub(super) bodies: T,
    pub(super) boxes: T,
}

impl PackedBodies {
    pub(super) fn of(state: &State) -> Self {
        let mut packed = PackedBodies::default();
        packed.fill(state, |_, _| {});
        packed
    }

    /// Packs all bodies, and calls `visit` with each while it is near; and the boxes of their shapes while their bodies are
    /// near: those of a block of bodies after these, if shapes come in the order of their bodies.
    pub(in crate::world) fn fill(&mut self, state: &State, mut visit: impl FnMut(BodyId, &Body)) {
        let State { bodies, shapes, .. } = state;
        let PackedBodies { bodies: motions, boxes } = self;
        motions.resize(bodies.len() * BODY_BYTES, 0);
        let mut boxes = BoxWriter::new(boxes, shapes);
        let (mut bodies_left, mut shapes_left) = (bodies.iter(), shapes.iter().peekable());
        for start in (0..bodies.len()).step_by(BLOCK) {
            let block = start * BODY_BYTES..bodies.len().min(start + BLOCK) * BODY_BYTES;
            let (mut special, mut specials_len, mut end) = ([0; BLOCK], 0, 0);
            for (bytes, (id, body)) in motions[block].as_chunks_mut().0.iter_mut().zip(bodies_left.by_ref()) {
                pack_motion(body, Record::new(bytes));
                if specials(body) != 0 {
                    special[specials_len] = id.slot();
                    specials_len += 1;
                }
                visit(id, body);
                end = id.slot();
            }
            for &slot in &special[..specials_len] {
                pack_special(slot, bodies.at(slot), motions);
            }
            while let Some((_, shape)) = shapes_left.next_if(|(_, shape)| shape.body.slot() <= end) {
                boxes.pack(shape, bodies);
            }
        }
        shapes_left.for_each(|(_, shape)| boxes.pack(shape, bodies));
        boxes.finish();
    }

    /// Becomes a copy, in the memory that it has.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.bodies.clone_from(&other.bodies);
        self.boxes.clone_from(&other.boxes);
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
    record.put(body.rest_ticks);
}

/// What a body has of what most have not. Without branches: most have none of it.
#[inline(always)]
fn specials(body: &Body) -> u8 {
    let pushes = body.force.x.to_bits() | body.force.y.to_bits() | body.torque.to_bits();
    let mark = |there: bool, flag: u8| u8::from(there) * flag;
    mark(pushes != 0, FORCE) | mark(body.island.is_some(), ISLAND) | mark(body.target.is_some(), TARGET)
}

/// Appends what [`specials`] tells of.
fn pack_special(slot: u32, body: &Body, bytes: &mut Vec<u8>) {
    let (specials, mut record) = (specials(body), [0; SPECIAL_BYTES]);
    let mut record = Record::new(&mut record);
    record.put(slot);
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

/// Writes boxes, in the order of the slots of their shapes.
struct BoxWriter<'a> {
    bytes: &'a mut Vec<u8>,
    count: usize,
    far: Vec<Aabb>,
}

impl<'a> BoxWriter<'a> {
    /// Makes room for a box of every shape.
    fn new(bytes: &'a mut Vec<u8>, shapes: &Shapes) -> Self {
        bytes.resize(shapes.len() * BOX_BYTES, 0);
        BoxWriter { bytes, count: 0, far: Vec::new() }
    }

    /// The box of the next shape, if its body is not fixed.
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

/// A box in steps of the grid from a point in the world, if it is on the grid and the steps are few enough.
#[inline(always)]
fn about(fat: Aabb, centre: Vec2<Fx>) -> Option<[i32; 4]> {
    const GRID: i64 = 1 << FAT_GRID_SHIFT;
    /// As many steps below the point as there may be.
    const LOWEST: i64 = (i32::MIN as i64) << FAT_GRID_SHIFT;
    /// The bits of what is on the grid, and not more than all steps there are above the lowest.
    const NEAR: i64 = (u32::MAX as i64) << FAT_GRID_SHIFT;
    let lowest = |centre: Fx| (centre.to_bits() & -GRID) + LOWEST;
    let (x, y) = (lowest(centre.x), lowest(centre.y));
    let [left, bottom, right, top] = corners(fat).map(Fx::to_bits);
    // What wraps around is still too far: a point in the world leaves a quarter of all numbers between.
    let above = |bits: i64, lowest: i64| bits.wrapping_sub(lowest);
    let above = [above(left, x), above(bottom, y), above(right, x), above(top, y)];
    let [a, b, c, d] = above;
    // The first has to say as well that the box is near, and cannot be the lowest.
    let bits = a | a.wrapping_sub(GRID) | b | c | d;
    (bits & !NEAR == 0).then(|| above.map(|above| low_half(above >> FAT_GRID_SHIFT) ^ i32::MIN))
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
