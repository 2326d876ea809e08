//! A world's state with all its fields in reach: the layout of `docs/FORMAT.md`, to change single fields of a
//! snapshot and leave the rest valid.

use lockstep2d::body::{BodyDef, BodyKind, MassProperties, MassSource, ShapeDef};
use lockstep2d::codec;
use lockstep2d::math::{Aabb, Fx, Vec2};
use lockstep2d::solver::JointDef;
use lockstep2d::world::{Config, World};
use serde::{Deserialize, Serialize};

use crate::generator::{self, serde_handle::Handle as _};
use crate::shapes;
use crate::source::Source;

/// Magic, format, semantics, length.
const HEADER_BYTES: usize = 24;
const HASH_BYTES: usize = 16;

/// Slot and generation.
type Handle = (u32, u32);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Slot<T> {
    generation: u32,
    value: Option<T>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Arena<T> {
    slots: Vec<Slot<T>>,
    free: Vec<u32>,
    retired: u32,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Body {
    kind: BodyKind,
    centre: (i64, i64),
    angle: u32,
    velocity: (i32, i32),
    spin: i32,
    force: (i64, i64),
    torque: i64,
    mass_source: MassSource,
    mass: MassProperties,
    linear_damping: i64,
    angular_damping: i64,
    gravity_scale: i64,
    shapes: Vec<Handle>,
    user_data: u64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Shape {
    body: Handle,
    def: ShapeDef,
    fat: Aabb,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Joint {
    def: JointDef,
    lambda: (i32, i32),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Point {
    feature: u16,
    normal: i32,
    tangent: i32,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Contact {
    shapes: (u32, u32),
    touching: bool,
    count: u8,
    points: [Point; 2],
}

/// The state of a world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    config: Config,
    tick: u64,
    faults: u64,
    bodies: Arena<Body>,
    shapes: Arena<Shape>,
    joints: Arena<Joint>,
    contacts: Vec<Contact>,
    pairs_left_out: bool,
    removed_contacts: Vec<(Handle, Handle)>,
    rng: (u64, u64),
}

/// The largest components of a velocity and of an impulse, in raw units of `Speed`.
const SPEED_MAX: i64 = 511 << 21;
const IMPULSE_MAX: i64 = 1023 << 21;
/// How far away a centre of mass may be, in raw units of `Fx`.
const CENTRE_MAX: i64 = ((1 << 30) + 1024) << 32;
const REACH_MAX: i64 = 256 << 32;

impl<T> Arena<T> {
    /// The slot number of some value.
    fn pick(&self, source: &mut Source<'_>) -> Option<usize> {
        let occupied = |(index, slot): (usize, &Slot<T>)| slot.value.is_some().then_some(index);
        let occupied: Vec<usize> = self.slots.iter().enumerate().filter_map(occupied).collect();
        (!occupied.is_empty()).then(|| source.pick(&occupied))
    }

    fn handle(&self, index: usize) -> Handle {
        (index as u32, self.slots[index].generation)
    }

    fn get(&mut self, index: usize) -> Option<&mut T> {
        self.slots.get_mut(index)?.value.as_mut()
    }

    fn values(&mut self) -> impl Iterator<Item = &mut T> {
        self.slots.iter_mut().filter_map(|slot| slot.value.as_mut())
    }

    /// Another order of vacant slots, one more of them, or one whose generations are used up.
    fn alter_vacancies(&mut self, source: &mut Source<'_>) {
        match source.below(4) {
            0 => {
                let (a, b) = (source.below(self.free.len()), source.below(self.free.len()));
                if !self.free.is_empty() {
                    self.free.swap(a, b);
                }
            }
            1 | 2 => {
                let generation = source.within(0, u32::MAX.into()) as u32;
                self.free.push(self.slots.len() as u32);
                self.slots.push(Slot { generation, value: None });
            }
            _ => {
                self.slots.push(Slot { generation: u32::MAX, value: None });
                self.retired += 1;
            }
        }
    }
}

fn pair(source: &mut Source<'_>, low: i64, high: i64) -> (i64, i64) {
    (source.within(low, high), source.within(low, high))
}

fn speed(source: &mut Source<'_>, limit: i64) -> i32 {
    source.within(-limit, limit) as i32
}

fn vector((x, y): (i64, i64)) -> Vec2<Fx> {
    Vec2::new(Fx::from_bits(x), Fx::from_bits(y))
}

impl State {
    /// The state in the bytes of a world.
    ///
    /// # Panics
    /// When the layout is not the one described here.
    #[must_use]
    pub fn of(world: &World) -> Self {
        let bytes = world.to_bytes();
        let state = &bytes[HEADER_BYTES..bytes.len() - HASH_BYTES];
        let mirror: State = codec::decode(state).expect("the layout of a world's state");
        debug_assert_eq!(codec::encode(&mirror), state, "the layout of a world's state");
        mirror
    }

    /// The encoding of the state, without header and hash.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        codec::encode(self)
    }

    /// Changes something in a way that is often valid. Nothing is changed when there is nothing to change, or
    /// when a body's mass would not follow from its shapes.
    pub fn alter(&mut self, source: &mut Source<'_>) {
        let before = self.clone();
        if self.try_alter(source).is_none() {
            *self = before;
        }
    }

    fn try_alter(&mut self, source: &mut Source<'_>) -> Option<()> {
        match source.below(20) {
            0..=6 => {
                let index = self.bodies.pick(source)?;
                self.alter_body(source, index)
            }
            7..=9 => {
                let index = self.shapes.pick(source)?;
                self.alter_shape(source, index)
            }
            10..=12 => self.alter_contact(source),
            13 | 14 => self.alter_joint(source),
            15 => {
                let calm = source.is_calm();
                let limits = self.config;
                self.config = generator::config(source);
                source.set_calm(calm);
                let Config { body_limit, shape_limit, joint_limit, .. } = limits;
                self.config = Config { body_limit, shape_limit, joint_limit, ..self.config };
                if source.one_in(2) {
                    self.config.pair_limit = source.below(30) as u32;
                }
                Some(())
            }
            16 => {
                match source.below(6) {
                    0 => self.tick = source.within(i64::MIN, i64::MAX) as u64,
                    1 => self.faults = source.within(i64::MIN, i64::MAX) as u64,
                    2 => self.rng = (source.word(), source.word()),
                    3 => self.pairs_left_out = !self.pairs_left_out,
                    4 => self.config.body_limit = self.bodies.values().count() as u32,
                    _ => self.config.shape_limit = self.shapes.values().count() as u32,
                }
                Some(())
            }
            17 => {
                let a = self.shapes.pick(source).map_or((source.byte().into(), 0), |a| self.shapes.handle(a));
                let b = (source.below(300) as u32, source.within(0, u32::MAX.into()) as u32);
                self.removed_contacts.push((a, b));
                Some(())
            }
            18 => {
                match source.below(3) {
                    0 => self.bodies.alter_vacancies(source),
                    1 => self.shapes.alter_vacancies(source),
                    _ => self.joints.alter_vacancies(source),
                }
                Some(())
            }
            _ => self.alter_generation(source),
        }
    }

    fn alter_body(&mut self, source: &mut Source<'_>, index: usize) -> Option<()> {
        let other = self.bodies.pick(source)?;
        let near = self.bodies.get(other)?.centre;
        let body = self.bodies.get(index)?;
        match source.below(14) {
            0 => body.centre = pair(source, -CENTRE_MAX, CENTRE_MAX),
            1 | 2 => {
                let (x, y) = pair(source, -(2 << 32), 2 << 32);
                body.centre = (near.0.saturating_add(x), near.1.saturating_add(y));
            }
            3 => body.angle = source.word() as u32,
            4 | 5 if body.kind != BodyKind::Fixed => {
                body.velocity = (speed(source, SPEED_MAX), speed(source, SPEED_MAX));
            }
            6 if body.kind != BodyKind::Fixed => body.spin = speed(source, SPEED_MAX),
            7 if body.kind == BodyKind::Dynamic => body.force = pair(source, i64::MIN, i64::MAX),
            8 if body.kind == BodyKind::Dynamic => body.torque = source.within(i64::MIN, i64::MAX),
            9 => body.linear_damping = source.within(0, 1000 << 32),
            10 => body.angular_damping = source.within(0, 1000 << 32),
            11 => body.gravity_scale = source.within(-(1000 << 32), 1000 << 32),
            12 => {
                body.mass_source = MassSource::Given {
                    mass: Fx::from_bits(source.within(42_950, 1 << 62)),
                    centre: vector(pair(source, -REACH_MAX, REACH_MAX)),
                    gyration: Fx::from_bits(source.within(8_589_935, 512 << 32)),
                };
                return self.weigh(index);
            }
            _ => {
                body.kind = source.pick(&[BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Fixed]);
                if body.kind != BodyKind::Dynamic {
                    (body.force, body.torque) = ((0, 0), 0);
                }
                if body.kind == BodyKind::Fixed {
                    (body.velocity, body.spin) = ((0, 0), 0);
                }
                return self.weigh(index);
            }
        }
        Some(())
    }

    /// Lets a body's mass follow from its shapes, as a new world would.
    fn weigh(&mut self, index: usize) -> Option<()> {
        let body = self.bodies.get(index)?.clone();
        let shapes: Vec<_> =
            body.shapes.iter().filter_map(|&(slot, _)| Some(self.shapes.get(slot as usize)?.def)).collect();
        let def = BodyDef { kind: body.kind, mass: body.mass_source, ..BodyDef::fixed() };
        let mut scale = World::default();
        scale.spawn(&def, &shapes).ok()?;
        self.bodies.get(index)?.mass = State::of(&scale).bodies.get(0)?.mass;
        Some(())
    }

    fn alter_shape(&mut self, source: &mut Source<'_>, index: usize) -> Option<()> {
        let shape = self.shapes.get(index)?;
        let fresh = if source.one_in(2) { shapes::calm_shape(source) } else { shapes::shape(source) };
        match source.below(7) {
            0 => shape.def = fresh,
            1 => shape.def.geometry = fresh.geometry,
            2 => shape.def.offset = vector(pair(source, -REACH_MAX, REACH_MAX)),
            3 => shape.def.density = Fx::from_bits(source.within(0, 1 << 52)),
            4 => shape.def.material = fresh.material,
            5 => {
                // A box that has nothing to do with the shape, as large as it likes.
                let (a, b) = (pair(source, i64::MIN, i64::MAX), pair(source, i64::MIN, i64::MAX));
                shape.fat = Aabb::new(vector(a).min(vector(b)), vector(a).max(vector(b)));
            }
            _ => shape.fat.upper = shape.fat.lower,
        }
        let body = shape.body.0;
        self.weigh(body as usize)
    }

    fn alter_contact(&mut self, source: &mut Source<'_>) -> Option<()> {
        let at = source.below(self.contacts.len());
        match source.below(6) {
            0 => {
                let (a, b) = (self.shapes.pick(source)? as u32, self.shapes.pick(source)? as u32);
                let shapes = (a.min(b), a.max(b));
                let at = self.contacts.binary_search_by_key(&shapes, |contact| contact.shapes).err()?;
                let touching = source.one_in(2);
                let contact = Contact { shapes, touching, count: 0, points: Default::default() };
                self.contacts.insert(at, contact);
            }
            _ if self.contacts.is_empty() => return None,
            1 => drop(self.contacts.remove(at)),
            2 => self.contacts[at].touching = !self.contacts[at].touching,
            _ => {
                let contact = &mut self.contacts[at];
                contact.count = source.byte() % 3;
                contact.points = Default::default();
                for point in &mut contact.points[..contact.count.into()] {
                    let feature = if source.one_in(2) { source.word() as u16 } else { source.byte().into() };
                    let normal = source.within(0, IMPULSE_MAX) as i32;
                    *point = Point { feature, normal, tangent: speed(source, IMPULSE_MAX) };
                }
            }
        }
        Some(())
    }

    fn alter_joint(&mut self, source: &mut Source<'_>) -> Option<()> {
        if source.one_in(3) {
            let (a, b) = (self.bodies.pick(source)?, self.bodies.pick(source)?);
            let id = |(slot, generation): Handle| {
                lockstep2d::body::BodyId::of_bytes(u64::from(generation) << 32 | u64::from(slot))
            };
            let ends = (id(self.bodies.handle(a)), id(self.bodies.handle(b)));
            let def = lockstep2d::solver::RevoluteDef::new(ends.0, ends.1).into();
            self.joints.slots.push(Slot { generation: 0, value: Some(Joint { def, lambda: (0, 0) }) });
        }
        let index = self.joints.pick(source)?;
        let joint = self.joints.get(index)?;
        let JointDef::Revolute(def) = &mut joint.def;
        match source.below(4) {
            0 => joint.lambda = (speed(source, IMPULSE_MAX), speed(source, IMPULSE_MAX)),
            1 => def.anchor_a = vector(pair(source, -REACH_MAX, REACH_MAX)),
            2 => def.anchor_b = vector(pair(source, -REACH_MAX, REACH_MAX)),
            _ => def.collide_connected = !def.collide_connected,
        }
        Some(())
    }

    /// Another generation for a slot and for all that name it.
    fn alter_generation(&mut self, source: &mut Source<'_>) -> Option<()> {
        let generation = source.within(0, u32::MAX.into()) as u32;
        match source.below(3) {
            0 => {
                let index = self.joints.pick(source)?;
                self.joints.slots[index].generation = generation;
            }
            1 => {
                let index = self.shapes.pick(source)?;
                let old = self.shapes.handle(index);
                self.shapes.slots[index].generation = generation;
                let names = self.bodies.values().flat_map(|body| &mut body.shapes);
                names.filter(|name| **name == old).for_each(|name| name.1 = generation);
            }
            _ => {
                let index = self.bodies.pick(source)?;
                let old = self.bodies.handle(index);
                self.bodies.slots[index].generation = generation;
                self.shapes
                    .values()
                    .filter(|shape| shape.body == old)
                    .for_each(|shape| shape.body.1 = generation);
            }
        }
        Some(())
    }
}
