//! Builds a setup command by command. Each command is also executed on a world, to obtain the handles of bodies.

use alloc::vec::Vec;

use lockstep2d::body::{BodyDef, BodyId, JointId, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::SandboxSetup;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::solver::JointDef;
use lockstep2d::world::{BodyPose, Command, Config, Outcome, World};

/// A setup under construction.
///
/// ```
/// use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::Config};
/// use lockstep2d_scenes::Builder;
/// let mut scene = Builder::new(Config::default());
/// let plank = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.1))?);
/// scene.spawn(BodyDef::dynamic(), &[plank])?;
/// let setup = scene.finish();
/// assert_eq!(setup.commands.len(), 1);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Debug)]
pub struct Builder {
    setup: SandboxSetup,
    world: World,
}

impl Builder {
    /// Creates an empty setup. This function accepts invalid settings; the game refuses such a setup later.
    #[must_use]
    pub fn new(config: Config) -> Self {
        let world = World::new(config).unwrap_or_default();
        Builder { setup: SandboxSetup { config, commands: Vec::new() }, world }
    }

    /// Adds a command of any kind.
    ///
    /// # Errors
    /// [`WorldError`] when the world refuses the command.
    pub fn command(&mut self, command: Command) -> Result<Outcome, WorldError> {
        let outcome = self.world.execute(&command)?;
        self.setup.commands.push(command);
        Ok(outcome)
    }

    /// Adds a body.
    ///
    /// # Errors
    /// [`WorldError`] when the world refuses the body.
    pub fn spawn(&mut self, body: BodyDef, shapes: &[ShapeDef]) -> Result<BodyId, WorldError> {
        match self.command(Command::Spawn { body, shapes: shapes.to_vec() })? {
            Outcome::Body(id) => Ok(id),
            other => unreachable!("expected a spawned body, got {other:?}"),
        }
    }

    /// Adds a joint.
    ///
    /// # Errors
    /// [`WorldError`] when the world refuses the joint.
    pub fn joint(&mut self, joint: impl Into<JointDef>) -> Result<JointId, WorldError> {
        match self.command(Command::AddJoint { joint: joint.into() })? {
            Outcome::Joint(id) => Ok(id),
            other => unreachable!("expected a joint, got {other:?}"),
        }
    }

    /// Adds a body at every position. All bodies have the angle of the definition.
    ///
    /// # Errors
    /// [`WorldError`] when the world refuses a body.
    pub fn spawn_each(
        &mut self,
        body: BodyDef,
        shapes: &[ShapeDef],
        positions: impl IntoIterator<Item = Vec2<Fx>>,
    ) -> Result<Vec<BodyId>, WorldError> {
        let poses = positions.into_iter().map(|position| BodyPose { position, angle: body.angle }).collect();
        match self.command(Command::SpawnEach { body, shapes: shapes.to_vec(), poses })? {
            Outcome::Bodies(ids) => Ok(ids),
            other => unreachable!("expected spawned bodies, got {other:?}"),
        }
    }

    /// Adds a joint between the bodies of each pair in `ends`.
    ///
    /// # Errors
    /// [`WorldError`] when the world refuses a joint.
    pub fn joint_each(
        &mut self,
        joint: impl Into<JointDef>,
        ends: Vec<(BodyId, BodyId)>,
    ) -> Result<Vec<JointId>, WorldError> {
        match self.command(Command::AddJointEach { joint: joint.into(), ends })? {
            Outcome::Joints(ids) => Ok(ids),
            other => unreachable!("expected joints, got {other:?}"),
        }
    }

    /// Returns the setup.
    #[must_use]
    pub fn finish(self) -> SandboxSetup {
        self.setup
    }
}

/// Builds a scene of this crate. Panics if the world refuses a command, because this is a mistake in the scene.
pub(super) fn build(
    config: Config,
    fill: impl FnOnce(&mut Builder) -> Result<(), WorldError>,
) -> SandboxSetup {
    let mut builder = Builder::new(config);
    fill(&mut builder).expect("the scenes of this crate are valid");
    builder.finish()
}

/// A rectangle with these half extents in metres.
pub(super) fn rectangle(half_width: Fx, half_height: Fx) -> Result<ShapeDef, WorldError> {
    Ok(ShapeDef::new(Polygon::rectangle(half_width, half_height)?))
}

/// A fixed floor whose top is at height 0.
pub(super) fn floor(scene: &mut Builder, half_width: Fx) -> Result<BodyId, WorldError> {
    scene.spawn(BodyDef::fixed().position((fx!(0), fx!(-1))), &[rectangle(half_width, fx!(1))?])
}

pub(super) fn weightless() -> Config {
    Config { gravity: Vec2::ZERO, ..Config::default() }
}

/// Settings without sleeping, for measuring performance.
pub(super) fn sleepless() -> Config {
    Config { sleeping: false, ..Config::default() }
}
