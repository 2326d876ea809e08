//! Shove: two to four players push each other off a platform that crumbles.
//!
//! Seen from above. A player is a disc that a [`Pad`] of one byte drives and that can dash now and then. In the middle a
//! mill swings two flails, bumpers kick what hits them, plates charge the dash of who comes over them, and crates lie
//! around. Whoever's centre leaves the platform has fallen, and all who still stand get a point. The last one wins the
//! round, unless time is up before.
//!
//! It is small on purpose: everything that lockstep, rollback, late join and the viewer are shown with plays it.
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
#[cfg(feature = "net")]
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

/// Most players of a game.
pub const SEATS_MAX: usize = 4;
