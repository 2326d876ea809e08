//! Scenes and what is done to them: settings, and commands for a world as it is at the moment.
//!
//! Most bodies are small and close together, so that most of them really touch.

use lockstep2d::body::{BodyDef, BodyId, BodyKind, JointId, MassSource, ShapeDef, ShapeId, WORLD_EXTENT_MAX};
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::solver::{ContactTuning, JointDef, RevoluteDef, SolverSettings};
use lockstep2d::world::{Command, Config, World};
use lockstep2d::{codec, fx};

use crate::shapes;
use crate::source::Source;

/// Generates commands, and remembers handles that have gone stale.
pub struct Generator {
    /// What the scene is built around.
    middle: Vec2<Fx>,
    bodies: Vec<BodyId>,
    shapes: Vec<ShapeId>,
    joints: Vec<JointId>,
}

/// Settings, mostly valid ones.
pub fn config(source: &mut Source<'_>) -> Config {
    let tick_rate = source.pick(&[60, 60, 30, 10, 120, 250, 1000, 20]);
    let sub_steps = source.pick(&[4, 4, 2, 8, 64, 16, 6, 1]);
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
            iterations: source.pick(&[1, 1, 2, 4]),
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
    if source.one_in(16) {
        config.body_limit = source.byte().into();
        config.shape_limit = source.byte().into();
        config.joint_limit = source.byte().into();
    }
    config
}

impl Generator {
    /// A generator for a new scene.
    pub fn new(source: &mut Source<'_>) -> Self {
        let edge = WORLD_EXTENT_MAX - fx!(3);
        let far = source.pick(&[Fx::ZERO, Fx::ZERO, Fx::ZERO, fx!(1000000000), edge, -edge]);
        let middle = Vec2::new(far, if source.one_in(2) { far } else { Fx::ZERO });
        Generator { middle, bodies: Vec::new(), shapes: Vec::new(), joints: Vec::new() }
    }

    /// What the scene starts with: mostly a floor and a heap of bodies.
    pub fn setup(&mut self, source: &mut Source<'_>) -> Vec<Command> {
        let mut commands = Vec::new();
        if !source.one_in(4) {
            let floor = ShapeDef::new(lockstep2d::body::Geometry::Segment {
                a: Vec2::new(fx!(-8), source.thousandths(-100, 1000)),
                b: Vec2::new(fx!(8), fx!(0)),
            });
            let position = self.middle + Vec2::new(fx!(0), fx!(-1));
            commands.push(spawn(BodyDef::fixed().position(position.x, position.y), &[floor]));
        }
        self.heap(source, &mut commands);
        commands
    }

    /// Commands for a tick.
    pub fn tick(&mut self, source: &mut Source<'_>, world: &World) -> Vec<Command> {
        let mut commands = Vec::new();
        for _ in 0..source.pick(&[0, 1, 0, 2, 0, 3, 5]) {
            self.command(source, world, &mut commands);
        }
        commands
    }

    fn command(&mut self, source: &mut Source<'_>, world: &World, commands: &mut Vec<Command>) {
        let body = self.body(source, world);
        let place = |generator: &Self, source: &mut Source<'_>| {
            if source.one_in(12) { source.mostly_vec(-5000, 5000) } else { generator.near(source, 3000) }
        };
        commands.push(match source.below(17) {
            0 | 1 => self.spawned(source),
            2 => return self.heap(source, commands),
            3 => Command::Despawn { body },
            4 => Command::AddShape { body, shape: shapes::shape(source) },
            5 => Command::RemoveShape { shape: self.shape(source, world) },
            6 | 7 => Command::AddJoint { joint: self.joint_def(source, world) },
            8 => Command::RemoveJoint { joint: self.joint(source, world) },
            9 => Command::ApplyForce {
                body,
                force: source.mostly_vec(-200_000, 200_000),
                point: place(self, source),
            },
            10 => Command::ApplyTorque { body, torque: source.mostly(-200_000, 200_000) },
            11 => Command::ApplyImpulse {
                body,
                impulse: source.mostly_vec(-20_000, 20_000),
                point: place(self, source),
            },
            12 => Command::ApplyAngularImpulse { body, impulse: source.mostly(-20_000, 20_000) },
            13 | 14 => Command::SetVelocity {
                body,
                velocity: if source.one_in(4) {
                    source.mostly_vec(-400_000, 400_000)
                } else {
                    source.mostly_vec(-10_000, 10_000)
                },
                angular_velocity: source.mostly(-40_000, 40_000),
            },
            15 => Command::SetTransform { body, position: place(self, source), angle: source.angle() },
            _ => Command::SetGravity { gravity: source.mostly_vec(-30_000, 30_000) },
        });
    }

    fn near(&self, source: &mut Source<'_>, reach: i64) -> Vec2<Fx> {
        self.middle + Vec2::new(source.thousandths(-reach, reach), source.thousandths(-reach, reach))
    }

    /// Many bodies of a kind at once, for few bytes: at one point, or scattered around it.
    fn heap(&self, source: &mut Source<'_>, commands: &mut Vec<Command>) {
        let count = source.pick(&[5, 12, 20, 8, 3, 40, 1, 80]);
        let mut rng = Rng::new(source.byte().into());
        let shape = shapes::shape(source);
        let spread = source.pick(&[fx!(2), fx!(1), fx!(0), fx!(0.01)]);
        let centre = self.near(source, 1000);
        for _ in 0..count {
            let offset = Vec2::new(rng.range(-spread, spread), rng.range(-spread, spread));
            let (position, angle) = (centre + offset, rng.angle());
            let mut def = BodyDef::dynamic().position(position.x, position.y);
            if spread > Fx::ONE {
                def = def.angle(angle);
            }
            commands.push(spawn(def, &[shape]));
        }
    }

    fn spawned(&self, source: &mut Source<'_>) -> Command {
        let kinds =
            [BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Fixed];
        let mut body = BodyDef::new(source.pick(&kinds));
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
        if source.one_in(6) {
            body.linear_damping = source.mostly(0, 10_000);
            body.angular_damping = source.mostly(0, 10_000);
            body.gravity_scale = source.mostly(-2000, 2000);
        }
        if source.one_in(5) {
            let masses = [fx!(1), fx!(0.00001), fx!(1073741824), fx!(1000), fx!(0.01)];
            let radii = [fx!(0.3), fx!(0.002), fx!(512), fx!(0.05)];
            body.mass = MassSource::Given {
                mass: if source.one_in(8) { source.edge() } else { source.pick(&masses) },
                centre: if source.one_in(3) { source.mostly_vec(-2000, 2000) } else { Vec2::ZERO },
                gyration: if source.one_in(8) { source.edge() } else { source.pick(&radii) },
            };
        }
        let count = source.pick(&[1, 1, 2, 1, 3, 0, 6]);
        let shapes: Vec<_> = (0..count).map(|_| shapes::shape(source)).collect();
        spawn(body, &shapes)
    }

    fn joint_def(&mut self, source: &mut Source<'_>, world: &World) -> JointDef {
        let (a, b) = (self.body(source, world), self.body(source, world));
        let anchor = |source: &mut Source<'_>| match source.below(4) {
            0 => Vec2::ZERO,
            1 | 2 => source.mostly_vec(-800, 800),
            _ => source.mostly_vec(-256_000, 256_000),
        };
        let (anchor_a, anchor_b) = (anchor(source), anchor(source));
        let collide_connected = source.one_in(2);
        RevoluteDef { body_a: a, body_b: b, anchor_a, anchor_b, collide_connected }.into()
    }

    /// Mostly a body that is there, sometimes one that has been, sometimes one that never was.
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

fn spawn(body: BodyDef, shapes: &[ShapeDef]) -> Command {
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

/// Handles from bytes, as they come in a file.
mod serde_handle {
    use super::{BodyId, JointId, ShapeId, codec};

    pub(super) trait Handle {
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

/// How much a tick of a world costs, roughly: what keeps a fuzzed scene from running for minutes.
#[must_use]
pub fn cost(world: &World) -> u64 {
    let solver = world.config().solver;
    let rounds = u64::from(solver.sub_steps) * u64::from(solver.iterations);
    (world.pair_count() as u64 + world.joints().count() as u64 + world.body_count() as u64) * (rounds + 2)
}
