//! [`Costs`]: work units of the commands of a tick or of a setup.
//!
//! All commands of a tick are charged before the first one is executed, but a command may refer to objects that an
//! earlier one adds. Objects added in the tick therefore count as existing.

use crate::body::BodyId;
use crate::solver::SolverSettings;
use crate::world::{AddedWork, Command, World};

/// Work units of a shape that is created or replaced.
const SHAPE_WORK: u64 = 8;
/// Work units of a body, of a joint, or of visiting a shape.
const VISIT_WORK: u64 = 4;

pub(super) struct Costs<'a> {
    world: &'a World,
    pub(super) added: AddedWork,
    /// Number of [`Command::AddShape`] commands of the tick.
    grown: u64,
    /// Passes of the solver: the largest product of sub-steps and iterations in the tick.
    pub(super) rounds: u64,
}

impl<'a> Costs<'a> {
    pub(super) fn of(world: &'a World) -> Self {
        let rounds = rounds(&world.config().solver);
        Costs { world, added: AddedWork::default(), grown: 0, rounds }
    }

    /// Counts the objects that a command of the tick adds. Raises `rounds` if the command sets larger solver settings.
    pub(super) fn add(&mut self, command: &Command) {
        self.added.bodies = self.added.bodies.saturating_add(bodies_added(command));
        self.added.shapes = self.added.shapes.saturating_add(shapes_added(command));
        self.added.joints = self.added.joints.saturating_add(joints_added(command));
        match command {
            Command::AddShape { .. } => self.grown = self.grown.saturating_add(1),
            // The world refuses settings that are out of range.
            Command::SetConfig { config } if config.validate().is_ok() => {
                self.rounds = self.rounds.max(rounds(&config.solver));
            }
            _ => {}
        }
    }

    /// Work units of a command. Many commands visit the shapes of their body. A removal visits all pairs and joints.
    pub(super) fn command(&self, command: &Command) -> u64 {
        match command {
            Command::Spawn { .. } | Command::SpawnEach { .. } => {
                let bodies = bodies_added(command).saturating_mul(VISIT_WORK);
                bodies.saturating_add(shapes_added(command).saturating_mul(SHAPE_WORK))
            }
            Command::AddJoint { joint } => {
                VISIT_WORK.saturating_add(self.joined(&[joint.body_a, joint.body_b]))
            }
            Command::AddJointEach { ends, .. } => ends
                .iter()
                .map(|(a, b)| VISIT_WORK.saturating_add(self.joined(&[*a, *b])))
                .fold(1, u64::saturating_add),
            Command::RemoveJoint { joint }
            | Command::SetJoint { joint, .. }
            | Command::EnableJoint { joint }
            | Command::DisableJoint { joint } => {
                let bodies = self.world.joint(*joint).map(|joint| joint.def().bodies());
                // A joint added in this tick may connect any two bodies, so it is charged for all shapes.
                let joined = bodies.map_or(self.shapes(), |(a, b)| self.joined(&[a, b]));
                VISIT_WORK.saturating_add(joined)
            }
            Command::Despawn { body } | Command::Disable { body } | Command::Enable { body } => {
                1 + self.shapes_of(*body) + self.removal()
            }
            Command::AddShape { body, .. } => SHAPE_WORK + self.shapes_of(*body),
            Command::RemoveShape { shape } => 1 + self.removal() + self.shapes_beside(shape),
            Command::SetShape { shape, .. } | Command::SetArea { shape, .. } => {
                SHAPE_WORK + self.removal() + self.shapes_beside(shape)
            }
            Command::SetKind { body, .. } => VISIT_WORK + self.shapes_of(*body) + self.removal(),
            // The world itself counts the search for overlaps that these commands cause, and the joints whose bodies
            // they wake.
            Command::SetBody { body, .. }
            | Command::SetMass { body, .. }
            | Command::SetTransform { body, .. } => VISIT_WORK + self.shapes_of(*body),
            Command::Sleep { .. } | Command::SetGravity { .. } | Command::SetConfig { .. } => {
                1 + self.everything()
            }
            // The world itself counts the shapes in reach of an explosion, and the joints and sleeping contacts that a
            // command visits.
            _ => VISIT_WORK,
        }
    }

    fn joints(&self) -> u64 {
        count(self.world.joint_count()).saturating_add(self.added.joints)
    }

    fn shapes(&self) -> u64 {
        count(self.world.shape_count()).saturating_add(self.added.shapes)
    }

    fn removal(&self) -> u64 {
        count(self.world.pair_count()).saturating_add(self.joints())
    }

    fn everything(&self) -> u64 {
        let bodies = count(self.world.body_count()).saturating_add(self.added.bodies);
        [bodies, self.shapes(), self.removal()].into_iter().fold(self.world.scan_work(), u64::saturating_add)
    }

    /// Work units of visiting the shapes of a body. A body added in this tick may have all shapes added in this tick.
    fn shapes_of(&self, body: BodyId) -> u64 {
        let shapes = match self.world.body(body) {
            Some(body) => count(body.shapes().len()).saturating_add(self.grown),
            None => self.added.shapes,
        };
        shapes.saturating_mul(VISIT_WORK)
    }

    fn shapes_beside(&self, shape: &crate::body::ShapeId) -> u64 {
        match self.world.shape(*shape) {
            Some(shape) => self.shapes_of(shape.body()),
            None => self.shapes().saturating_mul(VISIT_WORK),
        }
    }

    /// Work units of comparing the shapes of two bodies again after a change of their joint: one for each shape.
    fn joined(&self, bodies: &[BodyId; 2]) -> u64 {
        bodies.iter().map(|body| self.shapes_of(*body) / VISIT_WORK).fold(0, u64::saturating_add)
    }
}

fn rounds(solver: &SolverSettings) -> u64 {
    u64::from(solver.sub_steps) * u64::from(solver.iterations)
}

fn count(n: usize) -> u64 {
    u64::try_from(n).unwrap_or(u64::MAX)
}

fn shapes_added(command: &Command) -> u64 {
    match command {
        Command::Spawn { shapes, .. } => count(shapes.len()),
        Command::SpawnEach { shapes, poses, .. } => count(shapes.len()).saturating_mul(count(poses.len())),
        Command::AddShape { .. } => 1,
        _ => 0,
    }
}

fn bodies_added(command: &Command) -> u64 {
    match command {
        Command::Spawn { .. } => 1,
        Command::SpawnEach { poses, .. } => count(poses.len()),
        _ => 0,
    }
}

fn joints_added(command: &Command) -> u64 {
    match command {
        Command::AddJoint { .. } => 1,
        Command::AddJointEach { ends, .. } => count(ends.len()),
        _ => 0,
    }
}
