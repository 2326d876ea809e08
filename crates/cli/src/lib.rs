//! The command-line tools for replays, as a library. One line in `main` provides them for the rules of a game.
//!
//! ```no_run
//! # mod my_game {
//! #     use lockstep2d::{hash::StateHash, lockstep::{Game, RulesId, SetupError}};
//! #     pub struct MyGame;
//! #     impl Game for MyGame {
//! #         type Setup = ();
//! #         type Input = ();
//! #         type Save = ();
//! #         const RULES: RulesId = RulesId { name: "my game", version: 1 };
//! #         fn new(_: &()) -> Result<Self, SetupError> { Ok(MyGame) }
//! #         fn players(&self) -> u32 { 1 }
//! #         fn tick_rate(&self) -> u32 { 60 }
//! #         fn step(&mut self, _: &[()]) {}
//! #         fn state_hash(&self) -> StateHash { StateHash(0) }
//! #         fn save(&self) {}
//! #         fn load(&mut self, _: &()) {}
//! #         fn work(&self, _: &[()]) -> u64 { 1 }
//! #     }
//! # }
//! # use my_game::MyGame;
//! fn main() -> std::process::ExitCode {
//!     lockstep2d_cli::run::<MyGame>()
//! }
//! ```
//!
//! `run` provides `verify`, `diff`, `bisect`, `trace`, `stress-saves`, `inspect`, `seek`, `fork`, `trim`, `stats`,
//! `export`, `keygen` and `sign`. [`Tool::with_scenes`] adds `scenes` and `record`. With the feature `view`,
//! `Tool::with_viewer` adds `view`, which opens a window.

mod clock;
mod commands;
mod console;
mod context;
mod counts;
mod energy;
mod error;
mod exit;
mod figures;
mod files;
mod identity;
mod output_file;
mod panics;
mod rewriting;
mod sandbox;
mod scenes;
pub mod signature;
mod tool;
#[cfg(feature = "view")]
mod view;
mod walk;

use std::process::ExitCode;

use lockstep2d::lockstep::Game;

/// The version of clap whose types [`Tool::with_command`] takes.
pub use clap;
pub use commands::verify::{Judge, Judged, LimitArguments, with_defaults};
pub use exit::Exit;
/// The crate of the viewers that [`Tool::with_viewer`] takes.
#[cfg(feature = "view")]
pub use lockstep2d_viewer;
pub use sandbox::SandboxScenes;
pub use scenes::{Catalogue, Scene, SceneInfo, Script};
pub use tool::Tool;
pub use walk::{Walk, WalkError};

/// Runs the tools of a game, without scenes, with the arguments of this process. Returns the exit code.
#[must_use]
pub fn run<G: Game>() -> ExitCode {
    Tool::<G>::new().run()
}
