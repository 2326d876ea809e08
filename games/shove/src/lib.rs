//! Shove: two to four players push each other off a platform that crumbles.
//!
//! The view is from above. A player is a disc that is controlled by a [`Pad`] of one byte, and can dash when the dash
//! is recharged. A mill in the centre swings two flails, bumpers kick bodies, plates recharge the dash, and crates lie
//! around. A player whose centre leaves the platform falls. While a round is being played, each player who still stands
//! then gets a point. The last player standing wins the round, unless the time runs out first.
//!
//! The game is the example for lockstep, rollback, late join and the viewer.
//!
//! ```
//! use lockstep2d::lockstep::Game;
//! use lockstep2d_shove::{Bot, Setup, Shove};
//!
//! let setup = Setup { seats: 2, ..Setup::default() };
//! let mut game = Shove::new(&setup)?;
//! let mut bots = Bot::each(&setup);
//! for _ in 0..600 {
//!     let pads: Vec<_> = bots.iter_mut().map(|bot| bot.pad(&game)).collect();
//!     game.step(&pads);
//! }
//! assert_eq!(game.world().tick(), 600);
//! # Ok::<(), lockstep2d::lockstep::SetupError>(())
//! ```

mod arena;
mod bot;
mod game;
pub mod online;
mod pad;
mod rules;
mod setup;
mod view;

pub use arena::{Role, START_RADIUS};
pub use bot::Bot;
pub use game::{Save, Shove};
pub use pad::Pad;
pub use rules::Phase;
pub use setup::{Setup, UnplayableSetup};
pub use view::Player;

/// Maximum number of players.
pub const SEATS_MAX: usize = 4;
