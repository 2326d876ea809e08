//! The sandbox: physics as a game, whose input is a list of [`Command`]s.

use alloc::format;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Game, RulesId, SetupError, StartError};
use crate::hash::StateHash;
use crate::world::{Command, Config, Snapshot, World};

mod work;

use work::Costs;

/// A physics world that one player modifies by commands.
///
/// A command that the world refuses is skipped and counted.
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

/// Work units of a setup without commands.
const START_WORK: u64 = 100;

/// Maximum work units of a setup, which take a few seconds. A million bodies with one shape each take 12 million.
const SETUP_WORK_MAX: u64 = 100_000_000;

/// Initial state of a sandbox.
///
/// ```
/// use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
/// # use lockstep2d::{body::BodyDef, fx, math::Vec2, world::{Command, Config}};
/// // A level as data: settings, and the commands that build it.
/// let config = Config { gravity: Vec2::new(fx!(0), fx!(-3.7)), ..Config::default() };
/// let commands = vec![Command::Spawn { body: BodyDef::dynamic(), shapes: vec![] }];
/// let game = Sandbox::new(&SandboxSetup { config, commands })?;
/// assert_eq!((game.world().tick(), game.world().body_count()), (0, 1));
/// # Ok::<(), lockstep2d::lockstep::SetupError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SandboxSetup {
    /// The world's settings.
    pub config: Config,
    /// Commands that fill the world before the first tick.
    pub commands: Vec<Command>,
}

/// A copy of a sandbox.
///
/// ```
/// use lockstep2d::lockstep::{Game, Sandbox, SandboxSave, SandboxSetup};
/// use lockstep2d::codec;
/// let mut game = Sandbox::new(&SandboxSetup::default())?;
/// (0..10).for_each(|_| game.step(&[vec![]]));
/// // A saved game on disk.
/// let bytes = codec::encode(&game.save());
/// let save: SandboxSave = codec::decode(&bytes).expect("just encoded");
/// assert_eq!(save.world.state_hash(), game.world().state_hash());
/// # Ok::<(), lockstep2d::lockstep::SetupError>(())
/// ```
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

    /// The world, for settings outside of the state, such as the solver's backend. Do not change the state: the change
    /// would be missing from the inputs, and a replay would diverge.
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

    /// Refuses a setup whose settings or commands the world refuses, or that takes more than 100 million work units.
    fn new(setup: &SandboxSetup) -> Result<Self, SetupError> {
        match Self::new_within(setup, SETUP_WORK_MAX) {
            Ok((game, _)) => Ok(game),
            Err(StartError::Refused(error)) => Err(error),
            Err(error @ StartError::TooMuchWork { .. }) => Err(SetupError { why: format!("{error}") }),
        }
    }

    /// Charges the cost of each command before its execution, and then the work that the world has counted during the
    /// execution. A `work_max` above 100 million counts as 100 million.
    fn new_within(setup: &SandboxSetup, work_max: u64) -> Result<(Self, u64), StartError> {
        let max = work_max.min(SETUP_WORK_MAX);
        let refused = |why| StartError::Refused(SetupError { why });
        let mut world = World::new(setup.config).map_err(|error| refused(format!("{error}")))?;
        let mut work = START_WORK;
        for (index, command) in setup.commands.iter().enumerate() {
            work = work.saturating_add(Costs::of(&world).command(command));
            if work > max {
                return Err(StartError::TooMuchWork { work, max });
            }
            world.start_work_meter(max - work);
            world.execute(command).map_err(|error| refused(format!("command {index}: {error}")))?;
            work = work.saturating_add(world.stop_work_meter());
        }
        if work > max {
            return Err(StartError::TooMuchWork { work, max });
        }
        Ok((Sandbox { world, refused: 0 }, work))
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
            // A command that would change the tick rate is refused, because the tick rate of a game is constant.
            let is_constant = match command {
                Command::SetConfig { config } => config.tick_rate == tick_rate,
                _ => true,
            };
            if !is_constant || self.world.execute(command).is_err() {
                self.refused = self.refused.saturating_add(1);
            }
            // Stops if the work budget is exhausted, because further commands could take any time. The verifier
            // discards the state.
            if self.world.is_work_exhausted() {
                return;
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

    /// The bound of [`World::work`], including the objects that the commands add, plus the work of the commands. Work
    /// that is known only during the tick is not included, because the world counts it.
    fn work(&self, inputs: &[Vec<Command>]) -> u64 {
        let mut costs = Costs::of(&self.world);
        inputs.iter().flatten().for_each(|command| costs.add(command));
        let changes = inputs.iter().flatten().map(|command| costs.command(command));
        let changes = changes.fold(0, u64::saturating_add);
        self.world.work_in_rounds(costs.added, costs.rounds).saturating_add(changes)
    }
}
