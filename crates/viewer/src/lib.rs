//! A viewer for games on lockstep2d, in a window or on a web page: live play, replays, comparisons and the state of
//! bodies.
//!
//! [`Viewer`] builds the program:
//!
//! ```no_run
//! use lockstep2d_viewer::{Colour, Controls, Key, Viewer};
//! # mod my_game {
//! #     use lockstep2d::{hash::StateHash, lockstep::{Game, RulesId, SetupError}, math::{Fx, Vec2}};
//! #     #[derive(Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
//! #     pub struct Input { pub gas: i8, pub jump: bool }
//! #     #[derive(Clone, serde::Serialize, serde::Deserialize)]
//! #     pub struct MyGame { pub score: u32 }
//! #     impl MyGame { pub fn goal(&self) -> Vec2<Fx> { Vec2::ZERO } }
//! #     impl Game for MyGame {
//! #         type Setup = u64;
//! #         type Input = Input;
//! #         type Save = MyGame;
//! #         const RULES: RulesId = RulesId { name: "my game", version: 1 };
//! #         fn new(_: &u64) -> Result<Self, SetupError> { Ok(MyGame { score: 0 }) }
//! #         fn players(&self) -> u32 { 1 }
//! #         fn tick_rate(&self) -> u32 { 60 }
//! #         fn step(&mut self, _: &[Input]) {}
//! #         fn state_hash(&self) -> StateHash { StateHash(0) }
//! #         fn save(&self) -> Self { self.clone() }
//! #         fn load(&mut self, save: &Self) { *self = save.clone(); }
//! #         fn work(&self, _: &[Input]) -> u64 { 1 }
//! #     }
//! # }
//! # use my_game::{Input, MyGame};
//! fn main() -> std::process::ExitCode {
//!     let keys = Controls::new()
//!         .key(Key::Right, |input: &mut Input| input.gas += 1)
//!         .key(Key::Left, |input| input.gas -= 1)
//!         .key(' ', |input| input.jump = true);
//!     Viewer::<MyGame>::new()
//!         .scene("hill", "a car on a hill", |seed| seed)
//!         .keys(keys)
//!         .status(|game| format!("score {}", game.score))
//!         .draw(|game, canvas| canvas.text(game.goal(), Colour::hex(0x1b7f3b), "goal"))
//!         .run()
//! }
//! ```
//!
//! [`App`] is the viewer without a window, clock or files. It receives [`Event`]s and elapsed time, and fills a
//! [`DrawList`].
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

mod app;
mod canvas;
mod content;
#[cfg(not(target_arch = "wasm32"))]
mod desktop;
mod event;
pub mod live;
pub mod mesh;
mod play;
mod recording;
mod sandbox;
pub mod script;
mod source;
mod viewer;
mod window;

pub use app::{App, LAYER_KEYS, Report, Request};
pub use canvas::Canvas;
pub use event::{Button, Event, Key};
pub use lockstep2d_render::{Camera, Colour, DrawList};
pub use play::{Bot, Controls, LocalMatch, Online, Player};
pub use sandbox::sandbox;
pub use source::{OpenError, Replay, Snapshot, Source, SourceError};
pub use viewer::Viewer;
