//! The sandbox: raw physics as a game, whose input is a list of [`Command`]s.

use alloc::format;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Game, RulesId, SetupError};
use crate::hash::StateHash;
use crate::world::{Command, Config, Snapshot, World};

/// A physics world that one player changes by commands.
///
/// A command that the world refuses, for example because its body is gone, is skipped and counted.
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

/// How a sandbox begins.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SandboxSetup {
    /// The world's settings.
    pub config: Config,
    /// What is in it before the first tick.
    pub commands: Vec<Command>,
}

impl Sandbox {
    /// The world.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The world, to change what is no state: caches and the broad phase.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// How many commands the world has refused.
    #[must_use]
    pub const fn refused(&self) -> u64 {
        self.refused
    }
}

impl Game for Sandbox {
    type Setup = SandboxSetup;
    type Input = Vec<Command>;
    type Save = (Snapshot, u64);

    const RULES: RulesId = RulesId { name: "sandbox", version: 1 };

    /// A setup is refused if its settings or any of its commands are: unlike a player's, they are not guesses.
    fn new(setup: &SandboxSetup) -> Result<Self, SetupError> {
        let mut world = World::new(setup.config).map_err(|error| SetupError { why: format!("{error}") })?;
        for (index, command) in setup.commands.iter().enumerate() {
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
        for command in inputs.iter().flatten() {
            if self.world.execute(command).is_err() {
                self.refused = self.refused.saturating_add(1);
            }
        }
        self.world.step();
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of_digests([self.world.state_hash(), StateHash::of(&self.refused)])
    }

    fn save(&self) -> Self::Save {
        (self.world.save(), self.refused)
    }

    fn load(&mut self, (snapshot, refused): &Self::Save) {
        self.world.restore(snapshot);
        self.refused = *refused;
    }

    /// Bodies, pairs and joints times what is done for each in a tick. Shapes that have just been put on top of
    /// each other make pairs that are not there yet: as many as the world allows, in the worst case, for which
    /// the broad phase compares each with each.
    fn work(&self, inputs: &[Vec<Command>]) -> u64 {
        let count = |n: usize| u64::try_from(n).unwrap_or(u64::MAX);
        let world = &self.world;
        let commands = count(inputs.iter().map(Vec::len).sum());
        let spawned = inputs.iter().flatten().map(|command| match command {
            Command::Spawn { shapes, .. } => shapes.len(),
            _ => 0,
        });
        let shapes = count(world.shape_count()).saturating_add(count(spawned.sum()));
        let bodies = count(world.body_count()).saturating_add(commands);
        let solver = world.config().solver;
        let rounds = u64::from(solver.sub_steps) * u64::from(solver.iterations);
        let constraints = count(world.pair_count()).saturating_add(count(world.joint_count()));
        let solved = bodies.saturating_add(shapes).saturating_add(constraints).saturating_mul(rounds);
        let compared = shapes.saturating_mul(shapes);
        let possible_pairs = (compared / 2).min(world.config().pair_limit.into());
        solved.saturating_add(possible_pairs).saturating_add(compared / 64)
    }
}
