//! The sandbox: raw physics as a game, whose input is a list of [`Command`]s.

use alloc::format;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Game, RulesId, SetupError};
use crate::body::{BodyId, BodyKind};
use crate::hash::StateHash;
use crate::solver::SolverSettings;
use crate::world::{Command, Config, Snapshot, World};

/// A physics world that one player modifies by commands.
///
/// A command that the world refuses, for example because its body no longer exists, is skipped and counted.
///
/// ```
/// use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
/// let mut game = Sandbox::new(&SandboxSetup::default())?;
/// game.step(&[vec![]]);
/// assert_eq!(game.world().tick(), 1);
/// # Ok::<(), lockstep2d::lockstep::SetupError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sandbox {
    world: World,
    refused: u64,
}

/// Maximum work units of a setup's commands: about two seconds. A million bodies of one shape take 12 million.
const SETUP_WORK_MAX: u64 = 100_000_000;

/// Initial state of a sandbox.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SandboxSetup {
    /// The world's settings.
    pub config: Config,
    /// Commands that create the contents of the world before the first tick.
    pub commands: Vec<Command>,
}

/// A copy of a sandbox.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SandboxSave {
    /// The world.
    pub world: Snapshot,
    /// Number of refused commands.
    pub refused: u64,
}

impl Sandbox {
    /// The world.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// Mutable access to the world, to configure what is not state: caches and the broad phase. Any other change is
    /// missing from the input log, so a replay diverges.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// Number of commands that the world has refused.
    #[must_use]
    pub const fn refused(&self) -> u64 {
        self.refused
    }
}

impl Game for Sandbox {
    type Setup = SandboxSetup;
    type Input = Vec<Command>;
    type Save = SandboxSave;

    const RULES: RulesId = RulesId { name: "sandbox", version: 1 };

    /// Refuses a setup if its settings or any of its commands are refused: unlike a player's commands, the commands of
    /// a setup are not predictions that may fail.
    fn new(setup: &SandboxSetup) -> Result<Self, SetupError> {
        let mut world = World::new(setup.config).map_err(|error| SetupError { why: format!("{error}") })?;
        let mut work = 0u64;
        for (index, command) in setup.commands.iter().enumerate() {
            work = work.saturating_add(command_work(&world, command));
            if work > SETUP_WORK_MAX {
                return Err(SetupError {
                    why: format!("command {index}: too much work before the first tick"),
                });
            }
            let refused = |error| SetupError { why: format!("command {index}: {error}") };
            world.execute(command).map_err(refused)?;
        }
        Ok(Sandbox { world, refused: 0 })
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        self.world.config().tick_rate
    }

    fn step(&mut self, inputs: &[Vec<Command>]) {
        let tick_rate = self.world.config().tick_rate;
        for command in inputs.iter().flatten() {
            // The tick rate of a game is constant; only a setup may change it.
            let is_constant = match command {
                Command::SetConfig { config } => config.tick_rate == tick_rate,
                _ => true,
            };
            if !is_constant || self.world.execute(command).is_err() {
                self.refused = self.refused.saturating_add(1);
            }
        }
        self.world.step();
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of_digests([self.world.state_hash(), StateHash::of(&self.refused)])
    }

    fn save(&self) -> Self::Save {
        SandboxSave { world: self.world.save(), refused: self.refused }
    }

    fn load(&mut self, save: &SandboxSave) {
        self.world.restore(&save.world);
        self.refused = save.refused;
    }

    fn world(&self) -> Option<&World> {
        Some(&self.world)
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        Some(&mut self.world)
    }

    /// Bodies, shapes, pairs and joints, times the solver's sub-steps and iterations. Shapes that were just placed on
    /// top of each other make pairs that do not exist yet: in the worst case as many as the world allows, for which the
    /// broad phase compares every shape with every other.
    fn work(&self, inputs: &[Vec<Command>]) -> u64 {
        let world = &self.world;
        let commands = inputs.iter().flatten();
        let added: u64 = commands.clone().map(shapes_added).sum();
        let changes: u64 = commands.clone().map(|command| command_work(world, command)).sum();
        // The cost of adding a shape grows with the number of shapes that the body already has.
        let grown =
            count(commands.clone().filter(|command| matches!(command, Command::AddShape { .. })).count());
        let changes = changes.saturating_add(grown.saturating_mul(grown) * 4);
        let spawned: u64 = commands.clone().map(bodies_added).sum();
        // Settings that are out of range are refused, and cost nothing.
        let new_settings = commands.filter_map(|command| match command {
            Command::SetConfig { config } => config.validate().is_ok().then_some(&config.solver),
            _ => None,
        });
        let rounds = |solver: &SolverSettings| u64::from(solver.sub_steps) * u64::from(solver.iterations);
        let rounds = new_settings.map(rounds).fold(rounds(&world.config().solver), u64::max);
        world.work_in_rounds(spawned, added, rounds).saturating_add(changes)
    }
}

fn count(n: usize) -> u64 {
    u64::try_from(n).unwrap_or(u64::MAX)
}

fn shapes_added(command: &Command) -> u64 {
    match command {
        Command::Spawn { shapes, .. } => count(shapes.len()),
        Command::SpawnEach { shapes, places, .. } => count(shapes.len()).saturating_mul(count(places.len())),
        Command::AddShape { .. } => 1,
        _ => 0,
    }
}

fn bodies_added(command: &Command) -> u64 {
    match command {
        Command::Spawn { .. } => 1,
        Command::SpawnEach { places, .. } => count(places.len()),
        _ => 0,
    }
}

fn is_kinematic(world: &World, body: BodyId) -> bool {
    world.body(body).is_some_and(|body| body.kind() == BodyKind::Kinematic)
}

/// Work of a command: it visits the shapes of its body, and a removal visits all contacts and joints.
fn command_work(world: &World, command: &Command) -> u64 {
    let shapes_of = |body: BodyId| 4 * count(world.body(body).map_or(0, |body| body.shapes().len()));
    let removal = || count(world.pair_count()).saturating_add(count(world.joint_count()));
    let shapes_beside = |shape| world.shape(shape).map_or(0, |shape| shapes_of(shape.body()));
    let everything = || count(world.body_count()).saturating_add(removal());
    match command {
        Command::Spawn { .. } | Command::SpawnEach { .. } => {
            (4 * bodies_added(command)).saturating_add(shapes_added(command).saturating_mul(8))
        }
        Command::AddJointEach { ends, .. } => 1 + 4 * count(ends.len()),
        Command::Despawn { body } | Command::Disable { body } | Command::Enable { body } => {
            1 + shapes_of(*body) + removal()
        }
        Command::AddShape { body, .. } => 8 + shapes_of(*body),
        Command::RemoveShape { shape } => 1 + removal() + shapes_beside(*shape),
        Command::SetShape { shape, .. } => 8 + removal() + shapes_beside(*shape),
        Command::SetKind { body, .. } => 4 + shapes_of(*body) + removal(),
        Command::SetBody { body, .. } | Command::SetMass { body, .. } => 4 + shapes_of(*body),
        // Bodies joined to this one may have to be woken.
        Command::SetTransform { body, .. } => 4 + shapes_of(*body) + count(world.joint_count()),
        Command::SetVelocity { body, .. } | Command::MoveTo { body, .. } if is_kinematic(world, *body) => {
            1 + count(world.joint_count())
        }
        Command::Sleep { .. }
        | Command::SetGravity { .. }
        | Command::SetConfig { .. }
        | Command::Explode { .. } => 1 + everything(),
        Command::Wake { body } if world.body(*body).is_some_and(|body| !body.is_dynamic()) => {
            1 + everything()
        }
        _ => 1,
    }
}
