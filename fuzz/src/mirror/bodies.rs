//! Bodies and shapes.

use lockstep2d::body::{BodyDef, BodyKind, BodySettings, MassProperties, MassSource, ShapeDef};
use lockstep2d::math::{Aabb, Angle, Fx};
use lockstep2d::world::{Config, World};
use serde::{Deserialize, Serialize};

use super::{CENTRE_MAX, Handle, REACH_MAX, SPEED_MAX, State, pair, speed, vector};
use crate::source::Source;
use crate::{settings, shapes};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Body {
    pub(super) kind: BodyKind,
    pub(super) centre: (i64, i64),
    pub(super) angle: u32,
    pub(super) velocity: (i32, i32),
    pub(super) spin: i32,
    pub(super) force: (i64, i64),
    pub(super) torque: i64,
    mass_source: MassSource,
    mass: MassProperties,
    settings: BodySettings,
    pub(super) enabled: bool,
    pub(super) rest_ticks: u32,
    pub(super) island: Option<Handle>,
    target: Option<((i64, i64), u32)>,
    pub(super) shapes: Vec<Handle>,
    user_data: u64,
    name: Option<[u8; 16]>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Shape {
    pub(super) body: Handle,
    def: ShapeDef,
    fat: Aabb,
}

impl Body {
    /// Clears the velocities, forces and target that the kind, sleep and locks of the body do not allow.
    fn rest(&mut self) {
        if self.kind != BodyKind::Dynamic {
            (self.force, self.torque) = ((0, 0), 0);
        }
        if self.kind != BodyKind::Kinematic {
            self.target = None;
        }
        if self.kind == BodyKind::Fixed || self.island.is_some() {
            (self.velocity, self.spin, self.force, self.torque) = ((0, 0), 0, (0, 0), 0);
        }
        if self.settings.locks.x {
            self.velocity.0 = 0;
        }
        if self.settings.locks.y {
            self.velocity.1 = 0;
        }
    }
}

impl State {
    pub(super) fn alter_body(&mut self, source: &mut Source<'_>, index: usize) -> Option<()> {
        let other = self.bodies.pick(source)?;
        let near = self.bodies.get(other)?.centre;
        let sleepiest = self.config.ticks_to_sleep();
        let body = self.bodies.get(index)?;
        match source.below(20) {
            0 => body.centre = pair(source, -CENTRE_MAX, CENTRE_MAX),
            1 | 2 => {
                let (x, y) = pair(source, -(2 << 32), 2 << 32);
                body.centre = (near.0.saturating_add(x), near.1.saturating_add(y));
            }
            3 => body.angle = source.word() as u32,
            4 | 5 => body.velocity = (speed(source, SPEED_MAX), speed(source, SPEED_MAX)),
            6 => body.spin = speed(source, SPEED_MAX),
            7 => body.force = pair(source, i64::MIN, i64::MAX),
            8 => body.torque = source.within(i64::MIN, i64::MAX),
            9 => body.settings = settings::settings(source),
            10 => body.settings.sleep_speed = Fx::from_bits(source.within(0, 400 << 32)),
            11 => body.settings.gravity_scale = Fx::from_bits(source.within(-(1000 << 32), 1000 << 32)),
            12 => {
                body.settings.linear_damping = Fx::from_bits(source.within(0, 1000 << 32));
                body.settings.angular_damping = Fx::from_bits(source.within(0, 1000 << 32));
            }
            13 => {
                body.mass_source = MassSource::Given {
                    mass: Fx::from_bits(source.within(42_950, 1 << 62)),
                    centre: vector(pair(source, -REACH_MAX, REACH_MAX)),
                    gyration: Fx::from_bits(source.within(8_589_935, 512 << 32)),
                };
            }
            14 => body.rest_ticks = source.within(0, sleepiest.into()) as u32,
            15 => body.enabled = !body.enabled,
            16 | 17 => {
                body.kind = BodyKind::Kinematic;
                let (x, y) = pair(source, -(1 << 32), 1 << 32);
                let there = if source.one_in(4) { pair(source, -(1 << 62), 1 << 62) } else { body.centre };
                let there = (there.0.saturating_add(x), there.1.saturating_add(y));
                body.target = Some((there, source.word() as u32));
            }
            _ => body.kind = source.pick(&[BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Fixed]),
        }
        body.rest();
        if body.kind != BodyKind::Dynamic {
            let still = body.velocity == (0, 0) && body.spin == 0;
            let may_rest = body.kind == BodyKind::Kinematic && still;
            body.rest_ticks = body.rest_ticks.min(may_rest.into());
        }
        self.weigh(index)
    }

    /// Sets the mass of a body to the one that a new world computes. If the body is fixed, does so for the fat AABBs of
    /// its shapes, too.
    pub(super) fn weigh(&mut self, index: usize) -> Option<()> {
        let body = self.bodies.get(index)?.clone();
        let shapes: Vec<_> =
            body.shapes.iter().filter_map(|&(slot, _)| Some(self.shapes.get(slot as usize)?.def)).collect();
        let fixed = body.kind == BodyKind::Fixed;
        let mut def = BodyDef { kind: body.kind, mass: body.mass_source, ..BodyDef::fixed() };
        def.settings = body.settings;
        if fixed {
            (def.position, def.angle) = (vector(body.centre), Angle::from_bits(body.angle));
        }
        let config = Config { fat_margin: self.config.fat_margin, ..Config::default() };
        let mut scale = World::new(config).ok()?;
        scale.spawn(&def, &shapes).ok()?;
        let mut scale = State::of(&scale);
        self.bodies.get(index)?.mass = scale.bodies.get(0)?.mass;
        if fixed {
            for (&(slot, _), posed) in body.shapes.iter().zip(scale.shapes.values()) {
                self.shapes.get(slot as usize)?.fat = posed.fat;
            }
        }
        Some(())
    }

    pub(super) fn alter_shape(&mut self, source: &mut Source<'_>, index: usize) -> Option<()> {
        let shape = self.shapes.get(index)?;
        let fresh = if source.one_in(2) { shapes::ordinary_shape(source) } else { shapes::shape(source) };
        match source.below(12) {
            0 => shape.def = fresh,
            1 => shape.def.geometry = shapes::geometry(source),
            2 => shape.def.offset = vector(pair(source, -REACH_MAX, REACH_MAX)),
            3 => shape.def.density = Fx::from_bits(source.within(0, 1 << 52)),
            4 => shape.def.material = fresh.material,
            5 => shape.def.filter = fresh.filter,
            6 => shape.def.one_way = shape.def.one_way.is_none().then(|| source.angle()),
            7 => shape.def.sensor = !shape.def.sensor,
            8 if source.one_in(2) => shape.def.area = source.one_in(3).then(|| shapes::area(source)),
            8 => shape.def.events = fresh.events,
            9 => shape.def.material.surface_speed = Fx::from_bits(source.within(-(400 << 32), 400 << 32)),
            10 => {
                // The new fat AABB is unrelated to the shape.
                let (a, b) = (pair(source, i64::MIN, i64::MAX), pair(source, i64::MIN, i64::MAX));
                shape.fat = Aabb::new(vector(a).min(vector(b)), vector(a).max(vector(b)));
            }
            _ => shape.fat.upper = shape.fat.lower,
        }
        let body = shape.body.0;
        self.weigh(body as usize)
    }
}
