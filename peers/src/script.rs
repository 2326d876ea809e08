//! A scene as a list of commands, recorded once: what every engine is built and driven from.
//!
//! Commands name bodies by lockstep2d's handles, and those that spawn something make new ones. So each command is
//! carried out on a world that is never stepped, and kept together with what it made. The scenes' scripts do not look
//! at where bodies went, only at which there are, so the same list serves every engine.

use anyhow::{Context, Result, anyhow};
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::scenes::Scene;
use lockstep2d::world::{Command, Config, Outcome};

/// The ten scenes, in the order of the tables.
pub const SCENES: [&str; 10] = [
    "large_pyramid",
    "many_pyramids",
    "joint_grid",
    "rain",
    "smash",
    "spinner",
    "tumbler",
    "washer",
    "junkyard",
    "compounds",
];

/// A command and what it made.
pub type Event = (Command, Outcome);

/// A scene to run.
pub struct Script {
    /// The settings of its world.
    pub config: Config,
    /// What is in it at the start.
    pub setup: Vec<Event>,
    /// What happens before each step.
    pub ticks: Vec<Vec<Event>>,
    /// How many of the first steps are not timed.
    pub untimed: usize,
}

impl Script {
    /// A scene by name, for its own number of steps or fewer.
    pub fn of_scene(name: &str, most_steps: Option<u64>) -> Result<Self> {
        let scene = Scene::find(name).ok_or_else(|| anyhow!("no scene {name}"))?;
        let steps = most_steps.map_or(scene.ticks, |most| most.min(scene.ticks));
        Self::record(scene.setup(7), steps, |tick, game| scene.commands(tick, game))
            .with_context(|| format!("scene {name}"))
    }

    /// A setup in which nothing happens.
    pub fn of_setup(setup: SandboxSetup, steps: u64) -> Result<Self> {
        Self::record(setup, steps, |_, _| Vec::new())
    }

    fn record(
        setup: SandboxSetup,
        steps: u64,
        commands: impl Fn(u64, &Sandbox) -> Vec<Command>,
    ) -> Result<Self> {
        let empty = SandboxSetup { config: setup.config, commands: Vec::new() };
        let mut game = Sandbox::new(&empty).map_err(|error| anyhow!("{error:?}"))?;
        let setup_events = execute(&mut game, setup.commands)?;
        let mut ticks = Vec::new();
        for tick in 0..steps {
            let now = commands(tick, &game);
            ticks.push(execute(&mut game, now)?);
        }
        Ok(Script { config: setup.config, setup: setup_events, ticks, untimed: 1 })
    }

    /// The same with another number of first steps that are not timed.
    pub fn untimed(self, untimed: usize) -> Self {
        Script { untimed, ..self }
    }

    /// How many steps it has.
    pub fn steps(&self) -> usize {
        self.ticks.len()
    }
}

fn execute(game: &mut Sandbox, commands: Vec<Command>) -> Result<Vec<Event>> {
    let mut events = Vec::new();
    for command in commands {
        // What is sent somewhere has to be there for the next such command, without a step.
        let at_once = match command {
            Command::MoveTo { body, position, angle } => Command::SetTransform { body, position, angle },
            ref other => other.clone(),
        };
        let outcome = game.world_mut().execute(&at_once).map_err(|error| anyhow!("{error}"))?;
        events.push((command, outcome));
    }
    Ok(events)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_records_without_being_stepped() {
        for name in SCENES {
            let script = Script::of_scene(name, None).unwrap();
            assert!(script.steps() >= 200, "{name}");
            assert!(!script.setup.is_empty(), "{name}");
        }
        let rain = Script::of_scene("rain", Some(20)).unwrap();
        let busy: Vec<_> = (0..20).filter(|&tick| !rain.ticks[tick].is_empty()).collect();
        assert_eq!(busy, [0, 7, 8, 15, 16], "ragdolls are announced and released");
    }
}
