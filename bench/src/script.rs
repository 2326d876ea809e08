//! [`Script`]: a scene as a list of recorded commands, from which every engine is built and driven.
//!
//! Commands refer to bodies by handles that earlier commands created. So each command is executed once, on a world that
//! is never stepped, and stored with its outcome. The commands of the scenes in [`SCENES`] depend only on what earlier
//! commands have set, such as the user data of bodies, and not on results of the simulation. So the list is valid for
//! every engine.

use anyhow::{Context, Result, anyhow};
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::world::{Command, Config, Outcome};
use lockstep2d_scenes::Scene;

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

pub type Event = (Command, Outcome);

pub struct Script {
    pub config: Config,
    /// Commands that build the scene.
    pub setup: Vec<Event>,
    /// Commands before each step.
    pub ticks: Vec<Vec<Event>>,
    /// Number of initial steps that are not timed.
    pub untimed: usize,
}

impl Script {
    /// Records a scene, but at most its first `most_steps` steps.
    pub fn of_scene(name: &str, most_steps: Option<u64>) -> Result<Self> {
        let scene = Scene::find(name).ok_or_else(|| anyhow!("no scene {name}"))?;
        let steps = most_steps.map_or(scene.ticks, |most| most.min(scene.ticks));
        Self::record(scene.setup(7), steps, |tick, game| scene.commands(tick, game))
            .with_context(|| format!("scene {name}"))
    }

    /// Records a setup without later commands.
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

    pub fn untimed(self, untimed: usize) -> Self {
        Script { untimed, ..self }
    }

    pub fn steps(&self) -> usize {
        self.ticks.len()
    }
}

fn execute(game: &mut Sandbox, commands: Vec<Command>) -> Result<Vec<Event>> {
    let mut events = Vec::new();
    for command in commands {
        // This world is never stepped, so a `MoveTo` would never take effect. Instead, the body is placed at its target
        // at once, from which the next `MoveTo` starts.
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
        assert_eq!(busy, [0, 7, 8, 15, 16], "ragdolls should be spawned disabled and enabled later");
    }
}
