//! Worlds that differ only in their broad phase must have equal states, events and numbers of pairs. The scene is a
//! crowd of bodies, in which bodies are spawned, despawned, teleported and resized.

use lockstep2d::body::{BodyDef, BodyId, BodyKind, Geometry, ShapeDef};
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::world::{BodyPose, Command, World};

use crate::generator::{self, Generator};
use crate::shapes;
use crate::source::Source;

/// Maximum cost of a run. The cost of a tick is [`generator::cost`] plus `n * n / 64` for `n` shapes, because brute
/// force compares all pairs. A run ends in the tick in which the sum exceeds the maximum.
const COST_MAX: u64 = 120_000;
/// If the world has this number of shapes or more, no further bodies arrive.
const SHAPES_MAX: usize = 600;

/// Simulates the crowd that the bytes describe. Returns the sum of the numbers of pairs of all ticks.
///
/// # Panics
/// When the worlds differ.
pub fn run(bytes: &[u8]) -> u64 {
    let mut source = Source::new(bytes);
    let mut config = generator::config(&mut source);
    config.solver.sub_steps = source.pick(&[2, 1, 4]);
    if source.one_in(3) {
        config.pair_limit = source.byte().into();
    }
    let first = World::new(config).unwrap_or_default();
    let mut worlds = [first.clone(), first.clone(), first.clone(), first];
    worlds[1].set_broad_phase(BroadPhaseKind::SweepAndPrune);
    worlds[2].set_broad_phase(BroadPhaseKind::BruteForce);
    let mut generator = Generator::new(&mut source);
    let mut crowd = Crowd::new(&mut source);
    let (mut pairs, mut cost) = (0, 0);
    for tick in 0..20 + source.below(41) {
        let mut commands = crowd.commands(&mut source, &worlds[0]);
        if tick == 0 || source.one_in(8) {
            commands.extend(generator.tick(&mut source, &worlds[0]));
        }
        for command in &commands {
            let outcome = worlds[0].execute(command);
            for world in &mut worlds[1..] {
                assert_eq!(world.execute(command), outcome, "{command:?}");
            }
        }
        if source.one_in(4) {
            let kinds = [BroadPhaseKind::Tree, BroadPhaseKind::SweepAndPrune, BroadPhaseKind::BruteForce];
            worlds[3].set_broad_phase(source.pick(&kinds));
        }
        worlds.iter_mut().for_each(World::step);
        let [tree, others @ ..] = &worlds;
        for (nth, other) in others.iter().enumerate() {
            assert_eq!(other.pair_count(), tree.pair_count(), "world {nth}, tick {tick}: pairs");
            let differing = other.digest().differing(&tree.digest());
            assert!(differing.is_empty(), "world {nth}, tick {tick}: {differing:?}");
            assert_eq!(other.events(), tree.events(), "world {nth}, tick {tick}: events");
        }
        assert_eq!(tree.validate(), Ok(()));
        pairs += tree.pair_count() as u64;
        cost += generator::cost(tree) + (tree.shape_count() * tree.shape_count() / 64) as u64;
        if cost > COST_MAX {
            break;
        }
    }
    pairs
}

struct Crowd {
    rng: Rng,
    /// Half the width of the area in which bodies are placed.
    reach: Fx,
    shape: ShapeDef,
    kind: BodyKind,
}

impl Crowd {
    fn new(source: &mut Source<'_>) -> Self {
        let mut shape = match source.below(4) {
            0 => shapes::shape(source),
            1 => ShapeDef::new(Geometry::Circle { radius: source.thousandths(2, 3000) }),
            _ => shapes::ordinary_shape(source),
        };
        // Half of the crowds consist of sensors, which take no time in the solver.
        shape.sensor = source.one_in(2);
        let reaches = [fx!(10), fx!(3), fx!(30), fx!(300), fx!(100000), fx!(1000000000)];
        let kind = source.pick(&[BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Fixed]);
        Crowd { rng: Rng::new(source.word()), reach: source.pick(&reaches), shape, kind }
    }

    fn commands(&mut self, source: &mut Source<'_>, world: &World) -> Vec<Command> {
        let mut commands = Vec::new();
        if world.tick() == 0 {
            commands.push(self.arrive(source, 200));
        }
        for _ in 0..source.pick(&[1, 0, 2, 3]) {
            match source.below(8) {
                0 if world.shape_count() < SHAPES_MAX => {
                    commands.push(self.arrive(source, 60));
                }
                1 => self.each(world, 4, &mut commands, |_, body| Command::Despawn { body }),
                2 | 3 => self.each(world, 3, &mut commands, |crowd, body| {
                    let BodyPose { position, angle } = crowd.pose();
                    Command::SetTransform { body, position, angle }
                }),
                4 => self.each(world, 2, &mut commands, |crowd, body| {
                    let velocity =
                        Vec2::new(crowd.rng.range(fx!(-60), fx!(60)), crowd.rng.range(fx!(-9), fx!(9)));
                    Command::SetVelocity { body, velocity, angular_velocity: fx!(0) }
                }),
                5 => self.each(world, 6, &mut commands, |crowd, body| match crowd.rng.below(3) {
                    0 => Command::Disable { body },
                    1 => Command::Sleep { body },
                    _ => Command::Enable { body },
                }),
                6 => {
                    let shape = shapes::shape(source);
                    self.each(world, 8, &mut commands, |_, body| Command::AddShape { body, shape });
                }
                _ => {
                    let def = ShapeDef { sensor: self.shape.sensor, ..shapes::shape(source) };
                    let change = |id| Command::SetShape { shape: id, def };
                    let some = world.shapes().map(|(id, _)| id).filter(|_| self.rng.chance(1, 5));
                    commands.extend(some.map(change));
                }
            }
        }
        commands
    }

    fn each(
        &mut self,
        world: &World,
        one_of: u32,
        commands: &mut Vec<Command>,
        command: impl Fn(&mut Self, BodyId) -> Command,
    ) {
        for (body, _) in world.bodies() {
            if self.rng.chance(1, one_of) {
                commands.push(command(self, body));
            }
        }
    }

    fn arrive(&mut self, source: &mut Source<'_>, most: usize) -> Command {
        let count = 1 + source.below(most);
        let mut body = BodyDef::new(self.kind);
        body.settings.gravity_scale = source.pick(&[fx!(0), fx!(1)]);
        Command::SpawnEach {
            body,
            shapes: vec![self.shape],
            poses: (0..count).map(|_| self.pose()).collect(),
        }
    }

    fn pose(&mut self) -> BodyPose {
        let reach = self.reach;
        let mut position = Vec2::new(self.rng.range(-reach, reach), self.rng.range(-reach, reach));
        if self.rng.chance(1, 8) {
            // Whole numbers as coordinates, so that many AABBs have equal bounds.
            position = Vec2::new(self.rng.range(fx!(-4), fx!(4)).round(), position.y.round());
        }
        BodyPose {
            position,
            angle: if self.rng.chance(1, 2) { self.rng.angle() } else { Default::default() },
        }
    }
}
