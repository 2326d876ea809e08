//! A participant in a match of any [`Game`](crate::lockstep::Game): a [`session`](crate::session) with the game, its
//! saved states and its replay.
//!
//! The caller passes the time, and packets go through a [`Transport`]. Up to [`PeerOptions::guess`] ticks are played
//! with guessed inputs and corrected by rollback; 0 is lockstep.
//!
//! ```no_run
//! # use lockstep2d::lockstep::Game;
//! # use lockstep2d::peer::{Peer, PeerError, PeerIdentity, PeerOptions, Udp};
//! # fn read_pad<G: Game>() -> G::Input { G::Input::default() }
//! # fn draw<G: Game>(_: &G) {}
//! # fn play<MyGame: Game>(setup: &MyGame::Setup) -> Result<(), Box<dyn std::error::Error>> {
//! let me = PeerIdentity::random();
//! let mut peer = Peer::<MyGame, _>::host(setup, PeerOptions::rollback(), me, Udp::bind("0.0.0.0:7000")?)?;
//! # let start = std::time::Instant::now();
//! loop {
//!     peer.update(start.elapsed())?;
//!     while peer.is_due() {
//!         peer.advance(&[read_pad::<MyGame>()])?; // one own seat; for more: one input for each of `peer.seats()`
//!     }
//!     draw(peer.game());
//!     std::thread::sleep(std::time::Duration::from_millis(1));
//! }
//! # }
//! ```

mod error;
mod event;
mod files;
mod input_slot;
#[cfg(feature = "std")]
mod network;
mod options;
mod parameters;
mod participant;
#[cfg(feature = "sealed")]
mod sealed;
mod simulation;
mod transport;

pub use error::PeerError;
pub use event::{PeerDesync, PeerEnd, PeerEvent};
#[cfg(feature = "std")]
pub use network::{LinkConditions, Network, Port};
pub use options::{PeerIdentity, PeerOptions};
pub use parameters::{ParameterDifference, PeerParameters};
pub use participant::Peer;
#[cfg(feature = "sealed")]
pub use sealed::{SEALED_OVERHEAD, Sealed};
pub use transport::Transport;
#[cfg(feature = "std")]
pub use transport::{Udp, socket_address};
