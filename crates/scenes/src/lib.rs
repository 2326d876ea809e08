//! Scenes of [`lockstep2d`] as plain data, shared by tests, replays, tools and benchmarks.
//!
//! [`ALL`] lists them, [`Scene::find`] finds one by name, and [`Builder`] builds custom setups.
#![no_std]

extern crate alloc;

mod builder;
mod character;
mod drum;
mod elementary;
mod game;
mod joints;
mod machines;
mod piles;
mod ragdoll;
mod rain;
mod spring_leg;
#[cfg(test)]
mod tests;
mod waterworks;
mod yards;

use alloc::vec::Vec;

pub use builder::Builder;

use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::world::Command;

/// A scene: a setup, and a script of commands.
///
/// ```
/// use lockstep2d::lockstep::{Game, Sandbox};
/// use lockstep2d_scenes::Scene;
/// let pyramid = Scene::find("pyramid").expect("a scene");
/// let mut game = Sandbox::new(&pyramid.setup(0))?;
/// for tick in 0..10 {
///     let commands = pyramid.commands(tick, &game);
///     game.step(&[commands]);
/// }
/// assert!(game.world().body_count() > 10);
/// # Ok::<(), lockstep2d::lockstep::SetupError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// Name of the scene and of its replay.
    pub name: &'static str,
    /// One-line description.
    pub about: &'static str,
    /// Length in ticks.
    pub ticks: u64,
    /// Length in ticks of the scene's golden replay.
    pub golden_ticks: u64,
    setup: fn(seed: u64) -> SandboxSetup,
    script: fn(tick: u64, game: &Sandbox) -> Vec<Command>,
}

impl Scene {
    const fn new(
        name: &'static str,
        ticks: u64,
        about: &'static str,
        setup: fn(u64) -> SandboxSetup,
    ) -> Self {
        Scene { name, about, ticks, golden_ticks: ticks, setup, script: |_, _| Vec::new() }
    }

    const fn golden(self, ticks: u64) -> Self {
        Scene { golden_ticks: ticks, ..self }
    }

    /// Finds a scene by name.
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Scene> {
        ALL.iter().find(|scene| scene.name == name)
    }

    /// The setup. The seed has an effect only on random scenes.
    #[must_use]
    pub fn setup(&self, seed: u64) -> SandboxSetup {
        (self.setup)(seed)
    }

    /// The commands in a tick. `game` is the state before the tick.
    #[must_use]
    pub fn commands(&self, tick: u64, game: &Sandbox) -> Vec<Command> {
        (self.script)(tick, game)
    }
}

/// All scenes.
pub const ALL: &[Scene] = &[
    elementary::FREE_FALL,
    elementary::BOUNCING_BALL,
    elementary::HEAD_ON,
    elementary::OBLIQUE,
    elementary::SLOPE,
    elementary::BALL_IN_BOX,
    piles::BOX_STACK,
    piles::HEAVY_ON_LIGHT,
    piles::PYRAMID,
    piles::LARGE_PYRAMID,
    piles::MANY_PYRAMIDS,
    piles::HUNDRED_POLYGONS,
    drum::DRUM,
    drum::SPAWNING,
    joints::PENDULUM,
    joints::SPINNING_ROD,
    joints::LONG_ARM,
    joints::CHAIN,
    joints::JOINT_GRID,
    character::CHARACTER,
    rain::RAIN,
    yards::SMASH,
    machines::SPINNER,
    machines::TUMBLER,
    machines::WASHER,
    yards::JUNKYARD,
    yards::COMPOUNDS,
    ragdoll::RAGDOLL,
    joints::BRIDGE,
    game::GAME,
    spring_leg::SPRING_LEG,
    waterworks::WATERWORKS,
];
