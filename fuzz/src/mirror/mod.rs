//! Repeats the layout of a world's state from `docs/FORMAT.md`, so that single fields of a snapshot can be changed.

mod arena;
mod bodies;
mod contacts;
mod islands;
mod joints;

use lockstep2d::codec;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Config, World};
use serde::{Deserialize, Serialize};

use crate::generator;
use crate::source::Source;
use arena::Arena;
use bodies::{Body, Shape};
use contacts::{Contact, Reported};
use islands::Island;
use joints::Joint;

/// Size of the header: magic, format, semantics, length.
const HEADER_BYTES: usize = 24;
const HASH_BYTES: usize = 16;

/// A handle: slot and generation.
type Handle = (u32, u32);

/// The state of a world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    config: Config,
    tick: u64,
    faults: u64,
    bodies: Arena<Body>,
    shapes: Arena<Shape>,
    joints: Arena<Joint>,
    islands: Arena<Island>,
    contacts: Vec<Contact>,
    sleeping_contacts: Vec<Contact>,
    pairs_left_out: bool,
    removed_contacts: Vec<Reported>,
    rng: (u64, u64),
}

/// Maximum component of a velocity, in raw units of `Speed`.
const SPEED_MAX: i64 = 511 << 21;
/// Maximum magnitude of an impulse, in raw units of `Speed`.
const IMPULSE_MAX: i64 = 1023 << 21;
/// Maximum coordinate of a centre of mass, in raw units of `Fx`.
const CENTRE_MAX: i64 = ((1 << 30) + 1024) << 32;
/// Maximum coordinate of a shape's offset, of a given centre of mass or of an anchor, in raw units of `Fx`.
const REACH_MAX: i64 = 128 << 32;

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
    /// Decodes the state of a world.
    ///
    /// # Panics
    /// When the bytes of the world do not have the layout that these types describe.
    #[must_use]
    pub fn of(world: &World) -> Self {
        let bytes = world.to_bytes();
        let state = &bytes[HEADER_BYTES..bytes.len() - HASH_BYTES];
        let mirror: State = codec::decode(state).expect("the layout of a world's state");
        debug_assert_eq!(codec::encode(&mirror), state, "encoding the decoded state gives the same bytes");
        mirror
    }

    /// Encodes the state without header and hash.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        codec::encode(self)
    }

    /// Makes one random change. The changed state is often valid. If the drawn change is impossible, for example
    /// because there is no joint, the state stays as it is.
    pub fn alter(&mut self, source: &mut Source<'_>) {
        let before = self.clone();
        if self.try_alter(source).is_none() {
            *self = before;
        }
    }

    fn try_alter(&mut self, source: &mut Source<'_>) -> Option<()> {
        match source.below(24) {
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
            15 => self.alter_config(source),
            16 => {
                self.alter_counter(source);
                Some(())
            }
            17 => {
                self.alter_removed(source);
                Some(())
            }
            18 => {
                match source.below(4) {
                    0 => self.bodies.alter_vacancies(source),
                    1 => self.shapes.alter_vacancies(source),
                    2 => self.islands.alter_vacancies(source),
                    _ => self.joints.alter_vacancies(source),
                }
                Some(())
            }
            19 => self.alter_generation(source),
            _ => self.alter_sleep(source),
        }
    }

    fn alter_config(&mut self, source: &mut Source<'_>) -> Option<()> {
        let ordinary = source.is_ordinary();
        let limits = self.config;
        self.config = generator::config(source);
        source.set_ordinary(ordinary);
        let Config { body_limit, shape_limit, joint_limit, .. } = limits;
        self.config = Config { body_limit, shape_limit, joint_limit, ..self.config };
        self.config.sleeping |= self.islands.values().count() > 0;
        if source.one_in(2) {
            self.config.pair_limit = source.below(30) as u32;
        }
        // The fat AABBs of fixed shapes depend on the settings.
        (0..self.bodies.slots.len()).try_for_each(|index| match self.bodies.get(index) {
            Some(_) => self.weigh(index),
            None => Some(()),
        })
    }

    fn alter_counter(&mut self, source: &mut Source<'_>) {
        match source.below(8) {
            0 => self.tick = source.within(i64::MIN, i64::MAX) as u64,
            1 => self.faults = source.within(i64::MIN, i64::MAX) as u64,
            2 => self.rng = (source.word(), source.word()),
            3 => self.pairs_left_out = !self.pairs_left_out,
            4 => self.config.body_limit = self.bodies.values().count() as u32,
            5 => self.config.joint_limit = self.joints.values().count() as u32,
            6 => self.config.pair_limit = source.below(30) as u32,
            _ => self.config.shape_limit = self.shapes.values().count() as u32,
        }
    }

    fn alter_generation(&mut self, source: &mut Source<'_>) -> Option<()> {
        let generation = source.within(0, u32::MAX.into()) as u32;
        match source.below(4) {
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
            2 => {
                let index = self.islands.pick(source)?;
                let old = self.islands.handle(index);
                self.islands.slots[index].generation = generation;
                let names = self.bodies.values().filter_map(|body| body.island.as_mut());
                names.filter(|name| **name == old).for_each(|name| name.1 = generation);
            }
            _ => {
                let index = self.bodies.pick(source)?;
                let old = self.bodies.handle(index);
                self.bodies.slots[index].generation = generation;
                let new = self.bodies.handle(index);
                let owned = self.shapes.values().filter(|shape| shape.body == old);
                owned.for_each(|shape| shape.body = new);
                self.joints.values().for_each(|joint| joint.rename(old, new));
            }
        }
        Some(())
    }
}
