//! Generates scenes: the settings of a world, and for each tick commands that suit the current state of the world.
//!
//! Three of four scenes are ordinary ones ([`crate::ordinary`]). In the other scenes, values may be at or beyond their
//! limits, and most bodies are small and close together, so that they touch.

use lockstep2d::body::{BodyDef, BodyId, JointId, ShapeDef, ShapeId, WORLD_EXTENT_MAX};
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::solver::{ContactTuning, JointDef, SolverSettings};
use lockstep2d::world::{BodyPose, Command, Config, Explosion, World};
use lockstep2d::{codec, fx};

use crate::source::Source;
use crate::{joints, ordinary, settings, shapes};

/// Generates commands. It remembers handles that it has used, so that later commands may use stale ones.
pub struct Generator {
    /// Centre of the scene.
    middle: Vec2<Fx>,
    /// Whether only the first 12 of each 64 ticks may have commands, so that bodies fall asleep.
    lulls: bool,
    bodies: Vec<BodyId>,
    shapes: Vec<ShapeId>,
    joints: Vec<JointId>,
}

/// Decides whether the scene is ordinary, and returns the settings of its world. They are valid in most cases.
pub fn config(source: &mut Source<'_>) -> Config {
    let ordinary = !source.one_in(4);
    source.set_ordinary(ordinary);
    if ordinary { ordinary::config(source) } else { wild_config(source) }
}

fn wild_config(source: &mut Source<'_>) -> Config {
    let tick_rate = source.pick(&[60, 60, 30, 10, 120, 250, 1000, 20]);
    let sub_steps = source.pick(&[4, 4, 2, 4, 8, 4, 1, 6, 4, 2, 3, 4, 16, 4, 2, 64]);
    let contact = match source.below(3) {
        0 => SolverSettings::default().contact,
        1 => ContactTuning::Soft {
            hertz: source.mostly(1000, 60_000),
            damping_ratio: source.mostly(0, 20_000),
            push_speed: source.mostly(0, 400_000),
        },
        _ => ContactTuning::Baumgarte {
            share: source.mostly(0, 1000),
            slop: source.mostly(0, 20),
            push_speed: source.mostly(0, 400_000),
        },
    };
    let mut config = Config {
        tick_rate,
        solver: SolverSettings {
            sub_steps,
            iterations: source.pick(&[1, 1, 1, 2, 1, 1, 1, 4]),
            contact,
            ..SolverSettings::default()
        },
        ..Config::default()
    };
    if source.one_in(3) {
        config.gravity = source.mostly_vec(-40_000, 40_000);
    }
    if source.one_in(4) {
        config.speculative_distance = source.mostly(1, 1000);
        config.fat_margin = source.mostly(1, 10_000);
    }
    if source.one_in(4) {
        config.solver.joint_hertz = source.mostly(1000, 1_000_000);
        config.solver.joint_damping_ratio = source.mostly(0, 100_000);
        config.solver.restitution_threshold = source.mostly(0, 2000);
        config.solver.speed_max = source.mostly(1000, 400_000);
    }
    config.sleeping = !source.one_in(6);
    config.continuous = !source.one_in(6);
    if source.one_in(3) {
        config.hit_speed = source.mostly(0, 3000);
    }
    if source.one_in(16) {
        config.body_limit = source.byte().into();
        config.shape_limit = source.byte().into();
        config.joint_limit = source.byte().into();
        config.pair_limit = source.byte().into();
    }
    config
}

/// New settings for a world. In 11 of 12 cases they keep its limits of bodies, shapes, joints and pairs, which the
/// world refuses to change.
fn changed_config(source: &mut Source<'_>, world: &World) -> Config {
    let Config { body_limit, shape_limit, joint_limit, pair_limit, .. } = *world.config();
    let config = wild_config(source);
    if source.one_in(12) {
        config
    } else {
        Config { body_limit, shape_limit, joint_limit, pair_limit, ..config }
    }
}

impl Generator {
    /// Creates a generator for a new scene.
    pub fn new(source: &mut Source<'_>) -> Self {
        let edge = WORLD_EXTENT_MAX - fx!(3);
        // Ordinary scenes are not at the edge of the world, because a body that is clamped there counts as a fault.
        let places = [Fx::ZERO, Fx::ZERO, Fx::ZERO, fx!(1000000000), edge, -edge];
        let far = source.pick(if source.is_ordinary() { &places[..4] } else { &places });
        let middle = Vec2::new(far, if source.one_in(2) { far } else { Fx::ZERO });
        let lulls = source.one_in(2);
        Generator { middle, lulls, bodies: Vec::new(), shapes: Vec::new(), joints: Vec::new() }
    }

    /// The commands of the first tick. A scene that is not ordinary gets a heap, in most cases on a floor.
    pub fn setup(&mut self, source: &mut Source<'_>) -> Vec<Command> {
        let mut commands = Vec::new();
        if source.is_ordinary() {
            ordinary::setup(source, self.middle, &mut commands);
            return commands;
        }
        let position = self.middle + Vec2::new(fx!(0), fx!(-1));
        let fixed = BodyDef::fixed().position(position);
        match source.below(5) {
            0..=2 => {
                let floor = ShapeDef::new(lockstep2d::body::Geometry::Segment {
                    a: Vec2::new(fx!(-8), source.thousandths(-100, 1000)),
                    b: Vec2::new(fx!(8), fx!(0)),
                });
                commands.push(spawn(fixed, &[floor]));
            }
            3 => commands.push(spawn(fixed, &shapes::chain(source))),
            _ => {}
        }
        self.heap(source, &mut commands);
        if source.below(2) == 0 {
            ordinary::pile(source, self.middle, &mut commands);
        }
        commands
    }

    /// The commands of a tick.
    pub fn tick(&mut self, source: &mut Source<'_>, world: &World) -> Vec<Command> {
        let mut commands = Vec::new();
        if self.lulls && world.tick() % 64 >= 12 {
            return commands;
        }
        if source.is_ordinary() {
            for _ in 0..source.pick(&[0, 0, 1, 0, 0, 2]) {
                let body = self.body(source, world);
                ordinary::command(source, world, self.middle, body, &mut commands);
            }
            return commands;
        }
        for _ in 0..source.pick(&[0, 1, 0, 2, 0, 3, 5]) {
            self.command(source, world, &mut commands);
        }
        commands
    }

    fn command(&mut self, source: &mut Source<'_>, world: &World, commands: &mut Vec<Command>) {
        let body = self.body(source, world);
        commands.push(match source.below(37) {
            0 | 1 => self.spawned(source),
            2 => return self.heap(source, commands),
            3 => Command::Despawn { body },
            4 => Command::AddShape { body, shape: shapes::shape(source) },
            5 => Command::RemoveShape { shape: self.shape(source, world) },
            6..=8 => Command::AddJoint { joint: self.joint_def(source, world) },
            9 => Command::RemoveJoint { joint: self.joint(source, world) },
            10..=17 => self.push(source, body),
            18 => Command::SetGravity { gravity: source.mostly_vec(-30_000, 30_000) },
            19 | 20 => {
                // In 5 of 6 cases the target is so near that a kinematic body can reach it in one tick.
                let here = world.body(body).map_or(self.middle, |body| body.position());
                let reach = if source.one_in(6) { 20_000 } else { 300 };
                let position = here + source.mostly_vec(-reach, reach);
                Command::MoveTo { body, position, angle: source.angle() }
            }
            21 => Command::SetBody { body, settings: settings::settings(source) },
            22 => Command::SetKind { body, kind: settings::kind(source) },
            23 => Command::SetMass { body, mass: settings::mass(source) },
            24 if source.one_in(2) => Command::SetName { body, name: settings::name(source) },
            24 => Command::SetUserData { body, user_data: source.word() },
            25 => Command::Disable { body },
            26 => Command::Enable { body },
            27 => Command::Wake { body },
            28 | 29 => Command::Sleep { body },
            30 if source.one_in(4) => {
                let area = source.one_in(4).then(|| shapes::area(source));
                // Most shapes are solid, and the world refuses to give an area to a solid shape.
                Command::SetArea { shape: self.shape(source, world), area }
            }
            30 | 31 => {
                let shape = self.shape(source, world);
                Command::SetShape { shape, def: shapes::altered(source, world, shape) }
            }
            32 => self.altered_joint(source, world),
            33 => Command::Explode { explosion: self.explosion(source) },
            34 => self.spawned_each(source),
            35 => Command::SetConfig { config: changed_config(source, world) },
            _ => self.joined_each(source, world),
        });
    }

    fn push(&self, source: &mut Source<'_>, body: BodyId) -> Command {
        let place = |source: &mut Source<'_>| {
            if source.one_in(12) { source.mostly_vec(-5000, 5000) } else { self.near(source, 3000) }
        };
        match source.below(8) {
            0 => {
                let force = source.mostly_vec(-200_000, 200_000);
                Command::ApplyForce { body, force, point: place(source) }
            }
            1 => Command::ApplyTorque { body, torque: source.mostly(-200_000, 200_000) },
            2 => {
                let impulse = source.mostly_vec(-20_000, 20_000);
                Command::ApplyImpulse { body, impulse, point: place(source) }
            }
            3 => Command::ApplyAngularImpulse { body, impulse: source.mostly(-20_000, 20_000) },
            4 | 5 => {
                let reach = source.pick(&[10_000, 10_000, 10_000, 400_000]);
                let velocity = source.mostly_vec(-reach, reach);
                Command::SetVelocity { body, velocity, angular_velocity: source.mostly(-40_000, 40_000) }
            }
            _ => Command::SetTransform { body, position: place(source), angle: source.angle() },
        }
    }

    fn explosion(&self, source: &mut Source<'_>) -> Explosion {
        let centre = if source.one_in(12) { source.mostly_vec(-5000, 5000) } else { self.near(source, 3000) };
        Explosion {
            centre,
            radius: source.mostly(0, 5000),
            falloff: source.mostly(0, 5000),
            impulse_per_length: source.mostly(-50_000, 50_000),
            mask: source.pick(&[u64::MAX, u64::MAX, 1, 2, 0]),
        }
    }

    fn near(&self, source: &mut Source<'_>, reach: i64) -> Vec2<Fx> {
        self.middle + Vec2::new(source.thousandths(-reach, reach), source.thousandths(-reach, reach))
    }

    /// Adds 1 to 80 bodies with equal shapes, at one point or around it.
    fn heap(&self, source: &mut Source<'_>, commands: &mut Vec<Command>) {
        let count = source.pick(&[12, 5, 20, 14, 3, 16, 8, 12, 1, 12, 18, 16, 10, 14, 40, 80]);
        let asleep = source.one_in(6);
        let mut rng = Rng::new(source.byte().into());
        let shape = shapes::shape(source);
        let spread = source.pick(&[fx!(2), fx!(1), fx!(0), fx!(0.01)]);
        let centre = self.near(source, 1000);
        for _ in 0..count {
            let offset = Vec2::new(rng.range(-spread, spread), rng.range(-spread, spread));
            let (position, angle) = (centre + offset, rng.angle());
            let mut def = BodyDef::dynamic().position(position);
            if spread > Fx::ONE {
                def = def.angle(angle);
            }
            def.asleep = asleep;
            commands.push(spawn(def, &[shape]));
        }
    }

    fn body_def(&self, source: &mut Source<'_>) -> BodyDef {
        let mut body = BodyDef::new(settings::kind(source));
        body.position =
            if source.one_in(16) { source.mostly_vec(-3000, 3000) } else { self.near(source, 2000) };
        body.angle = source.angle();
        if source.one_in(3) {
            body.velocity = source.mostly_vec(-20_000, 20_000);
            body.angular_velocity = source.mostly(-20_000, 20_000);
        }
        if source.one_in(6) {
            body.velocity.x = source.pick(&[fx!(400), fx!(-400), fx!(399.9)]);
        }
        if source.one_in(3) {
            body.settings = settings::settings(source);
        }
        if source.one_in(5) {
            body.mass = settings::mass(source);
        }
        body.enabled = !source.one_in(16);
        body.asleep = source.one_in(8);
        body
    }

    fn shapes_of_a_body(source: &mut Source<'_>) -> Vec<ShapeDef> {
        if source.one_in(12) {
            return shapes::chain(source);
        }
        let count = source.pick(&[1, 1, 2, 1, 3, 0, 6]);
        (0..count).map(|_| shapes::shape(source)).collect()
    }

    fn spawned(&self, source: &mut Source<'_>) -> Command {
        Command::Spawn { body: self.body_def(source), shapes: Self::shapes_of_a_body(source) }
    }

    fn spawned_each(&self, source: &mut Source<'_>) -> Command {
        let (body, shapes) = (self.body_def(source), Self::shapes_of_a_body(source));
        let pose = |source: &mut Source<'_>| {
            let position = if source.one_in(16) { source.mostly_vec(0, 0) } else { self.near(source, 3000) };
            BodyPose { position, angle: source.angle() }
        };
        let poses = (0..source.below(8)).map(|_| pose(source)).collect();
        Command::SpawnEach { body, shapes, poses }
    }

    fn joint_def(&mut self, source: &mut Source<'_>, world: &World) -> JointDef {
        let (a, b) = (self.body(source, world), self.body(source, world));
        joints::joint(source, a, b)
    }

    fn joined_each(&mut self, source: &mut Source<'_>, world: &World) -> Command {
        let joint = self.joint_def(source, world);
        let count = source.below(5);
        let ends = (0..count).map(|_| (self.body(source, world), self.body(source, world))).collect();
        Command::AddJointEach { joint, ends }
    }

    /// A command that changes a joint. In 1 of 8 cases it usually names other bodies, and the world refuses it.
    fn altered_joint(&mut self, source: &mut Source<'_>, world: &World) -> Command {
        let joint = self.joint(source, world);
        let mut def = self.joint_def(source, world);
        if let Some(old) = world.joint(joint).filter(|_| !source.one_in(8)) {
            let (a, b) = old.def().bodies();
            def = def.between(a, b);
            if source.one_in(2) {
                def = joints::finish(source, *old.def());
                if def.user_data & 16 != 0 {
                    return match def.enabled {
                        true => Command::EnableJoint { joint },
                        false => Command::DisableJoint { joint },
                    };
                }
            }
        }
        Command::SetJoint { joint, def }
    }

    /// Handle of a body: in most cases of an existing one, sometimes a handle that may be stale or was never valid.
    fn body(&mut self, source: &mut Source<'_>, world: &World) -> BodyId {
        let present: Vec<BodyId> = world.bodies().map(|(id, _)| id).collect();
        handle(source, &present, &mut self.bodies)
    }

    fn shape(&mut self, source: &mut Source<'_>, world: &World) -> ShapeId {
        let present: Vec<ShapeId> = world.shapes().map(|(id, _)| id).collect();
        handle(source, &present, &mut self.shapes)
    }

    fn joint(&mut self, source: &mut Source<'_>, world: &World) -> JointId {
        let present: Vec<JointId> = world.joints().map(|(id, _)| id).collect();
        handle(source, &present, &mut self.joints)
    }
}

pub(crate) fn spawn(body: BodyDef, shapes: &[ShapeDef]) -> Command {
    Command::Spawn { body, shapes: shapes.to_vec() }
}

fn handle<H: Copy + serde_handle::Handle>(source: &mut Source<'_>, present: &[H], known: &mut Vec<H>) -> H {
    let any = match source.below(12) {
        0 if !known.is_empty() => Some(source.pick(known)),
        1 => None,
        _ if !present.is_empty() => Some(source.pick(present)),
        _ => None,
    };
    let chosen = any.unwrap_or_else(|| H::of_bytes(source.word()));
    if known.len() < 64 {
        known.push(chosen);
    }
    chosen
}

/// Handles decoded from bytes, as in a file.
pub(crate) mod serde_handle {
    use super::{BodyId, JointId, ShapeId, codec};

    pub(crate) trait Handle {
        fn of_bytes(bytes: u64) -> Self;
    }

    macro_rules! of_bytes {
        ($($name:ident),*) => {$(
            impl Handle for $name {
                fn of_bytes(bytes: u64) -> Self {
                    codec::decode(&bytes.to_le_bytes()).expect("two numbers")
                }
            }
        )*};
    }
    of_bytes!(BodyId, ShapeId, JointId);
}

/// Approximate cost of a tick, in arbitrary units. Targets limit the sum of these costs in a run.
#[must_use]
pub fn cost(world: &World) -> u64 {
    let solver = world.config().solver;
    let rounds = u64::from(solver.sub_steps) * u64::from(solver.iterations);
    (world.pair_count() as u64 + world.joint_count() as u64 + world.body_count() as u64) * (rounds + 2)
}
