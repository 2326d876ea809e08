//! Random commands of most kinds, valid and invalid, for a small, crowded world.

use lockstep2d::body::{
    Area, BodyDef, BodyId, BodyKind, BodySettings, Continuous, EventSwitches, Filter, JointId, MassSource,
    Material, MotionLocks, Name, ShapeDef, ShapeId,
};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Vec2};
use lockstep2d::solver::{
    Distance, Gear, JointDef, JointKind, Motor, Prismatic, Pulley, Rack, Revolute, Threshold,
    ThresholdAction, Weld, Wheel,
};
use lockstep2d::world::{Command, Config, Explosion, World};

use super::{ball, capsule, rectangle, square};

#[derive(Clone)]
pub(crate) struct Churn {
    rng: Rng,
}

impl Churn {
    pub(crate) fn new(seed: u64) -> Self {
        Churn { rng: Rng::new(seed) }
    }

    /// World with random settings, a floor, two walls, a pool, a lift and up to 15 random bodies.
    pub(crate) fn world(&mut self) -> World {
        let rng = &mut self.rng;
        let config = Config {
            tick_rate: [16, 20, 60][rng.below(3) as usize],
            sleeping: !rng.chance(1, 10),
            hit_speed: rng.range(fx!(0), fx!(3)),
            fat_margin: [fx!(0.01), fx!(0.1), fx!(0.5)][rng.below(3) as usize],
            pair_limit: if rng.chance(1, 4) { rng.below(40) } else { 1 << 18 },
            body_limit: 60,
            ..Config::default()
        };
        let mut world = World::new(config).expect("valid");
        let fixed = |x, y| BodyDef::fixed().position((x, y));
        world.spawn(&fixed(fx!(0), fx!(-1)), &[rectangle(fx!(7), fx!(1))]).expect("valid");
        world.spawn(&fixed(fx!(-6), fx!(4)), &[rectangle(fx!(0.5), fx!(5))]).expect("valid");
        world.spawn(&fixed(fx!(6), fx!(4)), &[rectangle(fx!(0.5), fx!(5))]).expect("valid");
        let trigger = rectangle(fx!(2), fx!(1)).area(Area::fluid(fx!(2)).drag(fx!(1), fx!(1)));
        world.spawn(&fixed(fx!(-2), fx!(1)), &[trigger]).expect("valid");
        world.spawn(&BodyDef::kinematic().position((fx!(3), fx!(0.3))), &[square(fx!(0.3))]).expect("valid");
        for _ in 0..15 {
            let (body, shapes) = (self.body(), self.shapes());
            let _refused_or_not = world.spawn(&body, &shapes);
        }
        world
    }

    /// Commands for a tick, in bursts and lulls, so that bodies fall asleep and are woken.
    pub(crate) fn commands(&mut self, world: &World) -> Vec<Command> {
        let cycle = u64::from(world.config().tick_rate) * 2;
        let count = match world.tick() % cycle < cycle / 4 {
            true => self.rng.below(4),
            false => u32::from(self.rng.chance(1, 15)),
        };
        (0..count).filter_map(|_| self.command(world)).collect()
    }

    fn command(&mut self, world: &World) -> Option<Command> {
        let crowded = world.body_count() > 35;
        let command = match self.rng.below(33) {
            0..=4 if !crowded => Command::Spawn { body: self.body(), shapes: self.shapes() },
            5 => Command::Despawn { body: self.any_body(world)? },
            6 => Command::AddShape { body: self.any_body(world)?, shape: self.shape() },
            7 => Command::RemoveShape { shape: self.any_shape(world)? },
            8 => Command::AddJoint { joint: self.joint(world)? },
            9 => Command::RemoveJoint { joint: self.any_joint(world)? },
            10 => {
                let joint = self.any_joint(world)?;
                Command::SetJoint { joint, def: self.changed_joint(world, joint)? }
            }
            11 => {
                let (body, force) = (self.any_body(world)?, self.vector(fx!(60)));
                Command::ApplyForce { body, force, point: self.place() }
            }
            12 => Command::ApplyTorque { body: self.any_body(world)?, torque: self.signed(fx!(30)) },
            13 => {
                let (body, impulse) = (self.any_body(world)?, self.vector(fx!(3)));
                Command::ApplyImpulse { body, impulse, point: self.place() }
            }
            14 => Command::ApplyAngularImpulse { body: self.any_body(world)?, impulse: self.signed(fx!(1)) },
            15 | 16 => self.velocity(world)?,
            17 | 18 => {
                let body = self.any_body(world)?;
                Command::SetTransform { body, position: self.place(), angle: self.angle() }
            }
            19 => Command::SetGravity { gravity: Vec2::new(self.signed(fx!(1)), fx!(-10)) },
            20 | 21 => {
                let body = self.kinematic_body(world)?;
                let position = world.body(body)?.position() + self.vector(fx!(0.4));
                Command::MoveTo { body, position, angle: self.angle() }
            }
            22 => Command::SetBody { body: self.any_body(world)?, settings: self.settings() },
            23 => Command::SetKind { body: self.any_body(world)?, kind: self.kind() },
            24 => Command::SetMass { body: self.any_body(world)?, mass: self.mass() },
            25 => Command::Enable { body: self.any_body(world)? },
            26 => Command::Disable { body: self.any_body(world)? },
            27 => Command::Wake { body: self.any_body(world)? },
            28 => Command::Sleep { body: self.any_body(world)? },
            29 => {
                let shape = self.any_shape(world)?;
                let old = *world.shape(shape)?.def();
                let def = self.changed_shape(old);
                let is_area = def.area != old.area && def == (ShapeDef { area: def.area, ..old });
                match is_area {
                    true => Command::SetArea { shape, area: def.area },
                    false => Command::SetShape { shape, def },
                }
            }
            31 => Command::SetName { body: self.any_body(world)?, name: Name::new("named").ok() },
            30 => Command::SetConfig { config: self.changed_config(*world.config()) },
            _ => Command::Explode { explosion: Explosion::new(self.place(), self.signed(fx!(2))) },
        };
        Some(command)
    }

    /// Settings with one random change.
    fn changed_config(&mut self, mut config: Config) -> Config {
        let rng = &mut self.rng;
        match rng.below(8) {
            0 => config.tick_rate = if rng.chance(1, 2) { 60 } else { 90 },
            1 => config.solver.sub_steps = if rng.chance(1, 2) { 4 } else { 6 },
            2 => config.sleeping = !config.sleeping,
            3 => config.continuous = !config.continuous,
            4 => config.solver.restitution_threshold = rng.range(fx!(0), fx!(2)),
            5 => config.speculative_distance = rng.range(fx!(0.005), fx!(0.05)),
            6 => config.fat_margin = rng.range(fx!(0.01), fx!(0.2)),
            _ => config.solver.speed_max = rng.range(fx!(20), fx!(400)),
        }
        config
    }

    fn velocity(&mut self, world: &World) -> Option<Command> {
        let body = if self.rng.chance(1, 2) { self.kinematic_body(world)? } else { self.any_body(world)? };
        let (velocity, angular_velocity) = match self.rng.below(3) {
            0 => (Vec2::ZERO, Fx::ZERO),
            1 => (self.vector(fx!(0.04)), Fx::ZERO),
            _ if self.rng.chance(1, 6) => (self.vector(fx!(40)), self.signed(fx!(30))),
            _ => (self.vector(fx!(4)), self.signed(fx!(3))),
        };
        Some(Command::SetVelocity { body, velocity, angular_velocity })
    }

    fn any_body(&mut self, world: &World) -> Option<BodyId> {
        self.pick(world.bodies().map(|(id, _)| id).collect())
    }

    fn kinematic_body(&mut self, world: &World) -> Option<BodyId> {
        let kinematic = world.bodies().filter(|(_, body)| body.kind() == BodyKind::Kinematic);
        self.pick(kinematic.map(|(id, _)| id).collect())
    }

    fn any_shape(&mut self, world: &World) -> Option<ShapeId> {
        self.pick(world.shapes().map(|(id, _)| id).collect())
    }

    fn any_joint(&mut self, world: &World) -> Option<JointId> {
        self.pick(world.joints().map(|(id, _)| id).collect())
    }

    fn pick<T: Copy>(&mut self, all: Vec<T>) -> Option<T> {
        all.get(self.rng.below(u32::try_from(all.len()).expect("few")) as usize).copied()
    }

    fn signed(&mut self, limit: Fx) -> Fx {
        self.rng.range(-limit, limit)
    }

    fn vector(&mut self, limit: Fx) -> Vec2<Fx> {
        Vec2::new(self.signed(limit), self.signed(limit))
    }

    fn place(&mut self) -> Vec2<Fx> {
        Vec2::new(self.signed(fx!(5)), self.rng.range(fx!(0), fx!(3)))
    }

    /// Angle that is usually zero, so that boxes come to rest.
    fn angle(&mut self) -> Angle {
        if self.rng.chance(1, 3) { self.rng.angle() } else { Angle::ZERO }
    }

    fn kind(&mut self) -> BodyKind {
        match self.rng.below(8) {
            0 => BodyKind::Fixed,
            1 | 2 => BodyKind::Kinematic,
            _ => BodyKind::Dynamic,
        }
    }

    fn body(&mut self) -> BodyDef {
        let at = self.place();
        let mut def = BodyDef::new(self.kind()).position(at).angle(self.angle()).mass(self.mass());
        def.settings = self.settings();
        def.asleep = self.rng.chance(1, 4);
        def.enabled = !self.rng.chance(1, 12);
        if self.rng.chance(1, 4) {
            def.velocity = self.vector(fx!(3));
            def.angular_velocity = self.signed(fx!(3));
        }
        def
    }

    fn settings(&mut self) -> BodySettings {
        let rng = &mut self.rng;
        let locks = MotionLocks { x: rng.chance(1, 12), y: rng.chance(1, 12), rotation: rng.chance(1, 8) };
        BodySettings {
            locks,
            linear_damping: if rng.chance(1, 4) { rng.range(fx!(0), fx!(2)) } else { Fx::ZERO },
            may_sleep: !rng.chance(1, 12),
            sleep_speed: [fx!(0.05), fx!(0.05), fx!(0.5)][rng.below(3) as usize],
            continuous: [Continuous::Fixed, Continuous::Bullet, Continuous::Kinematic]
                [rng.below(9) as usize % 3],
            ..BodySettings::default()
        }
    }

    fn mass(&mut self) -> MassSource {
        match self.rng.below(6) {
            0 => MassSource::Given { mass: fx!(2), centre: self.vector(fx!(0.1)), gyration: fx!(0.3) },
            _ => MassSource::Shapes,
        }
    }

    fn shapes(&mut self) -> Vec<ShapeDef> {
        (0..=self.rng.below(6) / 4).map(|_| self.shape()).collect()
    }

    fn shape(&mut self) -> ShapeDef {
        let half = self.rng.range(fx!(0.15), fx!(0.5));
        let shape = match self.rng.below(4) {
            0 => ball(half),
            1 if self.rng.chance(1, 2) => capsule(half, fx!(0.15)),
            1 => rectangle(half, fx!(0.2)),
            _ => square(half),
        };
        self.changed_shape(shape)
    }

    /// Area that accelerates upwards and to a side.
    fn wind(&mut self) -> Area {
        let wind = Area::new().acceleration((self.rng.range(fx!(-9), fx!(9)), fx!(5)));
        wind.drag(self.rng.range(fx!(0), fx!(4)), fx!(1))
    }

    /// Copy of `def` that differs in at most one setting.
    fn changed_shape(&mut self, mut def: ShapeDef) -> ShapeDef {
        let rng = &mut self.rng;
        match rng.below(14) {
            0 => (def.sensor, def.area) = (!def.sensor, None),
            13 => {
                def = def.area(self.wind());
            }
            1 => def.filter = Filter { category: 1 << rng.below(2), mask: rng.below(4).into(), group: 0 },
            2 => def.filter.group = [-1, 0, 1][rng.below(3) as usize],
            3 => {
                let (contact, hit, sensor) = (rng.chance(1, 2), rng.chance(1, 2), rng.chance(1, 2));
                def.events = EventSwitches { contact, hit, sensor, detect_sensors: rng.chance(1, 2) };
            }
            4 => def.material = Material { restitution: fx!(0.5), ..Material::default() },
            5 => def.geometry = ball(rng.range(fx!(0.1), fx!(0.4))).geometry,
            6 => def.geometry = square(rng.range(fx!(0.1), fx!(0.4))).geometry,
            7 => def.offset = self.vector(fx!(0.4)),
            8 => def.one_way = rng.chance(1, 2).then_some(Angle::ZERO),
            _ => def.events.hit = true,
        }
        def
    }

    fn joint(&mut self, world: &World) -> Option<JointDef> {
        let (a, b) = (self.any_body(world)?, self.any_body(world)?);
        let (pose_a, pose_b) = (world.body(a)?.transform(), world.body(b)?.transform());
        // The anchor is at B's origin, so that the joint starts without an error.
        let anchor = pose_a.apply_inverse(pose_b.apply(Vec2::ZERO));
        let mut def = JointDef::new(a, b, self.joint_kind()).anchor_a(anchor);
        if self.rng.chance(1, 3) {
            let action = if self.rng.chance(1, 2) { ThresholdAction::Event } else { ThresholdAction::Break };
            let force = Some(self.rng.range(fx!(1), fx!(200)));
            def = def.threshold(Threshold { force, torque: Some(fx!(100)), action });
        }
        Some(if self.rng.chance(1, 2) { def } else { def.colliding() })
    }

    fn joint_kind(&mut self) -> JointKind {
        let (speed, most) = (self.signed(fx!(2)), self.rng.range(fx!(0), fx!(20)));
        match self.rng.below(12) {
            0 => Prismatic::new().limit(fx!(-0.5), fx!(0.5)).motor(speed, most).into(),
            1 => Distance::rod(fx!(1)).into(),
            2 => Weld::default().into(),
            3 => Wheel::new().into(),
            4 => Motor::new().into(),
            5 => JointKind::Filter,
            7 => Gear::new(20, 30).into(),
            8 => Rack::new(fx!(0.4)).into(),
            9 => Pulley::new((fx!(-2), fx!(6)), (fx!(2), fx!(6)), fx!(9)).into(),
            6 => Revolute::new().limit(fx!(-0.5), fx!(0.5)).motor(speed, most).into(),
            _ => Revolute::new().into(),
        }
    }

    fn changed_joint(&mut self, world: &World, joint: JointId) -> Option<JointDef> {
        let mut def = *world.joint(joint)?.def();
        match self.rng.below(3) {
            0 => def.collide_connected = !def.collide_connected,
            1 => def.kind = self.joint_kind(),
            _ => def.frame_b.anchor = self.vector(fx!(0.2)),
        }
        Some(def)
    }
}
